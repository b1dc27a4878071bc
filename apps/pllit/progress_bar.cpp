#include "progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <format>

namespace pllit::app {

ProgressBar::ProgressBar(std::string what, bool wanted)
    : what_(std::move(what)), shown_(wanted && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(double share, long count) {
  const auto now = Clock::now();
  if (!shown_ || now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  constexpr int width = 30;
  const int filled = static_cast<int>(width * std::clamp(share, 0.0, 1.0));
  const std::string remaining = share > 0.01 ? std::format(", {:.0f} s left", elapsed_s * (1.0 - share) / share) : "";
  std::fputs(std::format("\r\033[K[{}{}] {:3.0f} %  {:.1f} {}/s{}", std::string(filled, '#'),
                         std::string(width - filled, '.'), 100.0 * std::max(0.0, share),
                         static_cast<double>(count) / std::max(elapsed_s, 1e-3), what_, remaining)
                 .c_str(),
             stderr);
}

}  // namespace pllit::app
