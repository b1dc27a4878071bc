// Gathers frames into keyframes for loop closing.
#pragma once

#include <optional>
#include <vector>

#include "pllit/loop/keyframe.hpp"
#include "pllit/loop/loop_config.hpp"
#include "pllit/slam/odometry.hpp"

namespace pllit {

class KeyframeMaker {
 public:
  explicit KeyframeMaker(const LoopKeyframeConfig& config) : config_(config) {}

  /// Takes the next frame; gives a keyframe where the way since the last one is long enough, the first frame's at once.
  /// Scans that did not match are left out.
  std::optional<LoopKeyframe> take(const FrameEstimate& frame);

 private:
  void gather(const FrameEstimate& frame);
  LoopKeyframe made_at(const FrameEstimate& frame) const;

  LoopKeyframeConfig config_;
  std::optional<FrameEstimate> last_;  ///< keyframe's, without its cloud
  std::optional<SE3> last_gathered_W_I_;
  std::vector<Vector3f> points_last_;  ///< seen since, in the last keyframe's I
  Vector3d last_p_W_ = Vector3d::Zero();
  double way_m_ = 0.0;
};

}  // namespace pllit
