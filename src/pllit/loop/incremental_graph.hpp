// The pose graph while it grows: each step costs what it changes.
#pragma once

#include <memory>
#include <vector>

#include "pllit/loop/pose_graph.hpp"

namespace pllit {

/// iSAM2 (Kaess et al., "iSAM2: Incremental Smoothing and Mapping Using the Bayes Tree", IJRR 2012) with a Cauchy loss
/// on loops, one thread. Measurements are taken at the next update().
class PLLIT_GRAPH_API IncrementalGraph {
 public:
  /// Pose 0, as in PoseGraph.
  IncrementalGraph(const SE3& T_M_I, double tilt_sigma_rad);
  IncrementalGraph(IncrementalGraph&&) noexcept;
  IncrementalGraph& operator=(IncrementalGraph&&) noexcept;
  ~IncrementalGraph();

  /// Adds pose `step.to`, the next one, guessed from the latest solution for `step.from`.
  void add_step(const RelativePose& step);
  void add_loop(const RelativePose& loop);
  void add_vertical(const Upright& vertical);
  /// Solves; `more` times again for loops that move much.
  void update(int more = 0);

  /// All poses that an update has seen, in M.
  std::vector<SE3> poses_M() const;
  /// The latest of them.
  SE3 last_pose_M() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace pllit
