// What is put into a place on purpose, by configuration: to be found, or to be left alone.
#pragma once

#include <span>
#include <vector>

#include "pllit/sim/config.hpp"
#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/scene_truth.hpp"
#include "pllit/sim/sightings.hpp"

namespace pllit {

/// In the order in which a place makes actors of them. Hot boxes are 0.1 to 0.5 m large, 5 to 40 K warm, up to 7 m off
/// the path, and begin between the 25th and the 50th second.
std::vector<FindingSpec> findings_of(const SimConfig& config);
/// Beside a finding that is asked for by name.
std::vector<DistractorSpec> distractors_of(const SimConfig& config);

/// All actors of a place that stand, with what a camera saw of them, one sighting an actor.
std::vector<SceneObject> objects_of(const Place& place, std::span<const FindingSpec> findings,
                                    std::span<const Sighting> sightings, const std::vector<Vector3d>& path_W);

}  // namespace pllit
