// What lies between the intensities of two visits beside the changes: the weather, the gain of the camera, and how far
// each visit's scale had wandered by the time it saw a place.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "pllit/geometry/voxel_table.hpp"
#include "pllit/map/anchor.hpp"

namespace pllit {

struct VisitDriftConfig {
  double block_m = 1.0;  ///< a curve for each block ...
  double reach_m = 2.0;  ///< ... from the surfaces around it that both visits saw
  /// A map is the mean of many images, whose curves bend differently.
  AnchorConfig curve{.loss = 20.0, .min_pairs = 60, .min_share = 0.4, .curve_slope_doubt = 0.15};
  /// Of a linear camera neighbourhoods differ from the site by a shift alone, of at most so much: with a slope of its
  /// own a large thing that has changed would explain itself. 0: each neighbourhood has a curve.
  double most_shift = 0.0;
};

/// A voxel that both visits saw.
struct SharedVoxel {
  Vector3d p_W;
  double before = 0.0, now = 0.0;
  double sigma_before = 0.0, sigma_now = 0.0;
};

/// An intensity of the second visit in the first one's scale, and how far it may be trusted beyond its own noise.
struct BroughtIntensity {
  double value = 0.0, sigma = 0.0;
};

/// A curve for the whole site, and one for each neighbourhood where the surfaces there allow one. Curves are robust
/// (see anchor_curve): what has changed does not bend them as long as other surfaces around it were as bright.
class VisitDrift {
 public:
  VisitDrift(std::span<const SharedVoxel> shared, const VisitDriftConfig& config);

  const AnchorFit& whole() const { return whole_; }
  /// Share of the shared voxels that some curve holds for.
  double covered() const { return covered_; }
  /// Nothing where no curve holds.
  std::optional<BroughtIntensity> bring(const Vector3d& p_W, double intensity) const;

 private:
  double block_m_;
  double covered_ = 0.0;
  AnchorFit whole_;
  std::map<VoxelKey, AnchorFit> blocks_;  ///< where their own curve holds
};

}  // namespace pllit
