// What one image came to, for the health record.
#pragma once

#include <string>

#include "pllit/state/nav_state.hpp"

namespace pllit {

struct ImageFacts {
  bool seen = false;                          ///< there was one
  bool used = false;                          ///< it has refined the state
  std::string refused;                        ///< why it was not looked at, or not believed; empty otherwise
  int points = 0, matches = 0, anchored = 0;  ///< features; with a keyframe's; of these on matched lines
  int lines = 0;                              ///< seen again, of the map
  int candidates = 0, inliers = 0;            ///< residuals
  double misfit = 0.0;      ///< of the residuals that no pose explains, over what their noise lets expect
  double correction = 0.0;  ///< what the images want the pose moved by, likewise, averaged over a few seconds
  bool holds = false;       ///< it knows the pose along what the LiDAR does not observe
  double gain = 1.0, bias_grey = 0.0;     ///< photometric
  Matrix6 information = Matrix6::Zero();  ///< about (theta, p), the keyframes taken as known
};

}  // namespace pllit
