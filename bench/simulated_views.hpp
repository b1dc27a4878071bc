// A thermal camera carried through a simulated place, with what is exactly known about its images: for benchmarks of
// the image front end.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pllit/base/arena.hpp"
#include "pllit/base/error.hpp"
#include "pllit/sim/camera/thermal_camera.hpp"
#include "pllit/sim/motion/motion.hpp"

namespace pllit::bench {

struct View {
  Time time;       ///< of readout
  SE3 T_W_C;       ///< where the scene was seen from
  cv::Mat counts;  ///< CV_16UC1
};

class SimulatedViews {
 public:
  /// address: of a scene with a thermal rig, as in sim:street?length=300. Its rig is as its data sheet says.
  static Expected<SimulatedViews> make(const std::string& address);

  /// `count` images from begin_s on, at 10 Hz. With a folder images are read from there, or rendered and kept there.
  std::vector<View> views(double begin_s, int count, const std::string& folder);

  const Camera& camera() const { return model_.camera; }

  /// The surface that shows at a pixel, the nearest one within 1.2 px: corners belong to what stands in front.
  std::optional<Vector3d> surface_W(const View& view, const Eigen::Vector2f& at_px);
  /// Where a point of a surface shows in another image; nothing where it is hidden or outside.
  std::optional<Eigen::Vector2f> pixel_of(const Vector3d& p_W, const View& view);

 private:
  SimulatedViews(std::string address, ThermalCameraModel model, SE3 T_I_C, Motion motion, std::unique_ptr<Place> place);
  SE3 pose(Time time) const { return motion_.at(time).T_W_I * T_I_C_; }
  void look_from(const View& view);

  std::string address_;
  ThermalCameraModel model_;
  SE3 T_I_C_;
  Motion motion_;
  std::unique_ptr<Place> place_;
  std::unique_ptr<RayCaster> caster_;
  std::optional<Time> looking_at_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace pllit::bench
