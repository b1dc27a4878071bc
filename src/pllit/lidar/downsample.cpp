#include "pllit/lidar/downsample.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace pllit {
namespace {

/// Kept points of a voxel of twice the spacing; on surfaces there are at most about seven.
struct Kept {
  std::array<Vector3f, 8> points;
  std::size_t count = 0;

  bool full_or_near(const Vector3f& p, float spacing2_m2) const {
    return count == points.size() ||
           std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const Vector3f& q) { return (p - q).squaredNorm() < spacing2_m2; });
  }
};

/// Each number below 2^bits once, in an order without a direction: odd multiplications and shifts can be undone, so
/// none is lost.
std::size_t scattered(std::size_t i, int bits) {
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  const int half = (bits + 1) / 2;
  std::uint64_t x = i;
  for (int round = 0; round < 2; ++round) {
    x = (x * 0x9e3779b97f4a7c15 + 0x7f4a7c15) & mask;
    x ^= x >> half;
  }
  return x;
}

}  // namespace

PointCloud downsample(const PointCloud& cloud, double spacing_m) {
  VoxelTable<Kept> table;
  PointCloud kept{.reference = cloud.reference, .points_I = {}, .intensity = {}};
  const double inverse_m = 0.5 / spacing_m;
  const auto spacing2_m2 = static_cast<float>(spacing_m * spacing_m);
  const std::size_t count = cloud.points_I.size();
  const int bits = std::bit_width(count);
  for (std::size_t visit = 0; visit < std::size_t{1} << bits; ++visit) {
    const std::size_t i = scattered(visit, bits);
    if (i >= count) continue;
    const Vector3f& p = cloud.points_I[i];
    const Eigen::Vector3i voxel = voxel_of(p, inverse_m);
    const Kept* own = table.find(voxel_key(voxel));
    if (own && own->full_or_near(p, spacing2_m2)) continue;
    // Points nearer than the spacing lie in this voxel or in those on the side of its centre where the point is.
    Eigen::Vector3i side;
    for (int k = 0; k < 3; ++k) side[k] = static_cast<double>(p[k]) * inverse_m - voxel[k] < 0.5 ? -1 : 1;
    bool near = false;
    for (int n = 1; n < 8 && !near; ++n) {
      const Eigen::Vector3i step(n & 1 ? side.x() : 0, n & 2 ? side.y() : 0, n & 4 ? side.z() : 0);
      const Kept* neighbour = table.find(voxel_key(voxel + step));
      near = neighbour && neighbour->count < neighbour->points.size() && neighbour->full_or_near(p, spacing2_m2);
    }
    if (near) continue;
    Kept& cell = *table.insert(voxel_key(voxel)).first;
    cell.points[cell.count++] = p;
    kept.points_I.push_back(p);
    kept.intensity.push_back(cloud.intensity[i]);
  }
  return kept;
}

PointCloud downsample(const PointCloud& cloud, double spacing_m, std::size_t least) {
  constexpr double kStep = 0.7;
  PointCloud kept = downsample(cloud, spacing_m);
  for (int i = 0; i < 4 && kept.points_I.size() < std::min(least, cloud.points_I.size()); ++i)
    kept = downsample(cloud, spacing_m *= kStep);
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
