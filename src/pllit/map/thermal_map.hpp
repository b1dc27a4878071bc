// The thermographic map: in every voxel of a surface, what intensity is normal there (the paper's probabilistic
// intensity voxel map).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pllit/geometry/voxel_blocks.hpp"
#include "pllit/map/image_sampling.hpp"
#include "pllit/map/thermal_voxel.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

struct ThermalMapConfig {
  double voxel_m = 0.05;
  double memory_mb = 256.0;  ///< above this the voxels that were not seen for longest are dropped
  VoxelModelConfig model{};
};

/// One image's observations, and what is common to them.
struct ThermalView {
  Time time;
  Vector3d viewpoint_W = Vector3d::Zero();
  double spread = 0.0;  ///< of its intensities about what is known, one sigma, in the map's unit
  std::vector<SurfaceObservation> observations{};
};

class ThermalMap {
 public:
  explicit ThermalMap(const ThermalMapConfig& config) : config_(config) {}

  /// Takes in one image: all observations of a voxel count as one sample of it, for they share the image's errors.
  /// Returns the voxels that were seen, ascending. The order of the observations makes no difference but rounding.
  std::vector<VoxelKey> integrate(const ThermalView& view);
  /// Keeps within the memory limit. Returns what was dropped, as `table` would show it.
  PointTable trim();
  /// What was known of a surface that is no longer there says nothing about the next one in its place.
  void forget(const Vector3d& p_W);

  const ThermalVoxel* find(VoxelKey key) const { return voxels_.find(key); }
  /// Voxel that a point lies in.
  VoxelKey key_at(const Vector3d& p_W) const { return voxel_key(voxel_of(p_W, 1.0 / config_.voxel_m)); }
  /// Mean of the points seen in a voxel.
  Vector3d position_W(VoxelKey key, const ThermalVoxel& voxel) const;

  /// Every voxel as a point with scalar fields: `intensity` (now), `normal`, `sigma` (in the map's unit), `raw`,
  /// `images`, `views`, `change_sigmas` (zero where nothing changed), `seen_s` (since the first image).
  PointTable table() const;
  static std::vector<std::string> fields();

  /// Of the first image; field `seen_s` counts from here.
  const std::optional<Time>& start() const { return start_; }
  std::size_t size() const { return voxels_.size(); }
  std::size_t bytes() const { return voxels_.bytes(); }
  const ThermalMapConfig& config() const { return config_; }

 private:
  Vector3d centre_W(VoxelKey key) const;
  void append(PointTable& table, const Eigen::Vector3i& at, const ThermalVoxel& voxel, Time start) const;

  ThermalMapConfig config_;
  VoxelBlocks<ThermalVoxel> voxels_;
  std::optional<Time> start_;
};

}  // namespace pllit
