#include "pllit/eval/evaluate.hpp"

#include <cmath>
#include <format>

namespace pllit {

Expected<Scores> evaluate(const Trajectory& truth, const Trajectory& estimate, const EvaluationConfig& config) {
  for (const double delta_m : config.rpe_deltas_m)
    if (!std::isfinite(delta_m) || delta_m <= 0.0)
      return input_error(std::format("relative error over {} m: the distance must be positive", delta_m));
  const auto pairs = associate(truth, estimate, config.association);
  if (!pairs) return std::unexpected(pairs.error());
  const auto T_W_V = alignment_of(*pairs, config.alignment);
  if (!T_W_V) return std::unexpected(T_W_V.error());

  Scores scores;
  scores.matched = pairs->size();
  scores.alignment = config.alignment;
  scores.T_W_V = *T_W_V;
  scores.ape = absolute_error(aligned(*pairs, *T_W_V));
  scores.length_m = scores.ape.samples.back().distance_m;
  for (const double delta_m : config.rpe_deltas_m) scores.rpe.push_back(relative_error(*pairs, delta_m));
  return scores;
}

}  // namespace pllit
