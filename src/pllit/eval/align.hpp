// The rigid motion that brings an estimate onto the truth before absolute errors are read.
#pragma once

#include <span>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/eval/associate.hpp"

namespace pllit {

enum class Alignment {
  se3,  ///< rotation and translation: what a start-up without heading, level or position leaves open
  yaw,  ///< heading and translation: for systems that find gravity; a tilt stays visible. z of both worlds points up
  none  ///< as they are
};

/// T_W_V that minimises the squared distances of the positions; never a scale. Umeyama, "Least-squares estimation of
/// transformation parameters between two point patterns", PAMI 1991, equations 34 to 43. Input error where the
/// positions do not determine it: fewer than three, all on one line (yaw: fewer than two, all above each other).
Expected<SE3> alignment_of(std::span<const PosePair> pairs, Alignment alignment);

/// The pairs with the estimate moved to the world of the truth, T_W_V * T_V_I.
std::vector<PosePair> aligned(std::span<const PosePair> pairs, const SE3& T_W_V);

}  // namespace pllit
