// How far known surfaces hold an image's curve.
#pragma once

#include <span>
#include <vector>

#include "pllit/map/anchor.hpp"

namespace pllit {

/// Notes between which intensities surfaces that are known without doubt hold the curve, but for a few at each end:
/// around those that most pairs agree on, up to where most contradict it. `residuals` of the pairs, in their order.
void note_support(std::span<const AnchorPair> pairs, const std::vector<double>& residuals, const AnchorConfig& config,
                  AnchorCurve& curve);

}  // namespace pllit
