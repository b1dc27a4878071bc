#include "pllit/slam/config_keys.hpp"

#include <algorithm>
#include <array>

#include "pllit/base/words.hpp"
#include "pllit/slam/config_section.hpp"

namespace pllit {
namespace {

// In the order of the enumerators.
constexpr std::array<std::string_view, 5> kPointTimeUnits{"auto", "s", "ms", "us", "ns"};
constexpr std::array<std::string_view, 3> kAccelUnits{"auto", "m_s2", "g"};
constexpr std::array<std::string_view, 3> kStartModes{"auto", "static", "moving"};
constexpr std::array<std::string_view, 2> kDistortions{"radtan", "equidistant"};

void list(Section section, InputConfig& config) {
  section.add(PLLIT_KEY(imu_topic), "Topic of the IMU (sensor_msgs/Imu); empty: found by its type.");
  section.add(PLLIT_KEY(lidar_topic), "Topic of the LiDAR (PointCloud2 or Livox CustomMsg); empty: found by its type.");
  section.add(PLLIT_KEY(image_topic), "Topic of the camera (Image or CompressedImage); empty: found by its type.");
  section.choose(PLLIT_KEY(lidar_time_unit), kPointTimeUnits,
                 "Unit of the time of each point; auto: from how long a scan lasts.");
}

void list(Section section, RigConfig::Imu& config) {
  section.add(PLLIT_KEY(noise_density), "White noise [gyroscope, accelerometer], as continuous densities.",
              "rad/s/sqrt(Hz), m/s^2/sqrt(Hz)", {1e-6, 10.0});
  section.add(PLLIT_KEY(bias_walk), "Random walk of the biases [gyroscope, accelerometer].",
              "rad/s^2/sqrt(Hz), m/s^3/sqrt(Hz)", {1e-9, 1.0});
}

void list(Section section, RigConfig::Lidar& config) {
  section.add(PLLIT_KEY(T_I_L),
              "Pose of the LiDAR in the IMU frame: p_I = R p_L + t. A 4x4 matrix is accepted as well.", "m",
              {-100.0, 100.0});
  section.add(PLLIT_KEY(delay_s), "Added to the LiDAR's time stamps to get IMU time.", "s", {-10.0, 10.0});
  section.add(PLLIT_KEY(range_m), "Points nearer or farther than [nearest, farthest] are dropped.", "m", {0.0, 1000.0});
}

void list(Section section, RigConfig::Camera& config) {
  section.add(PLLIT_KEY(T_I_C), "Pose of the camera (z forward) in the IMU frame: p_I = R p_C + t, or a 4x4 matrix.",
              "m", {-100.0, 100.0});
  section.add(PLLIT_KEY(delay_s), "Added to the camera's time stamps to get IMU time.", "s", {-10.0, 10.0});
  section.add(PLLIT_KEY(size_px), "Image size [width, height] of the calibration; [0, 0]: no camera.", "px",
              {0.0, 16384.0});
  section.add(PLLIT_KEY(intrinsics_px), "[fx, fy, cx, cy]; pixel (0, 0) is the centre of the top left pixel.", "px",
              {0.0, 65536.0});
  section.choose(PLLIT_KEY(model), kDistortions, "Lens distortion: radial-tangential, or equidistant for a fisheye.");
  section.add(PLLIT_KEY(distortion), "radtan: [k1, k2, p1, p2, k3]; equidistant: [k1, k2, k3, k4, 0].", "",
              {-100.0, 100.0});
}

void list(Section section, PlaneMapConfig& config) {
  section.add(PLLIT_KEY(voxel_m),
              "Voxel of the LiDAR map (planes span two of them): 0.4 serves most places, 0.2 narrow rooms.", "m",
              {0.05, 10.0});
}

void list_noise(Section section, RigConfig& rig) {
  {
    RigConfig::Imu& config = rig.imu;
    section.add("imu_bias_sigma", config.bias_sigma,
                "How large the biases may be at switch-on [gyroscope, accelerometer].", "rad/s, m/s^2", {1e-6, 10.0});
  }
  {
    RigConfig::Lidar& config = rig.lidar;
    section.add("lidar_" PLLIT_KEY(range_sigma_m), "Noise of a LiDAR point along its ray, one sigma.", "m",
                {1e-4, 1.0});
    section.add("lidar_" PLLIT_KEY(beam_sigma_deg), "Noise of a LiDAR point across its ray, one sigma.", "deg",
                {1e-4, 5.0});
  }
}

void list_details(Section section, PlaneMapConfig& config) {
  section.add(PLLIT_KEY(radius_m), "How far around the rig the map for matching reaches; older parts are forgotten.",
              "m", {5.0, 2000.0});
  section.add(PLLIT_KEY(memory_mb), "Most memory that the map for matching may take; beyond it the radius shrinks.",
              "MB", {16.0, 1048576.0});
  section.add(PLLIT_KEY(coarse_factor),
              "Voxel of the second grid, used where the first has too few points, as a multiple.", "", {1.0, 20.0});
  section.add(PLLIT_KEY(min_points), "Fewer points make no plane.", "", {4.0, 1000.0});
  section.add(PLLIT_KEY(max_points), "A voxel with this many points is complete.", "", {4.0, 10000.0});
  section.add(PLLIT_KEY(max_thickness), "Standard deviation across a plane, as a share of the voxel.", "",
              {0.001, 1.0});
  section.add(PLLIT_KEY(max_flatness), "Variance across a plane, as a share of the smaller one along it.", "",
              {0.001, 1.0});
}

void list(Section section, PlaneResidualConfig& config) {
  section.add(PLLIT_KEY(huber), "Residual at which the loss turns linear, in standard deviations.", "", {0.1, 100.0});
  section.add(PLLIT_KEY(gate), "Residuals beyond this many standard deviations do not count.", "", {0.1, 100.0});
  section.add(PLLIT_KEY(max_distance), "Nor do those beyond this share of the voxel.", "", {0.01, 10.0});
  section.add(PLLIT_KEY(max_information), "Independent points that a scan counts for at most; 0: every point counts.",
              "", {0.0, 1e6});
  section.add(PLLIT_KEY(plane_points), "Independent points that a plane counts for at most.", "", {1.0, 1e6});
}

void list(Section section, ScanConfig& config) {
  section.add(PLLIT_KEY(insert_voxels), "Spacing of the points that enter the map, in map voxels.", "", {0.05, 10.0});
  section.add(PLLIT_KEY(match_voxels), "Spacing of the points that are matched, in map voxels.", "", {0.05, 10.0});
  section.add(PLLIT_KEY(min_matched), "Where fewer remain, in narrow rooms, the spacing is reduced.", "", {0.0, 1e6});
  section.add(PLLIT_KEY(max_matched), "At most so many points of a scan are matched.", "", {100.0, 1e6});
}

void list(Section section, DriftConfig& config) {
  section.add(PLLIT_KEY(gain), "Variance that a whole new map inherits from scans, as a multiple of their match's.", "",
              {0.0, 1000.0});
  section.add(PLLIT_KEY(shift_m), "Drift in position that no scan knows of itself, one sigma.", "m/sqrt(m)",
              {0.0, 1.0});
  section.add(PLLIT_KEY(turn_rad), "Drift in attitude that no scan knows of itself, one sigma.", "rad/sqrt(m)",
              {0.0, 1.0});
  section.add(PLLIT_KEY(scale_share), "The LiDAR may measure longer or shorter by this share, one sigma.", "",
              {0.0, 0.1});
  section.add(PLLIT_KEY(turn_share), "It may show turns into the unknown wider or narrower by this share, one sigma.",
              "", {0.0, 0.1});
  section.add(PLLIT_KEY(imu_factor), "So many times noisier than promised an IMU may be that leads alone.", "",
              {1.0, 10.0});
}

void list(Section section, HealthConfig& config) {
  section.add(PLLIT_KEY(min_inliers), "Fewer matched points: the scan does not count.", "", {6.0, 1e6});
  section.add(PLLIT_KEY(min_inlier_share), "Smaller share of matched points: likewise.", "", {0.0, 1.0});
  section.add(PLLIT_KEY(low_inlier_share), "Below this share the frame is degraded.", "", {0.0, 1.0});
  section.add(PLLIT_KEY(max_residual_m), "Above this rms of the residuals the frame is degraded.", "m", {0.001, 10.0});
  section.add(PLLIT_KEY(max_speed_mps), "A higher speed is impossible: lost.", "m/s", {1.0, 1000.0});
  section.add(PLLIT_KEY(silent_degraded_s), "Without a matched scan for this long: degraded.", "s", {0.05, 60.0});
  section.add(PLLIT_KEY(silent_lost_s), "Without a matched scan for this long: lost.", "s", {0.1, 600.0});
  section.add(PLLIT_KEY(max_correction),
              "Above this multiple of the expected correction by images, averaged, the frame is degraded.", "",
              {1.0, 1e6});
  section.add(PLLIT_KEY(restart_after), "Scans in a row without a match before the map is begun anew.", "",
              {1.0, 1000.0});
}

void list(Section section, DegeneracyConfig& config) {
  section.add(PLLIT_KEY(min_over_noise),
              "A direction is observed where its information exceeds that of noise by this factor.", "", {0.0, 1e6});
  section.add(PLLIT_KEY(min_share), "... and is at least this share of what it would be were every plane to face it.",
              "", {0.0, 1.0});
  section.add(PLLIT_KEY(release), "An unobserved direction must exceed both by this factor to be observed again.", "",
              {1.0, 1000.0});
  section.add(PLLIT_KEY(follow), "Share of the way that an unobserved direction moves towards each scan's own.", "",
              {0.0, 1.0});
}

void list(Section section, ReportConfig& config) {
  section.add(PLLIT_KEY(severity),
              "File with the classes of severity, for radiometric input; empty: after NETA 100.18.");
}

void list_details(Section section, StartUpConfig& config) {
  section.add(PLLIT_KEY(window_s), "Length of IMU data that is looked at before the start.", "s", {0.1, 60.0});
  section.add(PLLIT_KEY(gravity_mps2), "Local gravity.", "m/s^2", {0.1, 30.0});
  section.add(PLLIT_KEY(gravity_sigma_mps2), "How well gravity is known, one sigma.", "m/s^2", {1e-4, 1.0});
  section.add(PLLIT_KEY(still_gyro_spread_rps), "At rest every axis of the gyroscope varies less, standard deviation.",
              "rad/s", {1e-4, 1.0});
  section.add(PLLIT_KEY(still_accel_spread_mps2),
              "At rest every axis of the accelerometer varies less, standard deviation.", "m/s^2", {1e-3, 10.0});
  section.add(PLLIT_KEY(still_slow_spread_rps),
              "At rest the means over tenths of the window vary less, standard deviation.", "rad/s", {1e-5, 1.0});
  section.add(PLLIT_KEY(still_rate_rps), "A mean rate above this is motion, unless gravity shows it to be a bias.",
              "rad/s", {1e-5, 1.0});
  section.add(PLLIT_KEY(moving_accel_mps2), "Mean acceleration that a moving start may have, one sigma.", "m/s^2",
              {0.01, 30.0});
  section.add(PLLIT_KEY(moving_speed_mps), "Speed that a moving start may have, one sigma.", "m/s", {0.1, 100.0});
}

void list(Section section, FilterConfig& config) {
  section.add(PLLIT_KEY(max_iterations), "Most iterations of one filter update.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(rotation_tolerance_rad), "An update ends when its steps are below both tolerances.", "rad",
              {1e-9, 0.1});
  section.add(PLLIT_KEY(position_tolerance_m), "An update ends when its steps are below both tolerances.", "m",
              {1e-9, 0.1});
}

void list(Section section, GapModel& config) {
  section.add("max_gap_s", config.max_gap, "IMU samples farther apart are a gap, bridged as constant motion.", "s",
              {0.001, 10.0});
  section.add(PLLIT_KEY(accel_sigma_mps2), "Random acceleration assumed in a gap, one sigma.", "m/s^2", {0.01, 100.0});
  section.add(PLLIT_KEY(rate_sigma_rps), "Random rate of turn assumed in a gap, one sigma.", "rad/s", {0.001, 100.0});
}

std::string_view last_word(std::string_view path) { return path.substr(path.rfind('.') + 1); }  // npos + 1 is 0

}  // namespace

KeyList keys_of(Config& config) {
  KeyList keys;
  Section root(keys);
  Section input = root.section("input", "What to read from the recording.");
  list(input, config.input);
  input.choose("accel_unit", config.start.unit, kAccelUnits, "Unit of the accelerometer; auto: from its mean length.");
  Section rig = root.section("rig", "The sensors: where they sit, how they see, how much they err.");
  list(rig.section("imu", "Inertial measurement unit; its frame I is the body frame."), config.rig.imu);
  list(rig.section("lidar", "LiDAR, frame L."), config.rig.lidar);
  list(rig.section("camera", "Thermal or visible camera, frame C (z forward, x right, y down)."), config.rig.camera);
  root.section("start", "How the first pose is found.")
      .choose("mode", config.start.mode, kStartModes, "State of motion at the start; auto: looked up in the IMU data.");
  list(root.section("map", "The map that scans are matched with."), config.map);
  list_thermal(root.section("thermal", "What images do, thermal or visible."), config.vision);
  list_features(root.section("features", "What is looked for in images."), config.vision);
  root.section("loop", "Loop closing: earlier places that are met again straighten the trajectory and the map.")
      .add_switch("enabled", config.loop.enabled, "Close loops; odometry.tum stays as it is without.");
  root.add(PLLIT_KEY(threads), "Threads for the heavy loops; 0: one for every core. Results do not depend on it.", "",
           {0.0, 256.0});
  Section advanced = root.section("advanced", "For experts: the defaults serve nearly everyone.");
  list_noise(advanced.section("noise", "Sensor noise beyond the data sheet."), config.rig);
  list_details(advanced.section("start", "Details of the start-up."), config.start);
  Section map = advanced.section("map", "The map that scans are matched with, and the one that is written.");
  list_details(map, config.map);
  map.add("file_voxel_m", config.map_file_voxel_m, "The written map holds one point in each voxel of this size.", "m",
          {0.001, 10.0});
  list(advanced.section("scan", "How scans are thinned out."), config.scan);
  list(advanced.section("planes", "Residuals of points to planes."), config.planes);
  list(advanced.section("degeneracy", "When a direction is left to the IMU."), config.degeneracy);
  list(advanced.section("filter", "The iterated update."), config.filter);
  list(advanced.section("gaps", "What to assume where IMU samples are missing."), config.gaps);
  list(advanced.section("drift", "How the doubt about the map grows."), config.drift);
  list_vision(advanced.section("vision", "How images are matched and believed."), config.vision);
  list_anomalies(advanced.section("anomalies", "The thermographic map, and what counts as abnormally hot."),
                 config.thermography);
  list_radiometry(advanced.section("radiometry", "Of radiometric cameras: from apparent temperatures to surfaces'."),
                  config.thermography.radiometry);
  list(advanced.section("health", "When a frame is called degraded or lost."), config.health);
  list_loop(advanced.section("loop", "How loops are found and checked."), config.loop);
  list(advanced.section("report", "How the report judges."), config.report);
  return keys;
}

const Key* KeyList::find(std::string_view path) const {
  const auto found = std::ranges::find(keys, path, &Key::path);
  return found == keys.end() ? nullptr : &*found;
}

const KeySection* KeyList::find_section(std::string_view path) const {
  const auto found = std::ranges::find(sections, path, &KeySection::path);
  return found == sections.end() ? nullptr : &*found;
}

std::string KeyList::nearest(std::string_view path) const {
  path = path.substr(0, 100);  // longer than any name; keeps the search cheap
  // A name may be mistyped, or right but written in the wrong section.
  const auto distance = [&](const std::string& candidate) {
    return std::min(edit_distance(path, candidate), 1 + edit_distance(last_word(path), last_word(candidate)));
  };
  std::vector<std::string> names;
  for (const Key& key : keys) names.push_back(key.path);
  for (const KeySection& section : sections) names.push_back(section.path);
  return *std::ranges::min_element(names, {}, distance);
}

}  // namespace pllit
