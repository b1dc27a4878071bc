#include "pllit/loop/incremental_graph.hpp"

#include <gtsam/nonlinear/ISAM2.h>

#include <cassert>

#include "pllit/loop/gtsam_factors.hpp"

namespace pllit {

struct IncrementalGraph::Parts {
  gtsam::ISAM2 solver;
  gtsam::NonlinearFactorGraph new_factors;
  gtsam::Values new_values;
  gtsam::Pose3 T_M_last;  // guess or solution of the latest pose
  int poses = 1;
};

namespace {

gtsam::ISAM2Params parameters() {
  gtsam::ISAM2Params parameters;
  parameters.relinearizeThreshold = 0.01;  // rad, m
  parameters.relinearizeSkip = 1;
  return parameters;
}

}  // namespace

IncrementalGraph::IncrementalGraph(const SE3& T_M_I, double tilt_sigma_rad)
    : parts_(std::make_unique<Parts>(Parts{.solver = gtsam::ISAM2(parameters()),
                                           .new_factors = {},
                                           .new_values = {},
                                           .T_M_last = to_gtsam(T_M_I),
                                           .poses = 1})) {
  parts_->new_factors.add(first_factor(T_M_I, tilt_sigma_rad));
  parts_->new_values.insert(key_of(0), parts_->T_M_last);
}

IncrementalGraph::IncrementalGraph(IncrementalGraph&&) noexcept = default;
IncrementalGraph& IncrementalGraph::operator=(IncrementalGraph&&) noexcept = default;
IncrementalGraph::~IncrementalGraph() = default;

void IncrementalGraph::add_step(const RelativePose& step) {
  assert(step.from == parts_->poses - 1 && step.to == parts_->poses);
  parts_->T_M_last = parts_->T_M_last * to_gtsam(step.T_from_to);
  parts_->new_values.insert(key_of(step.to), parts_->T_M_last);
  parts_->new_factors.add(between_factor(step, noise_of(step)));
  ++parts_->poses;
}

void IncrementalGraph::add_loop(const RelativePose& loop) {
  const auto cauchy = gtsam::noiseModel::mEstimator::Cauchy::Create(3.0);  // in standard deviations
  parts_->new_factors.add(between_factor(loop, gtsam::noiseModel::Robust::Create(cauchy, noise_of(loop))));
}

void IncrementalGraph::add_vertical(const Upright& vertical) { parts_->new_factors.add(vertical_factor(vertical)); }

void IncrementalGraph::update(int more) {
  on_one_thread([&] {
    parts_->solver.update(parts_->new_factors, parts_->new_values);
    for (int i = 0; i < more; ++i) parts_->solver.update();
  });
  parts_->new_factors.resize(0);
  parts_->new_values.clear();
  parts_->T_M_last = parts_->solver.calculateEstimate<gtsam::Pose3>(key_of(parts_->poses - 1));
}

std::vector<SE3> IncrementalGraph::poses_M() const {
  const gtsam::Values values = on_one_thread([&] { return parts_->solver.calculateEstimate(); });
  std::vector<SE3> poses_M;
  for (std::size_t i = 0; i < values.size(); ++i) poses_M.push_back(from_gtsam(values.at<gtsam::Pose3>(i)));
  return poses_M;
}

SE3 IncrementalGraph::last_pose_M() const { return from_gtsam(parts_->T_M_last); }

}  // namespace pllit
