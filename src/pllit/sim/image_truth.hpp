// What an image truly shows.
#pragma once

#include <vector>

#include "pllit/sim/camera/image_edges.hpp"
#include "pllit/sim/camera/pixel_truth.hpp"

namespace pllit {

struct TruthWanted {
  bool pixels = false, edges = false;
};

struct ImageTruth {
  Time seen;            ///< true time in the middle of the exposure; for a bolometer, one time constant before readout
  SE3 T_W_C;            ///< then
  bool frozen = false;  ///< the shutter is closed and the image an old one: all of this tells of now
  PixelTruth pixels;    ///< where wanted
  std::vector<ImageEdge> edges;  ///< where wanted; contrast in K for a thermal camera, else as Illumination has it
};

}  // namespace pllit
