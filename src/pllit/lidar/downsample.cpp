#include "pllit/lidar/downsample.hpp"

namespace pllit {
namespace {

struct Taken {};

}  // namespace

PointCloud downsample(const PointCloud& cloud, double voxel_m) {
  VoxelTable<Taken> taken;
  PointCloud kept{.reference = cloud.reference, .points_I = {}, .intensity = {}};
  for (std::size_t i = 0; i < cloud.points_I.size(); ++i) {
    if (!taken.insert(voxel_key(voxel_of(cloud.points_I[i], 1.0 / voxel_m))).second) continue;
    kept.points_I.push_back(cloud.points_I[i]);
    kept.intensity.push_back(cloud.intensity[i]);
  }
  return kept;
}

PointCloud thin(PointCloud cloud, std::size_t count) {
  const std::size_t size = cloud.points_I.size();
  if (size <= count) return cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points_I[i] = cloud.points_I[i * size / count];
    cloud.intensity[i] = cloud.intensity[i * size / count];
  }
  cloud.points_I.resize(count);
  cloud.intensity.resize(count);
  return cloud;
}

std::vector<std::size_t> FreshVoxels::select(const std::vector<Vector3f>& points_W, const Vector3d& centre_W) {
  if ((centre_W - last_centre_W_).norm() > 0.2 * radius_m_) {
    seen_.retain([&](VoxelKey key, const Seen&) {
      const Vector3d p = voxel_m_ * voxel_of_key(key).cast<double>();
      return (p - centre_W).cwiseAbs().maxCoeff() < radius_m_;
    });
    last_centre_W_ = centre_W;
  }
  std::vector<std::size_t> fresh;
  for (std::size_t i = 0; i < points_W.size(); ++i)
    if (seen_.insert(voxel_key(voxel_of(points_W[i], 1.0 / voxel_m_))).second) fresh.push_back(i);
  return fresh;
}

}  // namespace pllit
