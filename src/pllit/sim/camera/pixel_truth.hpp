// What is truly there at each pixel.
#pragma once

#include "pllit/sim/camera/expose.hpp"
#include "pllit/sim/camera/heat.hpp"

namespace pllit {

/// Along the rays through the centres of the pixels.
struct PixelTruth {
  cv::Mat range_m;        ///< CV_32FC1, along the ray; 0 where there is nothing
  cv::Mat depth_m;        ///< CV_32FC1, along the optical axis; 0 where there is nothing
  cv::Mat temperature_K;  ///< CV_32FC1, kinetic; the sky's apparent one where there is nothing
};

/// For a camera at one pose: T_W_C in the middle of the exposure (for a bolometer, one time constant before readout).
PixelTruth pixel_truth(const RayTable& table, const RayCaster& caster, const Heat& heat, const SE3& T_W_C,
                       Arena& arena);

}  // namespace pllit
