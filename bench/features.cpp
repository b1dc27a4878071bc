// How well points and lines come back: bench_features MODEL FOLDER... where a folder holds images, or what `pllit
// simulate
// --frames` wrote. Each image is paired with itself under a random homography (seeded; new sensor noise), and again
// under the homography and a random gain control. Every detector gives its best 300 points, spread by the same rule
// (corners.hpp).
//
// repeatability: share of the points, both ways, that have one within 3 px in the other image, of those that it shows.
// matching score: mutual nearest neighbours by descriptor that are within 3 px of the truth, over the points shown.
// lines: share of the length, both ways, that lies within 3 px and 5 degrees of a line in the other image.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "feature_scores.hpp"
#include "pllit/thermal/classical_extractor.hpp"
#include "pllit/thermal/network_extractor.hpp"

namespace {

using namespace pllit;
using namespace pllit::bench;
namespace fs = std::filesystem;

constexpr int kPoints = 300;
constexpr float kSpread_px = 8.0F;

struct Method {
  std::string name;
  std::function<Features(const cv::Mat&)> extract;
};

// --- detectors -------------------------------------------------------------------------------------------------------

/// OpenCV's detectors are asked for plenty of points, which are then spread like everyone else's.
Features opencv_features(cv::Feature2D& detector, bool describes, const cv::Mat& grey) {
  std::vector<cv::KeyPoint> found;
  detector.detect(grey, found);
  std::vector<Corner> corners;
  for (const cv::KeyPoint& k : found) corners.push_back({{k.pt.x, k.pt.y}, k.response});
  std::ranges::stable_sort(corners, std::ranges::greater{}, &Corner::strength);
  std::vector<cv::KeyPoint> chosen;
  for (const Corner& corner : spread_evenly(corners, kPoints, kSpread_px))
    chosen.push_back(*std::ranges::find_if(
        found, [&](const cv::KeyPoint& k) { return k.pt.x == corner.at_px.x() && k.pt.y == corner.at_px.y(); }));
  Features features;
  if (describes) detector.compute(grey, chosen, features.descriptors);  // may drop points
  for (const cv::KeyPoint& k : chosen) features.points_px.emplace_back(k.pt.x, k.pt.y);
  return features;
}

/// LSD as OpenCV has it, with its own default scale; segments of 16 px and more.
std::vector<LineSegment> lsd_lines(const cv::Mat& grey) {
  std::vector<cv::Vec4f> found;
  cv::createLineSegmentDetector()->detect(grey, found);
  std::vector<LineSegment> lines;
  for (const cv::Vec4f& s : found)
    if (const LineSegment line{{s[0], s[1]}, {s[2], s[3]}, 0.0F}; line.length_px() >= 16.0F) lines.push_back(line);
  for (LineSegment& line : lines) line.score = line.length_px() / (line.length_px() + 40.0F);
  return lines;
}

Method opencv_method(const std::string& name, const cv::Ptr<cv::Feature2D>& detector, bool describes) {
  return {name, [=](const cv::Mat& grey) { return opencv_features(*detector, describes, grey); }};
}

Method house_method(std::shared_ptr<FeatureExtractor> extractor) {
  return {std::string(extractor->name()), [=](const cv::Mat& grey) { return extractor->extract(grey).value(); }};
}

std::shared_ptr<FeatureExtractor> network(const std::string& model, NetworkConfig::Points points, int threads) {
  NetworkConfig config{.model = model, .threads = threads, .place_points = points};
  config.points.most = kPoints;
  auto extractor = NetworkExtractor::open(config);
  if (!extractor) std::fprintf(stderr, "%s\n", extractor.error().message.c_str());
  return extractor ? std::move(*extractor) : nullptr;
}

void add(Score& score, const Method& method, const Pair& pair) {
  add_pair(score, method.extract(pair.first), method.extract(pair.second), pair);
}

std::string share(double part, double whole) {
  if (whole <= 0.0) return "-";
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%.3f", part / whole);
  return text.data();
}

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename().string();
        name.ends_with(".jpg") || name.ends_with(".JPG") ||
        (name.ends_with(".png") && !name.contains(".counts") && !name.contains(".depth") &&
         !name.contains(".temperature")))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

/// 8 bit and at most 640 columns wide.
cv::Mat read_grey(const fs::path& file) {
  cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (image.cols > 640) cv::resize(image, image, {}, 640.0 / image.cols, 640.0 / image.cols, cv::INTER_AREA);
  return image;
}

void report_pairs(const fs::path& folder, const std::vector<Method>& methods, std::size_t most) {
  std::vector<fs::path> files = images_in(folder);
  const std::size_t every = std::max<std::size_t>(files.size() / most, 1);
  for (const bool gain : {false, true}) {
    std::printf("\n%s, homography%s\n%-36s %8s %14s %14s %8s %14s\n", folder.c_str(), gain ? " and gain control" : "",
                "", "points", "repeatability", "matching", "lines", "repeatability");
    for (const Method& method : methods) {
      Score score;
      for (std::size_t i = 0; i < files.size(); i += every)
        if (const cv::Mat image = read_grey(files[i]); !image.empty())
          add(score, method, make_pair(image, gain, static_cast<int>(i)));
      std::printf("%-36s %8.0f %14s %14s %8.0f %14s\n", method.name.c_str(), score.points / score.pairs,
                  share(score.back, score.shown).c_str(), share(score.right, score.could_match).c_str(),
                  score.lines / score.pairs, share(score.line.on, score.line.all).c_str());
      std::fflush(stdout);
    }
  }
}

void report_time(const Method& method, const cv::Mat& image) {
  std::vector<double> times_ms;
  for (int i = 0; i < 15; ++i) {
    const auto start = std::chrono::steady_clock::now();
    method.extract(image);
    times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::sort(times_ms);
  std::printf("%-36s %8.1f least, %8.1f median\n", method.name.c_str(), times_ms.front(),
              times_ms[times_ms.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) {
  using Points = NetworkConfig::Points;
  if (argc < 3) {
    std::fprintf(stderr, "bench_features MODEL FOLDER... (of images)\n");
    return 2;
  }
  const auto net = network(argv[1], Points::network, 2), at_corners = network(argv[1], Points::corners, 2),
             one_thread = network(argv[1], Points::network, 1);
  if (!net || !at_corners || !one_thread) return 1;
  cv::setNumThreads(2);
  ClassicalConfig classical;
  classical.most_points = kPoints;
  classical.most_radius_px = kSpread_px;
  constexpr int kPlenty = 3000;
  const std::vector<Method> methods{
      house_method(net),
      house_method(at_corners),
      house_method(std::make_shared<ClassicalExtractor>(classical)),
      {"LSD (OpenCV)", [](const cv::Mat& grey) { return Features{{}, {}, {}, lsd_lines(grey)}; }},
      opencv_method("GFTT (OpenCV)", cv::GFTTDetector::create(kPlenty, 1e-4, 1.0), false),
      opencv_method("FAST (OpenCV)", cv::FastFeatureDetector::create(5), false),
      opencv_method("ORB (OpenCV)", cv::ORB::create(kPlenty, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, 5), true),
      opencv_method("SIFT (OpenCV)", cv::SIFT::create(kPlenty, 3, 0.01), true)};
  const char* most = std::getenv("BENCH_IMAGES");
  for (int i = 2; i < argc; ++i) report_pairs(argv[i], methods, most ? std::strtoul(most, nullptr, 10) : 24);
  std::vector<fs::path> files = images_in(argv[2]);
  cv::Mat frame;
  cv::resize(read_grey(files.front()), frame, {640, 512});
  std::printf("\nms a frame of 640 x 512, all of it; two threads, then the network on one\n");
  for (const Method& method : methods) report_time(method, frame);
  report_time(house_method(one_thread), frame);
  return 0;
}
