#include "pllit/sim/world/mesh_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

namespace pllit {
namespace {

using Eigen::Vector3f;

constexpr float kWeld_m = 1e-3F;
constexpr float kBend = 0.9986F;       // cosine of 3 degrees
constexpr float kStraight = 0.99996F;  // cosine of half a degree

using Ends = std::pair<std::uint32_t, std::uint32_t>;  // of an edge, the lower index first

struct Side {
  Vector3f normal;
  std::uint32_t surface;
  float warmer_K;
};

/// One index for vertices at the same place.
std::vector<std::uint32_t> welded(const std::vector<Vector3f>& vertices) {
  std::map<std::array<std::int32_t, 3>, std::uint32_t> at;
  std::vector<std::uint32_t> index;
  index.reserve(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3i cell = (vertices[i] / kWeld_m).array().round().cast<int>();
    index.push_back(at.emplace(std::array{cell.x(), cell.y(), cell.z()}, i).first->second);
  }
  return index;
}

std::map<Ends, std::vector<Side>> sides_of_edges(const Mesh& mesh) {
  const std::vector<std::uint32_t> index = welded(mesh.vertices);
  std::map<Ends, std::vector<Side>> sides;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k] = index[mesh.triangles[t][k]];
    const Vector3f& a = mesh.vertices[corner[0]];
    const Vector3f normal = (mesh.vertices[corner[1]] - a).cross(mesh.vertices[corner[2]] - a);
    if (normal.norm() < 1e-10F) continue;  // welded to a line
    for (std::size_t k = 0; k < 3; ++k)
      sides[std::minmax(corner[k], corner[(k + 1) % 3])].push_back(
          {normal.normalized(), mesh.surface[t], mesh.warmer_K[t]});
  }
  return sides;
}

bool is_edge(const std::vector<Side>& sides) {
  if (sides.size() != 2) return true;
  const Side &a = sides[0], &b = sides[1];
  return std::abs(a.normal.dot(b.normal)) < kBend || a.surface != b.surface || a.warmer_K != b.warmer_K;
}

/// Walks from edge to edge as long as exactly straight ahead there is another.
class Chains {
 public:
  Chains(const std::vector<Vector3f>& vertices, std::vector<Ends> edges)
      : vertices_(vertices), edges_(std::move(edges)), used_(edges_.size(), false) {
    for (std::size_t i = 0; i < edges_.size(); ++i)
      for (const std::uint32_t end : {edges_[i].first, edges_[i].second}) at_[end].push_back(i);
  }

  std::vector<MeshEdge> joined() {
    std::vector<MeshEdge> chains;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (used_[i]) continue;
      used_[i] = true;
      const auto [a, b] = edges_[i];
      const Vector3f along = (vertices_[b] - vertices_[a]).normalized();
      chains.push_back({vertices_[last(a, -along)], vertices_[last(b, along)]});
    }
    return chains;
  }

 private:
  std::uint32_t last(std::uint32_t end, const Vector3f& along) {
    for (;;) {
      const auto& candidates = at_.at(end);
      const auto next = std::ranges::find_if(candidates, [&](std::size_t i) {
        return !used_[i] && (vertices_[other(i, end)] - vertices_[end]).normalized().dot(along) > kStraight;
      });
      if (next == candidates.end()) return end;
      used_[*next] = true;
      end = other(*next, end);
    }
  }
  std::uint32_t other(std::size_t edge, std::uint32_t end) const {
    return edges_[edge].first == end ? edges_[edge].second : edges_[edge].first;
  }

  const std::vector<Vector3f>& vertices_;
  std::vector<Ends> edges_;
  std::vector<bool> used_;
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> at_;
};

}  // namespace

std::vector<MeshEdge> straight_edges(const Mesh& mesh) {
  std::vector<Ends> edges;
  for (const auto& [ends, sides] : sides_of_edges(mesh))
    if (is_edge(sides)) edges.push_back(ends);
  return Chains(mesh.vertices, std::move(edges)).joined();
}

}  // namespace pllit
