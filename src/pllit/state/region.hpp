// Named regions of a place, and what a visit shows of them: the values that files, statistics and stores share.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "pllit/geometry/lie.hpp"

namespace pllit {

/// From what on something is to be told of a region.
struct RegionLimits {
  std::optional<double> change{};  ///< hotter than on the baseline by so much, in the unit of the map
  std::optional<double> kelvin{};  ///< temperature, K; radiometric input only
};

/// A box in the baseline's map frame W.
struct Region {
  std::string tag;
  Vector3d min_W = Vector3d::Zero(), max_W = Vector3d::Zero();
  double yaw_rad = 0.0;  ///< by which the box is turned about the vertical through its middle, counter-clockwise
  std::optional<double> emissivity{};  ///< of its surfaces; radiometric input only
  RegionLimits limits{};
  int line = 0;  ///< of the file that it stands in

  bool contains(const Vector3d& p_W) const {
    const Vector3d middle_W = 0.5 * (min_W + max_W), half_m = 0.5 * (max_W - min_W);
    const Vector3d p_box = Eigen::AngleAxisd(-yaw_rad, Vector3d::UnitZ()) * (p_W - middle_W);
    return (p_box.cwiseAbs().array() <= half_m.array()).all();
  }
};

/// Over the voxels of a region, in the unit of the map.
struct RegionValues {
  double mean = 0.0, p95 = 0.0, max = 0.0;
};

/// What one visit shows of a region.
struct RegionReading {
  int baseline_voxels = 0;                ///< that the baseline saw in the box
  int seen_again = 0;                     ///< of these, by the visit
  int voxels = 0;                         ///< that the visit saw in the box, new surfaces included
  std::optional<RegionValues> own{};      ///< as the visit measured; nothing where it saw no voxel
  std::optional<RegionValues> brought{};  ///< brought to the baseline; nothing where nothing brings it there either
  struct Change {
    double mean = 0.0, max = 0.0;  ///< against the baseline, voxel by voxel, over those that both saw
  };
  std::optional<Change> change{};
  /// Whether a limit is reached; nothing where there is none, or nothing to judge it by.
  std::optional<bool> change_exceeded{}, kelvin_exceeded{};

  bool seen() const { return voxels > 0; }
  /// Share of the baseline's voxels that was seen again; 0 where the baseline saw none.
  double seen_share() const { return baseline_voxels > 0 ? double(seen_again) / baseline_voxels : 0.0; }
  bool exceeded() const { return change_exceeded.value_or(false) || kelvin_exceeded.value_or(false); }
};

}  // namespace pllit
