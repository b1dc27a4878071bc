#include "pllit/thermal/keyframe_window.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <vector>

namespace pllit {
namespace {

/// Of the points matched with one keyframe between the two images, px; 0 without matches.
double median_motion_px(const Tracks& tracks, std::size_t index, const Keyframe& keyframe, const Features& now) {
  std::vector<float> motions;
  for (const PointMatch& match : tracks.points)
    if (match.keyframe == index)
      motions.push_back((now.points_px[static_cast<std::size_t>(match.current)] -
                         keyframe.features.points_px[static_cast<std::size_t>(match.reference)])
                            .norm());
  if (motions.empty()) return 0.0;
  const auto middle = motions.begin() + static_cast<std::ptrdiff_t>(motions.size() / 2);
  std::ranges::nth_element(motions, middle);
  return static_cast<double>(*middle);
}

std::vector<int> matches_by_keyframe(const Tracks& tracks, std::size_t keyframes) {
  std::vector<int> matches(keyframes, 0);
  for (const PointMatch& match : tracks.points) ++matches[match.keyframe];
  return matches;
}

/// Small for views that are alike: metres apart, with a metre for each radian turned.
double apart(const Keyframe& a, const Keyframe& b) { return (a.T_W_C.inverse() * b.T_W_C).log().coeffs().norm(); }

}  // namespace

Features strongest(const Features& features, int most) {
  if (std::ssize(features.points_px) <= most) return features;
  const std::ptrdiff_t count = most;
  return {.points_px = {features.points_px.begin(), features.points_px.begin() + count},
          .scores = {features.scores.begin(), features.scores.begin() + count},
          .descriptors = features.descriptors.rowRange(0, most).clone(),
          .lines = features.lines};
}

bool wants_keyframe(const Tracks& tracks, std::span<const Keyframe> window, const Features& now, Time time,
                    int width_px, const KeyframeConfig& config) {
  if (now.points_px.empty()) return false;
  if (window.empty()) return true;
  const Keyframe& last = window.back();
  const double passed_s = to_seconds(time - last.time);
  const int matches = matches_by_keyframe(tracks, window.size()).back();
  if (passed_s < config.least_s && matches >= config.lost_matches) return false;
  const auto points = static_cast<double>(std::min(last.features.points_px.size(), now.points_px.size()));
  if (matches < config.least_share * points && matches < config.least_matches) return true;
  const double motion_px = median_motion_px(tracks, window.size() - 1, last, now);
  if (motion_px > config.parallax * width_px) return true;
  return passed_s > config.most_s && motion_px > config.still_px;
}

std::size_t expendable(const Tracks& tracks, std::span<const Keyframe> window) {
  assert(window.size() >= 3);
  constexpr int kServes = 15;  // matches
  const std::vector<int> matches = matches_by_keyframe(tracks, window.size());
  const auto least = std::ranges::min_element(matches.begin(), matches.end() - 2);
  if (*least < kServes) return static_cast<std::size_t>(least - matches.begin());
  std::size_t nearest = 0;
  double distance = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i + 2 < window.size(); ++i)
    for (std::size_t k = 0; k < window.size(); ++k)
      if (k != i && apart(window[i], window[k]) < distance) {
        distance = apart(window[i], window[k]);
        nearest = i;
      }
  return nearest;
}

}  // namespace pllit
