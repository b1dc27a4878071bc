#include "pllit/sim/camera/expose.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr int kMoments = 64;
constexpr int kBlockColumns = 32, kBlockRows = 4;

void add(ExposurePoses& poses, const SE3& T_W_C) {
  poses.R_W_C.push_back(T_W_C.rotation());
  poses.p_W.push_back(T_W_C.translation());
}

/// By how much the image moves in all but the first tenth of the exposure, for things at 6 m.
double smear_rad(const ExposurePoses& poses) {
  constexpr double range_m = 6.0;
  const std::size_t first = poses.p_W.size() / 10;
  const Matrix3d turn = poses.R_W_C[first].transpose() * poses.R_W_C.back();
  return std::acos(std::clamp(0.5 * (turn.trace() - 1.0), -1.0, 1.0)) +
         (poses.p_W.back() - poses.p_W[first]).norm() / range_m;
}

float fraction(double x) { return static_cast<float>(x - std::floor(x)); }

/// Everything that the blocks of one image share.
struct Job {
  const RayTable& table;
  const RayCaster& caster;
  const ExposurePoses& poses;
  std::span<const Vector3d> first, more;  ///< right, down and moment of each sample of a pixel, before its turn
  float spread;
  int reach;  ///< px within which samples are compared
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

/// place: right, down and moment, modulo 1.
Ray sample_ray(const Job& job, const Vector3d& place, int column, int row) {
  const std::size_t poses = job.poses.p_W.size();
  const auto pose = std::min(static_cast<std::size_t>(fraction(place.z()) * static_cast<float>(poses)), poses - 1);
  const Vector3f ray_C = job.table.at(column, row, fraction(place.x()), fraction(place.y()));
  return {job.poses.p_W[pose], job.poses.R_W_C[pose] * ray_C.cast<double>()};
}

struct Pixel {
  int column, row;
};

/// Buffers of one block, used again for the next.
struct Buffers {
  std::vector<Pixel> pixels;
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<float> values;
};

/// Of the first samples of each pixel, CV_32FC1.
struct First {
  explicit First(cv::Size size) : mean(size, CV_32FC1), least(size, CV_32FC1), most(size, CV_32FC1) {}
  cv::Mat mean, least, most;
};

/// Values of the pattern's samples, pixel by pixel.
void sample(const Job& job, std::span<const Pixel> pixels, std::span<const Vector3d> pattern, Buffers& buffers) {
  // Turns the pattern from pixel to pixel such that neighbours complement each other in all three dimensions.
  const Vector3d per_column(0.7548776662, 0.3247179572, 0.1458980338),
      per_row(0.5698402910, 0.2451223338, 0.8191725134);
  buffers.rays.clear();
  for (const auto& [column, row] : pixels) {
    const Vector3d phase = job.phase + column * per_column + row * per_row;
    for (const Vector3d& place : pattern) buffers.rays.push_back(sample_ray(job, place + phase, column, row));
  }
  buffers.hits.resize(buffers.rays.size());
  job.caster.cast(buffers.rays, buffers.hits);
  buffers.values.resize(buffers.rays.size());
  job.shade(buffers.rays, buffers.hits, pattern.size(), buffers.values);
}

void expose_block(const Job& job, int left, int top, int right, int bottom, Buffers& buffers, First& image) {
  buffers.pixels.clear();
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column) buffers.pixels.push_back({column, row});
  sample(job, buffers.pixels, job.first, buffers);
  auto value = buffers.values.begin();
  for (const auto& [column, row] : buffers.pixels) {
    float sum = 0.0F, least = *value, most = *value;
    for (std::size_t i = 0; i < job.first.size(); ++i, ++value) {
      sum += *value;
      least = std::min(least, *value);
      most = std::max(most, *value);
    }
    image.mean.at<float>(row, column) = sum / static_cast<float>(job.first.size());
    image.least.at<float>(row, column) = least;
    image.most.at<float>(row, column) = most;
  }
}

/// Whether the samples of a pixel and of those up to job.reach beside, above and below it differ.
bool is_uneven(const Job& job, const First& image, int column, int row) {
  float least = image.least.at<float>(row, column), most = image.most.at<float>(row, column);
  const auto add = [&](int x, int y) {
    x = std::clamp(x, 0, image.mean.cols - 1);
    y = std::clamp(y, 0, image.mean.rows - 1);
    least = std::min(least, image.least.at<float>(y, x));
    most = std::max(most, image.most.at<float>(y, x));
  };
  for (int d = 1; d <= job.reach; ++d) {
    add(column - d, row);
    add(column + d, row);
    add(column, row - d);
    add(column, row + d);
  }
  return most - least > job.spread;
}

/// Adds more samples to the pixels in the buffers, which it empties.
void sample_more(const Job& job, Buffers& buffers, cv::Mat& image) {
  sample(job, buffers.pixels, job.more, buffers);
  const float share = static_cast<float>(job.first.size()) / static_cast<float>(job.first.size() + job.more.size());
  auto value = buffers.values.begin();
  for (const auto& [column, row] : buffers.pixels) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < job.more.size(); ++i) sum += *value++;
    float& mean = image.at<float>(row, column);
    mean = share * mean + (1.0F - share) * sum / static_cast<float>(job.more.size());
  }
  buffers.pixels.clear();
}

/// Adds more samples to the uneven pixels of some rows, so many pixels at a time that the caches hold them.
void refine(const Job& job, const First& first, int top, int bottom, cv::Mat& image) {
  Buffers buffers;
  for (int row = top; row < bottom; ++row)
    for (int column = 0; column < image.cols; ++column) {
      if (is_uneven(job, first, column, row)) buffers.pixels.push_back({column, row});
      if (buffers.pixels.size() == kBlockColumns) sample_more(job, buffers, image);
    }
  sample_more(job, buffers, image);
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

cv::Mat expose(const RayTable& table, const RayCaster& caster, const ExposurePoses& poses, const Sampling& sampling,
               std::uint64_t seed, const Shade& shade, Arena& arena) {
  Random random(seed);
  const double right = random.uniform(), down = random.uniform(), moment = random.uniform();
  // Long smears need more samples, and farther from where the first ones have shown them.
  const int reach =
      1 + static_cast<int>(std::min(1.0, 0.5 * smear_rad(poses) / static_cast<double>(table.pixel_rad())));
  const std::vector<Vector3d> first = sample_pattern(sampling.first), more = sample_pattern(sampling.more * reach);
  const Job job{table, caster, poses, first, more, sampling.spread, reach, shade, {right, down, moment}};
  First image({table.width(), table.height()});
  const auto rows = static_cast<std::size_t>(table.height());
  arena.for_chunks(rows, kBlockRows, [&](std::size_t begin, std::size_t end) {
    Buffers buffers;
    for (int left = 0; left < table.width(); left += kBlockColumns)
      expose_block(job, left, static_cast<int>(begin), std::min(left + kBlockColumns, table.width()),
                   static_cast<int>(end), buffers, image);
  });
  if (more.empty()) return image.mean;
  cv::Mat refined = image.mean.clone();
  arena.for_chunks(rows, kBlockRows, [&](std::size_t begin, std::size_t end) {
    refine(job, image, static_cast<int>(begin), static_cast<int>(end), refined);
  });
  return refined;
}

}  // namespace pllit
