// What thermal images are made of, in numbers: bench_thermal_anchors SOURCE... where a source is a folder of images (16
// bit ones pass the simulated camera's gain control; their median is taken for 7000 counts) or an address such as
// sim:street?duration=20. For each the quartiles over its images of: quantiles of the gradient's magnitude (grey levels
// a pixel), of the greys, Shi-Tomasi corners and segments of 15 pixels and more found by LSD. Wider images are
// shrunk to 640 columns, and counts are those of 640x512 pixels.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
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

std::vector<Figures> of_folder(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  GainControl control;
  std::vector<Figures> all;
  for (const auto& file : files) {
    cv::Mat image = cv::imread(file, cv::IMREAD_ANYDEPTH | cv::IMREAD_GRAYSCALE);
    if (image.empty()) continue;
    if (image.depth() == CV_16U) image = control.grey(image);
    all.push_back(figures_of(shrunk(image)));
  }
  return all;
}

/// One image in ten.
std::vector<Figures> of_simulation(const std::string& address) {
  auto simulation = open_simulation(address);
  std::vector<Figures> all;
  if (!simulation) std::fprintf(stderr, "%s\n", simulation.error().message.c_str());
  if (!simulation) return all;
  int index = 0;
  for (auto event = simulation->next(); event && *event; event = simulation->next())
    if (const auto* frame = std::get_if<CameraFrame>(&(*event)->data); frame && index++ % 10 == 5)
      all.push_back(figures_of(frame->counts));
  return all;
}

void report(const std::string& source) {
  const std::vector<Figures> all = source.starts_with("sim:") ? of_simulation(source) : of_folder(source);
  std::printf("%s: %zu images\n%-32s %10s %10s %10s\n", source.c_str(), all.size(), "", "25 %", "50 %", "75 %");
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    std::vector<float> values;
    for (const Figures& figures : all) values.push_back(static_cast<float>(figures[i]));
    std::printf("%-32s %10.1f %10.1f %10.1f\n", kNames[i], quantile(values, 0.25), quantile(values, 0.5),
                quantile(values, 0.75));
  }
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) std::fprintf(stderr, "bench_thermal_anchors needs folders of images or addresses of the simulator\n");
  for (int i = 1; i < argc; ++i) report(argv[i]);
  return argc < 2 ? 2 : 0;
}
