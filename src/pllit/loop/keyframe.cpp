#include "pllit/loop/keyframe.hpp"

#include <cmath>

#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

CompactCloud::CompactCloud(const std::vector<Vector3f>& points) {
  centimetres_.reserve(points.size());
  for (const Vector3f& p : points) {
    if (!(p.cwiseAbs().maxCoeff() < 327.0F)) continue;
    const auto rounded = [](float metres) { return static_cast<std::int16_t>(std::lround(100.0F * metres)); };
    centimetres_.push_back({rounded(p.x()), rounded(p.y()), rounded(p.z())});
  }
}

std::vector<Vector3f> CompactCloud::points() const {
  std::vector<Vector3f> points;
  points.reserve(centimetres_.size());
  for (const auto& [x, y, z] : centimetres_) points.push_back(0.01F * Vector3f(x, y, z));
  return points;
}

std::vector<Vector3f> thinned(const std::vector<Vector3f>& points, double voxel_m) {
  struct Sum {
    Vector3f total = Vector3f::Zero();
    float count = 0.0F;
  };
  VoxelTable<Sum> sums;
  for (const Vector3f& p : points) {
    Sum& sum = *sums.insert(voxel_key(voxel_of(p, 1.0 / voxel_m))).first;
    sum.total += p;
    sum.count += 1.0F;
  }
  std::vector<Vector3f> kept;
  kept.reserve(sums.size());
  sums.for_each([&](VoxelKey, const Sum& sum) { kept.push_back(sum.total / sum.count); });
  return kept;
}

}  // namespace pllit
