#include "pllit/sim/places/site.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kCell_m = 2.0;
constexpr double kSpacing_m = 0.1;
constexpr double kLeastHeight_m = 0.06;  // rigs are put down on the ground

std::int64_t key_of(std::int64_t x, std::int64_t y) { return x * 0x100000 + y; }
std::int64_t cell_of(double v) { return static_cast<std::int64_t>(std::floor(v / kCell_m)); }

Site site(const PlaceConfig& config, double yaw_rad, double ground_z) {
  const SO3 R_W_P = exp_so3({0.0, 0.0, yaw_rad});
  const SE3 T_P_turned = pose_from(R_W_P.inverse(), Vector3d::Zero());
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : config.path_W) box.extend(T_P_turned.act(p));
  Vector3d origin = box.center();
  origin.z() = ground_z;
  const SE3 T_W_P = pose_from(R_W_P, R_W_P.act(origin));
  const SE3 T_P_W = T_W_P.inverse();
  std::vector<Vector3d> path_P;
  for (const Vector3d& p : config.path_W) path_P.push_back(T_P_W.act(p));
  box.translate(-origin);
  return {T_W_P, PathIndex(densified(path_P, kSpacing_m)), box, config.clearance_m, config.height_m};
}

}  // namespace

PathIndex::PathIndex(std::vector<Vector3d> points) : points_(std::move(points)) {
  for (std::uint32_t i = 0; i < points_.size(); ++i)
    cells_[key_of(cell_of(points_[i].x()), cell_of(points_[i].y()))].push_back(i);
}

PathIndex::Nearest PathIndex::nearest(const Vector2d& p, double reach_m) const {
  Nearest best{reach_m, 0};
  const std::int64_t x = cell_of(p.x()), y = cell_of(p.y()),
                     rings = static_cast<std::int64_t>(std::ceil(reach_m / kCell_m));
  for (std::int64_t ring = 0; ring <= rings; ++ring) {
    if (static_cast<double>(ring - 1) * kCell_m > best.distance_m) break;
    for (std::int64_t i = -ring; i <= ring; ++i)
      for (std::int64_t j = -ring; j <= ring; j += std::abs(i) == ring || ring == 0 ? 1 : 2 * ring) {
        const auto cell = cells_.find(key_of(x + i, y + j));
        if (cell == cells_.end()) continue;
        for (const std::uint32_t k : cell->second) {
          const double distance_m = (points_[k].head<2>() - p).norm();
          if (distance_m < best.distance_m || (distance_m == best.distance_m && k < best.point)) best = {distance_m, k};
        }
      }
  }
  return best;
}

bool PathIndex::meets(const Mesh& mesh, const Vector3d& offset, double clearance_m) const {
  Eigen::AlignedBox3d box;
  for (const Vector3f& v : mesh.vertices) box.extend(v.cast<double>() + offset);
  if (box.isEmpty()) return false;
  std::vector<std::uint32_t> close;
  for (std::int64_t x = cell_of(box.min().x() - clearance_m); x <= cell_of(box.max().x() + clearance_m); ++x)
    for (std::int64_t y = cell_of(box.min().y() - clearance_m); y <= cell_of(box.max().y() + clearance_m); ++y)
      if (const auto cell = cells_.find(key_of(x, y)); cell != cells_.end())
        for (const std::uint32_t k : cell->second)
          if (box.exteriorDistance(points_[k]) < clearance_m) close.push_back(k);
  if (close.empty()) return false;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vector3d, 3> corner;
    Eigen::AlignedBox3d around;
    for (std::size_t i = 0; i < 3; ++i) around.extend(corner[i] = mesh.vertices[triangle[i]].cast<double>() + offset);
    for (const std::uint32_t k : close)
      if (around.exteriorDistance(points_[k]) < clearance_m &&
          distance_to_triangle(points_[k], corner[0], corner[1], corner[2]) < clearance_m)
        return true;
  }
  return false;
}

Site site_on_flat_ground(const PlaceConfig& config, double yaw_rad) {
  // Over the way, not over time: while the rig stands on the ground it makes no way.
  std::vector<double> heights;
  Vector3d last = config.path_W.front();
  for (const Vector3d& p : densified(config.path_W, kSpacing_m)) {
    if (!heights.empty() && (p - last).head<2>().norm() < 0.5 * kSpacing_m) continue;
    heights.push_back((last = p).z());
  }
  std::ranges::sort(heights);
  const double median = heights[heights.size() / 2];
  const auto lower = [](const Vector3d& a, const Vector3d& b) { return a.z() < b.z(); };
  const double lowest = std::ranges::min_element(config.path_W, lower)->z();
  return site(config, yaw_rad, std::min(median - config.height_m, lowest - kLeastHeight_m));
}

Site site_on_slopes(const PlaceConfig& config, double yaw_rad) {
  const auto lower = [](const Vector3d& a, const Vector3d& b) { return a.z() < b.z(); };
  return site(config, yaw_rad, std::ranges::min_element(config.path_W, lower)->z() - config.height_m);
}

double main_yaw_rad(std::span<const Vector3d> path_W) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector3d& p : path_W) mean += p.head<2>() / static_cast<double>(path_W.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vector3d& p : path_W) spread += (p.head<2>() - mean) * (p.head<2>() - mean).transpose();
  return 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
}

std::vector<Vector3d> densified(std::span<const Vector3d> path, double spacing_m) {
  std::vector<Vector3d> dense{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector3d step = path[i] - path[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(step.norm() / spacing_m)));
    for (int k = 1; k <= pieces; ++k) dense.push_back(path[i - 1] + step * (static_cast<double>(k) / pieces));
  }
  return dense;
}

// The closest feature is the face if p projects into it, otherwise one of the edges.
double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const auto inside = [&](const Vector3d& from, const Vector3d& to) {
    return normal.cross(to - from).dot(p - from) >= 0.0;
  };
  if (normal.squaredNorm() > 1e-20 && inside(a, b) && inside(b, c) && inside(c, a))
    return std::abs(normal.normalized().dot(p - a));
  const auto to_edge = [&](const Vector3d& from, const Vector3d& to) {
    const Vector3d edge = to - from;
    const double share = edge.squaredNorm() > 0.0 ? std::clamp(edge.dot(p - from) / edge.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - from - share * edge).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace pllit
