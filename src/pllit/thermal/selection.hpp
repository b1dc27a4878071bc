// Which features of an image to keep: an even spread over range and image.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/thermal/keyframe.hpp"

namespace pllit {

struct SelectionConfig {
  int count = 300;                        ///< features wanted
  double near_m = 5.0;                    ///< the near field
  double near_share = 0.4;                ///< of the features
  int near_columns = 16, near_rows = 12;  ///< the near field's features are spread over as many cells of the image
  int intervals = 10;                     ///< of range beyond the near field, with as many features each
  int empty_columns = 8, empty_rows = 6;  ///< cells of the image that must not stay empty
  double line_px = 3.0;                   ///< features as near to a line are added
  int line_points = 4;                    ///< most that are added to a line
};

/// Indices of the features to keep (the paper's even distribution), ascending: the near field finely divided, ten even
/// intervals of range beyond, then the best of each part of the image that is still empty, with or without depth, and
/// features near lines. `features.scores` decides among equals.
std::vector<int> select_features(const Features& features, std::span<const std::optional<FeatureDepth>> depths,
                                 const Camera& camera, const SelectionConfig& config);

}  // namespace pllit
