// Draws what images show of each alarm of a session: bench_finding_pictures F.bag SESSION PRESET [--scene
// F.scene.json]. A picture for each alarm, SESSION/alarm-ID.png: a row of crops around its place, three from images
// before it was first hot and four from the first 25 that show the place afterwards. With the scene of a simulated
// recording also SESSION/object-NAME.png for each object that was to be found, whose box is 20 cm wide; that of an
// alarm is its extent.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <format>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pllit/eval/evaluate.hpp"
#include "pllit/eval/findings.hpp"
#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/bag_reader.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/slam/config_presets.hpp"

namespace {

using namespace pllit;
namespace fs = std::filesystem;

constexpr int kHalf_px = 80, kScale = 2;
constexpr std::size_t kBefore = 3, kAfter = 4, kFirst = 25;

/// An image and where it was taken.
struct Look {
  Time time;
  SE3 T_W_C;
  cv::Mat grey;
};

/// A place, and since when something is said of it.
struct Subject {
  std::string name;
  Vector3d p_W, half_extent_m;
  Time begins;
};

/// For the eye: counts from their least to their greatest.
cv::Mat grey_of(const cv::Mat& raw) {
  if (raw.depth() == CV_8U) return raw.clone();
  cv::Mat grey;
  cv::normalize(raw, grey, 0.0, 255.0, cv::NORM_MINMAX, CV_8U);
  return grey;
}

Expected<std::vector<Look>> looks_of(const fs::path& bag, const fs::path& session, const Config& config, const Rig& rig,
                                     const SE3& T_I_C) {
  const auto path = read_interrupted_tum(session / "trajectory.tum");
  if (!path) return std::unexpected(path.error());
  auto source = open_bags({bag}, {.image_topic = config.input.image_topic});
  if (!source) return std::unexpected(source.error());
  std::vector<Look> looks;
  while (true) {
    auto event = (*source)->next();
    if (!event) return std::unexpected(event.error());
    if (!*event) return looks;
    const auto* frame = std::get_if<CameraFrame>(&(*event)->data);
    const auto T_W_I = frame ? pose_at(*path, frame->time + rig.camera_delay, from_seconds(0.3)) : std::nullopt;
    if (T_W_I && frame->counts.channels() == 1) looks.push_back({frame->time, *T_W_I * T_I_C, grey_of(frame->counts)});
  }
}

std::optional<Eigen::Vector2d> pixel_of(const Vector3d& p_W, const Look& look, const Camera& camera) {
  const Vector3d p_C = look.T_W_C.inverse().act(p_W);
  if (p_C.z() < 0.3 || p_C.norm() > 12.0) return std::nullopt;
  const auto pixel = camera.project(p_C);
  if (!pixel || pixel->x() < 8 || pixel->y() < 8 || pixel->x() > camera.width - 9 || pixel->y() > camera.height - 9)
    return std::nullopt;
  return pixel;
}

cv::Mat crop_of(const Look& look, const Subject& subject, const Camera& camera) {
  const auto pixel = pixel_of(subject.p_W, look, camera);
  cv::Mat padded, crop;
  cv::copyMakeBorder(look.grey, padded, kHalf_px, kHalf_px, kHalf_px, kHalf_px, cv::BORDER_CONSTANT);
  const cv::Rect part(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()), 2 * kHalf_px, 2 * kHalf_px);
  cv::resize(padded(part), crop, {}, kScale, kScale, cv::INTER_NEAREST);
  cv::cvtColor(crop, crop, cv::COLOR_GRAY2BGR);
  std::vector<cv::Point> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const auto at = camera.project(look.T_W_C.inverse().act(subject.p_W + side.cwiseProduct(subject.half_extent_m)));
    if (at)
      corners.emplace_back(static_cast<int>(kScale * (at->x() - pixel->x() + kHalf_px)),
                           static_cast<int>(kScale * (at->y() - pixel->y() + kHalf_px)));
  }
  if (!corners.empty()) cv::rectangle(crop, cv::boundingRect(corners), {60, 60, 255});
  const double range_m = (look.T_W_C.translation() - subject.p_W).norm();
  const std::string words = std::format("{:+.1f} s, {:.1f} m", to_seconds(look.time - subject.begins), range_m);
  cv::putText(crop, words, {6, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {0, 220, 255}, 1, cv::LINE_AA);
  return crop;
}

/// At most `most` of them, evenly spread.
std::vector<const Look*> some(const std::vector<const Look*>& looks, std::size_t most) {
  std::vector<const Look*> chosen;
  for (std::size_t i = 0; i < std::min(most, looks.size()); ++i)
    chosen.push_back(looks[looks.size() <= most ? i : i * (looks.size() - 1) / (most - 1)]);
  return chosen;
}

bool draw(const Subject& subject, const std::vector<Look>& looks, const Camera& camera, const fs::path& file) {
  std::vector<const Look*> before, after;
  for (const Look& look : looks)
    if (pixel_of(subject.p_W, look, camera)) (look.time < subject.begins ? before : after).push_back(&look);
  std::vector<const Look*> chosen = some(before, kBefore);
  after.resize(std::min(after.size(), kFirst));
  for (const Look* look : some(after, kAfter)) chosen.push_back(look);
  if (chosen.empty()) return true;
  std::vector<cv::Mat> crops;
  for (const Look* look : chosen) crops.push_back(crop_of(*look, subject, camera));
  cv::Mat row;
  cv::hconcat(crops, row);
  return cv::imwrite(file.string(), row);
}

Expected<nlohmann::ordered_json> json_of(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return std::unexpected(text.error());
  auto json = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (json.is_discarded()) return input_error(std::format("{}: is not JSON", file.string()));
  return json;
}

SE3 pose_of(const nlohmann::ordered_json& json) {
  const auto p = json.at("translation_m").get<std::array<double, 3>>();
  const auto q = json.at("rotation_xyzw").get<std::array<double, 4>>();
  return pose_from(SO3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized()), Vector3d(p[0], p[1], p[2]));
}

Expected<std::vector<Subject>> alarms_of(const fs::path& session) {
  const auto anomalies = read_anomalies(session / "anomalies.json");
  if (!anomalies) return std::unexpected(anomalies.error());
  std::vector<Subject> subjects;
  for (const Anomaly& anomaly : *anomalies)
    if (anomaly.confirmed)
      subjects.push_back(
          {std::format("alarm-{}", anomaly.id), anomaly.position_W, 0.5 * anomaly.extent_m, anomaly.first_seen});
  return subjects;
}

/// The objects that were to be found, in the world of the estimate.
Expected<std::vector<Subject>> objects_of(const fs::path& scene, const fs::path& session) {
  const auto json = json_of(scene);
  if (!json) return std::unexpected(json.error());
  const auto objects = objects_of_scene(*json);
  if (!objects) return std::unexpected(objects.error());
  const auto truth = read_tum(scene.parent_path() / (scene.stem().stem().string() + ".tum"));
  const auto path = read_interrupted_tum(session / "trajectory.tum");
  if (!truth || !path) return std::unexpected(truth ? path.error() : truth.error());
  const auto scores = evaluate(*truth, *path, {.rpe_deltas_m = {}});
  if (!scores) return std::unexpected(scores.error());
  std::vector<Subject> subjects;
  for (const TrueObject& object : *objects)
    if (object.finding)
      subjects.push_back({"object-" + object.name, scores->T_W_V.inverse().act(object.centroid_W),
                          Vector3d::Constant(0.1), object.begins});
  return subjects;
}

Expected<void> draw_all(const fs::path& bag, const fs::path& session, const std::string& preset,
                        const fs::path& scene) {
  const auto config = find_config(preset);
  if (!config) return std::unexpected(config.error());
  const Rig rig = make_rig(config->rig);
  if (!rig.camera) return input_error(preset + ": has no camera");
  const auto run = json_of(session / "run.json");
  if (!run) return std::unexpected(run.error());
  const SE3 T_I_C = run->contains("camera") ? pose_of(run->at("camera").at("T_I_C")) : rig.T_I_C;
  const auto looks = looks_of(bag, session, *config, rig, T_I_C);
  if (!looks) return std::unexpected(looks.error());
  auto subjects = alarms_of(session);
  if (!subjects) return std::unexpected(subjects.error());
  if (!scene.empty()) {
    const auto objects = objects_of(scene, session);
    if (!objects) return std::unexpected(objects.error());
    subjects->insert(subjects->end(), objects->begin(), objects->end());
  }
  for (const Subject& subject : *subjects)
    if (!draw(subject, *looks, *rig.camera, session / (subject.name + ".png")))
      return input_error(std::format("{}: cannot be written", (session / (subject.name + ".png")).string()));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Draws what images show of the alarms of a session.");
  fs::path bag, session, scene;
  std::string preset;
  app.add_option("bag", bag)->required();
  app.add_option("session", session)->required();
  app.add_option("preset", preset)->required();
  app.add_option("--scene", scene);
  CLI11_PARSE(app, argc, argv);
  const auto done = draw_all(bag, session, preset, scene);
  if (done) return 0;
  std::fprintf(stderr, "%s\n", done.error().message.c_str());
  return 1;
}
