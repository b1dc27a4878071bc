// What thermal images are made of, in numbers: bench_thermal_anchors SOURCE... where a source is a folder of images (16
// bit ones pass the simulated camera's gain control; their median is taken for 7000 counts) or an address such as
// sim:street?duration=20. For each the quartiles over its images of: quantiles of the gradient's magnitude (grey levels
// a pixel), of the greys, Shi-Tomasi corners and segments of 15 pixels and more found by LSD; and of how many of 300
// corners Lucas and Kanade's tracker still has one and five images later, there and back within half a pixel, and how
// far they move from image to image (of stills, those three say nothing). Wider images are shrunk to 640 columns, and
// counts are those of 640x512 pixels.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "pllit/sim/camera/agc.hpp"
#include "pllit/sim/simulation.hpp"

namespace {

using namespace pllit;

constexpr std::array kNames{"gradient 50 %", "gradient 75 %", "gradient 90 %",
                            "gradient 99 %", "grey 5 %",      "grey 95 %",
                            "corners",       "segments",      "longest 10 % of segments, px"};
using Figures = std::array<double, kNames.size()>;
constexpr std::array kTrackNames{"% tracked, next image", "% tracked, 5 images", "px from image to image"};
using Tracks = std::array<double, kTrackNames.size()>;

struct Anchors {
  std::vector<Figures> figures;
  std::vector<Tracks> tracks;
};

double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return static_cast<double>(*place);
}

std::vector<float> pixels_of(const cv::Mat& image) {
  cv::Mat flat;
  image.convertTo(flat, CV_32F);
  return {flat.begin<float>(), flat.end<float>()};
}

void measure_lines(const cv::Mat& grey, Figures& figures) {
  constexpr double kLeast_px = 15.0;
  std::vector<cv::Vec4f> segments;
  cv::createLineSegmentDetector()->detect(grey, segments);
  std::vector<float> lengths;
  for (const cv::Vec4f& s : segments)
    if (const double length = std::hypot(s[2] - s[0], s[3] - s[1]); length >= kLeast_px)
      lengths.push_back(static_cast<float>(length));
  figures[7] = static_cast<double>(lengths.size());
  figures[8] = quantile(lengths, 0.9);
}

Figures figures_of(const cv::Mat& grey) {
  cv::Mat dx, dy, magnitude;
  cv::Sobel(grey, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(grey, dy, CV_32F, 0, 1, 3, 0.125);
  cv::magnitude(dx, dy, magnitude);
  std::vector<float> gradients = pixels_of(magnitude), greys = pixels_of(grey);
  Figures figures{quantile(gradients, 0.5),  quantile(gradients, 0.75), quantile(gradients, 0.9),
                  quantile(gradients, 0.99), quantile(greys, 0.05),     quantile(greys, 0.95)};
  // An absolute threshold: one relative to the best corner would count fewer the better that one is.
  cv::Mat strength, best;
  cv::cornerMinEigenVal(grey, strength, 5);
  cv::dilate(strength, best, cv::getStructuringElement(cv::MORPH_RECT, {15, 15}));
  constexpr double kLeast = 4e-4;
  figures[6] = cv::countNonZero((strength >= best) & (strength > kLeast));
  measure_lines(grey, figures);
  const double share = 640.0 * 512.0 / static_cast<double>(grey.total());
  figures[6] *= share;
  figures[7] *= share;
  return figures;
}

/// Follows the corners of every fifth image through the next five.
class Tracker {
 public:
  void add(const cv::Mat& grey, std::vector<Tracks>& all) {
    if (!last_.empty()) step(grey);
    if (++steps_ > kSteps) {
      if (corners_ > 0) all.push_back(result_);
      cv::goodFeaturesToTrack(grey, points_, 300, 0.01, 12.0, cv::noArray(), 5);
      corners_ = points_.size();
      steps_ = 1;
    }
    last_ = grey.clone();
  }

 private:
  static constexpr int kSteps = 5;

  void step(const cv::Mat& grey) {
    if (points_.empty()) return;
    std::vector<cv::Point2f> there, back, kept;
    std::vector<std::uint8_t> found, found_back;
    std::vector<float> moved, unused;
    const cv::Size window(21, 21);
    cv::calcOpticalFlowPyrLK(last_, grey, points_, there, found, unused, window, 3);
    cv::calcOpticalFlowPyrLK(grey, last_, there, back, found_back, unused, window, 3);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (found[i] == 0 || found_back[i] == 0 || cv::norm(back[i] - points_[i]) > 0.5) continue;
      kept.push_back(there[i]);
      moved.push_back(static_cast<float>(cv::norm(there[i] - points_[i])));
    }
    points_ = kept;
    const double share = 100.0 * static_cast<double>(kept.size()) / static_cast<double>(corners_);
    if (steps_ == 1) {
      result_[0] = share;
      result_[2] = quantile(moved, 0.5);
    }
    if (steps_ == kSteps) result_[1] = share;
  }

  cv::Mat last_;
  std::vector<cv::Point2f> points_;
  std::size_t corners_ = 0;
  int steps_ = kSteps;
  Tracks result_{};
};

class GainControl {
 public:
  cv::Mat grey(const cv::Mat& counts) {
    cv::Mat shifted;
    if (offset_ == 0.0) {
      std::vector<float> values = pixels_of(counts);
      offset_ = 7000.0 - quantile(values, 0.5);
    }
    counts.convertTo(shifted, CV_16U, 1.0, offset_);
    cv::min(shifted, kLevels - 1, shifted);
    mapping_ = smoothed(mapping_, grey_mapping(shifted, config_, kLevels), config_.speed_256);
    return applied(mapping_, shifted);
  }

 private:
  static constexpr int kLevels = 1 << 14;
  AgcConfig config_;
  GreyMapping mapping_;
  double offset_ = 0.0;
};

cv::Mat shrunk(const cv::Mat& image) {
  cv::Mat smaller;
  if (image.cols <= 640) return image;
  cv::resize(image, smaller, {}, 640.0 / image.cols, 640.0 / image.cols, cv::INTER_AREA);
  return smaller;
}

Anchors of_folder(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  GainControl control;
  Tracker tracker;
  Anchors all;
  for (const auto& file : files) {
    cv::Mat image = cv::imread(file, cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE);
    if (image.empty()) continue;
    if (image.depth() == CV_16U) image = control.grey(image);
    image = shrunk(image);
    all.figures.push_back(figures_of(image));
    tracker.add(image, all.tracks);
  }
  return all;
}

/// Tracks through all images, the other figures of one in ten.
Anchors of_simulation(const std::string& address) {
  auto simulation = open_simulation(address);
  Tracker tracker;
  Anchors all;
  if (!simulation) std::fprintf(stderr, "%s\n", simulation.error().message.c_str());
  if (!simulation) return all;
  int index = 0;
  for (auto event = simulation->next(); event && *event; event = simulation->next())
    if (const auto* frame = std::get_if<CameraFrame>(&(*event)->data)) {
      tracker.add(frame->counts, all.tracks);
      if (index++ % 10 == 5) all.figures.push_back(figures_of(frame->counts));
    }
  return all;
}

template <class Rows, class Names>
void print_quartiles(const Rows& rows, const Names& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<float> values;
    for (const auto& row : rows) values.push_back(static_cast<float>(row[i]));
    std::printf("%-32s %10.1f %10.1f %10.1f\n", names[i], quantile(values, 0.25), quantile(values, 0.5),
                quantile(values, 0.75));
  }
}

void report(const std::string& source) {
  const Anchors all = source.starts_with("sim:") ? of_simulation(source) : of_folder(source);
  std::printf("%s: %zu images\n%-32s %10s %10s %10s\n", source.c_str(), all.figures.size(), "", "25 %", "50 %", "75 %");
  print_quartiles(all.figures, kNames);
  print_quartiles(all.tracks, kTrackNames);
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) std::fprintf(stderr, "bench_thermal_anchors needs folders of images or addresses of the simulator\n");
  for (int i = 1; i < argc; ++i) report(argv[i]);
  return argc < 2 ? 2 : 0;
}
