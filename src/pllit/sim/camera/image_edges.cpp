#include "pllit/sim/camera/image_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pllit/sim/camera/edge_lines.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kAside_px = 1.5;       // where to look beside an edge
constexpr double kStep_px = 2.0;        // between the places where it is looked at
constexpr double kLeastRun_px = 4.0;    // shorter pieces are not even joined to others
constexpr std::size_t kLongestGap = 2;  // places in a row where an edge may be lost
constexpr float kBend = 0.94F;          // cosine of 20 degrees

struct Line {
  Vector3d from_W, to_W;
};

/// How far the rays of a camera spread: |x| and |y| against z.
Vector2d spread_of(const Camera& camera) {
  Vector2d spread = Vector2d::Zero();
  for (const double u : {-0.5, 0.5 * camera.width, camera.width - 0.5})
    for (const double v : {-0.5, 0.5 * camera.height, camera.height - 0.5}) {
      const Vector3d ray = camera.ray({u, v});
      spread = spread.cwiseMax(ray.head<2>().cwiseAbs() / std::max(ray.z(), 0.05));
    }
  return 1.02 * spread;
}

/// The part of a segment within the pyramid that the camera sees, from 5 cm on.
std::optional<std::array<Vector3d, 2>> clipped(const Vector3d& a_C, const Vector3d& b_C, const Vector2d& spread) {
  double from = 0.0, to = 1.0;
  const auto keep_above_zero = [&](double at_a, double at_b) {
    if (at_a < 0.0 && at_b < 0.0) to = -1.0;
    const double zero = at_a / (at_a - at_b);
    if (at_a < 0.0 && at_b >= 0.0) from = std::max(from, zero);
    if (at_a >= 0.0 && at_b < 0.0) to = std::min(to, zero);
  };
  keep_above_zero(a_C.z() - 0.05, b_C.z() - 0.05);
  for (const int axis : {0, 1})
    for (const double sign : {-1.0, 1.0})
      keep_above_zero(spread[axis] * a_C.z() + sign * a_C[axis], spread[axis] * b_C.z() + sign * b_C[axis]);
  if (from >= to) return std::nullopt;
  return std::array<Vector3d, 2>{a_C + from * (b_C - a_C), a_C + to * (b_C - a_C)};
}

/// A place on an edge and in the image.
struct Spot {
  Vector3d p_W;
  Vector2d px;
};

/// Spots evenly along the image of a segment, as a pinhole camera has it; none outside the image.
std::vector<Spot> spots_along(const std::array<Vector3d, 2>& ends_C, const PlaceEdges::View& view) {
  const Camera& camera = view.camera;
  const double long_px = camera.fx * (ends_C[1].head<2>() / ends_C[1].z() - ends_C[0].head<2>() / ends_C[0].z()).norm();
  const int steps = std::clamp(static_cast<int>(std::ceil(long_px / kStep_px)), 2, 4000);
  std::vector<Spot> spots;
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    const double t = s * ends_C[0].z() / ((1.0 - s) * ends_C[1].z() + s * ends_C[0].z());
    const Vector3d p_C = ends_C[0] + t * (ends_C[1] - ends_C[0]);
    const auto px = camera.project(p_C);
    if (!px || px->minCoeff() < 0.0 || px->x() > camera.width - 1.0 || px->y() > camera.height - 1.0) continue;
    spots.push_back({view.T_W_C.act(p_C), *px});
  }
  return spots;
}

/// Rays to either side of each spot, first and second in turn.
std::vector<Ray> rays_beside(const std::vector<Spot>& spots, const PlaceEdges::View& view) {
  const Matrix3d R_W_C = view.T_W_C.rotation();
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const Vector2d along = spots[std::min(i + 1, spots.size() - 1)].px - spots[i == 0 ? 0 : i - 1].px;
    const Vector2d aside = kAside_px * Vector2d(-along.y(), along.x()).normalized();
    for (const double sign : {-1.0, 1.0})
      rays.push_back({view.T_W_C.translation(), R_W_C * view.camera.ray(spots[i].px + sign * aside)});
  }
  return rays;
}

bool lies_in(const Vector3d& p_W, const Ray& ray, const Hit& hit) {
  if (!hit) return false;
  const Vector3d hit_W = ray.origin_W + hit.range_m * ray.direction_W;
  const double tolerance_m = 0.004 + 0.0015 * static_cast<double>(hit.range_m);
  return std::abs(hit.normal_W.cast<double>().dot(p_W - hit_W)) < tolerance_m;
}

std::optional<ImageEdge::Kind> seen_as(const Vector3d& p_W, std::span<const Ray, 2> rays,
                                       std::span<const Hit, 2> hits) {
  const std::array in{lies_in(p_W, rays[0], hits[0]), lies_in(p_W, rays[1], hits[1])};
  if (in[0] && in[1]) {
    if (hits[0].normal_W.dot(hits[1].normal_W) < kBend) return ImageEdge::Kind::crease;
    const bool same = hits[0].surface == hits[1].surface && hits[0].warmer_K == hits[1].warmer_K;
    return same ? std::nullopt : std::optional(ImageEdge::Kind::border);
  }
  if (!in[0] && !in[1]) return std::nullopt;
  const Hit& other = in[0] ? hits[1] : hits[0];
  const double range_m = (p_W - rays[0].origin_W).norm();
  const bool behind = !other || static_cast<double>(other.range_m) > 1.005 * range_m + 0.01;
  return behind ? std::optional(ImageEdge::Kind::occlusion) : std::nullopt;
}

/// What the rays beside a run of spots tell.
struct Sides {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<std::optional<ImageEdge::Kind>> kinds;
};

ImageEdge edge_of_run(const std::vector<Spot>& spots, const Sides& sides, std::size_t first, std::size_t last,
                      const Shade& shade) {
  std::array<int, 3> votes{};
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<Vector2d> line_px;
  for (std::size_t i = first; i <= last; ++i) {
    line_px.push_back(spots[i].px);
    if (!sides.kinds[i]) continue;
    ++votes[static_cast<std::size_t>(*sides.kinds[i])];
    for (const std::size_t k : {2 * i, 2 * i + 1}) {
      rays.push_back(sides.rays[k]);
      hits.push_back(sides.hits[k]);
    }
  }
  std::vector<float> values(rays.size());
  shade(rays, hits, 1, values);
  float difference = 0.0F;
  for (std::size_t k = 0; k < values.size(); k += 2) difference += values[k] - values[k + 1];
  const auto kind = static_cast<ImageEdge::Kind>(std::ranges::max_element(votes) - votes.begin());
  return {.kind = kind,
          .from_W = spots[first].p_W,
          .to_W = spots[last].p_W,
          .line_px = simplified(line_px, 0.25),
          .contrast = std::abs(difference) * 2.0F / static_cast<float>(values.size())};
}

/// The visible runs of one edge.
std::vector<ImageEdge> visible_runs(const Line& line, const PlaceEdges::View& view, const Vector2d& spread,
                                    const RayCaster& caster, const Shade& shade) {
  const SE3 T_C_W = view.T_W_C.inverse();
  const auto ends_C = clipped(T_C_W.act(line.from_W), T_C_W.act(line.to_W), spread);
  if (!ends_C) return {};
  const std::vector<Spot> spots = spots_along(*ends_C, view);
  if (spots.size() < 3 || (spots.front().px - spots.back().px).norm() < kLeastRun_px) return {};
  Sides sides{.rays = rays_beside(spots, view), .hits = {}, .kinds = {}};
  for (const Ray& ray : sides.rays) sides.hits.push_back(caster.cast(ray));
  for (std::size_t i = 0; i < spots.size(); ++i)
    sides.kinds.push_back(seen_as(spots[i].p_W, std::span<const Ray, 2>(&sides.rays[2 * i], 2),
                                  std::span<const Hit, 2>(&sides.hits[2 * i], 2)));
  std::vector<ImageEdge> runs;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (!sides.kinds[i]) continue;
    std::size_t last = i;
    for (std::size_t k = i; k < spots.size() && k - last <= kLongestGap + 1; ++k)
      if (sides.kinds[k]) last = k;
    if ((spots[i].px - spots[last].px).norm() >= kLeastRun_px)
      runs.push_back(edge_of_run(spots, sides, i, last, shade));
    i = last;
  }
  return runs;
}

}  // namespace

double ImageEdge::length_px() const {
  double sum_px = 0.0;
  for (std::size_t i = 1; i < line_px.size(); ++i) sum_px += (line_px[i] - line_px[i - 1]).norm();
  return sum_px;
}

PlaceEdges::PlaceEdges(const Place& place, double reach_m) : place_(place), reach_m_(reach_m) {
  for (const Actor& actor : place.actors()) actors_O_.push_back(straight_edges(actor.mesh_O));
}

void PlaceEdges::gather_tiles(const Vector3d& p_W) {
  const auto near = place_.tiles_near(p_W, reach_m_);
  std::erase_if(tiles_, [&](const auto& tile) { return !std::ranges::binary_search(near, tile.first); });
  for (const std::uint32_t index : near) {
    if (tiles_.contains(index)) continue;
    const Tile tile = place_.tile(index);
    tiles_[index] = {tile.origin_W, straight_edges(tile.mesh)};
  }
}

std::vector<ImageEdge> PlaceEdges::visible(const View& view, const RayCaster& caster, const Shade& shade,
                                           Arena& arena) {
  gather_tiles(view.T_W_C.translation());
  std::vector<Line> lines;
  for (const auto& [index, tile] : tiles_)
    for (const auto& [from, to] : tile.edges)
      lines.push_back({tile.origin_W + from.cast<double>(), tile.origin_W + to.cast<double>()});
  for (std::size_t i = 0; i < actors_O_.size(); ++i) {
    const Actor& actor = place_.actors()[i];
    if (!actor.present(view.actors_s)) continue;
    const SE3 T_W_O = actor.pose(view.actors_s);
    for (const auto& [from, to] : actors_O_[i])
      lines.push_back({T_W_O.act(from.cast<double>()), T_W_O.act(to.cast<double>())});
  }
  const Vector2d spread = spread_of(view.camera);
  std::vector<std::vector<ImageEdge>> runs(lines.size());
  arena.for_chunks(lines.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) runs[i] = visible_runs(lines[i], view, spread, caster, shade);
  });
  std::vector<ImageEdge> edges;
  for (auto& some : runs) std::ranges::move(some, std::back_inserter(edges));
  return without_doubles(joined(std::move(edges)), view.camera.width, view.camera.height, view.least_px);
}

}  // namespace pllit
