#include "pllit/sim/world/lidar_patterns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pllit {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

using Laser = BeamPattern::Laser;

Vector3d direction(double azimuth_rad, double elevation_rad) {
  const double flat = std::cos(elevation_rad);
  return {flat * std::cos(azimuth_rad), flat * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

/// The angle of something that turns so often a second, within one turn.
double turned_rad(double turns_per_s, Duration time) {
  const double turns = turns_per_s * to_seconds(time);
  return kTurn * (turns - std::floor(turns));
}

/// How far a turning head has turned, clockwise.
double head_rad(Duration scan_period, Duration time) {
  return kTurn * static_cast<double>((time % scan_period).count()) / static_cast<double>(scan_period.count());
}

Laser laser_of_turning_head(double elevation_rad, Duration fires_after, int line) {
  const Duration turn = BeamPattern().scan_period;
  return {.angle_rad = elevation_rad,
          .fires_after = fires_after,
          .line = static_cast<std::uint8_t>(line),
          .ahead_L = direction(-head_rad(turn, fires_after), elevation_rad)};
}

/// Turned about z, clockwise seen from above.
struct HeadTurn {
  explicit HeadTurn(double by_rad) : cosine(std::cos(by_rad)), sine(std::sin(by_rad)) {}
  Vector3d operator()(const Vector3d& v) const {
    return {cosine * v.x() + sine * v.y(), cosine * v.y() - sine * v.x(), v.z()};
  }
  double cosine, sine;
};

constexpr double kHorizonWidth = 81.7 * kDegree, kHorizonHeight = 25.1 * kDegree;
constexpr double kHorizonCircle = 3.0 * kDegree;
constexpr double kHorizonSweeps_Hz = 77.3;
constexpr double kHorizonCircles_Hz = -2.618034 * kHorizonSweeps_Hz;

Vector3d behind_three_prisms(const Laser& laser, Duration time) {
  const double sweep = turned_rad(kHorizonSweeps_Hz, time), circle = turned_rad(kHorizonCircles_Hz, time);
  const double left_rad = (kHorizonWidth / 2.0 - kHorizonCircle) * std::cos(sweep) + kHorizonCircle * std::cos(circle);
  return direction(left_rad, laser.angle_rad + kHorizonCircle * std::sin(circle));
}

constexpr double kMid360Lowest = -7.0 * kDegree, kMid360Highest = 52.0 * kDegree;
constexpr double kMid360Spacing = 2.0 * kDegree;
constexpr Duration kMid360Shot = std::chrono::microseconds(20);
constexpr double kMid360Turns_Hz = 1.0 / (274.1 * 20e-6);
constexpr double kMid360Nods_Hz = 10.0;

/// Evenly up and down between 1 and -1, rounded where it turns: a triangle's first three harmonics.
double nod(double phase_rad) {
  const double c = std::cos(phase_rad), c2 = c * c;
  const double third = c * (4.0 * c2 - 3.0), fifth = c * (c2 * (16.0 * c2 - 20.0) + 5.0);  // cos of 3 and 5 phases
  return (c + third / 9.0 + fifth / 25.0) / (1.0 + 1.0 / 9.0 + 1.0 / 25.0);
}

Vector3d behind_nodding_mirror(const Laser& laser, Duration time) {
  const double turn = turned_rad(kMid360Turns_Hz, time);
  const double reach_rad = (kMid360Highest - kMid360Lowest) / 2.0 - 1.5 * kMid360Spacing;
  const double middle_rad = (kMid360Highest + kMid360Lowest) / 2.0 + reach_rad * nod(turned_rad(kMid360Nods_Hz, time));
  const double left_rad = laser.angle_rad * std::sin(turn) / std::cos(middle_rad);
  return direction(left_rad - turn, middle_rad + laser.angle_rad * std::cos(turn));
}

}  // namespace

std::size_t lines_of(const BeamPattern& pattern) {
  std::size_t lines = 0;
  for (const BeamPattern::Laser& laser : pattern.lasers) lines = std::max<std::size_t>(lines, laser.line + 1U);
  return lines;
}

std::int64_t first_shot_of(const BeamPattern& pattern, std::int64_t scan) {
  return (scan * pattern.scan_period + pattern.shot_period - Duration(1)) / pattern.shot_period;
}

std::vector<Beam> beams_of(const BeamPattern& pattern, std::int64_t scan, std::int64_t shot) {
  std::vector<Beam> beams;
  beams.reserve(pattern.lasers.size());
  const Duration shot_time = shot * pattern.shot_period;
  const HeadTurn head(head_rad(pattern.scan_period, shot_time));
  for (const Laser& laser : pattern.lasers) {
    const Duration time = shot_time + laser.fires_after;
    Beam& beam = beams.emplace_back(Beam{.offset = time - scan * pattern.scan_period, .line = laser.line});
    switch (pattern.optics) {
      case BeamPattern::Optics::turning_head:
        beam.direction_L = head(laser.ahead_L);
        break;
      case BeamPattern::Optics::three_prisms:
        beam.direction_L = behind_three_prisms(laser, time);
        break;
      case BeamPattern::Optics::nodding_mirror:
        beam.direction_L = behind_nodding_mirror(laser, time);
        break;
    }
  }
  return beams;
}

BeamPattern pandar_xt32_pattern() {
  BeamPattern pattern{.shot_period = std::chrono::microseconds(50), .lasers = {}};
  for (int channel = 0; channel < 32; ++channel)
    pattern.lasers.push_back(
        laser_of_turning_head((15.0 - channel) * kDegree, Duration(280 + 1512 * channel), channel));
  return pattern;
}

BeamPattern velodyne_vlp16_pattern() {
  BeamPattern pattern{.shot_period = Duration(55'296), .lasers = {}};
  for (int laser = 0; laser < 16; ++laser) {
    // -15, 1, -13, 3, ... : two interleaved rows, each from below.
    const int line = laser / 2 + (laser % 2) * 8;
    pattern.lasers.push_back(laser_of_turning_head((-15.0 + 2.0 * line) * kDegree, laser * Duration(2304), line));
  }
  return pattern;
}

BeamPattern velodyne_hdl64e_pattern() {
  BeamPattern pattern{.shot_period = std::chrono::microseconds(48), .lasers = {}};
  for (int pair = 0; pair < 32; ++pair) {
    const Duration fires_after = pair * Duration(1500);
    pattern.lasers.push_back(laser_of_turning_head((2.0 - pair / 3.0) * kDegree, fires_after, 63 - pair));
    pattern.lasers.push_back(laser_of_turning_head((-8.83 - pair / 2.0) * kDegree, fires_after, 31 - pair));
  }
  return pattern;
}

BeamPattern livox_horizon_pattern() {
  BeamPattern pattern{
      .optics = BeamPattern::Optics::three_prisms, .shot_period = std::chrono::microseconds(25), .lasers = {}};
  for (int line = 0; line < 6; ++line)
    pattern.lasers.push_back({.angle_rad = (kHorizonHeight / 2.0 - kHorizonCircle) * (1.0 - line / 2.5),
                              .fires_after = line * Duration(25'000) / 6,
                              .line = static_cast<std::uint8_t>(line),
                              .ahead_L = Vector3d::UnitX()});
  return pattern;
}

BeamPattern livox_mid360_pattern() {
  BeamPattern pattern{.optics = BeamPattern::Optics::nodding_mirror, .shot_period = kMid360Shot, .lasers = {}};
  for (int line = 0; line < 4; ++line)
    pattern.lasers.push_back({.angle_rad = kMid360Spacing * (line - 1.5),
                              .fires_after = line * kMid360Shot / 4,
                              .line = static_cast<std::uint8_t>(line),
                              .ahead_L = Vector3d::UnitX()});
  return pattern;
}

}  // namespace pllit
