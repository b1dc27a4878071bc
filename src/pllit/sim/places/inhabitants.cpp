#include "pllit/sim/places/inhabitants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace pllit {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kNearest_m = 1.5;  // horizontally; height adds to it
constexpr double kOffPath_m = 1.5;
constexpr double kBody_m = 0.35;  // half a person's width, stride and all

struct Spot {
  Vector2d centre;
  double yaw_rad;  ///< towards the path, in quarter turns
  std::vector<Vector2d> seen_from;
};

/// From where on a stretch of the path, given by indices, something lies ahead, near enough and in sight; nothing where
/// it hardly ever does.
std::optional<Vector2d> seen_ahead(const FloorPlan& plan, std::size_t from, std::size_t to, const Vector2d& centre,
                                   double z_m, double reach_m) {
  constexpr double kAhead_cos = 0.95;  // a camera sees 20 degrees and more to either side
  constexpr std::size_t kStep = 4, kOften = 6;
  const auto& path = plan.site().path_P.points();
  std::vector<Vector2d> places;
  for (std::size_t i = std::max(from, kStep); i + kStep < std::min(to, path.size()); ++i) {
    const Vector2d ahead = (path[i + kStep] - path[i - kStep]).head<2>(), towards = centre - path[i].head<2>();
    if (towards.norm() > reach_m || ahead.dot(towards) < kAhead_cos * ahead.norm() * towards.norm()) continue;
    if (plan.sees(path[i].head<2>(), centre, z_m)) places.emplace_back(path[i].head<2>());
  }
  if (places.size() < kOften) return std::nullopt;
  return places[places.size() / 2];
}

bool seen_while_passing(const FloorPlan& plan, std::size_t point, const Vector2d& centre, double z_m) {
  const auto& path = plan.site().path_P.points();
  for (const int step : {-6, -3, 0, 3, 6}) {
    const auto i = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(point) + step, 0,
                                              static_cast<std::ptrdiff_t>(path.size()) - 1);
    if (!plan.sees(path[static_cast<std::size_t>(i)].head<2>(), centre, z_m)) return false;
  }
  return true;
}

/// A free spot that comes into sight after a time of the motion, and where that is not its start, before it too, if the
/// path leads anywhere twice: what nobody saw before has not changed.
std::optional<Spot> find_spot(const PlaceConfig& config, const AlignedBox2d& box_P, double size_m, double z_m,
                              double after_s, double farthest_m, const FloorPlan& plan, Random& random) {
  const double reach_m = std::max(6.0, farthest_m + 1.5);
  const auto& path = plan.site().path_P.points();
  const double from = std::clamp(after_s / config.duration_s + 0.05, 0.05, 0.8);
  const auto start = static_cast<std::size_t>(from * static_cast<double>(path.size()));
  constexpr int kAttempts = 6000, kPicky = 4000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto point = static_cast<std::size_t>(random.uniform(from, 0.95) * static_cast<double>(path.size()));
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi),
                 range_m = random.uniform(kNearest_m + 0.05, farthest_m);
    const Vector2d from_path = path[point].head<2>(),
                   centre = from_path + range_m * Vector2d(std::cos(angle), std::sin(angle));
    const AlignedBox2d box = footprint(centre, size_m, size_m);
    if (!box_P.contains(box) || !plan.free(box, 0.1)) continue;
    if (plan.site().path_P.nearest(centre, farthest_m).distance_m < kNearest_m) continue;
    if (!seen_while_passing(plan, point, centre, z_m)) continue;
    const auto later = seen_ahead(plan, start, path.size(), centre, z_m, reach_m),
               earlier = after_s > 0.0 ? seen_ahead(plan, 0, start, centre, z_m, reach_m) : later;
    if (attempt < kPicky && !(later && earlier)) continue;
    const Vector2d back = from_path - centre;
    const double quarter = 0.5 * std::numbers::pi;
    return Spot{centre,
                quarter * std::round(std::atan2(back.y(), back.x()) / quarter),
                {from_path, later.value_or(from_path), earlier.value_or(from_path)}};
  }
  return std::nullopt;
}

/// Keeps furniture out of the line of sight.
void take_sight(const Spot& spot, FloorPlan& plan) {
  for (const Vector2d& from : spot.seen_from)
    for (double share = 0.0; share < 1.0; share += 0.05)
      plan.take(footprint(spot.centre + share * (from - spot.centre), 0.2, 0.2), 0.0);
}

Actor standing(std::string name, Mesh mesh, const Spot& spot, double z_m, const SE3& T_W_P) {
  const SE3 T_P_O = pose_from(exp_so3({0.0, 0.0, spot.yaw_rad}), {spot.centre.x(), spot.centre.y(), z_m});
  Actor actor;
  actor.name = std::move(name);
  actor.mesh_O = std::move(mesh);
  actor.path = {{0.0, T_W_P * T_P_O}};
  return actor;
}

Mesh put(const Mesh& mesh, const Spot& spot, double z_m = 0.0) {
  return shapes::at(mesh, Vector3d(spot.centre.x(), spot.centre.y(), z_m).cast<float>(),
                    static_cast<float>(spot.yaw_rad));
}

void warm(Actor& actor, const FindingSpec& spec) {
  actor.finding = true;
  if (spec.arrival == FindingSpec::Arrival::brought_in_hot) {
    actor.appears_s = spec.at_s;
    for (float& warmer_K : actor.mesh_O.warmer_K) warmer_K += static_cast<float>(spec.by_K);
  } else {
    actor.heating = {{spec.at_s, static_cast<float>(spec.by_K), 15.0}};
  }
}

constexpr double kTable_m = 0.74;

Actor found_object(const FindingSpec& spec, const Spot& spot, double ceiling_m, const SE3& T_W_P, SceneBuilder& scene,
                   Random& random) {
  switch (spec.kind) {
    case FindingSpec::Kind::cabinet:
      return standing("cabinet", shapes::cabinet({0.35F, 0.6F, 1.1F}, random), spot, 0.0, T_W_P);
    case FindingSpec::Kind::pipe: {
      constexpr float kRadius = 0.06F;
      scene.add(put(shapes::cylinder(kRadius, static_cast<float>(ceiling_m), 12, {Material::painted_metal}), spot));
      return standing("valve", shapes::flange(kRadius), spot, random.uniform(0.9, 1.3), T_W_P);
    }
    case FindingSpec::Kind::box:
    case FindingSpec::Kind::on_table:
      break;
  }
  scene.add(put(shapes::table({0.6F, 0.7F, static_cast<float>(kTable_m)}, Material::wood), spot));
  if (spec.kind == FindingSpec::Kind::box)
    return standing("box", shapes::box(Vector3d::Constant(spec.size_m).cast<float>(), {Material::painted_metal}), spot,
                    kTable_m, T_W_P);
  const bool kettle = random.uniform() < 0.5;
  return standing(kettle ? "kettle" : "toolbox", kettle ? shapes::kettle() : shapes::toolbox(), spot, kTable_m, T_W_P);
}

Actor distractor(const DistractorSpec& spec, const Spot& spot, const SE3& T_W_P, SceneBuilder& scene, Random& random) {
  if (spec.kind == DistractorSpec::Kind::hot_radiator)
    return standing("radiator", shapes::radiator(0.7F, 0.6F, static_cast<float>(random.uniform(5.0, 15.0))), spot, 0.0,
                    T_W_P);
  scene.add(put(shapes::table({0.6F, 0.7F, static_cast<float>(kTable_m)}, Material::wood), spot));
  Actor actor = standing("cold box", shapes::toolbox(), spot, kTable_m, T_W_P);
  for (float& warmer_K : actor.mesh_O.warmer_K) warmer_K -= 9.0F;
  actor.appears_s = spec.at_s;
  return actor;
}

}  // namespace

Expected<std::vector<Actor>> add_findings(const PlaceConfig& config, const AlignedBox2d& box_P, double ceiling_m,
                                          FloorPlan& plan, SceneBuilder& scene) {
  constexpr double kSize_m = 0.75;
  Random random(config.seed, 70);
  std::vector<Actor> actors;
  const auto spot_after = [&](double after_s, double z_m, double farthest_m) {
    // What only comes after the walk is for another visit, of the same place: it may stand where it would from the
    // start.
    const double seen_after_s = after_s < config.duration_s ? after_s : 0.0;
    const auto spot = find_spot(config, box_P, kSize_m, z_m, seen_after_s, farthest_m, plan, random);
    if (spot) {
      plan.take(footprint(spot->centre, kSize_m, kSize_m), z_m + 0.4);
      take_sight(*spot, plan);
    }
    return spot;
  };
  const auto no_spot = [] {
    return input_error(
        "no free spot beside the path and in sight before and after for another finding or distractor: "
        "ask for fewer, take another seed or a longer path");
  };
  const SE3& T_W_P = plan.site().T_W_P;
  for (const FindingSpec& spec : config.findings) {
    const auto spot = spot_after(spec.at_s, 0.75, spec.farthest_m);
    if (!spot) return no_spot();
    actors.push_back(found_object(spec, *spot, ceiling_m, T_W_P, scene, random));
    warm(actors.back(), spec);
  }
  for (const DistractorSpec& spec : config.distractors) {
    const auto spot = spot_after(spec.at_s, 0.75, FindingSpec{}.farthest_m);
    if (!spot) return no_spot();
    actors.push_back(distractor(spec, *spot, T_W_P, scene, random));
  }
  return actors;
}

Actor pacing(std::string name, Mesh mesh_O, const std::vector<Vector3d>& line_P, double speed_mps, double start_share,
             double until_s, const SE3& T_W_P) {
  Actor actor;
  actor.name = std::move(name);
  actor.mesh_O = std::move(mesh_O);
  const std::size_t corners = line_P.size();
  auto index = std::min(static_cast<std::size_t>(start_share * static_cast<double>(corners - 1)), corners - 2);
  bool forth = true;
  for (double t_s = 0.0; t_s < until_s + 10.0;) {
    if (forth ? index + 1 >= corners : index == 0) forth = !forth;
    const std::size_t next = forth ? index + 1 : index - 1;
    const Vector3d step = line_P[next] - line_P[index];
    const SO3 heading = exp_so3({0.0, 0.0, std::atan2(step.y(), step.x())});
    const double arrives_s = t_s + std::max(0.2, step.norm() / speed_mps);
    actor.path.push_back({t_s, T_W_P * pose_from(heading, line_P[index])});
    actor.path.push_back({arrives_s - 0.1, T_W_P * pose_from(heading, line_P[next])});
    t_s = arrives_s;
    index = next;
  }
  return actor;
}

std::vector<Actor> walkers_inside(const PlaceConfig& config, const AlignedBox2d& box_P, const FloorPlan& plan) {
  Random random(config.seed, 71);
  std::vector<Actor> walkers;
  const auto clear = [&](const Vector2d& a, const Vector2d& b) {
    const int steps = std::max(2, static_cast<int>((b - a).norm() / 0.2));
    for (int i = 0; i <= steps; ++i) {
      const AlignedBox2d body = footprint(a + (b - a) * (static_cast<double>(i) / steps), 2.0 * kBody_m, 2.0 * kBody_m);
      if (!box_P.contains(body) || !plan.free(body, 0.0) || !plan.off_path(body, kOffPath_m)) return false;
    }
    return true;
  };
  for (int attempt = 0; attempt < 3000 && static_cast<int>(walkers.size()) < config.people; ++attempt) {
    const auto any = [&] {
      return Vector2d(random.uniform(box_P.min().x(), box_P.max().x()),
                      random.uniform(box_P.min().y(), box_P.max().y()));
    };
    const Vector2d a = any(), b = a + random.uniform(0.8, 5.0) * (any() - a).normalized();
    if (!clear(a, b)) continue;
    walkers.push_back(pacing("person", shapes::person(random), {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}},
                             random.uniform(0.6, 1.4), random.uniform(), config.duration_s, plan.site().T_W_P));
  }
  return walkers;
}

}  // namespace pllit
