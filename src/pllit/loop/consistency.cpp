#include "pllit/loop/consistency.hpp"

#include <algorithm>
#include <numeric>

namespace pllit {

double cycle_error(const LoopRecord& a, const LoopRecord& b, const OdometryChain& odometry, double odometry_factor) {
  const auto odometry_between = [&](int from, int to) {
    UncertainMotion motion = odometry.between(from, to);
    motion.covariance *= odometry_factor;
    return motion;
  };
  const UncertainMotion along_b = odometry_between(a.earlier, b.earlier) *
                                  UncertainMotion{b.T_earlier_later, b.covariance} * odometry_between(b.later, a.later);
  return squared_difference({a.T_earlier_later, a.covariance}, along_b);
}

std::vector<std::size_t> agreeing_set(std::span<const LoopRecord> loops, std::size_t seed,
                                      const OdometryChain& odometry, double odometry_factor, double max_squared) {
  // The nearest in time first: there the odometry between two loops is surest.
  std::vector<std::size_t> order(loops.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return std::abs(loops[k].later - loops[seed].later); });
  std::vector<std::size_t> agreeing{seed};
  for (const std::size_t k : order) {
    if (k == seed) continue;
    const auto agrees = [&](std::size_t other) {
      return cycle_error(loops[other], loops[k], odometry, odometry_factor) <= max_squared;
    };
    if (std::ranges::all_of(agreeing, agrees)) agreeing.push_back(k);
  }
  return agreeing;
}

}  // namespace pllit
