// What the textures of surfaces look like.
#pragma once

#include <Eigen/Core>

#include "pllit/sim/world/mesh.hpp"

namespace pllit {

/// Value, in [-1, 1] with a mean about 0 over space, of a texture at a place in the mesh's own frame; its contrast is
/// not applied. clouds is continuous; bricks, tiles, planks and wires are drawn in the surface's own plane, for which
/// the unit normal in the same frame is needed; speckle (round grains) and the lattices have sharp edges, stains such
/// as one footprint blurs. Details smaller than footprint_m, the width of what a pixel sees, fade towards their mean.
float texture_value(const Texture& texture, const Eigen::Vector3f& p_own, const Eigen::Vector3f& normal_own,
                    float footprint_m);

/// Whether it varies little within a pixel's footprint: one place in a pixel then stands for all.
inline bool is_smooth(const Texture& texture) {
  using Kind = Texture::Kind;
  return texture.contrast == 0.0F || texture.kind == Kind::plain || texture.kind == Kind::clouds ||
         texture.kind == Kind::stains;
}

}  // namespace pllit
