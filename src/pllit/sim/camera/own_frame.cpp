#include "pllit/sim/camera/own_frame.hpp"

namespace pllit {

Eigen::Matrix3f rotation_to_own(const Actor& actor, double t_s) {
  return actor.pose(t_s).rotation().transpose().cast<float>();
}

Ray mirrored_ray(const Ray& ray, const Hit& hit) {
  const Vector3d normal_W = hit.normal_W.cast<double>();
  const Vector3d direction_W = ray.direction_W - 2.0 * ray.direction_W.dot(normal_W) * normal_W;
  return {ray.origin_W + hit.range_m * ray.direction_W + 0.002 * normal_W, direction_W.normalized()};
}

}  // namespace pllit
