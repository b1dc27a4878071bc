#include "pllit/thermal/line_segments.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

using Eigen::Vector2f;

/// Whether `piece` goes on or covers `line`: same direction, on the same straight line, at most a gap between them.
bool belongs(const LineSegment& line, const LineSegment& piece, const LineConfig& config) {
  const Vector2f along = (line.end_px - line.start_px).normalized(), own = (piece.end_px - piece.start_px).normalized();
  const auto least_cos = static_cast<float>(std::cos(config.merge_deg * std::numbers::pi / 180.0));
  if (along.dot(own) < least_cos) return false;
  const Vector2f across(-along.y(), along.x());
  const auto off = static_cast<float>(config.merge_px);
  if (std::abs(across.dot(piece.start_px - line.start_px)) > off ||
      std::abs(across.dot(piece.end_px - line.start_px)) > off)
    return false;
  const float begin = along.dot(piece.start_px - line.start_px), end = along.dot(piece.end_px - line.start_px);
  const auto gap = static_cast<float>(config.merge_gap_px);
  // A gap as long as what it joins joins nothing.
  const float allowed = std::min({gap, line.length_px(), piece.length_px()});
  return begin < line.length_px() + allowed && end > -allowed;
}

/// The line through both, by the total least squares of their ends weighted by length, from end to end.
LineSegment joined(const LineSegment& a, const LineSegment& b) {
  const float la = a.length_px(), lb = b.length_px();
  const Vector2f centre = (la * (a.start_px + a.end_px) + lb * (b.start_px + b.end_px)) / (2.0F * (la + lb));
  const Vector2f da = a.end_px - a.start_px, db = b.end_px - b.start_px;
  Eigen::Matrix2f scatter = Eigen::Matrix2f::Zero();
  const auto add = [&](const LineSegment& s, float weight) {
    for (const Vector2f& end : {s.start_px, s.end_px}) scatter += weight * (end - centre) * (end - centre).transpose();
  };
  add(a, la);
  add(b, lb);
  const float angle = 0.5F * std::atan2(2.0F * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  Vector2f along(std::cos(angle), std::sin(angle));
  if (along.dot(da + db) < 0.0F) along = -along;
  const auto place = [&](const Vector2f& p) { return along.dot(p - centre); };
  const float first = std::min(place(a.start_px), place(b.start_px)), last = std::max(place(a.end_px), place(b.end_px));
  return {.start_px = centre + first * along, .end_px = centre + last * along, .score = std::max(a.score, b.score)};
}

bool longer(const LineSegment& a, const LineSegment& b) { return a.length_px() > b.length_px(); }

}  // namespace

std::vector<LineSegment> merged(std::vector<LineSegment> segments, const LineConfig& config) {
  std::ranges::stable_sort(segments, longer);
  std::vector<LineSegment> lines;
  std::vector<bool> used(segments.size(), false);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (used[i]) continue;
    LineSegment line = segments[i];
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t k = i + 1; k < segments.size(); ++k) {
        if (used[k] || !belongs(line, segments[k], config)) continue;
        line = joined(line, segments[k]);
        used[k] = grown = true;
      }
    }
    if (line.length_px() >= static_cast<float>(config.least_length_px)) lines.push_back(line);
  }
  std::ranges::stable_sort(lines, longer);
  if (lines.size() > static_cast<std::size_t>(std::max(config.most, 0)))
    lines.resize(static_cast<std::size_t>(std::max(config.most, 0)));
  for (LineSegment& line : lines) line.score = line.length_px() / (line.length_px() + 40.0F);
  return lines;
}

std::vector<LineSegment> line_segments(const cv::Mat& grey, const LineConfig& config) {
  std::vector<cv::Vec4f> found;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD, config.scale)->detect(grey, found);
  std::vector<LineSegment> segments;
  for (const cv::Vec4f& s : found) {
    const LineSegment segment{.start_px = {s[0], s[1]}, .end_px = {s[2], s[3]}, .score = 0.0F};
    if (segment.length_px() >= 0.3F * static_cast<float>(config.least_length_px)) segments.push_back(segment);
  }
  return merged(std::move(segments), config);
}

}  // namespace pllit
