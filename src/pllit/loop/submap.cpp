#include "pllit/loop/submap.hpp"

#include <bit>

#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

SO3 levelled(const Vector3d& up_I) {
  return rotation_from(Eigen::Quaterniond::FromTwoVectors(up_I, Vector3d::UnitZ()));
}

std::vector<Column> columns_of(const std::vector<Vector3f>& points_H) {
  constexpr int slices = 64, least = 3;
  struct Taken {
    std::uint64_t heights = 0;
  };
  VoxelTable<Taken> columns;
  for (const Vector3f& p : points_H) {
    const Eigen::Vector3i voxel = voxel_of(p, 1.0 / kColumn_m);
    const int height = voxel.z() + slices / 2;
    if (height < 0 || height >= slices) continue;
    columns.insert(voxel_key({voxel.x(), voxel.y(), 0})).first->heights |= std::uint64_t{1} << height;
  }
  std::vector<Column> upright;
  columns.for_each([&](VoxelKey key, const Taken& taken) {
    const int height = std::popcount(taken.heights);
    if (height < least) return;
    const Eigen::Vector2f corner = voxel_of_key(key).head<2>().cast<float>();
    upright.push_back({static_cast<float>(kColumn_m) * (corner + Eigen::Vector2f::Constant(0.5F)), height});
  });
  return upright;
}

Submap make_submap(std::span<const LoopKeyframe> keyframes, std::size_t first, std::size_t last, std::size_t anchor,
                   double voxel_m, double range_m) {
  const SE3 T_H_O = pose_from(levelled(keyframes[anchor].up_I), Vector3d::Zero()) * keyframes[anchor].T_O_I.inverse();
  const auto range2 = static_cast<float>(range_m * range_m);
  std::vector<Vector3f> points_H;
  for (std::size_t k = first; k <= last; ++k) {
    const SE3 T_H_I = T_H_O * keyframes[k].T_O_I;
    const Eigen::Matrix3f R = T_H_I.rotation().cast<float>();
    const Vector3f t = T_H_I.translation().cast<float>();
    for (const Vector3f& p_I : keyframes[k].cloud.points()) {
      const Vector3f p_H = R * p_I + t;
      if (p_H.squaredNorm() < range2) points_H.push_back(p_H);
    }
  }
  Submap submap{thinned(points_H, voxel_m), {}};
  submap.columns = columns_of(submap.points_H);
  return submap;
}

}  // namespace pllit
