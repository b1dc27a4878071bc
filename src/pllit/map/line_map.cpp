#include "pllit/map/line_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/base/evenly.hpp"

namespace pllit {

namespace {

using Eigen::Vector2d;

/// Range along a line, from its centroid, that two lines cover together.
struct Along {
  double from_m, to_m;
};
Along along(const LineLandmark& line, const LineLandmark& other) {
  const double middle = (other.centroid - line.centroid).dot(line.axis.direction);
  const double half = other.half_length_m * std::abs(other.axis.direction.dot(line.axis.direction));
  return {middle - half, middle + half};
}

/// The longest stretch of a segment's samples that lie in the image.
struct Stretch {
  std::optional<Vector2d> start_px, end_px;
  double length_px() const { return start_px && end_px ? (*end_px - *start_px).norm() : 0.0; }
};

bool inside(const Vector2d& px, const Camera& camera) {
  return px.x() >= 0.0 && px.y() >= 0.0 && px.x() <= camera.width - 1.0 && px.y() <= camera.height - 1.0;
}

Stretch in_image(const LineLandmark& line, const SE3& T_C_W, const Camera& camera) {
  constexpr int steps = 32;
  Stretch longest, current;
  for (int i = 0; i <= steps; ++i) {
    const double at_m = line.half_length_m * (2.0 * i / steps - 1.0);
    const auto px = camera.project(T_C_W.act(line.centroid + at_m * line.axis.direction));
    if (!px || !inside(*px, camera)) {
      current = {};
      continue;
    }
    if (!current.start_px) current.start_px = *px;
    current.end_px = *px;
    if (current.length_px() > longest.length_px()) longest = current;
  }
  return longest;
}

}  // namespace

TrackId LineMap::observe(std::optional<TrackId> track, LineSighting sighting) {
  const TrackId id = track && tracks_.contains(*track) ? *track : next_track_++;
  Track& of = tracks_[id];
  ++of.seen;
  of.last_image = image_;
  if (of.line && lines_.contains(*of.line)) ++lines_[*of.line].sightings;
  if (of.seen <= config_.most_sightings) {
    sighting.points = evenly(sighting.points, static_cast<std::size_t>(config_.points_per_sighting));
    of.sightings.push_back(std::move(sighting));
    promote(of);
  } else {
    of.sightings.clear();  // settled, as a line or as none
  }
  return id;
}

/// A track's points as a line of the map: a new one, a better fit of the one that it has become, or part of another.
void LineMap::promote(Track& track) {
  constexpr int refit_after = 4;  // sightings: one more changes little
  if (track.seen < config_.min_sightings) return;
  if (track.line && track.seen % refit_after != 0 && track.seen < config_.most_sightings) return;
  const std::vector<LineSighting> sightings(track.sightings.begin(), track.sightings.end());
  auto fitted = fit_line(sightings, config_.fit);
  if (!fitted) return;
  if (!track.line) track.line = same_line(*fitted);
  if (!track.line) {
    fitted->id = next_line_++;
    track.line = fitted->id;
    lines_[fitted->id] = *fitted;
    return;
  }
  const auto known = lines_.find(*track.line);
  if (known == lines_.end()) return;  // left behind
  LineLandmark& line = known->second;
  const Along covered = along(line, *fitted);
  const double from_m = std::min(-line.half_length_m, covered.from_m),
               to_m = std::max(line.half_length_m, covered.to_m);
  // Both hold much the same errors of poses and calibration, so the surer one stands for both instead of their mean.
  if (fitted->covariance_m2.trace() < line.covariance_m2.trace()) {
    const Along of_line = along(*fitted, line);
    fitted->id = line.id;
    fitted->sightings = line.sightings;
    line = with_ends(*fitted, std::min(-fitted->half_length_m, of_line.from_m),
                     std::max(fitted->half_length_m, of_line.to_m));
  } else {
    line = with_ends(line, from_m, to_m);
  }
}

std::optional<std::uint32_t> LineMap::same_line(const LineLandmark& line) const {
  const double least_cos = std::cos(config_.merge_deg * M_PI / 180.0);
  for (const auto& [id, other] : lines_) {
    if (std::abs(line.axis.direction.dot(other.axis.direction)) < least_cos) continue;
    const Along covered = along(other, line);
    const double gap_m = std::max({0.0, covered.from_m - other.half_length_m, -other.half_length_m - covered.to_m});
    const Vector3d half = line.half_length_m * line.axis.direction;
    const bool passes = other.axis.distance_m(line.centroid - half) < config_.merge_m &&
                        other.axis.distance_m(line.centroid + half) < config_.merge_m;
    if (passes && gap_m < config_.fit.min_length_m) return id;
  }
  return std::nullopt;
}

void LineMap::end_image(const Vector3d& p_W) {
  ++image_;
  std::erase_if(lines_, [&](const auto& entry) {
    return (entry.second.centroid - p_W).norm() - entry.second.half_length_m > config_.keep_m;
  });
  std::erase_if(tracks_, [&](const auto& entry) { return image_ - entry.second.last_image > config_.patience; });
}

void LineMap::clear() {
  tracks_.clear();
  lines_.clear();
}

std::optional<LineLandmark> LineMap::line_of(TrackId track) const {
  const auto of = tracks_.find(track);
  if (of == tracks_.end() || !of->second.line) return std::nullopt;
  const auto line = lines_.find(*of->second.line);
  return line == lines_.end() ? std::nullopt : std::optional(line->second);
}

std::vector<VisibleLine> LineMap::visible_from(const SE3& T_W_C, const Camera& camera, double min_px) const {
  std::vector<VisibleLine> visible;
  const SE3 T_C_W = T_W_C.inverse();
  for (const auto& [id, line] : lines_) {
    const Stretch stretch = in_image(line, T_C_W, camera);
    if (stretch.length_px() >= min_px) visible.push_back({line, *stretch.start_px, *stretch.end_px});
  }
  return visible;
}

std::vector<LineLandmark> LineMap::lines() const {
  std::vector<LineLandmark> all;
  for (const auto& [id, line] : lines_) all.push_back(line);
  return all;
}

}  // namespace pllit
