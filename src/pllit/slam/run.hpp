// A whole run: a source's events through assembler and odometry, frame by frame to a sink.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "pllit/base/distribution.hpp"
#include "pllit/slam/odometry.hpp"
#include "pllit/slam/thermography.hpp"

namespace pllit {

/// Takes each frame as soon as it is known; an error ends the run.
using FrameSink = std::function<Expected<void>(const FrameEstimate&)>;

/// What a run came to, in bounded memory.
struct RunSummary {
  int frames = 0;
  double duration_s = 0.0;  ///< of the recording
  double length_m = 0.0;    ///< of the path
  double wall_s = 0.0;      ///< that the run took
  Distribution frame_ms;
  std::array<Distribution, stage_names.size()> stage_ms;
  std::array<int, 4> health{};  ///< frames in each HealthState
  HealthState final_state = HealthState::initialising;
  std::vector<std::string> notes;  ///< what was noticed, each once
  std::optional<Start> start;
  std::optional<RefinedMount> mount;  ///< of the camera, at the end; none without images
  bool interrupted = false;

  double real_time_factor() const { return wall_s > 0.0 ? duration_s / wall_s : 0.0; }
  int count(HealthState state) const { return health[static_cast<std::size_t>(state)]; }
  /// Lost at any time, not good at the end, or degraded for more than a tenth of the frames.
  bool was_degraded() const { return !doubts().empty(); }
  /// Which of these it was, in words; empty where none.
  std::string doubts() const;
};

struct RunHooks {
  FrameSink sink;
  std::function<void(double)> progress = [](double) {};  ///< share of the source, 0 to 1
  std::stop_token stop = {};                             ///< ends the run after the frame in hand, as if the data ended
  Thermography* thermography = nullptr;                  ///< sees each frame with an image before the sink does
};

/// Runs to the end of the source. Errors: no start possible, the sink's, or the source's with what came before it
/// delivered. In every case `summary` tells what was done.
Expected<void> run_odometry(EventSource& source, const Rig& rig, const Config& config, const RunHooks& hooks,
                            RunSummary& summary);

}  // namespace pllit
