// The map's explicit lines: from tracked segments to landmarks (the paper's "Spatiotemporal Explicit Structural
// Constraints").
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/map/line_fit.hpp"

namespace pllit {

struct LineMapConfig {
  LineFitConfig fit{};
  int min_sightings = 5;         ///< the paper's N_track
  int most_sightings = 20;       ///< kept for a fit; a line with as many is left as it is
  int points_per_sighting = 12;  ///< at most; more would only repeat the sighting's common error
  int patience = 30;             ///< images without a sighting after which a track that is no line yet is forgotten
  double merge_deg = 3.0;        ///< two lines are one when their directions differ by less
  double merge_m = 0.06;         ///< and one passes the other's ends by less
  double keep_m = 60.0;          ///< lines farther than this from the rig are dropped
};

using TrackId = std::uint32_t;

/// A line of the map as a camera sees it, or would.
struct VisibleLine {
  LineLandmark line;
  Eigen::Vector2d start_px, end_px;  ///< of the part inside the image
};

class LineMap {
 public:
  explicit LineMap(const LineMapConfig& config) : config_(config) {}

  /// Another sighting of a track, or the first of a new one; returns the track. The points are those of the image as
  /// the filter left its pose. A track becomes a line of the map once it has sightings and points enough and they are
  /// straight; a line that is one already is merged with it.
  TrackId observe(std::optional<TrackId> track, LineSighting sighting);
  /// One image is over: forgets tracks that are lost, and lines that the rig has left behind.
  void end_image(const Vector3d& p_W);
  void clear();

  /// The line that a track has become; nothing before that.
  std::optional<LineLandmark> line_of(TrackId track) const;
  /// Lines that lie in the image, at least in part and for `min_px`; whether something hides them is not known here.
  std::vector<VisibleLine> visible_from(const SE3& T_W_C, const Camera& camera, double min_px = 20.0) const;
  std::vector<LineLandmark> lines() const;

 private:
  struct Track {
    std::deque<LineSighting> sightings;
    int seen = 0;  ///< images
    int last_image = 0;
    std::optional<std::uint32_t> line;
  };
  void promote(Track& track);
  std::optional<std::uint32_t> same_line(const LineLandmark& line) const;

  LineMapConfig config_;
  std::map<TrackId, Track> tracks_;
  std::map<std::uint32_t, LineLandmark> lines_;
  TrackId next_track_ = 0;
  std::uint32_t next_line_ = 0;
  int image_ = 0;
};

}  // namespace pllit
