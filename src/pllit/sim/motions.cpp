#include "pllit/sim/motions.hpp"

#include <utility>

#include "pllit/sim/motion/continuation.hpp"
#include "pllit/sim/motion/paths.hpp"
#include "pllit/sim/motion/routes.hpp"

namespace pllit {
namespace {

constexpr Time kStart = time_from_parts(1'700'000'000, 0);  // any real date, so that lost digits of a time would show
constexpr double kCarAcceleration_mps2 = 3.9;

Trajectory started_at(Trajectory path, Time start) {
  const Duration by = path.empty() ? Duration{0} : start - path.front().time;
  for (StampedPose& pose : path) pose.time += by;
  return path;
}

Expected<Trajectory> edited(const SimConfig& config, const SimRig& rig, Trajectory path) {
  if (config.way == SimConfig::Way::mirrored) path = mirrored(path);
  if (config.way == SimConfig::Way::reversed) path = reversed(path);
  if (config.length_m)
    path = rig.on_car ? continued(path, {.length_m = *config.length_m}) : cut_to_length(path, *config.length_m);
  if (config.speedup == 1.0) return path;
  if (rig.on_car) return sped_up_within(path, config.speedup, kCarAcceleration_mps2, kCarFit);
  return sped_up(path, config.speedup);
}

Motion upright_motion(const SimConfig& config) {
  switch (config.scene) {
    case SceneKind::corridor:
      return corridor_walk({.seed = config.seed, .length_m = config.length_m.value_or(100.0)});
    case SceneKind::stairs:
      return stair_climb({.seed = config.seed, .stairs = {.level_m = config.length_m.value_or(0.0)}});
    default:
      return inspection_walk({.seed = visit_seed(config)});
  }
}

Expected<ChosenMotion> along(const Trajectory& path, const SimRig& rig) {
  auto fitted = motion_along(started_at(path, kStart), rig.on_car ? kCarFit : kHandHeldFit);
  if (!fitted) return std::unexpected(fitted.error());
  return ChosenMotion{std::move(fitted->motion), fitted->distance};
}

Expected<ChosenMotion> calm_motion(const SimConfig& config, const SimRig& rig, const std::optional<Trajectory>& path) {
  if (path) {
    const auto way = edited(config, rig, *path);
    return way ? along(*way, rig) : std::unexpected(way.error());
  }
  if (config.scene == SceneKind::street || config.scene == SceneKind::field) {
    Trajectory drive = street_drive(
        {.seed = config.seed, .length_m = config.length_m.value_or(500.0), .speed_mps = rig.on_car ? 10.0 : 1.4});
    for (StampedPose& pose : drive) pose.T_W_I = pose.T_W_I * pose_from(rig.R_B_I, Vector3d(0.0, 0.0, rig.height_m));
    return along(drive, rig);
  }
  const Motion upright = upright_motion(config);
  return ChosenMotion{upright.of_turned_frame(rig.R_B_I), std::nullopt};
}

}  // namespace

Expected<ChosenMotion> choose_motion(const SimConfig& config, const SimRig& rig,
                                     const std::optional<Trajectory>& path) {
  auto chosen = calm_motion(config, rig, path);
  if (chosen && !config.ideal)
    chosen->motion = chosen->motion.with_vibration(rig.on_car ? vehicle_vibration(visit_seed(config))
                                                              : hand_held_vibration(visit_seed(config)));
  return chosen;
}

}  // namespace pllit
