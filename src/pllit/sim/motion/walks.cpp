#include "pllit/sim/motion/walks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pllit/sim/motion/arcs.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

using std::numbers::pi;
constexpr double kSpacing_s = 0.1;  // of the controls: steps at 2 Hz survive, what is faster is smoothed away
constexpr double kRamp_s = 1.5;     // from rest to full motion
constexpr Time kStart = time_from_parts(1'700'000'000, 0);  // any real date, so that lost digits of a time would show

/// 0 until zero, 1 after one, with two continuous derivatives.
double ramp(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

struct Wave {
  double amplitude, frequency_hz, phase;
  double at(double t_s) const { return amplitude * std::sin(2.0 * pi * frequency_hz * t_s + phase); }
};

Wave random_wave(double amplitude, double frequency_hz, Random& random) {
  const double scale = random.uniform(0.9, 1.1);
  return {amplitude, frequency_hz * scale, random.uniform(0.0, 2.0 * pi)};
}

/// The point `s` metres along the centre line, counter-clockwise from the middle of the side at negative y.
PlanePose lane_point(const Lane& lane, double s) {
  PlanePose at{{0.0, -0.5 * lane.straight_y_m - lane.corner_radius_m}, 0.0};
  s = std::fmod(s, perimeter_m(lane));
  const double half_x_m = 0.5 * lane.straight_x_m;
  for (const double straight_m : {half_x_m, lane.straight_y_m, lane.straight_x_m, lane.straight_y_m, half_x_m}) {
    at.position += std::min(s, straight_m) * direction(at.heading_rad);
    s -= straight_m;
    if (s <= 0.0) return at;
    const double turn = std::min(s / lane.corner_radius_m, 0.5 * pi);
    at.position += lane.corner_radius_m * (left_of(at.heading_rad) - left_of(at.heading_rad + turn));
    at.heading_rad += turn;
    s -= turn * lane.corner_radius_m;
  }
  return at;
}

Vector3d above_ground(const Lane& lane, const Eigen::Vector2d& position, double above_m) {
  return {position.x(), position.y(), lane.slope.dot(position) + above_m};
}

SO3 rotation_from_angles(double yaw, double pitch, double roll) {
  return exp_so3({0.0, 0.0, yaw}) * exp_so3({0.0, pitch, 0.0}) * exp_so3({roll, 0.0, 0.0});
}

double random_start_m(const Lane& lane, Random& random) {
  const double share = random.uniform();
  return std::isinf(perimeter_m(lane)) ? 0.0 : share * perimeter_m(lane);
}

/// Motion through pose_at(t, strength), t in seconds since the start and strength the ramp from 0 (rest) to 1.
template <class PoseAt>
Motion ramped_motion(const MotionConfig& config, const PoseAt& pose_at) {
  // A control acts for three spacings to either side, so what is to rest until rest_s starts that much later.
  const double moving_from_s = config.rest_s + 3.0 * kSpacing_s;
  const int segments = static_cast<int>(std::ceil(config.duration_s / kSpacing_s - 1e-9));
  std::vector<SE3> controls;
  for (int i = 0; i < segments + 5; ++i) {
    const double t_s = (i - 2) * kSpacing_s;
    controls.push_back(pose_at(t_s, ramp((t_s - moving_from_s) / kRamp_s)));
  }
  return Motion(kStart, from_seconds(kSpacing_s), controls);
}

/// What a person's body does to the rig, in the order drawn.
struct Gait {
  Gait(double glance_rad, Random& random) {
    const double wiggle_length_m = random.uniform(5.0, 8.0);
    aside = {0.2, 1.0 / wiggle_length_m, random.uniform(0.0, 2.0 * pi)};
    pace = random_wave(0.15, 0.11, random);
    glance = random_wave(glance_rad, 0.07, random), look_up = random_wave(0.06, 0.13, random);
    sway = random_wave(0.045, 0.9, random), nod = random_wave(0.035, 1.8, random);
    bob = random_wave(0.025, 1.8, random);
    held_roll = 0.03 * random.gaussian();
    held_pitch = 0.03 * random.gaussian();
  }
  SO3 rotation(double heading_rad, double t_s, double strength) const {
    return rotation_from_angles(heading_rad + strength * glance.at(t_s),
                                held_pitch + strength * (nod.at(t_s) + look_up.at(t_s)),
                                held_roll + strength * sway.at(t_s));
  }

  Wave aside;  // over metres, not seconds
  Wave pace, glance, look_up, sway, nod, bob;
  double held_roll, held_pitch;
};

}  // namespace

double perimeter_m(const Lane& lane) {
  return 2.0 * (lane.straight_x_m + lane.straight_y_m + pi * lane.corner_radius_m);
}

Motion walk_along(const Lane& lane, const MotionConfig& config) {
  Random random(config.seed, 1);
  const bool clockwise = random.uniform() < 0.5;
  const double mirror = clockwise ? -1.0 : 1.0;
  double s = random_start_m(lane, random);
  const Gait gait(config.glance_rad, random);

  return ramped_motion(config, [&](double t_s, double strength) {
    s += strength * config.speed_mps * (1.0 + gait.pace.at(t_s)) * kSpacing_s;
    const PlanePose on_lane = lane_point(lane, s);
    Eigen::Vector2d position = on_lane.position + gait.aside.at(s) * left_of(on_lane.heading_rad);
    position.y() *= mirror;
    return pose_from(gait.rotation(mirror * on_lane.heading_rad, t_s, strength),
                     above_ground(lane, position, lane.height_m + strength * gait.bob.at(t_s)));
  });
}

Motion walk_way(const std::function<Foothold(double s_m)>& way, double length_m, double height_m,
                const MotionConfig& config) {
  Random random(config.seed, 3);
  Gait gait(config.glance_rad, random);
  gait.aside.amplitude = 0.08;  // ways may be narrow
  // The pace is even: what slows the start and the end costs one ramp of time altogether.
  MotionConfig timed = config;
  const double walking_s = length_m / config.speed_mps;
  const double stop_s = config.rest_s + 3.0 * kSpacing_s + walking_s;  // where slowing down begins
  timed.duration_s = stop_s + kRamp_s + 1.0;
  double s = 0.0;
  return ramped_motion(timed, [&](double t_s, double strength) {
    const double lively = strength * (1.0 - ramp((t_s - stop_s) / kRamp_s));
    s = std::min(s + lively * config.speed_mps * kSpacing_s, length_m);
    const Foothold at = way(s);
    const Eigen::Vector2d aside = lively * gait.aside.at(s) * left_of(at.heading_rad);
    return pose_from(gait.rotation(at.heading_rad, t_s, lively),
                     at.ground_W + Vector3d(aside.x(), aside.y(), height_m + lively * gait.bob.at(t_s)));
  });
}

Motion fast_shake(const Lane& lane, const MotionConfig& config) {
  Random random(config.seed, 2);
  const PlanePose stand = lane_point(lane, random_start_m(lane, random));
  const Wave yaw = random_wave(0.66, 0.5, random), pitch = random_wave(0.28, 0.7, random);
  const Wave roll = random_wave(0.22, 0.9, random);
  const Wave x = random_wave(0.12, 0.6, random), y = random_wave(0.12, 0.8, random), z = random_wave(0.1, 0.7, random);

  return ramped_motion(config, [&](double t_s, double strength) {
    const Eigen::Vector2d position = stand.position + strength * Eigen::Vector2d(x.at(t_s), y.at(t_s));
    return pose_from(rotation_from_angles(stand.heading_rad + strength * yaw.at(t_s), strength * pitch.at(t_s),
                                          strength * roll.at(t_s)),
                     above_ground(lane, position, lane.height_m + strength * z.at(t_s)));
  });
}

}  // namespace pllit
