#include "pllit/sim/camera/visible_camera.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "pllit/sim/camera/illumination.hpp"
#include "pllit/sim/camera/image_stages.hpp"

namespace pllit {
namespace {

/// Pixels whose samples, or neighbours, differ by more, in full scales, get more samples.
constexpr float kUneven = 0.1F;

/// Exposure times gain that would bring the mean to the target, approached with the controller's speed.
double next_effort_s(double effort_s, double mean, const AutoExposure& exposure) {
  const double wanted = effort_s * std::pow(exposure.target / std::max(mean, 1e-3), exposure.speed);
  return std::clamp(wanted, exposure.least_s, exposure.most_s * exposure.most_gain);
}

/// Brightness to signal of full scale with shot and read noise, in place.
void add_electrons(cv::Mat& image, const VisibleCameraModel& model, double exposure_s, double gain, std::uint64_t seed,
                   Arena& arena) {
  const auto electrons_per_light = static_cast<float>(model.full_well_e * exposure_s / model.full_light_s);
  const auto well_e = static_cast<float>(model.full_well_e), read_e = static_cast<float>(model.read_noise_e);
  arena.for_chunks(static_cast<std::size_t>(image.rows), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Random random(seed, row);
      float* value = image.ptr<float>(static_cast<int>(row));
      for (int column = 0; column < image.cols; ++column) {
        const float passes = vignetting(column, static_cast<int>(row), image.cols, image.rows, model.vignetting);
        const float mean_e = std::max(0.0F, electrons_per_light * passes * value[column]);
        const float caught_e = mean_e + std::sqrt(mean_e + read_e * read_e) * quick_gaussian(random);
        value[column] = std::clamp(static_cast<float>(gain) * caught_e / well_e, 0.0F, 1.0F);
      }
    }
  });
}

cv::Mat to_grey(const cv::Mat& signal, double gamma) {
  constexpr int steps = 4096;
  std::vector<std::uint8_t> table;
  for (int i = 0; i <= steps; ++i)
    table.push_back(static_cast<std::uint8_t>(std::lround(255.0 * std::pow(i / double{steps}, 1.0 / gamma))));
  cv::Mat grey(signal.size(), CV_8UC1);
  for (int row = 0; row < grey.rows; ++row) {
    const float* in = signal.ptr<float>(row);
    auto* out = grey.ptr<std::uint8_t>(row);
    for (int column = 0; column < grey.cols; ++column)
      out[column] = table[static_cast<std::size_t>(in[column] * steps + 0.5F)];
  }
  return grey;
}

}  // namespace

VisibleCamera::VisibleCamera(const VisibleCameraModel& model, const Place& place, Time start, std::uint64_t seed)
    : model_(model), place_(&place), start_(start), rays_(model.camera), random_(seed) {
  const int ahead = std::max(1, model.exposure.delay_frames);
  planned_.assign(static_cast<std::size_t>(ahead), model.full_light_s * model.exposure.target);
}

VisibleFrame VisibleCamera::capture(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena) {
  const double effort_s = planned_.front();
  planned_.pop_front();
  const double exposure_s = std::min(effort_s, model_.exposure.most_s), gain = effort_s / exposure_s;
  const Illumination illumination(*place_, to_seconds(time - start_), rays_.pixel_rad());
  const Shade shade = [&](auto rays, auto hits, std::size_t samples, auto brightness) {
    illumination.shade(caster, rays, hits, samples, brightness);
  };
  const auto full_scale = static_cast<float>(model_.full_light_s / effort_s);
  const Sampling sampling = sampling_for(model_.samples, kUneven * full_scale);
  const auto poses = open_shutter(path, time, from_seconds(exposure_s));
  cv::Mat image =
      blurred(expose(rays_, caster, poses, sampling, random_.bits(), shade, arena), model_.blur_sigma_px, arena);
  add_electrons(image, model_, exposure_s, gain, random_.bits(), arena);
  planned_.push_back(next_effort_s(effort_s, cv::mean(image)[0], model_.exposure));
  return {.time = time, .grey = to_grey(image, model_.gamma), .exposure_s = exposure_s, .gain = gain};
}

}  // namespace pllit
