#include "pllit/thermal/line_matching.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace pllit {
namespace {

using Eigen::Vector2f;

constexpr double kDegree = std::numbers::pi / 180.0;

/// For each of one side the best of the other and for each of the other the best of the one, by a table of scores of
/// which those that are not positive do not count.
class MutualBest {
 public:
  MutualBest(std::size_t rows, std::size_t columns) : of_row_(rows), of_column_(columns) {}

  void offer(int row, int column, float score) {
    take(of_row_[static_cast<std::size_t>(row)], column, score);
    take(of_column_[static_cast<std::size_t>(column)], row, score);
  }
  /// The column of a row that is its best and whose best it is; negative where there is none.
  int of(int row) const {
    const Best& best = of_row_[static_cast<std::size_t>(row)];
    return best.other >= 0 && of_column_[static_cast<std::size_t>(best.other)].other == row ? best.other : -1;
  }

 private:
  struct Best {
    int other = -1;
    float score = 0.0F;
  };
  static void take(Best& best, int other, float score) {
    if (score > best.score) best = {other, score};
  }
  std::vector<Best> of_row_, of_column_;
};

/// Inverse depth along the optical axis at both ends of a line, from points of known depth near it: linear along the
/// line, as it is for a straight edge, where they lie far enough apart.
std::optional<std::pair<double, double>> inverse_depths(const Keyframe& keyframe, const LineSegment& line,
                                                        const Camera& camera, const LineMatchConfig& config) {
  double n = 0.0, s = 0.0, ss = 0.0, d = 0.0, sd = 0.0;
  const Vector2f along = (line.end_px - line.start_px) / line.length_px();
  const auto near = static_cast<float>(config.depth_near_px);
  for (std::size_t i = 0; i < keyframe.depths.size(); ++i) {
    if (!keyframe.depths[i]) continue;
    const float off = distance_on_line(keyframe.features.points_px[i], line, near);
    if (off < 0.0F || off > near) continue;
    const Vector3d ray = camera.ray(keyframe.features.points_px[i].cast<double>());
    const double place = along.dot(keyframe.features.points_px[i] - line.start_px) / line.length_px();
    const double inverse = 1.0 / (ray.z() * keyframe.depths[i]->range_m);
    n += 1.0;
    s += place;
    ss += place * place;
    d += inverse;
    sd += place * inverse;
  }
  if (n < 1.0) return std::nullopt;
  const double spread = ss / n - (s / n) * (s / n);
  const double slope = n >= 2.0 && spread > 0.02 ? (sd / n - s / n * d / n) / spread : 0.0;
  const double start = d / n - slope * s / n, end = start + slope;
  if (start <= 0.0 || end <= 0.0) return std::pair(d / n, d / n);
  return std::pair(start, end);
}

/// Where the pose puts a keyframe's line in the image now.
std::optional<LineSegment> predicted(const Keyframe& keyframe, const LineSegment& line, const SE3& T_C_K,
                                     const Camera& camera, const LineMatchConfig& config) {
  const auto inverse = inverse_depths(keyframe, line, camera, config);
  if (!inverse) return std::nullopt;
  const auto project = [&](const Vector2f& pixel, double inverse_depth) {
    const Vector3d ray = camera.ray(pixel.cast<double>());
    return camera.project(T_C_K.act(Vector3d(ray / (ray.z() * inverse_depth))));
  };
  const auto start = project(line.start_px, inverse->first), end = project(line.end_px, inverse->second);
  if (!start || !end || (*end - *start).norm() < 1.0) return std::nullopt;
  return LineSegment{.start_px = start->cast<float>(), .end_px = end->cast<float>(), .score = line.score};
}

double angle_between(const LineSegment& a, const LineSegment& b) {
  const Vector2f da = (a.end_px - a.start_px).normalized(), db = (b.end_px - b.start_px).normalized();
  return std::acos(std::min(std::abs(static_cast<double>(da.dot(db))), 1.0));
}

/// How well two lines in one image agree: 0 for not at all, up to 1.
float likeness(const LineSegment& a, const LineSegment& b, const LineMatchConfig& config) {
  if (angle_between(a, b) > config.alike_deg * kDegree) return 0.0F;
  const LineSegment &long_one = a.length_px() >= b.length_px() ? a : b, &short_one = &long_one == &a ? b : a;
  const Vector2f along = (long_one.end_px - long_one.start_px) / long_one.length_px(), across(-along.y(), along.x());
  const float off = std::max(std::abs(across.dot(short_one.start_px - long_one.start_px)),
                             std::abs(across.dot(short_one.end_px - long_one.start_px)));
  if (off > static_cast<float>(config.alike_px)) return 0.0F;
  const float one = along.dot(short_one.start_px - long_one.start_px),
              other = along.dot(short_one.end_px - long_one.start_px);
  const float begin = std::max(std::min(one, other), 0.0F), end = std::min(std::max(one, other), long_one.length_px());
  const float overlap = (end - begin) / short_one.length_px();
  if (overlap < static_cast<float>(config.least_overlap)) return 0.0F;
  return std::min(overlap, 1.0F) * (1.0F - 0.9F * off / static_cast<float>(config.alike_px));
}

/// How many matched points lie on both, for pairs of lines that have any.
Eigen::MatrixXi shared_points(const PointsOnLines& reference, const PointsOnLines& current,
                              const std::vector<PointMatch>& points, std::size_t reference_points) {
  std::vector<int> current_of(reference_points, -1);
  for (const PointMatch& match : points) current_of[static_cast<std::size_t>(match.reference)] = match.current;
  Eigen::MatrixXi shared = Eigen::MatrixXi::Zero(std::ssize(reference), std::ssize(current));
  for (Eigen::Index i = 0; i < shared.rows(); ++i)
    for (const int point : reference[static_cast<std::size_t>(i)]) {
      const int match = current_of[static_cast<std::size_t>(point)];
      if (match < 0) continue;
      for (Eigen::Index k = 0; k < shared.cols(); ++k)
        if (std::ranges::binary_search(current[static_cast<std::size_t>(k)], match)) ++shared(i, k);
    }
  return shared;
}

/// How many points on each line are matched at all, in one of the two images.
std::vector<int> matched_points(const PointsOnLines& on_lines, const std::vector<PointMatch>& points,
                                int PointMatch::* side) {
  std::vector<int> matched;
  for (const std::vector<int>& on_line : on_lines)
    matched.push_back(static_cast<int>(std::ranges::count_if(
        points, [&](const PointMatch& match) { return std::ranges::binary_search(on_line, match.*side); })));
  return matched;
}

}  // namespace

float distance_on_line(const Vector2f& point_px, const LineSegment& line, float beyond_px) {
  const float length = line.length_px();
  if (length <= 0.0F) return -1.0F;
  const Vector2f along = (line.end_px - line.start_px) / length, from_start = point_px - line.start_px;
  const float place = along.dot(from_start);
  if (place < -beyond_px || place > length + beyond_px) return -1.0F;
  return std::abs(along.x() * from_start.y() - along.y() * from_start.x());
}

PointsOnLines points_on_lines(const Features& features, const LineMatchConfig& config) {
  const auto near = static_cast<float>(config.on_line_px);
  PointsOnLines on_lines(features.lines.size());
  for (std::size_t i = 0; i < features.lines.size(); ++i) {
    const LineSegment& line = features.lines[i];
    // All that lies near, and a little more.
    const Vector2f low = line.start_px.cwiseMin(line.end_px).array() - 1.5F * near,
                   high = line.start_px.cwiseMax(line.end_px).array() + 1.5F * near;
    for (std::size_t k = 0; k < features.points_px.size(); ++k) {
      const Vector2f& at = features.points_px[k];
      if (at.x() < low.x() || at.x() > high.x() || at.y() < low.y() || at.y() > high.y()) continue;
      const float distance = distance_on_line(at, line, near);
      if (distance >= 0.0F && distance <= near) on_lines[i].push_back(static_cast<int>(k));
    }
  }
  return on_lines;
}

std::vector<LineMatch> match_lines(const Keyframe& keyframe, const Features& now, const PointsOnLines& on_lines_now,
                                   const std::vector<PointMatch>& points, const SE3& T_C_K, const Camera& camera,
                                   const LineMatchConfig& config) {
  const std::vector<LineSegment>& lines = keyframe.features.lines;
  const PointsOnLines on_lines = points_on_lines(keyframe.features, config);
  const Eigen::MatrixXi shared = shared_points(on_lines, on_lines_now, points, keyframe.features.points_px.size());
  const std::vector<int> matched_before = matched_points(on_lines, points, &PointMatch::reference),
                         matched_now = matched_points(on_lines_now, points, &PointMatch::current);
  std::vector<std::optional<LineSegment>> expected;
  for (const LineSegment& line : lines) expected.push_back(predicted(keyframe, line, T_C_K, camera, config));

  MutualBest by_points(lines.size(), now.lines.size()), by_place(lines.size(), now.lines.size());
  for (int i = 0; i < static_cast<int>(lines.size()); ++i)
    for (int k = 0; k < static_cast<int>(now.lines.size()); ++k) {
      const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(k);
      if (expected[row])
        if (const float alike = likeness(*expected[row], now.lines[column], config); alike > 0.0F)
          by_place.offer(i, k, alike);
      const int count = shared(i, k), fewer = std::min(matched_before[row], matched_now[column]);
      if (count < config.least_shared || count * count < config.least_share * fewer) continue;
      if (expected[row] && angle_between(*expected[row], now.lines[column]) > config.turned_deg * kDegree) continue;
      by_points.offer(i, k, static_cast<float>(count));
    }

  std::vector<LineMatch> matches;
  std::vector<bool> taken(now.lines.size(), false);
  const auto add = [&](int i, int k) {
    if (k < 0 || taken[static_cast<std::size_t>(k)]) return false;
    taken[static_cast<std::size_t>(k)] = true;
    matches.push_back({.reference = i, .current = k, .shared_points = shared(i, k)});
    return true;
  };
  std::vector<bool> matched(lines.size(), false);
  for (int i = 0; i < static_cast<int>(lines.size()); ++i)
    matched[static_cast<std::size_t>(i)] = add(i, by_points.of(i));
  for (int i = 0; i < static_cast<int>(lines.size()); ++i)
    if (!matched[static_cast<std::size_t>(i)]) add(i, by_place.of(i));
  return matches;
}

void mark_anchored(std::vector<PointMatch>& points, const std::vector<LineMatch>& lines, const Features& reference,
                   const Features& now, const LineMatchConfig& config) {
  const auto near = static_cast<float>(config.on_line_px);
  for (PointMatch& match : points)
    for (const LineMatch& pair : lines) {
      const float before = distance_on_line(reference.points_px[static_cast<std::size_t>(match.reference)],
                                            reference.lines[static_cast<std::size_t>(pair.reference)], near);
      const float after = distance_on_line(now.points_px[static_cast<std::size_t>(match.current)],
                                           now.lines[static_cast<std::size_t>(pair.current)], near);
      const auto distance = static_cast<double>(std::max(before, after));
      if (before < 0.0F || after < 0.0F || distance > config.on_line_px) continue;
      if (match.line_px < 0.0 || distance < match.line_px) match.line_px = distance;
    }
}

}  // namespace pllit
