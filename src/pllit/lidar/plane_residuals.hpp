// Point-to-plane residuals of a scan against the plane map: the paper's eq. (7) as normal equations.
#pragma once

#include <memory>

#include "pllit/base/arena.hpp"
#include "pllit/lidar/plane_map.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/state/normal_equations.hpp"

namespace pllit {

struct PlaneResidualConfig {
  double huber = 1.5;             ///< whitened residual at which the loss turns linear
  double gate = 3.0;              ///< residuals beyond this many standard deviations, prior included, do not count
  double max_distance = 1.0;      ///< nor beyond this share of the plane's voxel
  double max_information = 30.0;  ///< independent points that a scan may count for at most; 0: every point counts
  double plane_points = 20.0;  ///< independent points that a plane may count for at most (its points share pose errors)
};

/// Normal equations of a scan, and how much of them may be noise.
struct PlaneEquations {
  NormalEquations sums;
  /// What errors of the planes' normals add to the 6 x 6 pose block of H in the mean: information that is not there.
  Matrix6 noise_information = Matrix6::Zero();
  double weight = 0.0;     ///< sum of the weights, 1/m2
  double lever2_m2 = 0.0;  ///< sum of weight x squared distance from I

  PlaneEquations& operator+=(const PlaneEquations& other);
};

/// Residuals of one scan. A function of the state alone: what it keeps between calls is only the planes already fitted,
/// which are looked up again where a point has moved to other voxels.
class PlaneResiduals {
 public:
  /// `search_covariance`: 6 x 6 pose covariance of the prediction, for the gate. The referents must outlive the object.
  PlaneResiduals(const PointCloud& cloud, const PlaneMap& map, const Rig& rig, const Matrix6& search_covariance,
                 const PlaneResidualConfig& config, Arena& arena);

  PlaneEquations operator()(const NavState& state);

 private:
  struct Association {
    PlaneMap::Window window{};
    bool looked_up = false;
    std::optional<PlanePatch> plane;
  };
  void add_point(std::size_t i, const NavState& state, PlaneEquations& equations);

  const PointCloud& cloud_;
  const PlaneMap& map_;
  const Rig& rig_;
  Matrix6 search_covariance_;
  PlaneResidualConfig config_;
  Arena& arena_;
  std::vector<Association> associations_;
};

}  // namespace pllit
