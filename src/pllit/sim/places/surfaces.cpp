#include "pllit/sim/places/surfaces.hpp"

#include <algorithm>
#include <array>

namespace pllit {
namespace {

struct Row {
  Material material;
  const char* name;
  float reflectivity, albedo, emissivity, mirror;
  float excess_K, follows_air, sun_K, sees_sky;
  Texture::Kind paint;
  float paint_scale_m, paint_contrast;
  Texture::Kind heat;
  float heat_scale_m, heat_contrast_K;
};

using enum Texture::Kind;
using enum Material;

// Emissivities follow the tables of FLIR's camera manuals (T505002, section 21) and of Testo ("Emissivities of the most
// important materials"), rounded: brick 0.93, plaster 0.91, asphalt 0.95, skin 0.98, paint 0.92, stainless steel 0.16
// to 0.2, rough bare metal 0.1 to 0.3. Everything else is assumed: reflectivities at 905 nm such that foliage is bright
// while asphalt and tyres are dark, temperatures such that walls vary by tenths of a kelvin and machines exceed the air
// by tens. Heat spreads, so that solid walls and floors vary without
// edges; outdoors, where sun, moisture and wind differ, they vary by about a kelvin.
constexpr std::array kRows{
    // clang-format off: a table reads by its columns
    Row{plaster,        "plaster",          .72F, .75F, .91F, 0, 0, .15F, 0, 0, clouds, 1.5F, .05F, clouds, .9F, .25F},
    Row{paint_wall,     "painted wall",     .6F, .55F, .93F, .02F, 0, .15F, 0, 0, clouds, .7F, .06F, bricks, .3F, .15F},
    Row{brick_wall,     "brick wall",       .45F, .4F, .93F, 0, 0, .15F, 0, 0, bricks, .25F, .12F, bricks, .25F, .35F},
    Row{concrete,       "concrete",         .42F, .45F, .94F, 0, -.3F, .1F, 0, 0, stains, 1.2F, .03F, clouds, 1.6F, .35F},
    Row{floor_tiles,    "floor tiles",      .5F, .5F, .93F, .05F, -.8F, .1F, 0, 0, tiles, .3F, .08F, tiles, .3F, .12F},
    Row{parquet,        "parquet",          .5F, .35F, .9F, .04F, -.4F, .2F, 0, 0, planks, .9F, .1F, planks, .9F, .12F},
    Row{carpet,         "carpet",           .35F, .25F, .95F, 0, -.3F, .3F, 0, 0, speckle, .02F, .06F, clouds, 2.F, .2F},
    Row{ceiling_panels, "ceiling panels",   .75F, .85F, .92F, 0, .5F, .3F, 0, 0, tiles, .6F, .05F, tiles, .6F, .25F},
    Row{wood,           "wood",             .6F, .45F, .9F, .02F, .2F, .4F, 0, 0, planks, .4F, .08F, clouds, .6F, .2F},
    Row{dark_wood,      "dark wood",        .45F, .2F, .9F, .03F, .3F, .4F, 0, 0, planks, .3F, .06F, clouds, .6F, .2F},
    Row{door_leaf,      "door",             .6F, .6F, .92F, .02F, -.6F, .4F, 0, 0, clouds, .8F, .04F, clouds, .9F, .2F},
    Row{door_frame,     "door frame",       .5F, .35F, .9F, .02F, -1.2F, .4F, 0, 0, plain, 1.F, 0, clouds, .5F, .2F},
    Row{window_frame,   "window frame",     .7F, .8F, .9F, .02F, -2.F, .5F, 2.F, .2F, plain, 1.F, 0, clouds, .4F, .3F},
    Row{window_glass,   "window",           .08F, .25F, .86F, .5F, -3.F, .6F, 1.F, .3F, plain, 1.F, 0, clouds, 1.F, .4F},
    Row{lamp,           "lamp",             .7F, .9F, .9F, 0, 9.F, .2F, 0, 0, plain, 1.F, 0, clouds, .3F, .8F},
    Row{radiator,       "radiator",         .7F, .8F, .92F, 0, 18.F, .2F, 0, 0, plain, 1.F, 0, clouds, .6F, 1.5F},
    Row{painted_metal,  "painted metal",    .5F, .45F, .91F, .05F, .4F, .5F, 6.F, .2F, speckle, .05F, .05F, clouds, .5F, .3F},
    Row{bare_metal,     "bare metal",       .4F, .5F, .12F, .6F, .5F, .6F, 8.F, .1F, clouds, .3F, .08F, clouds, .5F, .2F},
    Row{galvanised,     "galvanised sheet", .5F, .55F, .26F, .35F, .2F, .6F, 6.F, .1F, speckle, .06F, .1F, clouds, 1.F, .3F},
    Row{stainless,      "stainless steel",  .45F, .55F, .18F, .55F, .3F, .5F, 6.F, .1F, clouds, .5F, .06F, clouds, .6F, .2F},
    Row{cable,          "cable",            .15F, .08F, .94F, 0, 2.F, .4F, 3.F, .1F, plain, 1.F, 0, clouds, .5F, .6F},
    Row{dark_plastic,   "dark plastic",     .12F, .08F, .94F, .03F, .8F, .4F, 6.F, .1F, speckle, .03F, .02F, clouds, .3F, .4F},
    Row{light_plastic,  "light plastic",    .6F, .7F, .93F, .02F, .3F, .4F, 3.F, .1F, plain, 1.F, 0, clouds, .4F, .3F},
    Row{fabric,         "fabric",           .4F, .3F, .95F, 0, .6F, .5F, 4.F, .1F, speckle, .04F, .06F, stains, .4F, .5F},
    Row{cardboard,      "cardboard",        .6F, .42F, .92F, 0, .1F, .5F, 0, 0, stains, .25F, .08F, clouds, .4F, .25F},
    Row{paper,          "paper",            .75F, .85F, .93F, 0, .1F, .6F, 0, 0, wires, .15F, .15F, plain, 1.F, 0},
    Row{books,          "books",            .5F, .4F, .92F, 0, .2F, .3F, 0, 0, planks, .05F, .25F, clouds, .4F, .25F},
    Row{cabinet,        "electric cabinet", .55F, .6F, .92F, .03F, 2.5F, .3F, 6.F, .1F, clouds, .8F, .04F, clouds, .6F, .9F},
    Row{motor,          "motor",            .4F, .3F, .92F, .02F, 14.F, .1F, 3.F, 0, stains, .3F, .08F, clouds, .3F, 1.5F},
    Row{insulation,     "insulated pipe",   .6F, .55F, .88F, .1F, 4.F, .2F, 3.F, .1F, planks, .5F, .05F, planks, .9F, .6F},
    Row{cold_pipe,      "cold pipe",        .45F, .4F, .92F, .02F, -5.F, .1F, 2.F, .1F, stains, .3F, .06F, clouds, .7F, .5F},
    Row{tank,           "tank",             .5F, .5F, .9F, .1F, 1.5F, .1F, 6.F, .2F, stains, .9F, .06F, clouds, 1.2F, .7F},
    Row{ceramic,        "ceramic",          .7F, .8F, .92F, .05F, .2F, .3F, 0, 0, plain, 1.F, 0, clouds, .1F, .2F},
    Row{skin,           "skin",             .55F, .5F, .98F, 0, 11.F, .1F, 0, 0, plain, 1.F, 0, clouds, .15F, .8F},
    Row{clothes,        "clothes",          .4F, .3F, .96F, 0, 5.F, .3F, 2.F, .1F, stains, .3F, .05F, stains, .25F, 1.2F},
    Row{screen,         "screen",           .1F, .06F, .92F, .1F, 5.F, .2F, 0, 0, plain, 1.F, 0, clouds, .3F, 1.F},
    Row{asphalt,        "asphalt",          .14F, .16F, .95F, 0, 1.F, .05F, 16.F, .7F, speckle, .04F, .04F, clouds, .5F, 1.25F},
    Row{lane_paint,     "lane paint",       .75F, .75F, .93F, 0, .3F, .05F, 10.F, .7F, stains, .3F, .15F, stains, 1.8F, .4F},
    Row{pavement,       "pavement",         .35F, .4F, .94F, 0, .5F, .08F, 12.F, .6F, tiles, .4F, .07F, tiles, .4F, 1.F},
    Row{kerb,           "kerb",             .45F, .5F, .94F, 0, .3F, .08F, 9.F, .5F, planks, 1.F, .05F, planks, 1.F, .3F},
    Row{facade_plaster, "plastered front",  .6F, .6F, .92F, 0, 1.2F, .1F, 9.F, .4F, stains, 2.F, .03F, clouds, .5F, 1.2F},
    Row{facade_brick,   "brick front",      .4F, .35F, .93F, 0, 1.F, .1F, 11.F, .4F, bricks, .25F, .1F, bricks, .25F, 1.25F},
    Row{facade_stone,   "stone front",      .5F, .45F, .93F, 0, .8F, .06F, 9.F, .4F, bricks, .9F, .08F, bricks, .9F, .9F},
    Row{roof_tiles,     "roof tiles",       .35F, .25F, .93F, 0, .5F, .2F, 16.F, .9F, tiles, .3F, .06F, tiles, .3F, 1.1F},
    Row{leaves,         "leaves",           .6F, .18F, .97F, 0, -.5F, .8F, 2.F, .5F, speckle, .1F, .08F, clouds, .8F, 1.F},
    Row{bark,           "bark",             .35F, .2F, .95F, 0, .5F, .3F, 6.F, .3F, stains, .2F, .08F, stains, .3F, .8F},
    Row{grass,          "grass",            .55F, .22F, .97F, 0, -.8F, .6F, 5.F, .8F, clouds, 1.5F, .06F, clouds, .8F, 1.5F},
    Row{earth,          "earth",            .3F, .25F, .94F, 0, .3F, .2F, 11.F, .8F, stains, 1.F, .04F, clouds, .8F, 1.3F},
    Row{car_paint,      "car body",         .45F, .4F, .9F, .15F, 2.F, .6F, 12.F, .5F, clouds, 1.F, .03F, clouds, .8F, .8F},
    Row{car_glass,      "car window",       .07F, .12F, .88F, .5F, .5F, .6F, 4.F, .4F, plain, 1.F, 0, clouds, .6F, .4F},
    Row{tyre,           "tyre",             .07F, .06F, .95F, 0, 3.F, .3F, 8.F, .2F, plain, 1.F, 0, clouds, .2F, .5F},
    Row{sign_face,      "sign",             1.F, .8F, .9F, .05F, .2F, .7F, 7.F, .4F, tiles, .3F, .2F, plain, 1.F, 0},
    Row{street_metal,   "street furniture", .45F, .4F, .85F, .1F, .2F, .7F, 9.F, .4F, plain, 1.F, 0, clouds, .8F, .4F},
    Row{grating,        "grating",          .4F, .4F, .3F, .3F, .2F, .6F, 4.F, .1F, tiles, .05F, .15F, clouds, .8F, .3F},
    Row{rail_paint,     "railing",          .55F, .5F, .92F, .02F, -.2F, .6F, 5.F, .2F, plain, 1.F, 0, clouds, .6F, .3F},
    Row{screed,         "concrete floor",   .4F, .42F, .94F, .01F, -.8F, .08F, 0, 0, stains, 1.4F, .02F, clouds, 1.8F, .35F},
    // clang-format on
};

static_assert(kRows.size() == static_cast<std::size_t>(Material::count));
static_assert([] {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (static_cast<std::size_t>(kRows[i].material) != i) return false;
  return true;
}());

}  // namespace

bool is_ground(Material material) {
  constexpr std::array grounds{Material::floor_tiles, Material::parquet,  Material::carpet, Material::asphalt,
                               Material::lane_paint,  Material::pavement, Material::kerb,   Material::grass,
                               Material::earth,       Material::screed};
  return std::ranges::find(grounds, material) != grounds.end();
}

std::vector<Surface> palette(std::uint64_t seed, bool lamps_lit) {
  std::vector<Surface> surfaces;
  surfaces.reserve(kRows.size());
  for (const Row& row : kRows) {
    const auto pattern_seed = static_cast<std::uint32_t>(seed * 2654435761U + 97U * surfaces.size());
    const bool dark_lamp = row.material == lamp && !lamps_lit;
    surfaces.push_back({.name = row.name,
                        .reflectivity = row.reflectivity,
                        .albedo = row.albedo,
                        .emissivity = row.emissivity,
                        .mirror = row.mirror,
                        .glow = row.material == lamp && lamps_lit ? 1.5F : 0.0F,
                        .excess_K = dark_lamp ? 0.0F : row.excess_K,
                        .follows_air = row.follows_air,
                        .sun_K = row.sun_K,
                        .sees_sky = row.sees_sky,
                        .paint = {row.paint, row.paint_scale_m, row.paint_contrast, pattern_seed + 1},
                        .heat = {row.heat, row.heat_scale_m, row.heat_contrast_K, pattern_seed + 2}});
  }
  return surfaces;
}

}  // namespace pllit
