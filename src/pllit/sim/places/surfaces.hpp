// What the simulated worlds are painted with.
#pragma once

#include <cstdint>
#include <vector>

#include "pllit/sim/world/mesh.hpp"

namespace pllit {

/// Index into palette().
enum class Material : std::uint32_t {
  plaster,
  paint_wall,
  brick_wall,
  concrete,
  floor_tiles,
  parquet,
  carpet,
  ceiling_panels,
  wood,
  dark_wood,
  door_leaf,
  door_frame,
  window_frame,
  window_glass,
  lamp,
  radiator,
  painted_metal,
  bare_metal,
  galvanised,
  stainless,
  cable,
  dark_plastic,
  light_plastic,
  fabric,
  cardboard,
  paper,
  books,
  cabinet,
  motor,
  insulation,
  cold_pipe,
  tank,
  ceramic,
  skin,
  clothes,
  screen,
  asphalt,
  lane_paint,
  pavement,
  kerb,
  facade_plaster,
  facade_brick,
  facade_stone,
  roof_tiles,
  leaves,
  bark,
  grass,
  earth,
  car_paint,
  car_glass,
  tyre,
  sign_face,
  street_metal,
  grating,
  rail_paint,
  screed,
  count
};

/// Whether one walks or drives on it: the only surfaces that a motion may come near.
bool is_ground(Material material);

/// All materials, in the order of Material. The seed shifts patterns; lamps shine only where lit.
std::vector<Surface> palette(std::uint64_t seed, bool lamps_lit);

}  // namespace pllit
