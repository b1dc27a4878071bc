// The motion as the generators see it: in a frame of the place, with distances to it.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <unordered_map>
#include <vector>

#include "pllit/sim/places/make_place.hpp"

namespace pllit {

/// Points along a path, dense enough that the polyline and its points keep the same distances within a centimetre.
class PathIndex {
 public:
  explicit PathIndex(std::vector<Vector3d> points);

  const std::vector<Vector3d>& points() const { return points_; }
  /// Horizontal distance from a place to the path, or `reach` where it is farther; and the point that is nearest.
  struct Nearest {
    double distance_m;
    std::size_t point;
  };
  Nearest nearest(const Eigen::Vector2d& p, double reach_m) const;
  /// Whether any of the mesh's triangles (shifted by offset) comes closer than clearance_m to any point.
  bool meets(const Mesh& mesh, const Vector3d& offset, double clearance_m) const;

 private:
  std::vector<Vector3d> points_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

/// Frame P of a place: its z axis is up, z = 0 on the ground at the path's lowest, its origin below the middle of the
/// path.
struct Site {
  SE3 T_W_P = SE3::Identity();
  PathIndex path_P;
  Eigen::AlignedBox3d bounds_P;  ///< of the path
  double clearance_m = 0.6;
  double height_m = 1.3;
};

/// Flat ground: as far below the path's median height as configured, but below all of it. `yaw_rad`: of P in W.
Site site_on_flat_ground(const PlaceConfig& config, double yaw_rad);
/// The same, but z = 0 is height_m below the path's lowest point.
Site site_on_slopes(const PlaceConfig& config, double yaw_rad);

/// Yaw of the path's main direction.
double main_yaw_rad(std::span<const Vector3d> path_W);

/// Points every `spacing_m` or less, with those given among them.
std::vector<Vector3d> densified(std::span<const Vector3d> path, double spacing_m);

/// Distance from p to the triangle abc.
double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c);

}  // namespace pllit
