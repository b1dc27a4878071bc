#include "pllit/sim/camera/thermal_camera.hpp"

#include <algorithm>
#include <cmath>

#include "pllit/sim/camera/image_stages.hpp"

namespace pllit {
namespace {

/// Pixels whose samples, or neighbours, differ by more get more samples.
constexpr float kUneven_K = 0.45F;

std::uint64_t sub_seed(std::uint64_t seed, std::uint64_t stream) { return Random(seed, stream).bits(); }

/// Radiance, CV_32FC1, to counts before noise: what the housing adds towards the corners was measured at the last
/// shutter event and is taken off again, as an offset; the scene's loss remains.
cv::Mat to_counts(const cv::Mat& radiance, const ThermalCameraModel& model, const ThermalBand& band) {
  cv::Mat counts(radiance.size(), CV_32FC1);
  const auto per_radiance = static_cast<float>(model.counts_per_K / band.slope(300.0F));
  const auto offset = static_cast<float>(model.counts_at_300K);
  const float zero = band.radiance(300.0F), housing = band.radiance(static_cast<float>(model.housing_K));
  for (int row = 0; row < counts.rows; ++row) {
    const float* in = radiance.ptr<float>(row);
    float* out = counts.ptr<float>(row);
    for (int column = 0; column < counts.cols; ++column) {
      const float passes = vignetting(column, row, counts.cols, counts.rows, model.vignetting);
      out[column] = offset + per_radiance * (housing + passes * (in[column] - housing) - zero);
    }
  }
  return counts;
}

cv::Mat rounded(const cv::Mat& counts, int bits) {
  const auto highest = static_cast<float>((1 << bits) - 1);
  cv::Mat image(counts.size(), CV_16UC1);
  for (int row = 0; row < counts.rows; ++row) {
    const float* in = counts.ptr<float>(row);
    auto* out = image.ptr<std::uint16_t>(row);
    for (int column = 0; column < counts.cols; ++column)
      out[column] = static_cast<std::uint16_t>(std::clamp(in[column] + 0.5F, 0.0F, highest));
  }
  return image;
}

}  // namespace

ThermalCamera::ThermalCamera(const ThermalCameraModel& model, const Place& place, Time start, std::uint64_t seed)
    : model_(model),
      place_(&place),
      start_(start),
      rays_(model.camera),
      random_(seed, 0),
      pattern_(model.camera.width, model.camera.height, model.fixed_pattern, sub_seed(seed, 1)),
      shutter_(model.shutter, start, sub_seed(seed, 2)) {}

cv::Mat ThermalCamera::counts(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena) {
  const Heat heat(*place_, band_, to_seconds(time - start_), rays_.pixel_rad());
  const Sampling sampling = sampling_for(model_.samples, kUneven_K * band_.slope(300.0F));
  const auto poses = fading_memory(path, time, from_seconds(model_.time_constant_s));
  const Shade shade = [&](auto rays, auto hits, std::size_t samples, auto radiance) {
    heat.shade(caster, rays, hits, samples, radiance);
  };
  const cv::Mat radiance = expose(rays_, caster, poses, sampling, random_.bits(), shade, arena);
  cv::Mat counts = to_counts(blurred(radiance, model_.blur_sigma_px, arena), model_, band_);
  const auto per_K = static_cast<float>(model_.counts_per_K);
  pattern_.add_to(counts, per_K, arena);
  add_noise(counts, static_cast<float>(model_.netd_K) * per_K, random_.bits(), arena);
  return rounded(counts, model_.bits);
}

ThermalFrame ThermalCamera::capture(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena) {
  const Shutter::State shutter = shutter_.at(time);
  if (shutter.closed && last_) {
    last_->time = time;
    last_->frozen = true;
    return *last_;
  }
  if (shutter.events != shutter_events_) {
    pattern_.reset(arena);
    shutter_events_ = shutter.events;
  } else if (last_) {
    pattern_.walk(to_seconds(time - last_->time), arena);
  }
  const cv::Mat image = counts(caster, path, time, arena);
  mapping_ = smoothed(mapping_, grey_mapping(image, model_.agc, 1 << model_.bits), model_.agc.speed_256);
  last_ = ThermalFrame{.time = time, .counts = image, .grey = applied(mapping_, image)};
  return *last_;
}

}  // namespace pllit
