#include "pllit/sim/camera/ray_table.hpp"

namespace pllit {

RayTable::RayTable(const Camera& camera)
    : width_(camera.width),
      height_(camera.height),
      stride_(static_cast<std::size_t>(camera.width) + 1),
      pixel_rad_(static_cast<float>(2.0 / (camera.fx + camera.fy))) {
  corners_.reserve(stride_ * (static_cast<std::size_t>(height_) + 1));
  for (int row = 0; row <= height_; ++row)
    for (int column = 0; column <= width_; ++column)
      corners_.push_back(camera.ray({column - 0.5, row - 0.5}).cast<float>());
}

}  // namespace pllit
