// When an image becomes a keyframe, and which keyframe makes room for it.
#pragma once

#include <cstddef>
#include <span>

#include "pllit/thermal/keyframe.hpp"

namespace pllit {

struct KeyframeConfig {
  int most_points = 400;  ///< that a keyframe keeps
  int most = 8;           ///< keyframes in a window
  /// With fewer matches with the last keyframe than both this share of its points and this number, the image becomes
  /// one.
  double least_share = 0.55;
  int least_matches = 80;
  double parallax = 0.08;  ///< median motion of its points, as a share of the image's width: with more
  double most_s = 3.0;     ///< without a keyframe, where the rig moves: then the image becomes one
  double least_s = 0.3;    ///< between two keyframes, unless fewer are matched than the image needs to be followed:
  int lost_matches = 30;
  double still_px = 2.0;  ///< median motion below which the rig counts as still
};

/// The best points, at most `most`, with all lines: what a keyframe keeps. Images are searched for more points than
/// that, so that a keyframe's points are among them.
Features strongest(const Features& features, int most);

/// Whether the image now should become a keyframe. `tracks` were matched with `window`, whose last is the newest. An
/// empty window wants any image that has points. width_px: the image's.
bool wants_keyframe(const Tracks& tracks, std::span<const Keyframe> window, const Features& now, Time time,
                    int width_px, const KeyframeConfig& config);

/// Index of the keyframe to drop from a full window before a new one is added: of all but the newest two, the one that
/// matches the image now least; where all still serve, the one that a neighbour stands nearest to, for its view.
/// The window holds at least three.
std::size_t expendable(const Tracks& tracks, std::span<const Keyframe> window);

}  // namespace pllit
