// From hot voxels to findings: clusters that last, and what becomes of them.
#pragma once

#include <map>
#include <vector>

#include "pllit/map/watch.hpp"
#include "pllit/state/anomaly.hpp"

namespace pllit {

struct AnomalyConfig {
  WatchConfig watch;
  int min_voxels = 4;       ///< smaller clusters are noise
  double min_sigmas = 5.0;  ///< mean change of its voxels: they err together, so that many say no more than one
  double dwell_s = 0.5;     ///< how long its voxels must have been hot before the alarm is raised
  int min_views = 2;  ///< viewpoints that it must have been hot from, twice as many where it is one voxel thick: what
                      ///< is seen past an edge moves ...
  double still_dwell_s = 3.0;  ///< ... or how long, for a rig that stands
  /// Its mean change must be so much of the greatest, or it must have lasted for still_dwell_s; and so much where it is
  /// one voxel thick, however long it lasted: the rim of a thing shows now and then what is behind it.
  double evenness = 0.4;
  /// So much of the least change must be left in a third of the voxels that are judged by themselves, and in two,
  /// however they lie to the edges of the image: at its edge a hot thing may be a seam that is seen a few pixels off,
  /// inside it is one.
  double sure_change = 0.67;
  /// It must outshine so much of what is normally brighter than it, in three images in a row (outshining.hpp); 0: not
  /// asked.
  double min_outshone = 0.0;
  double join_m = 0.1;         ///< hot voxels in neighbouring cells of this size are one anomaly
  int enough_seeds = 8;        ///< so many voxels that are judged by themselves vouch for any number of others
  double place_cell_m = 0.15;  ///< its position is the mean over cells of this size, whatever they hold
  double max_leaving = 0.3;    ///< clusters of which a greater share has left their place are moving: people, vehicles
  double least_still = 0.6;    ///< ... and so is what came, if a smaller share of where it was is still seen hot
  double registration_m = 0.02;   ///< how well images and surfaces lie on each other, one sigma
  double forget_fresh_s = 120.0;  ///< what was never confirmed is dropped when not seen for so long
};

/// Follows what is hot from image to image. Anomalies keep their numbers; those that were never confirmed vanish again.
class AnomalyDetector {
 public:
  explicit AnomalyDetector(const AnomalyConfig& config) : config_(config) {}

  /// Takes in an image that the map has been given. Only images whose pose and calibration hold may come here.
  void update(const WatchInput& input, const ThermalView& view);

  /// In order of their numbers.
  std::vector<Anomaly> anomalies() const;
  const Watch& watch() const { return watch_; }

 private:
  /// Hot voxels that hang together, ascending.
  using Cluster = std::vector<VoxelKey>;
  /// What an anomaly owns of the watch.
  using Parts = std::vector<WatchedVoxel*>;
  struct Track {
    Anomaly anomaly;
    Vector3d last_viewpoint_W;
    int outshining = 0;  ///< images in a row in which it outshone what it must
  };

  std::vector<Cluster> clusters(const ThermalMap& map) const;
  Track& owner_of(const Cluster& cluster, const ThermalView& view);
  Track& new_track(const Cluster& cluster, const ThermalView& view);
  std::map<std::uint32_t, Parts> parts_by_owner();
  void note_outshining(const WatchInput& input, std::map<std::uint32_t, Parts>& parts_of, Time now);
  void measure(Track& track, const Parts& parts, const ThermalView& view);
  void settle(Track& track, const Parts& parts, Time now, const ThermalMap& map) const;
  void drop_vanished(Time now, const std::map<std::uint32_t, Parts>& parts_of);

  AnomalyConfig config_;
  Watch watch_;
  std::map<std::uint32_t, Track> tracks_;
  std::uint32_t next_id_ = 1;
};

}  // namespace pllit
