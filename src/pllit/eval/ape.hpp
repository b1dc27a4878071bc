// Absolute pose error: how far each pose of an aligned estimate is from the truth.
#pragma once

#include <span>
#include <vector>

#include "pllit/eval/associate.hpp"
#include "pllit/eval/statistics.hpp"

namespace pllit {

/// One matched pose, for plots.
struct ErrorSample {
  Time time;
  double distance_m = 0.0;                ///< travelled so far, along the matched truth
  Vector3d error_W_m = Vector3d::Zero();  ///< estimate minus truth
  double yaw_deg = 0.0;                   ///< heading of the estimate minus that of the truth, about W's z
  double rotation_deg = 0.0;              ///< angle of the whole rotation error, never negative
};

/// Translation: length of the position error in metres; rotation: angle of R_truth' R_estimate in degrees. The same as
/// `evo_ape -r trans_part` and `-r angle_deg`.
struct AbsoluteError {
  Statistics translation_m;
  Statistics rotation_deg;
  std::vector<ErrorSample> samples;
};

/// `pairs` come aligned: V is W.
AbsoluteError absolute_error(std::span<const PosePair> pairs);

}  // namespace pllit
