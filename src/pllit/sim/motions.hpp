// The motion that a simulation is about.
#pragma once

#include <optional>

#include "pllit/sim/motion/fit.hpp"
#include "pllit/sim/rigs.hpp"

namespace pllit {

struct ChosenMotion {
  Motion motion;                        ///< of I, with a soft start
  std::optional<FitDistance> distance;  ///< to the path that it was fitted to
};

/// Along `path` (of I; what config.motion names) or, without one, made to suit the scene; with vibration unless ideal.
/// It starts at one date for all. Input errors: the path cannot be fitted.
Expected<ChosenMotion> choose_motion(const SimConfig& config, const SimRig& rig, const std::optional<Trajectory>& path);

}  // namespace pllit
