// One generator for each kind of place; the configuration has been checked.
#pragma once

#include "pllit/sim/places/scene.hpp"

namespace pllit {

Expected<PlaceParts> make_room(const PlaceConfig& config);
Expected<PlaceParts> make_corridor(const PlaceConfig& config);
Expected<PlaceParts> make_stairs(const PlaceConfig& config);
Expected<PlaceParts> make_plant(const PlaceConfig& config);
Expected<PlaceParts> make_street(const PlaceConfig& config);
Expected<PlaceParts> make_field(const PlaceConfig& config);

}  // namespace pllit
