// Draws what the image front end sees, before (left) and after (right) photometric calibration, while the gain control
// changes: bench_feature_pictures FOLDER OUT.jpg. Upper row: a real frame of FOLDER (consecutive 16-bit frames); lower
// row: a simulated plant. Lines are green, bright where they are matched with the keyframe before; points are yellow
// where they are matched, grey where not, and blue where they are anchored to a matched line.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "front_end.hpp"
#include "pllit/sim/camera/agc.hpp"
#include "simulated_views.hpp"

namespace {

using namespace pllit;

constexpr int kFrames = 9;
constexpr int kLevels = 1 << 14;

/// Plateau equalisation; from the last but one image on everything is darker and flatter, as when something hot comes
/// into view.
std::vector<cv::Mat> video_of(const std::vector<cv::Mat>& counts) {
  const AgcConfig agc;
  GreyMapping mapping;
  std::vector<cv::Mat> video;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    mapping = smoothed(mapping, grey_mapping(counts[i], agc, kLevels), mapping.empty() ? 256 : agc.speed_256);
    GreyMapping changed = mapping;
    if (i + 2 >= counts.size())
      for (float& grey : changed) grey = 0.4F * grey + 5.0F;
    video.push_back(applied(changed, counts[i]));
  }
  return video;
}

void draw_point(cv::Mat& picture, const Eigen::Vector2f& at, const cv::Scalar& colour, int radius) {
  constexpr int kShift = 3;
  const cv::Point centre(cvRound(8.0F * at.x()), cvRound(8.0F * at.y()));
  cv::circle(picture, centre, radius << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
}

cv::Mat drawn(const bench::FrontEndImage& now) {
  cv::Mat picture;
  cv::cvtColor(now.image, picture, cv::COLOR_GRAY2BGR);
  std::vector<bool> line_matched(now.features.lines.size(), false);
  for (const LineMatch& match : now.tracks.lines) line_matched[static_cast<std::size_t>(match.current)] = true;
  for (std::size_t i = 0; i < now.features.lines.size(); ++i) {
    const LineSegment& line = now.features.lines[i];
    cv::line(picture, {cvRound(line.start_px.x()), cvRound(line.start_px.y())},
             {cvRound(line.end_px.x()), cvRound(line.end_px.y())},
             line_matched[i] ? cv::Scalar(60, 230, 60) : cv::Scalar(40, 120, 40), 1, cv::LINE_AA);
  }
  for (const Eigen::Vector2f& point : now.features.points_px) draw_point(picture, point, {150, 150, 150}, 1);
  for (const PointMatch& match : now.tracks.points)
    draw_point(picture, now.features.points_px[static_cast<std::size_t>(match.current)], {0, 220, 255}, 2);
  for (const PointMatch& match : now.tracks.points)
    if (match.line_px >= 0.0)
      draw_point(picture, now.features.points_px[static_cast<std::size_t>(match.current)], {255, 120, 0}, 3);
  return picture;
}

cv::Mat row_of(const std::vector<cv::Mat>& video, const std::vector<SE3>& T_W_C,
               const bench::FrontEnd::Config& config) {
  std::vector<cv::Mat> pictures;
  for (const bool calibrate : {false, true}) {
    bench::FrontEnd::Config own = config;
    own.calibrate = calibrate;
    bench::FrontEnd front_end(own);
    bench::FrontEndImage now;
    for (std::size_t i = 0; i < video.size(); ++i)
      now = front_end.take(video[i], Time(from_seconds(0.1 * static_cast<double>(i))), T_W_C[i]);
    std::printf("%s: %zu points, %zu matches, %d anchored, %zu lines, %zu matched\n", calibrate ? "calibrated" : "raw",
                now.features.points_px.size(), now.tracks.points.size(), bench::anchored(now),
                now.features.lines.size(), now.tracks.lines.size());
    pictures.push_back(drawn(now));
  }
  cv::Mat row;
  cv::hconcat(pictures, row);
  return row;
}

std::vector<cv::Mat> counts_of_folder(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<cv::Mat> counts;
  for (std::size_t i = 0; i < std::min<std::size_t>(files.size(), kFrames); ++i) {
    counts.push_back(cv::imread(files[i], cv::IMREAD_UNCHANGED));
    cv::min(counts.back(), kLevels - 1, counts.back());
  }
  return counts;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "bench_feature_pictures needs a folder of 16-bit frames and a file to write\n");
    return 2;
  }
  const std::vector<cv::Mat> real = counts_of_folder(argv[1]);
  auto world = bench::SimulatedViews::make("sim:plant?duration=40&seed=502");
  if (real.empty() || !world) {
    std::fprintf(stderr, "%s\n", world ? "no frames in the folder" : world.error().message.c_str());
    return 1;
  }
  std::vector<cv::Mat> simulated;
  std::vector<SE3> poses;
  for (const bench::View& view : world->views(8.0, kFrames, "")) {
    simulated.push_back(view.counts);
    poses.push_back(view.T_W_C);
  }
  const Camera camera{
      .width = real[0].cols, .height = real[0].rows, .fx = 700.0, .fy = 700.0, .cx = 319.5, .cy = 255.5};
  const std::vector<cv::Mat> rows{row_of(video_of(real), std::vector<SE3>(real.size(), SE3::Identity()),
                                         {.camera = camera, .matching = {.window_px = 45.0, .gate_px = 45.0}}),
                                  row_of(video_of(simulated), poses, {.camera = world->camera()})};
  cv::Mat all;
  cv::vconcat(rows, all);
  cv::imwrite(argv[2], all, {cv::IMWRITE_JPEG_QUALITY, 88});
  return 0;
}
