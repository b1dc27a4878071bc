#include "simulated_views.hpp"

#include <algorithm>
#include <filesystem>
#include <format>
#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "pllit/sim/config.hpp"
#include "pllit/sim/motions.hpp"
#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/rigs.hpp"

namespace pllit::bench {
namespace {

constexpr double kReach_m = 150.0;

PlaceKind place_kind(SceneKind scene) {
  switch (scene) {
    case SceneKind::corridor:
      return PlaceKind::corridor;
    case SceneKind::stairs:
      return PlaceKind::stairs;
    case SceneKind::plant:
      return PlaceKind::plant;
    case SceneKind::street:
      return PlaceKind::street;
    case SceneKind::field:
      return PlaceKind::field;
    default:
      return PlaceKind::room;
  }
}

PlaceConfig place_config(const SimConfig& config, const SimRig& rig, const Motion& motion) {
  PlaceConfig place{.kind = place_kind(config.scene), .seed = config.seed, .path_W = {}};
  place.duration_s = to_seconds(motion.end() - motion.start());
  const int steps = std::max(2, static_cast<int>(place.duration_s / 0.2));
  for (int i = 0; i <= steps; ++i)
    place.path_W.push_back(motion.at(motion.start() + from_seconds(place.duration_s * i / steps)).T_W_I.translation());
  place.height_m = rig.height_m;
  place.clearance_m = rig.on_car ? 2.5 : 0.6;
  place.light = config.day ? Light::day : Light::night;
  return place;
}

}  // namespace

SimulatedViews::SimulatedViews(std::string address, ThermalCameraModel model, SE3 T_I_C, Motion motion,
                               std::unique_ptr<Place> place)
    : address_(std::move(address)),
      model_(std::move(model)),
      T_I_C_(T_I_C),
      motion_(std::move(motion)),
      place_(std::move(place)),
      caster_(std::make_unique<RayCaster>(*place_, kReach_m)),
      arena_(std::make_unique<Arena>(0)) {
  // Shutter events are the benchmark's business.
  model_.shutter = {.least_interval_s = 1e6, .most_interval_s = 1e6, .least_freeze_s = 0.0, .most_freeze_s = 0.0};
}

Expected<SimulatedViews> SimulatedViews::make(const std::string& address) {
  auto config = parse_sim_config(address);
  if (!config) return std::unexpected(config.error());
  const bool drive = config->scene == SceneKind::street || config->scene == SceneKind::field;
  const SimRig rig = sim_rig(drive ? SimConfig::RigName::ntu4dradlm : SimConfig::RigName::inspection);
  auto motion = choose_motion(*config, rig, std::nullopt);
  if (!motion) return std::unexpected(motion.error());
  auto place = make_place(place_config(*config, rig, motion->motion));
  if (!place) return std::unexpected(place.error());
  return SimulatedViews(address, *rig.thermal, rig.T_I_C, std::move(motion->motion), std::move(*place));
}

std::vector<View> SimulatedViews::views(double begin_s, int count, const std::string& folder) {
  ThermalCamera camera(model_, *place_, motion_.start(), 1);
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const Time time = motion_.start() + from_seconds(begin_s + 0.1 * i);
    View view{.time = time, .T_W_C = pose(time - from_seconds(model_.time_constant_s)), .counts = {}};
    const std::string file = std::format("{}/{:016x}_{}.png", folder, std::hash<std::string>{}(address_),
                                         to_seconds(time - motion_.start()));
    if (!folder.empty() && std::filesystem::exists(file)) {
      view.counts = cv::imread(file, cv::IMREAD_UNCHANGED);
    } else {
      look_from(view);
      view.counts = camera.capture(*caster_, [this](Time t) { return pose(t); }, time, *arena_).counts;
      if (!folder.empty()) cv::imwrite(file, view.counts);
    }
    views.push_back(view);
  }
  return views;
}

void SimulatedViews::look_from(const View& view) {
  if (looking_at_ == view.time) return;
  caster_->move_to(view.T_W_C.translation(), to_seconds(view.time - motion_.start()));
  looking_at_ = view.time;
}

std::optional<Vector3d> SimulatedViews::surface_W(const View& view, const Eigen::Vector2f& at_px) {
  look_from(view);
  constexpr double kAround_px = 1.2;
  const Matrix3d R_W_C = view.T_W_C.rotation();
  double nearest_m = -1.0;
  for (const double x : {0.0, -kAround_px, kAround_px})
    for (const double y : {0.0, -kAround_px, kAround_px}) {
      const Vector3d ray_W = R_W_C * camera().ray(at_px.cast<double>() + Eigen::Vector2d(x, y));
      const Hit hit = caster_->cast(Ray{view.T_W_C.translation(), ray_W});
      if (hit && (nearest_m < 0.0 || hit.range_m < nearest_m)) nearest_m = hit.range_m;
    }
  if (nearest_m < 0.0) return std::nullopt;
  return view.T_W_C.act(Vector3d(nearest_m * camera().ray(at_px.cast<double>())));
}

std::optional<Eigen::Vector2f> SimulatedViews::pixel_of(const Vector3d& p_W, const View& view) {
  look_from(view);
  const auto pixel = camera().project(view.T_W_C.inverse().act(p_W));
  constexpr double kMargin_px = 8.0;
  if (!pixel || pixel->x() < kMargin_px || pixel->y() < kMargin_px || pixel->x() > camera().width - 1 - kMargin_px ||
      pixel->y() > camera().height - 1 - kMargin_px)
    return std::nullopt;
  const Vector3d from_W = view.T_W_C.translation(), way = p_W - from_W;
  const double range_m = way.norm();
  // Corners stand at the rim of what they belong to: a ray that passes by it does not hide them.
  const Hit hit = caster_->cast(Ray{from_W, way / range_m});
  if (hit && hit.range_m < 0.98 * range_m - 0.05) return std::nullopt;
  return pixel->cast<float>();
}

}  // namespace pllit::bench
