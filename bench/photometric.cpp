// How well the photometric calibration undoes known changes of real 16-bit thermal images, from its own tracks:
// bench_photometric FOLDER (60 consecutive frames of a drive, PNG). The frames are mapped to 8 bits by a known curve
// that changes from frame to frame; the chain of curves is recovered from the first frame on. Prints the largest
// deviation, over the greys from the 5 to the 95 % quantile that are not clipped, and how many points are anchored to
// lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <string>

#include "front_end.hpp"
#include "pllit/sim/camera/agc.hpp"

namespace {

using namespace pllit;

constexpr int kLevels = 1 << 14;
/// Of each raw grey the calibrated one; nothing where it is not known or clipped.
using Truth = std::array<std::optional<double>, 256>;

struct Seen {
  cv::Mat raw;
  Truth truth;
};

std::vector<cv::Mat> frames_in(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<cv::Mat> frames;
  for (const auto& file : files) frames.push_back(cv::imread(file, cv::IMREAD_UNCHANGED));
  return frames;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

std::vector<double> sampled(const std::vector<cv::Mat>& frames) {
  std::vector<double> values;
  for (const cv::Mat& frame : frames)
    for (int row = 0; row < frame.rows; row += 8)
      for (int column = 0; column < frame.cols; column += 8) values.push_back(frame.at<std::uint16_t>(row, column));
  return values;
}

/// Frames under an affine curve that changes: calibrated = gain raw + bias.
std::vector<Seen> under_affine(const std::vector<cv::Mat>& frames,
                               const std::function<std::pair<double, double>(int)>& curve) {
  const std::vector<double> values = sampled(frames);
  const double low = quantile(values, 0.01), high = quantile(values, 0.99), scale = 160.0 / (high - low);
  std::vector<Seen> seen;
  for (int k = 0; k < static_cast<int>(frames.size()); ++k) {
    const auto [gain, bias] = curve(k);
    Seen one;
    frames[static_cast<std::size_t>(k)].convertTo(one.raw, CV_8U, scale / gain, ((48.0 - low * scale) - bias) / gain);
    for (int raw = 1; raw < 255; ++raw) one.truth[static_cast<std::size_t>(raw)] = gain * raw + bias;
    seen.push_back(one);
  }
  return seen;
}

/// Frames under a thermal camera's own plateau equalisation; the first one's greys are the calibrated ones.
std::vector<Seen> under_plateau(const std::vector<cv::Mat>& frames) {
  const double middle = quantile(sampled(frames), 0.5);
  const AgcConfig agc;
  GreyMapping first, mapping;
  std::vector<Seen> seen;
  for (const cv::Mat& frame : frames) {
    cv::Mat counts;
    frame.convertTo(counts, CV_16U, 1.0, 7000.0 - middle);
    cv::min(counts, kLevels - 1, counts);
    mapping = smoothed(mapping, grey_mapping(counts, agc, kLevels), mapping.empty() ? 256 : agc.speed_256);
    if (first.empty()) first = mapping;
    Seen one{.raw = applied(mapping, counts), .truth = {}};
    std::array<double, 256> sum{}, pixels{};
    for (int row = 0; row < counts.rows; ++row)
      for (int column = 0; column < counts.cols; ++column) {
        const double calibrated = static_cast<double>(first[counts.at<std::uint16_t>(row, column)]);
        if (calibrated < 2.0 || calibrated > 253.0) continue;
        const std::size_t raw = one.raw.at<std::uint8_t>(row, column);
        sum[raw] += calibrated;
        pixels[raw] += 1.0;
      }
    for (std::size_t raw = 3; raw < 253; ++raw)
      if (pixels[raw] > 20.0) one.truth[raw] = sum[raw] / pixels[raw];
    seen.push_back(one);
  }
  return seen;
}

double deviation(const Seen& seen, const GreyCurve& curve) {
  std::array<double, 256> histogram{};
  double all = 0.0;
  for (int row = 0; row < seen.raw.rows; ++row)
    for (int column = 0; column < seen.raw.cols; ++column)
      if (const std::size_t raw = seen.raw.at<std::uint8_t>(row, column); seen.truth[raw]) {
        histogram[raw] += 1.0;
        all += 1.0;
      }
  double below = 0.0, worst = 0.0;
  for (std::size_t raw = 0; raw < 256; ++raw) {
    below += histogram[raw];
    if (seen.truth[raw] && below >= 0.05 * all && below - histogram[raw] <= 0.95 * all)
      worst = std::max(worst, std::abs(curve(static_cast<double>(raw)) - *seen.truth[raw]));
  }
  return worst;
}

struct Outcome {
  std::vector<double> deviations;
  double matches = 0.0, anchored = 0.0;
  std::array<int, 4> kinds{};
  double inliers = 0.0, pairs = 0.0, rms = 0.0;
};

/// The images have no poses: points are sought within 45 px of where they were.
Outcome run(const std::vector<Seen>& video, double false_share, bool calibrate) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  bench::FrontEnd front_end(
      {.camera = {.width = 640, .height = 512, .fx = 700.0, .fy = 700.0, .cx = 319.5, .cy = 255.5},
       .matching = {.window_px = 45.0, .gate_px = 45.0},
       .calibrate = calibrate,
       .disturb = [&](Tracks& tracks, const Features& now) {
         for (PointMatch& match : tracks.points)
           if (share(engine) < false_share)
             match.current = static_cast<int>(share(engine) * static_cast<double>(now.points_px.size()));
       }});
  Outcome outcome;
  for (std::size_t k = 0; k < video.size(); ++k) {
    const auto now = front_end.take(video[k].raw, Time(from_seconds(0.1 * static_cast<double>(k))), SE3::Identity());
    outcome.matches += static_cast<double>(now.tracks.points.size());
    outcome.anchored += bench::anchored(now);
    if (k == 0) continue;
    ++outcome.kinds[static_cast<std::size_t>(now.fit.kind)];
    outcome.deviations.push_back(deviation(video[k], now.curve));
    outcome.inliers += now.fit.inliers;
    outcome.pairs += now.fit.pairs;
    outcome.rms += now.fit.rms_grey;
  }
  return outcome;
}

void report(const char* name, const std::vector<Seen>& video) {
  const double frames = static_cast<double>(video.size() - 1);
  for (const double false_share : {0.0, 0.3}) {
    const Outcome with = run(video, false_share, true);
    std::printf("%-16s %4.0f %%  %5.2f  %5.2f  %5.2f   %4d/%d/%d/%d", name, 100.0 * false_share,
                quantile(with.deviations, 0.5), quantile(with.deviations, 0.9), quantile(with.deviations, 1.0),
                with.kinds[0], with.kinds[1], with.kinds[2], with.kinds[3]);
    std::printf("  pairs %5.0f inliers %5.0f rms %4.2f", with.pairs / frames, with.inliers / frames, with.rms / frames);
    if (false_share == 0.0) {
      const Outcome without = run(video, 0.0, false);
      std::printf("  anchored %4.1f -> %4.1f, matches %5.0f -> %5.0f", without.anchored / frames,
                  with.anchored / frames, without.matches / frames, with.matches / frames);
    }
    std::puts("");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "bench_photometric needs a folder of 16-bit frames\n");
    return 2;
  }
  const std::vector<cv::Mat> frames = frames_in(argv[1]);
  std::puts("curve           false    50 %   90 %  worst   kept/bias/affine/curve");
  const std::array<std::pair<double, double>, 6> levels{
      {{1.0, 0.0}, {0.6, 40.0}, {1.6, -40.0}, {1.2, 20.0}, {0.8, -40.0}, {1.4, -20.0}}};
  report("steps",
         under_affine(frames, [&](int k) { return levels[static_cast<std::size_t>(k / 10) % levels.size()]; }));
  report("ramps", under_affine(frames, [&](int k) {
           const auto &from = levels[static_cast<std::size_t>(k / 10) % levels.size()],
                      &to = levels[static_cast<std::size_t>(k / 10 + 1) % levels.size()];
           return std::pair(std::lerp(from.first, to.first, k % 10 / 10.0),
                            std::lerp(from.second, to.second, k % 10 / 10.0));
         }));
  report("plateau", under_plateau(frames));
  return 0;
}
