// When and where a LiDAR's pulses go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

constexpr double kDegree = std::numbers::pi / 180.0;  ///< data sheets speak of degrees

/// One pulse of a scan. L: x forward, y left, z up.
struct Beam {
  Duration offset{0};  ///< since the scan's start
  Vector3d direction_L = Vector3d::UnitX();
  std::uint8_t line = 0;  ///< ring or laser, numbered as the maker's driver does
};

/// Lasers that fire one after another in every shot, over optics that turn.
struct BeamPattern {
  enum class Optics {
    turning_head,    ///< the lasers turn about z, clockwise seen from above, once a scan
    three_prisms,    ///< Livox Horizon
    nodding_mirror,  ///< Livox Mid-360
  };
  struct Laser {
    double angle_rad = 0.0;   ///< above the horizon; for the mirror: from the middle of the row of lasers
    Duration fires_after{0};  ///< since the shot's start
    std::uint8_t line = 0;
    Vector3d ahead_L = Vector3d::UnitX();  ///< turning head: where it fires in a shot that starts at the x axis
  };
  Optics optics = Optics::turning_head;
  Duration scan_period{std::chrono::milliseconds(100)};
  Duration shot_period{0};
  std::vector<Laser> lasers;  ///< in the order in which they fire
};

/// How many lines, or rings, it has.
std::size_t lines_of(const BeamPattern& pattern);

/// Shots are counted from the moment that the LiDAR was switched on, when scan 0 began, and go on without regard to
/// scans: where a shot does not end with the scan, as in Velodynes, or the pattern does not repeat, as in Livoxes,
/// every scan is another.
std::int64_t first_shot_of(const BeamPattern& pattern, std::int64_t scan);

/// The pulses of a shot of a scan, one a laser, in the order in which they fire.
std::vector<Beam> beams_of(const BeamPattern& pattern, std::int64_t scan, std::int64_t shot);

/// 32 rings from +15 (line 0) to -16 degrees, 2000 shots a turn; firing times as in Hesai's manual: 0.28 us and 1.512
/// us a channel.
BeamPattern pandar_xt32_pattern();
/// 16 rings from -15 (line 0) to +15 degrees, a shot every 55.296 us, 2.304 us a laser in the interleaved order of
/// Velodyne's manual.
BeamPattern velodyne_vlp16_pattern();
/// 64 rings: 32 from +2 to -8.33 degrees, 1/3 degree apart, and 32 from -8.83 to -24.33, half a degree apart (line 0 is
/// the lowest), by data sheet; a shot every 48 us (1.33 million a second). Assumed: one laser of each block fires at a
/// time, both from the top.
BeamPattern velodyne_hdl64e_pattern();

/// 6 lines, 240 000 pulses a second over 81.7 by 25.1 degrees. Livox publishes these numbers and the coverage (about 60
/// % in 0.1 s, close to all in 1 s), not the optics. Modelled on what is known of its relatives: two equal prisms turn
/// against each other and sweep the column of lasers sideways, a third, weaker one moves it about a small circle at a
/// ratio that never repeats. Deflections are added as angles, to first order; the speeds were chosen to give the
/// published coverage, counted in cells of 0.3 degrees.
BeamPattern livox_horizon_pattern();
/// 4 lines, 200 000 pulses a second over 360 degrees by -7 to +52. A mirror turns once in 274.1 shots of 20 us and nods
/// evenly up and down once in 0.1 s: the periods that public fits to Livox's own table of directions show. Turning, the
/// mirror turns the image of the row of lasers too. Assumed: the row's spacing of 2 degrees.
BeamPattern livox_mid360_pattern();

}  // namespace pllit
