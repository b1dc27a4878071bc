// What happens to messages between sensor and recorder.
#pragma once

#include <deque>
#include <optional>

#include "pllit/base/time.hpp"
#include "pllit/sensor/measurements.hpp"
#include "pllit/sim/config.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

/// Takes messages in order of their true times and hands them out
/// in the order received, with the faults that were asked for.
class FaultyLine {
 public:
  FaultyLine(const SimFaults& faults, Time start, std::uint64_t seed)
      : faults_(faults), start_(start), random_(seed, 50) {}

  /// A message whose sensor was done with it at `event.received`. `next`: when the same sensor's next one will come.
  void push(SensorEvent event, Time next);
  /// The first message, where all those before `until` are known.
  std::optional<SensorEvent> pop_before(Time until);
  bool empty() const { return pending_.empty(); }

 private:
  void deliver(SensorEvent event, double t_s);

  SimFaults faults_;
  Time start_;
  Random random_;
  int imu_samples_ = 0;
  std::deque<SensorEvent> pending_;
};

}  // namespace pllit
