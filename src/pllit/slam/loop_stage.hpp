// Loop closing beside the odometry: on a thread of its own, fed with frames, giving nothing back to them.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "pllit/base/distribution.hpp"
#include "pllit/loop/correction.hpp"
#include "pllit/loop/loop_closer.hpp"
#include "pllit/slam/keyframe_maker.hpp"

namespace pllit {

/// What loop closing has come to.
struct LoopResult {
  Correction correction{{}};  ///< changes nothing where no loop was closed
  std::vector<LoopRecord> records{};
  int accepted = 0;
  Distribution frame_ms{};  ///< time on its thread for each frame
  std::string stopped{};    ///< why it ended early, which leaves the odometry as it was; empty if it did not

  /// Whether anything was moved.
  bool closed() const { return accepted > 0 && stopped.empty(); }
};

/// Frames wait in a short queue; where the thread falls behind, take() waits for it. The odometry stays smooth in its
/// own frame, map -> odom is the result's correction. The result does not depend on timing.
class LoopStage {
 public:
  explicit LoopStage(const LoopConfig& config);
  LoopStage(const LoopStage&) = delete;
  LoopStage& operator=(const LoopStage&) = delete;
  /// Gives up what was not finished.
  ~LoopStage();

  void take(const FrameEstimate& frame);
  /// Works off what waits, solves the graph once more and ends.
  LoopResult finish();

 private:
  void work();
  void take_in(const FrameEstimate& frame);
  void close_queue();
  Correction correction() const;

  LoopConfig config_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<FrameEstimate> waiting_;
  bool closed_ = false;
  // The thread's own until it has ended.
  KeyframeMaker maker_;
  LoopCloser closer_;
  Distribution frame_ms_;
  std::string stopped_;
  std::thread thread_;
};

}  // namespace pllit
