// Finds where the way comes back to an earlier place, makes sure, and bends the trajectory accordingly.
#pragma once

#include <optional>
#include <vector>

#include "pllit/loop/consistency.hpp"
#include "pllit/loop/descriptor.hpp"
#include "pllit/loop/incremental_graph.hpp"

namespace pllit {

/// Keyframes in, corrected poses out. Uses no threads; the same keyframes give the same result to the bit.
class LoopCloser {
 public:
  explicit LoopCloser(const LoopConfig& config) : config_(config) {}

  /// Takes the next keyframe and looks for loops as far as submaps are complete.
  void add(LoopKeyframe keyframe);
  /// No more keyframes come: looks at the last places, and solves the whole graph once more, leaving out loops that do
  /// not agree with the rest.
  void finish();

  const std::vector<LoopKeyframe>& keyframes() const { return keyframes_; }
  /// Of the keyframes, in the frame M of the corrected map; the odometry's own while no loop is closed.
  const std::vector<SE3>& poses_M() const { return poses_M_; }
  /// All candidates so far, those still waiting for others to agree included.
  const std::vector<LoopRecord>& records() const { return records_; }
  int accepted() const;
  /// By how much the odometry's variances had to be raised for its drift to be as the loops show it.
  double odometry_factor() const { return odometry_factor_; }
  std::size_t bytes() const;

 private:
  struct Anchor {
    int keyframe = 0;
    PlaceDescriptor descriptor;
  };
  struct Candidate {
    std::size_t anchor = 0;
    FoundBy found_by = FoundBy::radius;
    double distance_m = 0.0;
    HeadingMatch alignment{};
  };

  void add_to_graph(std::size_t k);
  void look_from(std::size_t keyframe);
  Submap submap_around(std::size_t keyframe) const;
  std::vector<Candidate> candidates(const Anchor& here) const;
  LoopRecord tried(const Anchor& here, const Submap& submap, const Candidate& candidate) const;
  SearchWindow window_for(const Anchor& here, const Candidate& candidate) const;
  std::string refusal(const LoopRecord& record) const;
  void count_agreement();
  bool accept(std::size_t seed, std::span<const std::size_t> window);
  void follow_drift(const std::vector<std::size_t>& agreeing);
  double vertical_sigma_rad(std::size_t k) const;
  void rebuild_graph();
  PoseGraph whole_graph() const;
  UncertainMotion expected(int earlier, int later) const;
  double way_between(int earlier, int later) const;
  double plausible_m(int earlier, int later) const;

  LoopConfig config_;
  std::vector<LoopKeyframe> keyframes_;
  OdometryChain odometry_;
  std::optional<IncrementalGraph> graph_;
  std::vector<SE3> poses_M_;
  std::vector<Anchor> anchors_;
  std::vector<LoopRecord> records_;
  std::optional<std::size_t> last_loop_;  // index into records_
  double next_anchor_m_ = 0.0;
  double odometry_factor_ = 1.0;
};

}  // namespace pllit
