// Which pose of the estimate belongs to which pose of the truth: by time, with interpolation between samples.
#pragma once

#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// The same instant in both trajectories. W is the world of the truth, V that of the estimate, I the body: both files
/// must describe the same body frame, for no alignment takes a lever arm away.
struct PosePair {
  Time time;
  SE3 T_W_I;  ///< truth
  SE3 T_V_I;  ///< estimate
};

enum class AssociationTimes {
  sparser,  ///< at the samples of whichever has fewer in the common time; the denser one is interpolated
  truth     ///< at the truth's samples; the estimate is interpolated
};

struct AssociationConfig {
  AssociationTimes times = AssociationTimes::sparser;
  Duration max_gap{250'000'000};  ///< no interpolation between samples further apart
};

/// Pairs in order of time. Neither trajectory is extrapolated. Input error where no time is common, with both spans.
Expected<std::vector<PosePair>> associate(const Trajectory& truth, const Trajectory& estimate,
                                          const AssociationConfig& config = {});

}  // namespace pllit
