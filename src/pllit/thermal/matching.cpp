#include "pllit/thermal/matching.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "pllit/thermal/point_index.hpp"
#include "pllit/thermal/prediction.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;

using Predictions = std::vector<std::optional<Prediction>>;

float similarity(const cv::Mat& a, int i, const cv::Mat& b, int k) {
  using Row = Eigen::Map<const Eigen::VectorXf>;
  return Row(a.ptr<float>(i), a.cols).dot(Row(b.ptr<float>(k), b.cols));
}

float distance_of(float similarity) { return std::sqrt(std::max(2.0F - 2.0F * similarity, 0.0F)); }

struct Found {
  int current = -1;
  float distance = std::numeric_limits<float>::max();
};

struct Candidate {
  int index;
  float similarity;
};

/// The current image, ready to be searched.
struct Now {
  const Features& features;
  const cv::Mat& image;
  PointIndex index;
};

/// The best point within `radius` of the prediction; nothing where it is not clearly the best.
Found best_near(const Prediction& prediction, float radius, const cv::Mat& descriptors, int row, const Now& now,
                const MatchConfig& config) {
  const Vector2f margin(radius, radius);
  std::vector<Candidate> candidates;
  now.index.for_box(prediction.far_px.cwiseMin(prediction.near_px) - margin,
                    prediction.far_px.cwiseMax(prediction.near_px) + margin, [&](int k) {
                      const Vector2f& at = now.features.points_px[static_cast<std::size_t>(k)];
                      if (prediction.off(at).squaredNorm() > radius * radius) return;
                      candidates.push_back({k, similarity(descriptors, row, now.features.descriptors, k)});
                    });
  if (candidates.empty()) return {};
  const auto best = std::ranges::max_element(candidates, {}, &Candidate::similarity);
  const Vector2f& best_px = now.features.points_px[static_cast<std::size_t>(best->index)];
  float second = -1.0F;
  for (const Candidate& other : candidates)
    if (const Vector2f& at = now.features.points_px[static_cast<std::size_t>(other.index)];
        (at - best_px).norm() > static_cast<float>(config.twin_px))
      second = std::max(second, other.similarity);
  const float distance = distance_of(best->similarity);
  if (distance > static_cast<float>(config.most_distance) ||
      distance > static_cast<float>(config.ratio) * distance_of(second))
    return {};
  return {.current = best->index, .distance = distance};
}

/// Matches of one keyframe that are the best for both of their points.
std::vector<PointMatch> mutual_matches(const Keyframe& keyframe, const Predictions& predictions, float radius,
                                       const Now& now, const MatchConfig& config) {
  std::vector<Found> found(predictions.size());
  std::vector<int> taken_by(now.features.points_px.size(), -1);
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    if (!predictions[i]) continue;
    found[i] = best_near(*predictions[i], radius, keyframe.features.descriptors, static_cast<int>(i), now, config);
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

/// T_C_K: as predicted.
Tracks match_to_one(const Now& now, const PointsOnLines& on_lines_now, const SE3& T_C_K, const Keyframe& keyframe,
                    const Camera& camera, const MatchConfig& config) {
  if (keyframe.features.points_px.empty() || now.features.points_px.empty()) return {};
  assert(keyframe.features.descriptors.cols == now.features.descriptors.cols);
  const std::vector<Vector3d> rays_K = rays_of(keyframe, camera);
  const auto matched_around = [&](const SE3& pose, double radius_px) {
    return mutual_matches(keyframe, predictions_of(keyframe, rays_K, pose, camera, config.nearest_m),
                          static_cast<float>(radius_px), now, config);
  };
  const SE3 agreed =
      agreed_pose(keyframe, rays_K, matched_around(T_C_K, config.window_px), now.features, T_C_K, camera);
  Tracks tracks{
      .points = matched_around(agreed, std::min(config.gate_px, config.window_px)), .tracked = {}, .lines = {}};
  tracks.lines = match_lines(keyframe, now.features, on_lines_now, tracks.points, agreed, camera, config.lines);
  mark_anchored(tracks.points, tracks.lines, keyframe.features, now.features, config.lines);
  tracks.tracked =
      tracked_points(now.image, now.features, keyframe, rays_K, tracks.points, agreed, camera, config.align);
  return tracks;
}

}  // namespace

Tracks match_to_keyframes(const Features& now, const cv::Mat& image_now, const SE3& T_W_C_now,
                          std::span<const Keyframe> window, const Camera& camera, const MatchConfig& config,
                          Arena& arena) {
  const Now searched{now, image_now, PointIndex(now.points_px, camera.width, camera.height)};
  const PointsOnLines on_lines_now = points_on_lines(now, config.lines);
  std::vector<Tracks> found(window.size());
  arena.for_chunks(window.size(), 1, [&](std::size_t k, std::size_t) {
    found[k] = match_to_one(searched, on_lines_now, T_W_C_now.inverse() * window[k].T_W_C, window[k], camera, config);
  });
  Tracks tracks;
  for (std::size_t k = 0; k < found.size(); ++k) {
    for (PointMatch& match : found[k].points) {
      match.keyframe = k;
      tracks.points.push_back(match);
    }
    for (PointTrack& track : found[k].tracked) {
      track.keyframe = k;
      tracks.tracked.push_back(track);
    }
    for (LineMatch& match : found[k].lines) {
      match.keyframe = k;
      tracks.lines.push_back(match);
    }
  }
  return tracks;
}

}  // namespace pllit
