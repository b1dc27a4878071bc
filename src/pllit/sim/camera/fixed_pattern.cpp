#include "pllit/sim/camera/fixed_pattern.hpp"

#include <cmath>
#include <opencv2/core.hpp>

#include "pllit/sim/camera/image_stages.hpp"

namespace pllit {

FixedPattern::FixedPattern(int width, int height, const FixedPatternModel& model, std::uint64_t seed)
    : model_(model),
      random_(seed),
      pixels_(cv::Mat::zeros(height, width, CV_32FC1)),
      columns_(cv::Mat::zeros(1, width, CV_32FC1)) {}

void FixedPattern::disturb(double keep, double column_sigma, double pixel_sigma, double whole_sigma, Arena& arena) {
  whole_ = static_cast<float>(keep * whole_ + whole_sigma * random_.gaussian());
  columns_ *= keep;
  pixels_ *= keep;
  add_noise(columns_, static_cast<float>(column_sigma), random_.bits(), arena);
  add_noise(pixels_, static_cast<float>(pixel_sigma), random_.bits(), arena);
}

void FixedPattern::reset(Arena& arena) {
  disturb(0.0, model_.column_left, model_.pixel_left, model_.whole_left, arena);
}

void FixedPattern::walk(double seconds, Arena& arena) {
  const double root = std::sqrt(std::max(seconds, 0.0));
  disturb(1.0, root * model_.column_walk, root * model_.pixel_walk, root * model_.whole_walk, arena);
}

void FixedPattern::add_to(cv::Mat& image, float scale, Arena& arena) const {
  arena.for_chunks(static_cast<std::size_t>(image.rows), 16, [&](std::size_t begin, std::size_t end) {
    const float* column_offset = columns_.ptr<float>(0);
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      const float* offset = pixels_.ptr<float>(row);
      float* value = image.ptr<float>(row);
      for (int column = 0; column < image.cols; ++column)
        value[column] += scale * (offset[column] + column_offset[column] + whole_);
    }
  });
}

Shutter::Shutter(const ShutterModel& model, Time start, std::uint64_t seed) : model_(model), random_(seed) {
  schedule(start);
}

void Shutter::schedule(Time after) {
  closes_ = after + from_seconds(random_.uniform(model_.least_interval_s, model_.most_interval_s));
  opens_ = closes_ + from_seconds(random_.uniform(model_.least_freeze_s, model_.most_freeze_s));
}

Shutter::State Shutter::at(Time time) {
  while (time >= opens_) {
    ++events_;
    schedule(opens_);
  }
  return {.closed = time >= closes_, .events = events_};
}

}  // namespace pllit
