// Samples over the pixels' areas and the time of exposure: what every camera has in common.
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "pllit/base/arena.hpp"
#include "pllit/base/time.hpp"
#include "pllit/sim/camera/ray_table.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// T_W_C at any time, also somewhat before a motion's start.
using CameraPath = std::function<SE3(Time)>;

/// Poses at moments that weigh equally, in order of time.
struct ExposurePoses {
  std::vector<Eigen::Matrix3d> R_W_C;
  std::vector<Eigen::Vector3d> p_W;
};

/// A shutter that is open for `length` around `middle`.
ExposurePoses open_shutter(const CameraPath& path, Time middle, Duration length);
/// A bolometer read at `readout`, whose memory fades exponentially: on average it sees one time constant earlier.
ExposurePoses fading_memory(const CameraPath& path, Time readout, Duration time_constant);

/// Gives the samples of some pixels their values; those of one pixel stand together, as many as the number says.
/// Called from several threads.
using Shade = std::function<void(std::span<const Ray>, std::span<const Hit>, std::size_t samples, std::span<float>)>;

/// How many samples a pixel gets: `first`, and `more` where these differ by more than `spread`, in the unit of Shade,
/// within it or from those of its neighbours, as on edges. Where the camera moves fast, up to twice as many.
struct Sampling {
  int first = 2, more = 8;
  float spread = 0.0F;
};

/// Of a camera that is to be as good as with so many samples in every pixel, and better on edges: a quarter as many
/// where all around is even, one and a half to three times as many besides elsewhere.
inline Sampling sampling_for(int samples, float spread) {
  return {.first = (samples + 3) / 4, .more = 3 * samples / 2, .spread = spread};
}

/// Mean over the samples of each pixel, CV_32FC1. They are spread over the pixel's area and the poses by
/// low-discrepancy sequences that depend on the pixel and on `seed` alone.
cv::Mat expose(const RayTable& table, const RayCaster& caster, const ExposurePoses& poses, const Sampling& sampling,
               std::uint64_t seed, const Shade& shade, Arena& arena);

}  // namespace pllit
