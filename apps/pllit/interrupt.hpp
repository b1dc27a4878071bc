// Ctrl-C and SIGTERM as a stop token: the run ends after the frame in hand and everything is written.
#pragma once

#include <stop_token>
#include <thread>

namespace pllit::app {

/// While it lives, the first signal requests a stop; the second one ends the process at once. Make it before other
/// threads start: they inherit that the signals are blocked.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return stop_.get_token(); }

 private:
  std::stop_source stop_;
  std::jthread watcher_;
};

}  // namespace pllit::app
