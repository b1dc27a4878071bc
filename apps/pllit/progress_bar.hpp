// A progress bar with rate and remaining time on stderr, where that is a terminal.
#pragma once

#include <chrono>
#include <string>

namespace pllit::app {

class ProgressBar {
 public:
  /// Shown only where stderr is a terminal and `wanted` holds.
  ProgressBar(std::string what, bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// share: 0 to 1, negative where unknown; count: things done so far, for the rate.
  void show(double share, long count);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_;
  Clock::time_point begin_ = Clock::now(), next_ = begin_;
};

}  // namespace pllit::app
