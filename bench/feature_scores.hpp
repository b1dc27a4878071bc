// Pairs of images whose motion is known, and what detectors are worth on them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "pllit/thermal/features.hpp"

namespace pllit::bench {

using Eigen::Vector2f;

constexpr float kNear_px = 3.0F;

// --- pairs -----------------------------------------------------------------------------------------------------------

struct Pair {
  cv::Mat first, second;
  cv::Matx33d homography;  ///< from the first to the second
};

inline cv::Matx33d random_homography(cv::RNG& random, const cv::Size& size) {
  const cv::Point2d centre(size.width / 2.0, size.height / 2.0);
  const double angle = random.uniform(-0.26, 0.26), scale = std::exp(random.uniform(-0.22, 0.22));
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const cv::Matx33d there(1, 0, -centre.x, 0, 1, -centre.y, 0, 0, 1);
  const cv::Matx33d turn(c, -s, 0, s, c, 0, random.uniform(-1e-4, 1e-4), random.uniform(-1e-4, 1e-4), 1);
  const cv::Matx33d back(1, 0, centre.x + random.uniform(-40.0, 40.0), 0, 1, centre.y + random.uniform(-40.0, 40.0), 0,
                         0, 1);
  return back * turn * there;
}

/// A gain 0.6 to 1.6 and a bias of up to 40 grey levels, after a clipped equalisation of the histogram every other
/// time.
inline cv::Mat gain_controlled(const cv::Mat& grey, cv::RNG& random) {
  cv::Mat out = grey.clone();
  if (random.uniform(0.0, 1.0) < 0.5) {
    std::array<double, 256> curve{};
    for (const auto value : cv::Mat_<std::uint8_t>(grey)) curve[value] += 256.0 / static_cast<double>(grey.total());
    double sum = 0.0;
    for (double& value : curve) value = sum += std::min(value, 3.0);
    cv::Mat table(1, 256, CV_8UC1);
    for (int i = 0; i < 256; ++i)
      table.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(curve[static_cast<std::size_t>(i)] / sum * 255.0);
    cv::LUT(grey, table, out);
  }
  out.convertTo(out, CV_8U, random.uniform(0.6, 1.6), random.uniform(-40.0, 40.0));
  return out;
}

inline Pair make_pair(const cv::Mat& image, bool gain, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed) * 7919 + 17);
  Pair pair{image, {}, random_homography(random, image.size())};
  cv::warpPerspective(image, pair.second, pair.homography, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::Mat noise(image.size(), CV_16SC1), noisy;
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  pair.second.convertTo(noisy, CV_16S);
  cv::Mat(noisy + noise).convertTo(pair.second, CV_8U);
  if (gain) pair.second = gain_controlled(pair.second, random);
  return pair;
}

inline Vector2f carried(const cv::Matx33d& h, const Vector2f& p) {
  const cv::Vec3d q = h * cv::Vec3d(p.x(), p.y(), 1.0);
  return {static_cast<float>(q[0] / q[2]), static_cast<float>(q[1] / q[2])};
}

inline bool inside(const Vector2f& p, const cv::Size& size) {
  constexpr float kMargin_px = 8.0F;
  return p.x() > kMargin_px && p.y() > kMargin_px && p.x() < static_cast<float>(size.width) - kMargin_px &&
         p.y() < static_cast<float>(size.height) - kMargin_px;
}

// --- scores ----------------------------------------------------------------------------------------------------------

struct Shown {
  std::vector<int> index;
  std::vector<Vector2f> there;  ///< in the other image
};

inline Shown shown_in(const Features& features, const cv::Matx33d& h, const cv::Size& size) {
  Shown shown;
  for (std::size_t i = 0; i < features.points_px.size(); ++i)
    if (const Vector2f q = carried(h, features.points_px[i]); inside(q, size) && inside(features.points_px[i], size)) {
      shown.index.push_back(static_cast<int>(i));
      shown.there.push_back(q);
    }
  return shown;
}

inline int come_back(const Shown& shown, const Features& other) {
  return static_cast<int>(std::ranges::count_if(shown.there, [&](const Vector2f& q) {
    return std::ranges::any_of(other.points_px, [&](const Vector2f& p) { return (p - q).norm() < kNear_px; });
  }));
}

inline cv::Mat rows_of(const cv::Mat& descriptors, const std::vector<int>& index) {
  cv::Mat rows;
  for (const int i : index) rows.push_back(descriptors.row(i));
  return rows;
}

/// Mutual nearest neighbours that are right.
inline int right_matches(const Features& a, const Features& b, const Shown& from_a, const Shown& from_b) {
  if (from_a.index.empty() || from_b.index.empty()) return 0;
  std::vector<cv::DMatch> matches;
  const int norm = a.descriptors.type() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2;
  cv::BFMatcher(norm, true).match(rows_of(a.descriptors, from_a.index), rows_of(b.descriptors, from_b.index), matches);
  return static_cast<int>(std::ranges::count_if(matches, [&](const cv::DMatch& m) {
    const Vector2f& truth = from_a.there[static_cast<std::size_t>(m.queryIdx)];
    const int other = from_b.index[static_cast<std::size_t>(m.trainIdx)];
    return (b.points_px[static_cast<std::size_t>(other)] - truth).norm() < kNear_px;
  }));
}

/// Length of a segment, sampled every 2 px, that lies on one of some lines; and the length counted at all.
struct Length {
  double on = 0.0, all = 0.0;
};

inline Length on_lines(const LineSegment& segment, const std::vector<LineSegment>& lines, const cv::Size& size) {
  Length length;
  const Vector2f whole = segment.end_px - segment.start_px, along = whole.normalized();
  const int places = std::max(static_cast<int>(whole.norm() / 2.0F), 1);
  for (int i = 0; i < places; ++i) {
    const Vector2f at = segment.start_px + (static_cast<float>(i) + 0.5F) / static_cast<float>(places) * whole;
    if (!inside(at, size)) continue;
    length.all += 1.0;
    length.on += std::ranges::any_of(lines, [&](const LineSegment& line) {
      const Vector2f u = (line.end_px - line.start_px).normalized(), offset = at - line.start_px;
      const float t = u.dot(offset);
      return std::abs(u.dot(along)) > 0.9962F && t > -kNear_px && t < line.length_px() + kNear_px &&
             std::abs(u.x() * offset.y() - u.y() * offset.x()) < kNear_px;
    });
  }
  return length;
}

inline Length lines_that_come_back(const std::vector<LineSegment>& from, const std::vector<LineSegment>& to,
                                   const cv::Matx33d& h, const cv::Size& size) {
  Length sum;
  for (const LineSegment& line : from) {
    const Length one = on_lines({carried(h, line.start_px), carried(h, line.end_px), 0.0F}, to, size);
    sum.on += one.on;
    sum.all += one.all;
  }
  return sum;
}

struct Score {
  double shown = 0.0, back = 0.0, right = 0.0, could_match = 0.0, points = 0.0, lines = 0.0, pairs = 0.0;
  Length line;
};

inline void add_pair(Score& score, const Features& a, const Features& b, const Pair& pair) {
  const cv::Size size = pair.first.size();
  const Shown from_a = shown_in(a, pair.homography, size), from_b = shown_in(b, pair.homography.inv(), size);
  score.shown += static_cast<double>(from_a.index.size() + from_b.index.size());
  score.back += come_back(from_a, b) + come_back(from_b, a);
  score.points += static_cast<double>(a.points_px.size());
  score.lines += static_cast<double>(a.lines.size());
  score.pairs += 1.0;
  if (!a.descriptors.empty() && !b.descriptors.empty()) {
    score.right += right_matches(a, b, from_a, from_b);
    score.could_match += static_cast<double>(std::min(from_a.index.size(), from_b.index.size()));
  }
  for (const Length& one : {lines_that_come_back(a.lines, b.lines, pair.homography, size),
                            lines_that_come_back(b.lines, a.lines, pair.homography.inv(), size)}) {
    score.line.on += one.on;
    score.line.all += one.all;
  }
}

}  // namespace pllit::bench
