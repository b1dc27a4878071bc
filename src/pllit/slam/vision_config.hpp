// What a user may set of the camera's part.
#pragma once

#include <string>
#include <string_view>

#include "pllit/map/line_map.hpp"
#include "pllit/thermal/classical_extractor.hpp"
#include "pllit/thermal/depth.hpp"
#include "pllit/thermal/grey_input.hpp"
#include "pllit/thermal/image_check.hpp"
#include "pllit/thermal/keyframe_window.hpp"
#include "pllit/thermal/matching.hpp"
#include "pllit/thermal/photometric_chain.hpp"
#include "pllit/thermal/visual_residuals.hpp"

namespace pllit {

/// The extractor without a network, as features.model.
inline constexpr std::string_view kClassical = "classical";

struct VisionConfig {
  bool enabled = true;                                     ///< where the rig has a camera and the recording images
  bool photometric = true;                                 ///< calibrate the greys of 8-bit images
  std::string model{kClassical};                           ///< or the file of a network
  std::string provider = "cpu";                            ///< that runs it
  int threads = 2;                                         ///< for it
  Duration image_spacing = std::chrono::milliseconds(70);  ///< images that follow sooner are left out
  Duration line_spacing = std::chrono::milliseconds(250);  ///< between sightings of lines, which need depths
  double T_I_C_turn_deg = 0.3;         ///< how well the camera's attitude on the rig is known, one sigma; it is refined
  double T_I_C_shift_m = 0.01;         ///< and its place
  double delay_sigma_s = 0.004;        ///< and how well the camera's delay is; 0 takes it as known
  double depth_stretch_sigma = 0.004;  ///< and how well LiDAR ranges are, as a share
  double depth_window_s = 1.0;         ///< LiDAR points that give depth are at most so old
  double most_misfit = 4.0;  ///< of the residuals over what is expected of them: above, an image is not believed
  int least_inliers = 12;    ///< fewer residuals that fit tell too little
  ClassicalConfig classical;
  ImageCheckConfig check;
  GreyInputConfig grey;
  ChainConfig chain;
  MatchConfig matching;
  KeyframeConfig keyframes;
  DepthConfig depth;
  LineMapConfig lines;
  VisualConfig residuals;
};

}  // namespace pllit
