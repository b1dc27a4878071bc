#include "pllit/sim/camera/expose.hpp"

#include <algorithm>
#include <cmath>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr int kMoments = 64;
constexpr int kBlockColumns = 16, kBlockRows = 4;

void add(ExposurePoses& poses, const SE3& T_W_C) {
  poses.R_W_C.push_back(T_W_C.rotation());
  poses.p_W.push_back(T_W_C.translation());
}

float fraction(double x) { return static_cast<float>(x - std::floor(x)); }

/// Everything that the blocks of one image share.
struct Job {
  const RayTable& table;
  const RayCaster& caster;
  const ExposurePoses& poses;
  std::span<const Vector3d> pattern;  ///< right, down and moment of each sample of a pixel, before its turn
  const Shade& shade;
  Vector3d phase;  ///< of this image
};

/// Digits of an index, mirrored at the point: van der Corput's sequence.
double mirrored_digits(int index, int base) {
  double value = 0.0, place = 1.0;
  for (; index > 0; index /= base) value += (place /= base) * (index % base);
  return value;
}

/// Hammersley's points for places; moments evenly, in an order that has nothing to do with the places.
std::vector<Vector3d> sample_pattern(int samples) {
  std::vector<Vector3d> pattern;
  for (int i = 0; i < samples; ++i) {
    const int turned = (i + samples / 2) % samples;
    const double moment = (std::floor(mirrored_digits(turned, 3) * samples) + 0.5) / samples;
    pattern.emplace_back(static_cast<double>(i) / samples, mirrored_digits(i, 2), moment);
  }
  return pattern;
}

Ray sample_ray(const Job& job, const Vector3d& phase, int column, int row, std::size_t index) {
  const Vector3d place = job.pattern[index] + phase;
  const std::size_t poses = job.poses.p_W.size();
  const auto pose = std::min(static_cast<std::size_t>(fraction(place.z()) * static_cast<float>(poses)), poses - 1);
  const Vector3f ray_C = job.table.at(column, row, fraction(place.x()), fraction(place.y()));
  return {job.poses.p_W[pose], job.poses.R_W_C[pose] * ray_C.cast<double>()};
}

/// Buffers of one block, used again for the next.
struct Buffers {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<float> values;
};

void expose_block(const Job& job, int left, int top, int right, int bottom, Buffers& buffers, cv::Mat& image) {
  // Turns the pattern from pixel to pixel such that neighbours complement each other in all three dimensions.
  const Vector3d per_column(0.7548776662, 0.3247179572, 0.1458980338),
      per_row(0.5698402910, 0.2451223338, 0.8191725134);
  const std::size_t samples = job.pattern.size();
  buffers.rays.clear();
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column)
      for (std::size_t i = 0; i < samples; ++i)
        buffers.rays.push_back(sample_ray(job, job.phase + column * per_column + row * per_row, column, row, i));
  buffers.hits.resize(buffers.rays.size());
  buffers.values.resize(samples);
  job.caster.cast(buffers.rays, buffers.hits);
  std::size_t first = 0;
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column, first += samples) {
      job.shade(std::span(buffers.rays).subspan(first, samples), std::span(buffers.hits).subspan(first, samples),
                buffers.values);
      float sum = 0.0F;
      for (const float value : buffers.values) sum += value;
      image.at<float>(row, column) = sum / static_cast<float>(samples);
    }
  }
}

}  // namespace

ExposurePoses open_shutter(const CameraPath& path, Time middle, Duration length) {
  ExposurePoses poses;
  for (int i = 0; i < kMoments; ++i)
    add(poses, path(middle + from_seconds(((i + 0.5) / kMoments - 0.5) * to_seconds(length))));
  return poses;
}

ExposurePoses fading_memory(const CameraPath& path, Time readout, Duration time_constant) {
  ExposurePoses poses;
  for (int i = 0; i < kMoments; ++i)
    add(poses, path(readout + from_seconds(std::log((i + 0.5) / kMoments) * to_seconds(time_constant))));
  return poses;
}

cv::Mat expose(const RayTable& table, const RayCaster& caster, const ExposurePoses& poses, int samples,
               std::uint64_t seed, const Shade& shade, Arena& arena) {
  Random random(seed);
  const double right = random.uniform(), down = random.uniform(), moment = random.uniform();
  const std::vector<Vector3d> pattern = sample_pattern(samples);
  const Job job{table, caster, poses, pattern, shade, {right, down, moment}};
  cv::Mat image(table.height(), table.width(), CV_32FC1);
  arena.for_chunks(static_cast<std::size_t>(table.height()), kBlockRows, [&](std::size_t begin, std::size_t end) {
    Buffers buffers;
    for (int left = 0; left < table.width(); left += kBlockColumns)
      expose_block(job, left, static_cast<int>(begin), std::min(left + kBlockColumns, table.width()),
                   static_cast<int>(end), buffers, image);
  });
  return image;
}

}  // namespace pllit
