#include "pllit/thermal/matching.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "pllit/thermal/point_index.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;

/// Where a point may show: on the segment between two pixels, which are one where its depth is known.
struct Prediction {
  Vector2f far_px = Vector2f::Zero(), near_px = Vector2f::Zero();

  /// From the nearest place of the segment to a pixel.
  Vector2f off(const Vector2f& at) const {
    const Vector2f along = near_px - far_px;
    const float length2 = along.squaredNorm();
    const float s = length2 > 0.0F ? std::clamp(along.dot(at - far_px) / length2, 0.0F, 1.0F) : 0.0F;
    return at - far_px - s * along;
  }
  bool is_point() const { return far_px == near_px; }
};

std::optional<Prediction> predict(const Vector3d& ray_K, const std::optional<FeatureDepth>& depth, const SE3& T_C_K,
                                  const Camera& camera, double nearest_m) {
  const Vector3d p_C = T_C_K.translation(), direction_C = T_C_K.rotation() * ray_K;
  if (depth) {
    const auto pixel = camera.project(p_C + depth->range_m * direction_C);
    if (!pixel) return std::nullopt;
    return Prediction{pixel->cast<float>(), pixel->cast<float>()};
  }
  const auto far = camera.project(direction_C);
  if (!far) return std::nullopt;
  constexpr int kDoublings = 8;
  for (int i = 0; i < kDoublings; ++i, nearest_m *= 2.0)
    if (const auto near = camera.project(p_C + nearest_m * direction_C); near && (*near - *far).norm() < camera.width)
      return Prediction{far->cast<float>(), near->cast<float>()};
  return Prediction{far->cast<float>(), far->cast<float>()};
}

using Predictions = std::vector<std::optional<Prediction>>;

Predictions predictions_of(const Keyframe& keyframe, const SE3& T_W_C_now, const Camera& camera, double nearest_m) {
  assert(keyframe.depths.size() == keyframe.features.points_px.size());
  const SE3 T_C_K = T_W_C_now.inverse() * keyframe.T_W_C;
  Predictions predictions;
  predictions.reserve(keyframe.depths.size());
  for (std::size_t i = 0; i < keyframe.depths.size(); ++i)
    predictions.push_back(predict(camera.ray(keyframe.features.points_px[i].cast<double>()), keyframe.depths[i], T_C_K,
                                  camera, nearest_m));
  return predictions;
}

float similarity(const cv::Mat& a, int i, const cv::Mat& b, int k) {
  using Row = Eigen::Map<const Eigen::VectorXf>;
  return Row(a.ptr<float>(i), a.cols).dot(Row(b.ptr<float>(k), b.cols));
}

float distance_of(float similarity) { return std::sqrt(std::max(2.0F - 2.0F * similarity, 0.0F)); }

struct Found {
  int current = -1;
  float distance = std::numeric_limits<float>::max();
};

/// The current image, ready to be searched.
struct Now {
  const Features& features;
  PointIndex index;
};

/// The best point within `radius` of the prediction, shifted; nothing where it is not clearly the best.
Found best_near(const Prediction& prediction, const Vector2f& shift, float radius, const cv::Mat& descriptors, int row,
                const Now& now, const MatchConfig& config) {
  const Vector2f margin(radius, radius);
  float best = -1.0F, second = -1.0F;
  int found = -1;
  now.index.for_box(prediction.far_px.cwiseMin(prediction.near_px) + shift - margin,
                    prediction.far_px.cwiseMax(prediction.near_px) + shift + margin, [&](int k) {
                      const Vector2f& at = now.features.points_px[static_cast<std::size_t>(k)];
                      if (prediction.off(at - shift).squaredNorm() > radius * radius) return;
                      const float s = similarity(descriptors, row, now.features.descriptors, k);
                      if (s > best) {
                        second = best;
                        best = s;
                        found = k;
                      } else {
                        second = std::max(second, s);
                      }
                    });
  const float distance = distance_of(best);
  if (found < 0 || distance > static_cast<float>(config.most_distance) ||
      distance > static_cast<float>(config.ratio) * distance_of(second))
    return {};
  return {.current = found, .distance = distance};
}

/// Matches of one keyframe that are the best for both of their points.
std::vector<PointMatch> mutual_matches(const Keyframe& keyframe, const Predictions& predictions, const Vector2f& shift,
                                       float radius, const Now& now, const MatchConfig& config) {
  std::vector<Found> found(predictions.size());
  std::vector<int> taken_by(now.features.points_px.size(), -1);
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    if (!predictions[i]) continue;
    found[i] =
        best_near(*predictions[i], shift, radius, keyframe.features.descriptors, static_cast<int>(i), now, config);
    if (found[i].current < 0) continue;
    int& holder = taken_by[static_cast<std::size_t>(found[i].current)];
    if (holder < 0 || found[i].distance < found[static_cast<std::size_t>(holder)].distance)
      holder = static_cast<int>(i);
  }
  std::vector<PointMatch> matches;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].current >= 0 && taken_by[static_cast<std::size_t>(found[i].current)] == static_cast<int>(i))
      matches.push_back({.reference = static_cast<int>(i), .current = found[i].current, .distance = found[i].distance});
  return matches;
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// How far the image lies off the prediction as a whole, by the points whose depth is known.
Vector2f shift_of(const std::vector<PointMatch>& matches, const Predictions& predictions, const Features& now) {
  constexpr std::size_t kEnough = 8;
  std::vector<float> x, y;
  for (const PointMatch& match : matches) {
    const Prediction& prediction = *predictions[static_cast<std::size_t>(match.reference)];
    if (!prediction.is_point()) continue;
    const Vector2f off = prediction.off(now.points_px[static_cast<std::size_t>(match.current)]);
    x.push_back(off.x());
    y.push_back(off.y());
  }
  if (x.size() < kEnough) return Vector2f::Zero();
  return {median(x), median(y)};
}

}  // namespace

Tracks match_to_keyframes(const Features& now, const SE3& T_W_C_now, std::span<const Keyframe> window,
                          const Camera& camera, const MatchConfig& config) {
  const Now searched{now, PointIndex(now.points_px, camera.width, camera.height)};
  const PointsOnLines on_lines_now = points_on_lines(now, config.lines);
  Tracks tracks;
  for (std::size_t k = 0; k < window.size(); ++k) {
    const Keyframe& keyframe = window[k];
    if (keyframe.features.points_px.empty() || now.points_px.empty()) continue;
    assert(keyframe.features.descriptors.cols == now.descriptors.cols);
    const Predictions predictions = predictions_of(keyframe, T_W_C_now, camera, config.nearest_m);
    const std::vector<PointMatch> wide =
        mutual_matches(keyframe, predictions, Vector2f::Zero(), static_cast<float>(config.window_px), searched, config);
    const Vector2f shift = shift_of(wide, predictions, now);
    std::vector<PointMatch> points = mutual_matches(
        keyframe, predictions, shift, static_cast<float>(std::min(config.gate_px, config.window_px)), searched, config);
    const std::vector<LineMatch> lines =
        match_lines(keyframe, now, on_lines_now, points, T_W_C_now.inverse() * keyframe.T_W_C, camera, config.lines);
    mark_anchored(points, lines, keyframe.features, now, config.lines);
    for (PointMatch& match : points) {
      match.keyframe = k;
      tracks.points.push_back(match);
    }
    for (LineMatch match : lines) {
      match.keyframe = k;
      tracks.lines.push_back(match);
    }
  }
  return tracks;
}

}  // namespace pllit
