#include "pllit/sim/places/make_place.hpp"

#include <algorithm>
#include <cmath>

#include "pllit/sim/places/generators.hpp"

namespace pllit {
namespace {

Expected<void> check(const PlaceConfig& config) {
  if (config.path_W.size() < 2)
    return input_error("a place is made around a path of at least two points, not " +
                       std::to_string(config.path_W.size()));
  const auto finite = [](const Vector3d& p) { return p.allFinite(); };
  if (const auto bad = std::ranges::find_if_not(config.path_W, finite); bad != config.path_W.end())
    return input_error("point " + std::to_string(bad - config.path_W.begin()) +
                       " of the path has a coordinate that is not finite");
  if (!(config.height_m > 0.0) || !(config.clearance_m > 0.0) || !(config.duration_s > 0.0))
    return input_error("the height above ground, the clearance and the duration must be positive");
  const bool inspected = config.kind == PlaceKind::room || config.kind == PlaceKind::plant;
  if (!inspected && !(config.findings.empty() && config.distractors.empty()))
    return input_error(
        "findings and distractors exist in rooms and plants only: choose one of these or leave them out");
  return {};
}

Expected<PlaceParts> parts_of(const PlaceConfig& config) {
  switch (config.kind) {
    case PlaceKind::room:
      return make_room(config);
    case PlaceKind::corridor:
      return make_corridor(config);
    case PlaceKind::stairs:
      return make_stairs(config);
    case PlaceKind::plant:
      return make_plant(config);
    case PlaceKind::street:
      return make_street(config);
    case PlaceKind::field:
      return make_field(config);
  }
  return input_error("unknown kind of place");
}

}  // namespace

Expected<std::unique_ptr<Place>> make_place(const PlaceConfig& config) {
  if (auto checked = check(config); !checked) return std::unexpected(checked.error());
  auto parts = parts_of(config);
  if (!parts) return std::unexpected(parts.error());
  parts->climate.air_K += config.warmer_K;
  parts->climate.air_drift_Kph += config.air_drift_Kph;
  return assembled(std::move(*parts));
}

std::vector<Vector3d> positions_of(const Trajectory& trajectory) {
  std::vector<Vector3d> positions;
  for (const StampedPose& pose : trajectory) positions.push_back(pose.T_W_I.translation());
  return positions;
}

Vector3d visible_centroid_W(const Actor& actor, double at_s, const std::vector<Vector3d>& path_W) {
  constexpr double kNear_m = 6.0;
  const SE3 T_W_O = actor.pose(at_s);
  const Vector3d there = T_W_O.translation();
  std::vector<Vector3d> eyes;
  for (const Vector3d& p : path_W)
    if ((p - there).norm() < kNear_m) eyes.push_back(p);
  if (eyes.empty())
    eyes.push_back(*std::ranges::min_element(
        path_W, [&](const Vector3d& a, const Vector3d& b) { return (a - there).norm() < (b - there).norm(); }));
  Vector3d sum = Vector3d::Zero();
  double weights = 0.0;
  for (const auto& triangle : actor.mesh_O.triangles) {
    const auto corner = [&](std::size_t i) { return T_W_O.act(actor.mesh_O.vertices[triangle[i]].cast<double>()); };
    const Vector3d a = corner(0), b = corner(1), c = corner(2), centre = (a + b + c) / 3.0,
                   normal = 0.5 * (b - a).cross(c - a);
    for (const Vector3d& eye : eyes) {
      const Vector3d to_eye = eye - centre;
      const double weight = std::max(0.0, normal.dot(to_eye)) / std::pow(to_eye.norm(), 3);
      sum += weight * centre;
      weights += weight;
    }
  }
  return weights > 0.0 ? Vector3d(sum / weights) : there;
}

}  // namespace pllit
