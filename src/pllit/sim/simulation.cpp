#include "pllit/sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <format>
#include <utility>

#include "pllit/sim/box_scene.hpp"
#include "pllit/sim/faults.hpp"
#include "pllit/sim/motions.hpp"
#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/random.hpp"
#include "pllit/sim/scene_objects.hpp"
#include "pllit/sim/sensors.hpp"

namespace pllit {

struct Simulation::Parts {
  Parts(const SimConfig& c, ChosenMotion chosen, SimRig known_rig, SimRig built_rig)
      : config(c),
        seed(visit_seed(c)),
        known(std::move(known_rig)),
        built(std::move(built_rig)),
        rig(known.known()),
        motion(std::move(chosen.motion)),
        fit(chosen.distance),
        end(std::min(motion.end(), motion.start() + from_seconds(c.duration_s.value_or(1e6)))),
        line(c.faults, motion.start(), seed),
        delivered_until(motion.start()) {}

  SimConfig config;
  std::uint64_t seed;   // of noise
  SimRig known, built;  // of boxes: the IMU's model alone
  Rig rig;
  Motion motion;
  std::optional<FitDistance> fit;
  Time end;
  std::optional<PlanesWorld> boxes;
  std::optional<Surroundings> around;
  std::optional<Sightings> sightings;
  std::vector<std::unique_ptr<SimSensor>> sensors;  // in the order in which messages of one time are received
  ImageSensor* camera = nullptr;                    // one of them
  FaultyLine line;
  Time delivered_until;

  ImuStream fresh_imu() const { return ImuStream(motion.start(), built.imu, seed); }

  SimSensor& first_due() const {
    return **std::ranges::min_element(sensors, {}, [](const auto& sensor) { return sensor->due(); });
  }
  bool finished() const { return first_due().due() > end; }
};

namespace {

constexpr double kReach_m = 150.0;

SimConfig::RigName rig_for(const SimConfig& config) {
  if (config.rig) return *config.rig;
  if (config.scene == SceneKind::street || config.scene == SceneKind::field) return SimConfig::RigName::ntu4dradlm;
  const bool inspected = config.scene == SceneKind::plant || !findings_of(config).empty();
  return inspected ? SimConfig::RigName::inspection : SimConfig::RigName::hilti2022;
}

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

/// Where the rig goes, evenly in time.
std::vector<Vector3d> path_of(const Motion& motion, Time end) {
  const double duration_s = to_seconds(end - motion.start());
  const int steps = std::max(2, static_cast<int>(duration_s / 0.2));
  std::vector<Vector3d> path_W;
  for (int i = 0; i <= steps; ++i)
    path_W.push_back(motion.at(motion.start() + from_seconds(duration_s * i / steps)).T_W_I.translation());
  return path_W;
}

/// Around the whole motion, whatever part of it config.duration_s lets happen.
PlaceConfig place_config(const SimConfig& config, const SimRig& rig, const Motion& motion) {
  PlaceConfig place{.kind = place_kind(config.scene), .seed = config.seed, .path_W = path_of(motion, motion.end())};
  place.duration_s = to_seconds(motion.end() - motion.start());
  place.height_m = rig.height_m;
  place.clearance_m = rig.on_car ? 2.5 : 0.6;
  place.warmer_K = config.warmer_K;
  place.air_drift_Kph = config.air_drift_Kph;
  place.light = config.day ? Light::day : Light::night;
  place.bare = config.bare;
  place.people = config.people;
  place.cars = config.cars;
  place.findings = findings_of(config);
  place.distractors = distractors_of(config);
  return place;
}

}  // namespace

Simulation::Simulation(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

namespace {

/// The sensors of a box scene.
template <class Parts>
void furnish_boxes(Parts& parts, BoxScene scene) {
  parts.rig = scene.rig;
  parts.boxes = std::move(scene.world);
  parts.sensors.push_back(imu_sensor(parts.motion, parts.fresh_imu(), parts.config.accel_in_g));
  parts.sensors.push_back(box_lidar_sensor(parts.motion, scene.lidar, *parts.boxes, parts.seed));
}

/// The place around the first visit's motion, and the rig's sensors in it.
template <class Parts>
Expected<void> furnish_world(Parts& parts, const Motion& first) {
  auto place = make_place(place_config(parts.config, parts.known, first));
  if (!place) return std::unexpected(place.error());
  parts.around.emplace(std::move(*place), kReach_m);
  parts.sightings.emplace(parts.around->place.get());
  const SimConfig& config = parts.config;
  parts.sensors.push_back(imu_sensor(parts.motion, parts.fresh_imu(), parts.built.accel_in_g));
  if (config.scans) parts.sensors.push_back(lidar_sensor(parts.motion, parts.built, *parts.around, parts.seed));
  if (config.images == SimConfig::Images::none) return {};
  const ImageStream stream{.rate_hz = config.image_rate_hz,
                           .agc = config.images != SimConfig::Images::counts,
                           .counts = config.images != SimConfig::Images::agc,
                           .ideal = config.ideal};
  auto camera = parts.built.thermal
                    ? thermal_sensor(parts.motion, parts.built, stream, *parts.around, parts.seed, *parts.sightings)
                    : visible_sensor(parts.motion, parts.built, stream, *parts.around, parts.seed);
  parts.camera = camera.get();
  parts.sensors.push_back(std::move(camera));
  return {};
}

}  // namespace

Expected<Simulation> Simulation::make(const SimConfig& config, const std::optional<Trajectory>& path) {
  if (is_box(config.scene)) {
    BoxScene scene = box_scene(config);
    SimRig built{.name = "boxes", .imu = scene.imu, .lidar = {}, .thermal = {}, .visible = {}};
    auto parts = std::make_unique<Parts>(config, ChosenMotion{scene.motion, {}}, built, built);
    furnish_boxes(*parts, std::move(scene));
    return Simulation(std::move(parts));
  }
  if (config.motion.empty() == path.has_value())
    return failure(path ? "a path was given that the simulation does not name"
                        : "the simulation names a motion's file that was not read");
  SimRig known = sim_rig(rig_for(config));
  if (!config.imu.empty()) {
    auto model = imu_model(config.imu);
    if (!model) return std::unexpected(model.error());
    known.imu = std::move(*model);
  }
  auto motion = choose_motion(config, known, path);
  if (!motion) return std::unexpected(motion.error());
  SimRig built = config.ideal ? without_errors(known) : as_built(known, config.seed);
  std::optional<ChosenMotion> first;  // where it is not this one
  if (config.visit > 0) {
    SimConfig first_visit = config;
    first_visit.visit = 0;
    auto chosen = choose_motion(first_visit, known, path);
    if (!chosen) return std::unexpected(chosen.error());
    first = std::move(*chosen);
  }
  auto parts = std::make_unique<Parts>(config, std::move(*motion), std::move(known), std::move(built));
  if (auto furnished = furnish_world(*parts, first ? first->motion : parts->motion); !furnished)
    return std::unexpected(furnished.error());
  return Simulation(std::move(parts));
}

Expected<std::optional<SensorEvent>> Simulation::next() {
  Parts& parts = *parts_;
  // No event is received before its true time, so the first pending one is due once all up to its time have been made.
  std::optional<SensorEvent> event = parts.line.pop_before(parts.finished() ? Time::max() : parts.first_due().due());
  while (!event && !parts.finished()) {
    SimSensor& sensor = parts.first_due();
    auto made = sensor.take();
    for (SensorEvent& one : made) parts.line.push(std::move(one), sensor.due());
    event = parts.line.pop_before(parts.finished() ? Time::max() : parts.first_due().due());
  }
  if (event) parts.delivered_until = event->received;
  return event;
}

double Simulation::progress() const {
  const Time start = parts_->motion.start();
  return std::min(to_seconds(parts_->delivered_until - start) / to_seconds(parts_->end - start), 1.0);
}

const Rig& Simulation::rig() const { return parts_->rig; }
const std::string& Simulation::rig_name() const { return parts_->known.name; }
bool Simulation::is_thermal() const { return parts_->known.thermal.has_value(); }
const Motion& Simulation::motion() const { return parts_->motion; }
const PlanesWorld& Simulation::boxes() const { return *parts_->boxes; }

Trajectory Simulation::truth() const {
  Trajectory truth;
  const Motion& motion = parts_->motion;
  Time time = motion.start();
  for (std::int64_t i = 0; time <= parts_->end; time = imu_time(motion.start(), parts_->built.imu.rate_hz, ++i))
    truth.push_back({time, motion.at(time).T_W_I});
  return truth;
}

std::vector<StampedImuBias> Simulation::true_biases() const {
  std::vector<StampedImuBias> biases;
  for (ImuStream imu = parts_->fresh_imu(); imu.next_time() <= parts_->end; imu.next(parts_->motion))
    biases.push_back({imu.next_time(), imu.bias()});
  return biases;
}

SceneTruth Simulation::scene_truth() const {
  const Parts& parts = *parts_;
  SceneTruth truth;
  truth.config = parts.config;
  truth.rig = parts.known.name;
  truth.start = parts.motion.start();
  truth.duration_s = to_seconds(parts.end - truth.start);
  truth.fit = parts.fit;
  truth.imu_known = parts.rig.imu;
  truth.imu = parts.built.imu.noise;
  const std::vector<Vector3d> path_W = path_of(parts.motion, parts.end);
  for (std::size_t i = 1; i < path_W.size(); ++i) truth.length_m += (path_W[i] - path_W[i - 1]).norm();
  if (!parts.around) return truth;
  truth.T_I_C_known = parts.known.T_I_C;
  truth.T_I_C = parts.built.T_I_C;
  truth.camera_known = *parts.known.camera();
  truth.camera = *parts.built.camera();
  truth.lidar = parts.built.lidar.unit;
  truth.lidar_clock = parts.built.lidar_clock;
  truth.camera_clock = parts.built.camera_clock;
  truth.objects = objects_of(*parts.around->place, findings_of(parts.config), parts.sightings->seen(), path_W);
  return truth;
}

ImageTruth Simulation::image_truth(const TruthWanted& wanted) {
  assert(parts_->camera && parts_->config.faults == SimFaults{});
  return parts_->camera->truth(wanted);
}

Expected<Simulation> open_simulation(std::string_view source) {
  return parse_sim_config(source).and_then([](const SimConfig& config) { return Simulation::make(config); });
}

}  // namespace pllit
