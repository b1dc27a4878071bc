// Cars that drive and people who walk along a street.
#pragma once

#include "pllit/sim/places/ground.hpp"
#include "pllit/sim/places/inhabitants.hpp"

namespace pllit {

/// Cars on the lane to the left, people on the pavements: to and fro on stretches that stay 1.5 m or more off the path.
std::vector<Actor> street_traffic(const PlaceConfig& config, const Site& site, const StreetLine& line,
                                  const Ground& ground);

}  // namespace pllit
