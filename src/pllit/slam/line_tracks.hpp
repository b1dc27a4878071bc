// Which observed lines are the map's: lines that are matched from image to image, and what the map knows of each.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/base/arena.hpp"
#include "pllit/map/line_map.hpp"
#include "pllit/thermal/depth.hpp"
#include "pllit/thermal/observations.hpp"

namespace pllit {

/// Follows lines through a window of keyframes, which it mirrors: add() an image, then keep() it where it became a
/// keyframe, and drop() the keyframe that made room.
class LineTracks {
 public:
  explicit LineTracks(const LineMapConfig& config) : map_(config) {}

  /// The image's lines that have become lines of the map. Each goes with the oldest keyframe of the window that saw it:
  /// it was built from about there, with that pose's error. Keyframe::T_W_C is all that is read of them.
  std::vector<LineObservation> observed(const Features& now, const Tracks& tracks,
                                        std::span<const Keyframe> keyframes) const;
  /// Sightings of the image's lines, by the pose that the filter left it.
  void add(const Features& now, const Tracks& tracks, const DepthImage& depths, const SE3& T_W_C, const Camera& camera,
           Arena& arena);
  /// The image of the last add() is the window's newest keyframe.
  void keep() { keyframes_.push_back(now_); }
  /// The keyframe at this index has left the window.
  void drop(std::size_t index) { keyframes_.erase(keyframes_.begin() + static_cast<std::ptrdiff_t>(index)); }
  /// Forgets everything: the poses that it was built on are not to be trusted any more.
  void restart();

  const LineMap& map() const { return map_; }

 private:
  using PerLine = std::vector<std::optional<TrackId>>;
  PerLine tracks_of(const Features& now, const Tracks& tracks) const;

  std::size_t oldest_with(TrackId track) const;

  LineMap map_;
  std::vector<PerLine> keyframes_;  ///< of the window, oldest first
  PerLine now_;
};

}  // namespace pllit
