// What became of every candidate for a loop.
#pragma once

#include <string>

#include "pllit/loop/registration.hpp"

namespace pllit {

enum class FoundBy { radius, descriptor };

struct LoopRecord {
  int earlier = 0, later = 0;  ///< keyframes
  Time earlier_time{}, later_time{};
  FoundBy found_by = FoundBy::radius;
  double distance_m = 0.0;  ///< between the two, as the graph had it
  double score = 0.0;       ///< of their descriptors
  Registration registration{};
  SE3 T_earlier_later{};                     ///< as registered, of I
  Matrix6 covariance = Matrix6::Identity();  ///< (theta, p) on the right of it
  double squared_against_odometry = 0.0;     ///< whitened difference from what the graph expected
  double against_odometry_m = 0.0;           ///< the same in metres
  int agreeing = 0;                          ///< loops that agree with it, itself counted
  bool accepted = false;
  std::string reason{};  ///< why it was refused, or what it was accepted for
};

}  // namespace pllit
