#include "pllit/eval/ape.hpp"

#include "pllit/eval/rotation_error.hpp"

namespace pllit {

AbsoluteError absolute_error(std::span<const PosePair> pairs) {
  AbsoluteError error;
  std::vector<double> translation_m, rotation_deg;
  double distance_m = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const SE3 &truth = pairs[i].T_W_I, &estimate = pairs[i].T_V_I;
    if (i > 0) distance_m += (truth.translation() - pairs[i - 1].T_W_I.translation()).norm();
    const Vector3d error_W_m = estimate.translation() - truth.translation();
    const SO3 turn_W = estimate.asSO3() * truth.asSO3().inverse();
    error.samples.push_back({pairs[i].time, distance_m, error_W_m, yaw_deg(turn_W), angle_deg(turn_W)});
    translation_m.push_back(error_W_m.norm());
    rotation_deg.push_back(error.samples.back().rotation_deg);
  }
  error.translation_m = statistics_of(translation_m);
  error.rotation_deg = statistics_of(rotation_deg);
  return error;
}

}  // namespace pllit
