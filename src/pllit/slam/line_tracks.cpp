#include "pllit/slam/line_tracks.hpp"

#include <algorithm>
#include <cassert>

namespace pllit {

/// The track of each line: that of the newest keyframe's line that it was matched with.
LineTracks::PerLine LineTracks::tracks_of(const Features& now, const Tracks& tracks) const {
  PerLine ids(now.lines.size());
  std::vector<std::size_t> from(now.lines.size(), 0);
  for (const LineMatch& match : tracks.lines) {
    assert(match.keyframe < keyframes_.size());
    const auto current = static_cast<std::size_t>(match.current);
    const auto& id = keyframes_[match.keyframe][static_cast<std::size_t>(match.reference)];
    if (!id || (ids[current] && from[current] > match.keyframe)) continue;
    ids[current] = id;
    from[current] = match.keyframe;
  }
  return ids;
}

std::size_t LineTracks::oldest_with(TrackId track) const {
  const auto has = [&](const PerLine& ids) { return std::ranges::find(ids, std::optional(track)) != ids.end(); };
  return static_cast<std::size_t>(std::ranges::find_if(keyframes_, has) - keyframes_.begin());
}

std::vector<LineObservation> LineTracks::observed(const Features& now, const Tracks& tracks,
                                                  std::span<const Keyframe> keyframes) const {
  assert(keyframes.size() == keyframes_.size());
  std::vector<LineObservation> observations;
  const PerLine ids = tracks_of(now, tracks);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!ids[i]) continue;
    const auto line_W = map_.line_of(*ids[i]);
    if (!line_W) continue;
    const std::size_t keyframe = oldest_with(*ids[i]);
    observations.push_back({.keyframe = keyframe,
                            .line_K = keyframes[keyframe].T_W_C.inverse() * *line_W,
                            .start_px = now.lines[i].start_px.cast<double>(),
                            .end_px = now.lines[i].end_px.cast<double>()});
  }
  return observations;
}

void LineTracks::add(const Features& now, const Tracks& tracks, const DepthImage& depths, const SE3& T_W_C,
                     const Camera& camera, Arena& arena) {
  std::vector<LineSighting> sightings(now.lines.size());
  arena.for_chunks(sightings.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      sightings[i] = {.T_W_C = T_W_C, .points = points_along(now.lines[i], depths, camera)};
  });
  now_ = tracks_of(now, tracks);
  for (std::size_t i = 0; i < now_.size(); ++i) now_[i] = map_.observe(now_[i], std::move(sightings[i]));
  map_.end_image(T_W_C.translation());
}

void LineTracks::restart() {
  map_.clear();
  keyframes_.clear();
  now_.clear();
}

}  // namespace pllit
