// Vectors and poses as every JSON file of the project writes them.
#pragma once

#include <nlohmann/json.hpp>

#include "pllit/geometry/lie.hpp"

namespace pllit {

inline nlohmann::ordered_json vector_json(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

inline nlohmann::ordered_json pose_json(const SE3& pose) {
  const Eigen::Quaterniond q = pose.quat();
  return {{"translation_m", vector_json(pose.translation())}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace pllit
