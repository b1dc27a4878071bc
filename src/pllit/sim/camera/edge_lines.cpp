#include "pllit/sim/camera/edge_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kJoin_px = 3.0;
constexpr double kSameWay = 0.99985;  // cosine of one degree
constexpr double kSameTurn_deg = 6.0;
constexpr double kDoubledShare = 0.6;

double distance_px(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = b - a;
  const double t = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - t * along).norm();
}

void simplify(const std::vector<Vector2d>& line_px, std::size_t first, std::size_t last, double off_px,
              std::vector<Vector2d>& kept) {
  std::size_t worst = first;
  double most_px = off_px;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double off = distance_px(line_px[i], line_px[first], line_px[last]);
    if (off <= most_px) continue;
    most_px = off;
    worst = i;
  }
  if (worst != first) {
    simplify(line_px, first, worst, off_px, kept);
    simplify(line_px, worst, last, off_px, kept);
  } else {
    kept.push_back(line_px[last]);
  }
}

ImageEdge reversed(ImageEdge edge) {
  std::swap(edge.from_W, edge.to_W);
  std::ranges::reverse(edge.line_px);
  return edge;
}

/// b after a, where b begins as a ends and goes on the same way.
bool append(ImageEdge& a, const ImageEdge& b) {
  if ((a.line_px.back() - b.line_px.front()).norm() > kJoin_px) return false;
  const Vector3d way = (a.to_W - a.from_W).normalized();
  if (way.dot((b.to_W - b.from_W).normalized()) < kSameWay || way.dot((b.to_W - a.from_W).normalized()) < kSameWay)
    return false;
  const double a_px = a.length_px(), b_px = b.length_px();
  a.contrast = static_cast<float>((a_px * a.contrast + b_px * b.contrast) / (a_px + b_px));
  a.line_px.back() = 0.5 * (a.line_px.back() + b.line_px.front());
  a.line_px.insert(a.line_px.end(), b.line_px.begin() + 1, b.line_px.end());
  a.line_px = simplified(a.line_px, 0.25);
  a.to_W = b.to_W;
  return true;
}

bool touch(const ImageEdge& a, const ImageEdge& b) {
  for (const Vector2d* end : {&a.line_px.front(), &a.line_px.back()})
    for (const Vector2d* other : {&b.line_px.front(), &b.line_px.back()})
      if ((*end - *other).squaredNorm() <= kJoin_px * kJoin_px) return true;
  return false;
}

bool joins(ImageEdge& a, const ImageEdge& b) {
  if (a.kind != b.kind || !touch(a, b)) return false;
  if (append(a, b) || append(a, reversed(b))) return true;
  ImageEdge turned = reversed(a);
  if (!append(turned, b) && !append(turned, reversed(b))) return false;
  a = std::move(turned);
  return true;
}

/// Degrees, 0 to 180.
float turn_deg(const Vector2d& along) {
  const double turn = std::atan2(along.y(), along.x()) * 180.0 / std::numbers::pi;
  return static_cast<float>(turn < 0.0 ? turn + 180.0 : turn);
}

/// Calls visit(x, y, turn) for pixels along a line, one for each pixel of length.
template <class Visit>
void walk(const std::vector<Vector2d>& line_px, const Visit& visit) {
  for (std::size_t i = 1; i < line_px.size(); ++i) {
    const Vector2d along = line_px[i] - line_px[i - 1];
    const int steps = std::max(1, static_cast<int>(along.norm()));
    for (int k = 0; k <= steps; ++k) {
      const Vector2d p = line_px[i - 1] + along * (static_cast<double>(k) / steps);
      visit(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())), turn_deg(along));
    }
  }
}

}  // namespace

std::vector<Vector2d> simplified(const std::vector<Vector2d>& line_px, double off_px) {
  std::vector<Vector2d> kept{line_px.front()};
  simplify(line_px, 0, line_px.size() - 1, off_px, kept);
  return kept;
}

std::vector<ImageEdge> joined(std::vector<ImageEdge> edges) {
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t k = i + 1; k < edges.size();) {
      if (!joins(edges[i], edges[k])) {
        ++k;
        continue;
      }
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;  // the longer edge may reach others now
    }
  return edges;
}

std::vector<ImageEdge> without_doubles(std::vector<ImageEdge> edges, int width, int height, double least_px) {
  std::erase_if(edges, [&](const ImageEdge& edge) { return edge.length_px() < least_px; });
  std::ranges::stable_sort(edges, std::greater{}, &ImageEdge::length_px);
  cv::Mat turns(height, width, CV_32FC1, cv::Scalar(-1.0));  // of the edges kept, 1 px to either side
  std::vector<ImageEdge> kept;
  for (ImageEdge& edge : edges) {
    int doubled = 0, count = 0;
    walk(edge.line_px, [&](int x, int y, float turn) {
      const float other = turns.at<float>(std::clamp(y, 0, height - 1), std::clamp(x, 0, width - 1));
      const double apart = std::abs(static_cast<double>(other - turn));
      doubled += other >= 0.0F && std::min(apart, 180.0 - apart) < kSameTurn_deg;
      ++count;
    });
    if (doubled > kDoubledShare * count) continue;
    walk(edge.line_px, [&](int x, int y, float turn) {
      for (int row = std::max(0, y - 1); row <= std::min(height - 1, y + 1); ++row)
        for (int column = std::max(0, x - 1); column <= std::min(width - 1, x + 1); ++column)
          turns.at<float>(row, column) = turn;
    });
    kept.push_back(std::move(edge));
  }
  return kept;
}

}  // namespace pllit
