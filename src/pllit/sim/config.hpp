// What to simulate, and its text form: sim:SCENE?key=value&key=value
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"

namespace pllit {

/// Seconds since the start, [from, to); empty as it comes.
struct FaultInterval {
  double from_s = 0.0, to_s = 0.0;
  bool contains(double t_s) const { return t_s >= from_s && t_s < to_s; }
  bool operator==(const FaultInterval&) const = default;
};

/// What goes wrong, and when. An IMU sample and an image are in an interval by their true time, a scan by the true end
/// of its turn.
struct SimFaults {
  FaultInterval imu_gap;      ///< IMU samples are lost
  FaultInterval lidar_gap;    ///< scans are lost: a silent LiDAR
  FaultInterval image_gap;    ///< images are lost
  FaultInterval time_back;    ///< stamps of all sensors are 1 s too early; the times of receipt are not
  FaultInterval duplicates;   ///< every message comes twice
  FaultInterval imu_nan;      ///< IMU samples hold NaN
  FaultInterval late_scans;   ///< scans are received late_by_s after the end of their turn
  FaultInterval late_images;  ///< images are received late_by_s after their time
  FaultInterval swapped_imu;  ///< neighbouring IMU samples change places
  double late_by_s = 0.08;
  double lost_share = 0.0;       ///< of all messages, at random
  double clock_drift_ppm = 0.0;  ///< of the LiDAR's and the camera's clock against the IMU's
  bool operator==(const SimFaults&) const = default;
};

/// Boxes are exact, plain worlds for tests: rectangles, a spinning LiDAR, an IMU. The other scenes are worlds of
/// triangles with heat and light, seen by a rig of real sensors that the estimator knows imperfectly.
enum class SceneKind { box_room, box_corridor, box_street, room, corridor, stairs, plant, street, field };

struct SimConfig {
  enum class Carried { walk, shake };
  enum class BoxLidar { ring32, ring16 };
  enum class RigName { hilti2022, ntu4dradlm, inspection };
  enum class Way { as_recorded, mirrored, reversed };
  enum class Images { none, agc, counts, both };
  enum class Finding { none, table, cabinet, pipe };
  enum class Arrival { drawn, heated, brought };

  SceneKind scene = SceneKind::box_room;
  std::uint64_t seed = 1;
  std::optional<double> duration_s;  ///< 30 s for boxes, else the whole motion
  bool ideal = false;                ///< no noise, no bias, nothing unknown to the estimator
  SimFaults faults;

  // Boxes.
  Carried carried = Carried::walk;
  BoxLidar box_lidar = BoxLidar::ring32;
  double imu_rate_hz = 200.0;
  double speed_mps = 1.0;
  bool accel_in_g = false;  ///< the accelerometer reports g instead of m/s2, as some LiDARs' own IMUs do

  // Worlds.
  std::optional<RigName> rig;  ///< else what suits the scene
  std::string motion;          ///< TUM file of the IMU's poses; else a motion is made that suits the scene
  double speedup = 1.0;
  Way way = Way::as_recorded;
  std::optional<double> length_m;  ///< drives are continued or cut to it, corridors (also beside stairs) are as long
  std::string imu;                 ///< model; else the rig's own
  double image_rate_hz = 10.0;
  Images images = Images::agc;
  bool scans = true;  ///< the LiDAR is on
  bool day = true;
  bool bare = false;  ///< of a corridor: flush doors, and nothing else that a LiDAR could see along it
  int people = 0, cars = 0;
  Finding finding = Finding::none;
  Arrival arrival = Arrival::drawn;
  double finding_at_s = 40.0, finding_K = 25.0;
  int hot_boxes = 0;           ///< further findings of random size, heat, distance and time
  int visit = 0;               ///< of the same place and rig: from 1 on, another walk and other noise than on the first
  double warmer_K = 0.0;       ///< air and everything in it, than on the first visit
  double air_drift_Kph = 0.0;  ///< further drift of the air, which surfaces follow by their shares
};

/// Of what differs from visit to visit: the walk, noise, vibration.
std::uint64_t visit_seed(const SimConfig& config);

bool is_box(SceneKind scene);
std::string_view name_of(SceneKind scene);

/// Reads sim:SCENE?key=value&... What is unknown, repeated, out of range or does not go together is an input error that
/// says what would be right; sim_keys() lists the keys.
Expected<SimConfig> parse_sim_config(std::string_view source);

struct SimKey {
  std::string_view name;
  std::string wants;
  enum class For { all, boxes, worlds } scenes = For::all;
};
std::vector<SimKey> sim_keys();
std::vector<std::string> scene_names();

}  // namespace pllit
