// A trajectory against the truth: associate, align, score.
#pragma once

#include <vector>

#include "pllit/eval/align.hpp"
#include "pllit/eval/ape.hpp"
#include "pllit/eval/associate.hpp"
#include "pllit/eval/rpe.hpp"

namespace pllit {

struct EvaluationConfig {
  AssociationConfig association = {};
  Alignment alignment = Alignment::se3;
  std::vector<double> rpe_deltas_m = {10.0, 100.0};  ///< positive
};

struct Scores {
  std::size_t matched = 0;  ///< pairs of poses
  double length_m = 0.0;    ///< of the path along the matched truth
  Alignment alignment = Alignment::se3;
  SE3 T_W_V = SE3::Identity();  ///< world of the estimate to world of the truth
  AbsoluteError ape;
  std::vector<RelativeError> rpe;  ///< one for each delta
};

/// Input error where no time is common, the alignment is not determined, or a delta is not a positive length.
Expected<Scores> evaluate(const Trajectory& truth, const Trajectory& estimate, const EvaluationConfig& config = {});

}  // namespace pllit
