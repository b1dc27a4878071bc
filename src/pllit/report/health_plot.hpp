// How localisation went, over time, as a drawing inside the page.
#pragma once

#include <span>
#include <string>

namespace pllit {

/// One frame.
struct HealthSample {
  double time_s = 0.0;  ///< since 1970
  std::string state;    ///< as health.csv says it: initialising, good, degraded, lost
  std::string reasons;  ///< likewise; empty when good
  double sigma_m = 0.0, matched = 0.0, speed_mps = 0.0;
};

/// An <svg> in the page's own colours: a strip of states, and under it position sigma, matched points and speed. Where
/// there are more frames than it is wide, the worst of them are drawn. Empty for fewer than two frames.
std::string health_plot(std::span<const HealthSample> frames);

}  // namespace pllit
