// Whether loops agree with each other: two of them and the odometry between their ends make a cycle that must close.
#pragma once

#include <span>

#include "pllit/loop/loop_record.hpp"
#include "pllit/loop/uncertain_motion.hpp"

namespace pllit {

/// Squared whitened error of the cycle through two loops; 6 degrees of freedom. The odometry's variances count
/// `odometry_factor` times. (Pairwise consistency: Mangelson et al., ICRA 2018.)
double cycle_error(const LoopRecord& a, const LoopRecord& b, const OdometryChain& odometry, double odometry_factor);

/// The largest set found of loops that all agree with each other and with `loops[seed]`, that one first: each in turn
/// joins if it agrees with all that have.
std::vector<std::size_t> agreeing_set(std::span<const LoopRecord> loops, std::size_t seed,
                                      const OdometryChain& odometry, double odometry_factor, double max_squared);

}  // namespace pllit
