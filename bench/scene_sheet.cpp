// One picture of all scenes of the simulator, row by row: bench_scene_sheet OUT.jpg [SECOND]. Left the thermal image
// after gain control and the visible one as they are SECOND (default 5) seconds after the start, right the scan before
// them from above (room 20 m wide, other indoor scenes 40 m, outdoors 160 m), points within 0.3 to 2.3 m above the
// lowest ones in it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <format>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pllit/sim/simulation.hpp"

namespace {

using namespace pllit;

constexpr int kTile_px = 320, kTileHeight_px = 256;

struct Scene {
  const char *title, *address, *lidar_rig;
  double width_m;
};
constexpr Scene kScenes[] = {{"room", "room?seed=2&people=2", "hilti2022", 20.0},
                             {"corridor", "corridor?seed=1", "hilti2022", 40.0},
                             {"stairs", "stairs?seed=1&length=20", "hilti2022", 40.0},
                             {"plant", "plant?seed=1&people=2", "inspection", 40.0},
                             {"street", "street?seed=1&cars=4&people=4", "ntu4dradlm", 160.0},
                             {"street, night", "street?seed=1&light=night&cars=4&people=4", "ntu4dradlm", 160.0},
                             {"field", "field?seed=1&people=3", "ntu4dradlm", 160.0}};

/// What a rig delivers last before a time.
struct Seen {
  std::optional<LidarScan> scan;
  std::optional<CameraFrame> frame;
};

Seen seen_at(const Scene& scene, const std::string& rig, double second, bool images) {
  const std::string address =
      std::format("sim:{}&rig={}&duration={}&{}", scene.address, rig, second, images ? "scans=0" : "images=none");
  auto simulation = open_simulation(address);
  if (!simulation) {
    std::fprintf(stderr, "%s: %s\n", address.c_str(), simulation.error().message.c_str());
    std::exit(1);
  }
  Seen seen;
  for (auto event = simulation->next(); event && *event; event = simulation->next()) {
    if (auto* scan = std::get_if<LidarScan>(&(*event)->data)) seen.scan = std::move(*scan);
    if (auto* frame = std::get_if<CameraFrame>(&(*event)->data)) seen.frame = std::move(*frame);
  }
  return seen;
}

cv::Mat image_tile(const std::optional<CameraFrame>& frame) {
  cv::Mat tile = cv::Mat::zeros(kTileHeight_px, kTile_px, CV_8UC1);
  if (!frame) return tile;
  const double scale = std::min(static_cast<double>(kTile_px) / frame->counts.cols,
                                static_cast<double>(kTileHeight_px) / frame->counts.rows);
  cv::Mat small;
  cv::resize(frame->counts, small, {}, scale, scale, cv::INTER_AREA);
  small.copyTo(tile(cv::Rect((kTile_px - small.cols) / 2, (kTileHeight_px - small.rows) / 2, small.cols, small.rows)));
  return tile;
}

cv::Mat scan_tile(const std::optional<LidarScan>& scan, double width_m) {
  cv::Mat tile = cv::Mat::zeros(kTileHeight_px, kTile_px, CV_8UC1);
  if (!scan) return tile;
  std::vector<float> heights;
  for (const auto& p_L : scan->points_L) heights.push_back(p_L.z());
  std::ranges::sort(heights);
  const float floor_m = heights.empty() ? 0.0F : heights[heights.size() / 50];
  const double px_per_m = kTile_px / width_m;
  for (std::size_t i = 0; i < scan->points_L.size(); ++i) {
    const auto& p_L = scan->points_L[i];
    const int column = static_cast<int>(kTile_px / 2 + px_per_m * static_cast<double>(p_L.x())),
              row = static_cast<int>(kTileHeight_px / 2 - px_per_m * static_cast<double>(p_L.y()));
    if (p_L.z() < floor_m + 0.3F || p_L.z() > floor_m + 2.3F) continue;
    if (column < 0 || column >= kTile_px || row < 0 || row >= kTileHeight_px) continue;
    auto& pixel = tile.at<std::uint8_t>(row, column);
    pixel = std::max(pixel, static_cast<std::uint8_t>(std::min(255.0F, 90.0F + 2.0F * scan->intensity[i])));
  }
  return tile;
}

cv::Mat row_of(const Scene& scene, double second) {
  const bool outdoors = std::string(scene.lidar_rig) == "ntu4dradlm";
  std::vector<cv::Mat> tiles{
      image_tile(seen_at(scene, outdoors ? "ntu4dradlm" : "inspection", second, true).frame),
      image_tile(seen_at(scene, "hilti2022", second, true).frame),
      scan_tile(seen_at(scene, scene.lidar_rig, second, false).scan, scene.width_m),
  };
  for (cv::Mat& tile : tiles) cv::copyMakeBorder(tile, tile, 2, 2, 2, 2, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::Mat row;
  cv::hconcat(tiles, row);
  cv::rectangle(row, {2, 2}, {12 + 9 * static_cast<int>(std::string(scene.title).size()), 20}, cv::Scalar(255),
                cv::FILLED);
  cv::putText(row, scene.title, {7, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(0), 1, cv::LINE_AA);
  return row;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) return std::fprintf(stderr, "usage: bench_scene_sheet OUT.jpg [SECOND]\n"), 2;
  const double second = count > 2 ? std::atof(arguments[2]) : 5.0;
  std::vector<cv::Mat> rows;
  for (const Scene& scene : kScenes) rows.push_back(row_of(scene, second));
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  return cv::imwrite(arguments[1], sheet, {cv::IMWRITE_JPEG_QUALITY, 88}) ? 0 : 1;
}
