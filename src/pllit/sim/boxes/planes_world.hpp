// A world made of rectangles, seen by rays. Analytic: a hit is exact to rounding.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace pllit {

/// A bounded plane patch in W, visible from both sides; the half edges are orthogonal.
struct Rectangle {
  Eigen::Vector3d center_W;
  Eigen::Vector3d half_u_W, half_v_W;  ///< from the centre to the middle of an edge, metres
  double reflectivity = 0.5;           ///< 0 to 1
};

struct RayHit {
  double range_m = 0.0;
  std::size_t rectangle = 0;   ///< index into PlanesWorld::rectangles()
  double cos_incidence = 0.0;  ///< 1 where the ray meets the surface at a right angle
};

class PlanesWorld {
 public:
  explicit PlanesWorld(std::vector<Rectangle> rectangles);

  const std::vector<Rectangle>& rectangles() const { return rectangles_; }

  /// Indices of the rectangles that may lie within `slack` (rad) of the plane through `origin_W` with the unit
  /// `normal_W`, as seen from there; a fan of rays in that plane needs to look at these only.
  std::vector<std::size_t> near_plane(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& normal_W,
                                      double slack) const;

  /// Nearest hit within max_range_m of the ray along the unit `direction_W`, among all rectangles or the given ones.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W,
                             double max_range_m) const;
  std::optional<RayHit> cast(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W, double max_range_m,
                             std::span<const std::size_t> among) const;

  /// Distance from a point to the nearest rectangle, metres.
  double distance_m(const Eigen::Vector3d& point_W) const;

 private:
  /// What the inner loop needs: normal . x = offset on the plane; |u . (x - center)| <= 1 and likewise v inside.
  struct Patch {
    Eigen::Vector3d normal, center, u, v;
    double offset, radius;
  };
  std::vector<Rectangle> rectangles_;
  std::vector<Patch> patches_;
  std::vector<std::size_t> all_;
};

}  // namespace pllit
