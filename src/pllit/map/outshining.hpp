// Heat by order alone: whether something outshines, in the image as it came, what is normally brighter than it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/map/watch.hpp"

namespace pllit {

/// A surface that nothing has happened to.
struct CalmSurface {
  float normal = 0.0F;  ///< in the map's unit
  float raw = 0.0F;     ///< as this image shows it
};

/// Those that an image shows, or enough of them.
std::vector<CalmSurface> calm_surfaces(const WatchInput& input, const Watch& watch);

/// Of the calm surfaces that are normally brighter than a hot voxel the share that this image shows darker than it; the
/// median over the voxels that are judged by themselves and seen at `now`. Nothing where none is normally brighter. A
/// gain control changes all of an image in ways that no curve may find, but it keeps the order.
std::optional<double> outshone(std::span<WatchedVoxel* const> parts, std::span<const CalmSurface> calm,
                               const ThermalMap& map, Time now);

}  // namespace pllit
