#include "pllit/map/anomalies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>

#include "pllit/geometry/voxel_neighbours.hpp"
#include "pllit/map/anomaly_members.hpp"
#include "pllit/map/even_centroid.hpp"
#include "pllit/map/outshining.hpp"

namespace pllit {
namespace {

Eigen::Vector3i cell_of(const WatchedVoxel& watched, double size_m) {
  return voxel_of(watched.position_W, 1.0 / size_m);
}

/// Distance from a point to the box that holds an anomaly.
double distance_m(const Anomaly& anomaly, const Vector3d& p_W) {
  return ((p_W - anomaly.position_W).cwiseAbs() - 0.5 * anomaly.extent_m).cwiseMax(0.0).norm();
}

/// How an anomaly stands: by those of its voxels that were seen when it was last looked at, if these are enough of it.
/// The others may not have been seen since it cooled.
AnomalyState state_of(std::span<WatchedVoxel* const> parts) {
  constexpr double kOneLook_s = 5.0;
  constexpr int kEnough = 5;  // one of so many
  Time seen{};
  for (const WatchedVoxel* part : parts)
    if (!part->vacated) seen = std::max(seen, part->seen);
  int all = 0, left = 0, hot = 0, in_view = 0, hot_in_view = 0;
  for (const WatchedVoxel* part : parts) {
    ++all;
    left += part->vacated ? 1 : 0;
    if (part->vacated) continue;
    const int is_hot = part->hot ? 1 : 0, is_seen = to_seconds(seen - part->seen) < kOneLook_s ? 1 : 0;
    hot += is_hot;
    in_view += is_seen;
    hot_in_view += is_hot * is_seen;
  }
  const bool enough = kEnough * in_view >= all - left;
  const int judged = enough ? in_view : all - left, judged_hot = enough ? hot_in_view : hot;
  if (2 * left > all || 5 * judged_hot <= judged) return AnomalyState::gone;
  return 2 * judged_hot < judged ? AnomalyState::cooling : AnomalyState::confirmed;
}

/// Where the hot voxels of an anomaly are.
EvenCentroid place_of(std::span<WatchedVoxel* const> parts, double cell_m) {
  EvenCentroid place(cell_m);
  for (const WatchedVoxel* part : parts)
    if (part->hot) place.add(part->position_W);
  return place;
}

/// Voxels judged by themselves of which so much of the change is left however they lie to the edges of the image.
int sure_seeds(std::span<WatchedVoxel* const> parts, double least) {
  return static_cast<int>(std::ranges::count_if(parts, [&](const WatchedVoxel* part) {
    return part->hot && !part->joined && static_cast<double>(part->sure) >= least;
  }));
}

/// The part of an image that shows an anomaly, with a margin around it.
std::optional<ImageCrop> crop_of(const Watch& watch, std::uint32_t id, const ThermalView& view, double voxel_m) {
  constexpr float kMargin_px = 24.0F;
  Eigen::AlignedBox2f box;
  for (const SurfaceObservation& observation : view.observations) {
    const auto found = watch.find(voxel_key(voxel_of(observation.p_W, 1.0 / voxel_m)));
    if (found != watch.end() && found->second.owner == id && found->second.hot) box.extend(observation.pixel_px);
  }
  if (box.isEmpty()) return std::nullopt;
  const Eigen::Vector2i low = (box.min().array() - kMargin_px).max(0.0F).cast<int>(),
                        high = (box.max().array() + kMargin_px).cast<int>();
  return ImageCrop{
      .time = view.time, .left = low.x(), .top = low.y(), .width = high.x() - low.x(), .height = high.y() - low.y()};
}

double confidence(const Anomaly& anomaly) {
  const double contrast = 1.0 - std::exp(-anomaly.mean_sigmas / 4.0), size = 1.0 - std::exp(-anomaly.voxels / 6.0),
               views = 1.0 - 0.5 / std::max(1, anomaly.views);
  return contrast * size * views;
}

/// Whether a cluster lies so near to an anomaly that they are one thing, of which the LiDAR's rings left parts out.
bool next_to(const Anomaly& anomaly, const std::vector<VoxelKey>& cluster, const Watch& watch) {
  constexpr double kNext_m = 0.2;
  return std::ranges::any_of(cluster,
                             [&](VoxelKey key) { return distance_m(anomaly, watch.at(key).position_W) < kNext_m; });
}

/// One voxel thick: an edge that calibration has shifted by a few pixels looks like that, from few viewpoints.
bool is_thin(const Anomaly& anomaly, double voxel_m) {
  std::array<double, 3> sides{anomaly.extent_m.x(), anomaly.extent_m.y(), anomaly.extent_m.z()};
  std::ranges::sort(sides);
  return sides[1] < 1.5 * voxel_m;
}

}  // namespace

void AnomalyDetector::update(const WatchInput& input, const ThermalView& view) {
  watch_ = watched(std::move(watch_), input, config_.watch);
  for (const Cluster& cluster : clusters(input.map)) {
    if (static_cast<int>(cluster.size()) < config_.min_voxels) continue;
    const std::uint32_t id = owner_of(cluster, view).anomaly.id;
    for (const VoxelKey key : cluster) watch_.at(key).owner = id;
  }
  std::map<std::uint32_t, Parts> parts_of = parts_by_owner();
  note_outshining(input, parts_of, view.time);
  for (auto& [id, track] : tracks_) {
    measure(track, parts_of[id], view);
    settle(track, parts_of[id], view.time, input.map);
    if (track.anomaly.last_seen != view.time) continue;
    const auto crop = crop_of(watch_, id, view, input.map.config().voxel_m);
    std::optional<ImageCrop>& best = track.anomaly.crop;
    if (crop && (!best || crop->width * crop->height > best->width * best->height)) best = crop;
  }
  drop_vanished(view.time, parts_of);
}

std::map<std::uint32_t, AnomalyDetector::Parts> AnomalyDetector::parts_by_owner() {
  std::map<std::uint32_t, Parts> parts_of;
  for (auto& [key, watched] : watch_)
    if (watched.owner != 0) parts_of[watched.owner].push_back(&watched);
  return parts_of;
}

/// Of those that may yet become alarms.
void AnomalyDetector::note_outshining(const WatchInput& input, std::map<std::uint32_t, Parts>& parts_of, Time now) {
  if (config_.min_outshone <= 0.0) return;
  std::optional<std::vector<CalmSurface>> calm;
  for (auto& [id, track] : tracks_) {
    if (track.anomaly.state != AnomalyState::fresh) continue;
    if (!calm) calm = calm_surfaces(input, watch_);
    if (const auto share = outshone(parts_of[id], *calm, input.map, now))
      track.outshining = *share >= config_.min_outshone ? track.outshining + 1 : 0;
  }
}

std::vector<Anomaly> AnomalyDetector::anomalies() const {
  std::vector<Anomaly> anomalies;
  for (const auto& [id, track] : tracks_) anomalies.push_back(track.anomaly);
  return anomalies;
}

std::vector<AnomalyDetector::Cluster> AnomalyDetector::clusters(const ThermalMap& map) const {
  std::map<VoxelKey, Cluster> cells;
  for (const auto& [key, watched] : watch_)
    if (watched.hot && watched.hits >= map.config().model.hits)
      cells[voxel_key(cell_of(watched, config_.join_m))].push_back(key);
  std::vector<Cluster> clusters;
  for (const auto& group : connected(std::move(cells), [](const Cluster&, const Cluster&) { return true; })) {
    Cluster& cluster = clusters.emplace_back();
    for (const Cluster& part : group) cluster.insert(cluster.end(), part.begin(), part.end());
    std::ranges::sort(cluster);
  }
  return clusters;
}

/// The anomaly that a cluster belongs to: the oldest of those that hold voxels of it or lie next to it, which takes in
/// the others; else a new one.
AnomalyDetector::Track& AnomalyDetector::owner_of(const Cluster& cluster, const ThermalView& view) {
  std::set<std::uint32_t> owners;
  for (const auto& [number, track] : tracks_)
    if (next_to(track.anomaly, cluster, watch_)) owners.insert(number);
  for (const VoxelKey key : cluster)
    if (const std::uint32_t owner = watch_.at(key).owner; owner != 0) owners.insert(owner);
  if (owners.empty()) return new_track(cluster, view);
  const std::uint32_t oldest = *owners.begin();
  owners.erase(oldest);
  if (owners.empty()) return tracks_.at(oldest);
  for (auto& [key, watched] : watch_)
    if (owners.contains(watched.owner)) watched.owner = oldest;
  for (const std::uint32_t other : owners) tracks_.erase(other);
  return tracks_.at(oldest);
}

AnomalyDetector::Track& AnomalyDetector::new_track(const Cluster& cluster, const ThermalView& view) {
  Eigen::AlignedBox3d box_W;
  for (const VoxelKey key : cluster) box_W.extend(watch_.at(key).position_W);
  const std::uint32_t id = next_id_++;
  Track track{.anomaly = {.id = id, .first_seen = view.time}, .last_viewpoint_W = view.viewpoint_W};
  track.anomaly.position_W = box_W.center();
  track.anomaly.extent_m = box_W.sizes();
  track.anomaly.views = 1;
  return tracks_.emplace(id, track).first->second;
}

void AnomalyDetector::measure(Track& track, const Parts& parts, const ThermalView& view) {
  constexpr double kViewSpacing_m = 0.25;
  Anomaly& anomaly = track.anomaly;
  const Members members = members_of(parts, view.time, config_.dwell_s);
  if (members.hot == 0 || !members.seen_hot_now) return;
  const double n = members.hot;
  anomaly.kind = members.new_surfaces > members.known ? AnomalyKind::new_hot : AnomalyKind::heated;
  const EvenCentroid place = place_of(parts, config_.place_cell_m);
  anomaly.position_W = place.centroid_W();
  anomaly.covariance_m2 =
      place.covariance_m2() + config_.registration_m * config_.registration_m * Matrix3d::Identity();
  anomaly.extent_m = members.box_W.sizes();
  anomaly.mean_change = members.change / n;
  anomaly.mean_sigmas = members.sigmas / n;
  anomaly.peak_change = std::max(anomaly.peak_change, members.peak_change);
  anomaly.peak_sigmas = std::max(anomaly.peak_sigmas, members.peak_sigmas);
  anomaly.voxels = std::max(anomaly.voxels, members.hot);
  anomaly.last_seen = view.time;
  ++anomaly.frames;
  if ((view.viewpoint_W - track.last_viewpoint_W).norm() > kViewSpacing_m) {
    ++anomaly.views;
    track.last_viewpoint_W = view.viewpoint_W;
  }
  anomaly.confidence = confidence(anomaly);
}

void AnomalyDetector::settle(Track& track, const Parts& parts, Time now, const ThermalMap& map) const {
  constexpr int kStillFrames = 15;  // a rig that stands sees it in all of them, one that passes by in a few
  constexpr int kFewestSeeds = 2, kOutshining = 3;
  Anomaly& anomaly = track.anomaly;
  if (anomaly.state != AnomalyState::fresh) {
    anomaly.state = state_of(parts);
    return;
  }
  const Members members = members_of(parts, now, config_.dwell_s);
  const bool stays = members.left <= config_.max_leaving * members.all;
  if (!stays || walks(members, config_.least_still) || members.lasting < config_.min_voxels || !members.seen_hot_now)
    return;
  const int seeds = members.known + members.new_surfaces;
  const VoxelModelConfig& model = map.config().model;
  if (members.own_change < model.min_change * seeds || members.own_sigmas < config_.min_sigmas * seeds) return;
  if (seeds < std::clamp(members.hot / config_.watch.parts_of_one, kFewestSeeds, config_.enough_seeds)) return;
  const int sure = sure_seeds(parts, config_.sure_change * model.min_change);
  if (sure < kFewestSeeds || 3 * sure < seeds) return;
  const bool thin = is_thin(anomaly, map.config().voxel_m);
  const bool even = anomaly.mean_change >= config_.evenness * anomaly.peak_change;
  if (thin && !even) return;
  const int views = thin ? 2 * config_.min_views : config_.min_views;
  const bool watched_long =
      to_seconds(now - anomaly.first_seen) >= config_.still_dwell_s && anomaly.frames >= kStillFrames;
  if ((anomaly.views < views || !even) && !watched_long) return;
  if (config_.min_outshone > 0.0 && track.outshining < kOutshining) return;
  anomaly.state = AnomalyState::confirmed;
  anomaly.confirmed = now;
}

void AnomalyDetector::drop_vanished(Time now, const std::map<std::uint32_t, Parts>& parts_of) {
  std::erase_if(tracks_, [&](const auto& entry) {
    const Anomaly& anomaly = entry.second.anomaly;
    if (anomaly.state != AnomalyState::fresh) return false;
    const Parts& parts = parts_of.at(anomaly.id);
    const bool any_hot = std::ranges::any_of(parts, &WatchedVoxel::hot);
    if (any_hot && to_seconds(now - anomaly.last_seen) < config_.forget_fresh_s) return false;
    for (WatchedVoxel* part : parts) part->owner = 0;
    return true;
  });
}

}  // namespace pllit
