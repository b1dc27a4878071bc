// Mean, extremes and percentiles of a stream of positive numbers in constant memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pllit {

/// Counts in bins whose width is 2 % of their value, from 1e-4 to 1e7; percentiles are right to that.
class Distribution {
 public:
  void add(double value) {
    ++bins_[bin_of(value)];
    ++count_;
    sum_ += value;
    max_ = std::max(max_, value);
  }

  std::int64_t count() const { return count_; }
  double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0.0; }
  double max() const { return max_; }
  /// The value that a share of all (0 to 1) do not exceed.
  double percentile(double share) const {
    std::int64_t below = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      below += bins_[i];
      if (static_cast<double>(below) >= share * static_cast<double>(count_) && below > 0)
        return std::min(max_, lowest * std::pow(ratio, static_cast<double>(i) + 0.5));
    }
    return 0.0;
  }

 private:
  static constexpr double lowest = 1e-4, ratio = 1.02;
  static std::size_t bin_of(double value) {
    if (!(value > lowest)) return 0;
    return std::min(bin_count - 1, static_cast<std::size_t>(std::log(value / lowest) / std::log(ratio)));
  }

  static constexpr std::size_t bin_count = 1300;
  std::array<std::int64_t, bin_count> bins_{};
  std::int64_t count_ = 0;
  double sum_ = 0.0, max_ = 0.0;
};

}  // namespace pllit
