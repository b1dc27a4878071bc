#include "frame_folder.hpp"

#include <array>
#include <cmath>
#include <format>
#include <opencv2/core.hpp>

#include "pllit/io/file.hpp"
#include "pllit/report/pictures.hpp"
#include "program.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kDepthUnit_m = 0.0025, kTemperatureUnit_K = 0.01;

Json numbers(const auto& vector) { return std::vector<double>(vector.begin(), vector.end()); }

Json pose_json(const SE3& pose) {
  const Eigen::Quaterniond q = pose.quat();
  return {{"translation_m", numbers(pose.translation())}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json camera_json(const Camera& camera) {
  return {{"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"distortion", camera.distortion == Camera::Distortion::radtan ? "radtan" : "equidistant"},
          {"k", camera.k}};
}

double rounded(double value, double step) { return std::round(value / step) * step; }

Json edge_json(const ImageEdge& edge) {
  constexpr std::array kKinds{"occlusion", "crease", "border"};
  Json line = Json::array();
  for (const Eigen::Vector2d& p : edge.line_px) line.push_back({rounded(p.x(), 0.01), rounded(p.y(), 0.01)});
  return {{"kind", kKinds[static_cast<std::size_t>(edge.kind)]},
          {"line_px", line},
          {"from_W", numbers(edge.from_W)},
          {"to_W", numbers(edge.to_W)},
          {"contrast", rounded(edge.contrast, 1e-4)}};
}

/// CV_16UC1, rounded; what does not fit is cut off.
cv::Mat in_units(const cv::Mat& values, double unit) {
  cv::Mat units;
  values.convertTo(units, CV_16UC1, 1.0 / unit);
  return units;
}

}  // namespace

Expected<FrameFolder> FrameFolder::create(const fs::path& folder, const FrameChoice& choice, bool overwrite,
                                          const Simulation& simulation) {
  const SimConfig config = simulation.scene_truth().config;
  if (is_box(config.scene) || config.images == SimConfig::Images::none)
    return input_error("--frames needs images: a scene that is no box, without images=none");
  if (config.faults != SimFaults{}) return input_error("--frames goes with no faults: write a bag with --out instead");
  std::error_code error;
  if (fs::exists(folder) && !fs::is_empty(folder, error) && !overwrite)
    return input_error(
        std::format("'{}' holds something; give another folder with --frames, or --overwrite", folder.string()));
  fs::create_directories(folder, error);
  if (error) return input_error(std::format("cannot make the folder '{}': {}", folder.string(), error.message()));
  return FrameFolder(folder, choice);
}

std::string FrameFolder::file_name(const char* key, const char* extension) const {
  return std::format("{:06}.{}.{}", images_ - 1, key, extension);
}

Expected<void> FrameFolder::write_png(const char* key, const cv::Mat& image) {
  const std::string name = file_name(key, "png");
  frames_.back()[key] = name;
  return write_file(folder_ / name, png_of(image));
}

Expected<void> FrameFolder::write_edges(const std::vector<ImageEdge>& edges) {
  Json list = Json::array();
  for (const ImageEdge& edge : edges) list.push_back(edge_json(edge));
  const std::string name = file_name("edges", "json");
  frames_.back()["edges"] = name;
  return write_file(folder_ / name, Json{{"edges", list}}.dump() + "\n");
}

Expected<void> FrameFolder::begin_frame(const CameraFrame& image, Simulation& simulation) {
  const long number = images_++;
  chosen_ = number % choice_.every == 0;
  if (!chosen_) return {};
  const ImageTruth truth =
      simulation.image_truth({.pixels = choice_.depth || choice_.temperature, .edges = choice_.edges});
  chosen_ = !truth.frozen;
  if (!chosen_) return {};
  frames_.push_back({{"number", number},
                     {"stamp_s", to_seconds(image.time.time_since_epoch())},
                     {"seen_s", to_seconds(truth.seen.time_since_epoch())},
                     {"T_W_C", pose_json(truth.T_W_C)}});
  Expected<void> done;
  if (choice_.depth) done = write_png("depth", in_units(truth.pixels.depth_m, kDepthUnit_m));
  if (done && choice_.temperature)
    done = write_png("temperature", in_units(truth.pixels.temperature_K, kTemperatureUnit_K));
  if (done && choice_.edges) done = write_edges(truth.edges);
  return done;
}

Expected<void> FrameFolder::write(const SensorEvent& event, Simulation& simulation) {
  const auto* image = std::get_if<CameraFrame>(&event.data);
  if (!image) return {};
  if (last_ != event.received) {
    if (auto done = begin_frame(*image, simulation); !done) return done;
    last_ = event.received;
  }
  if (!chosen_) return {};
  return write_png(image->counts.type() == CV_16UC1 ? "counts" : "grey", image->counts);
}

Expected<void> FrameFolder::close(const Simulation& simulation, const std::string& address) {
  const SceneTruth scene = simulation.scene_truth();
  const Json index{{"schema_version", kSchemaVersion},
                   {"simulator_version", kSimulatorVersion},
                   {"source", address},
                   {"camera", camera_json(scene.camera)},
                   {"depth_unit_m", kDepthUnit_m},
                   {"temperature_unit_K", kTemperatureUnit_K},
                   {"contrast_unit", simulation.is_thermal() ? "K" : "light"},
                   {"frames", frames_}};
  return replace_file(folder_ / "frames.json", index.dump(1) + "\n");
}

}  // namespace pllit::app
