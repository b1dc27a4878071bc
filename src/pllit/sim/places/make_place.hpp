// Makes a place to simulate in around a motion.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/sim/world/place.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

enum class PlaceKind {
  room,      ///< an office floor, room after room; walls open where the path passes
  corridor,  ///< parallel walls with few features along the path's main direction, well beyond both its ends
  stairs,    ///< a stairwell with flights and landings below a path that climbs, and corridors where it goes on level
  plant,     ///< a hall of pumps, tanks, cabinets, pipes
  street,    ///< houses, parked cars and trees along kilometres
  field      ///< open land with few trees and posts
};

enum class Light { day, night };  ///< indoors: lamps lit or out

/// Something to be found: hot at a time of its own, on a spot that the seed chooses, in sight of the path and 1.5 m or
/// more away from it.
struct FindingSpec {
  enum class Kind { on_table, cabinet, pipe, box };
  enum class Arrival { heated_in_place, brought_in_hot };
  Kind kind = Kind::on_table;
  Arrival arrival = Arrival::heated_in_place;
  double at_s = 30.0;       ///< since the start of the motion
  double by_K = 15.0;       ///< above what it was, or above its surroundings
  double size_m = 0.3;      ///< of each edge of a box, which stands on a table
  double farthest_m = 3.2;  ///< from the place of the path that it is chosen for
};

/// What must not be reported: something cold that is put down, or a radiator that has been hot all along.
struct DistractorSpec {
  enum class Kind { cold_object, hot_radiator };
  Kind kind = Kind::cold_object;
  double at_s = 30.0;  ///< when it appears (cold objects)
};

struct PlaceConfig {
  PlaceKind kind = PlaceKind::room;
  std::uint64_t seed = 1;
  std::vector<Eigen::Vector3d> path_W;  ///< of the IMU, in order, at least two; evenly spread over duration_s
  double duration_s = 120.0;            ///< of the motion; what moves goes on moving a little longer
  double height_m = 1.3;                ///< of the IMU above the ground, as a rule
  double clearance_m = 0.6;             ///< that every surface but the ground keeps from the path; 2.5 suits a car
  Light light = Light::day;
  double warmer_K = 0.0;                ///< the air, and with it everything, than usual
  double air_drift_Kph = 0.0;           ///< beyond the place's own
  bool bare = false;                    ///< corridors: with nothing that tells a LiDAR one metre from the next
  int people = 0;                       ///< at most; fewer where there is no room 1.5 m off the path
  int cars = 0;                         ///< that drive (street), at most
  std::vector<FindingSpec> findings{};  ///< rooms and plants only
  std::vector<DistractorSpec> distractors{};
};

/// Errors: a path of fewer than two points or with numbers that are not finite, a height or clearance that is not
/// positive, findings in a kind of place that has none, or no spot for a finding.
Expected<std::unique_ptr<Place>> make_place(const PlaceConfig& config);

std::vector<Eigen::Vector3d> positions_of(const Trajectory& trajectory);

/// Centroid of the actor's surface that faces the path (weighted by area, foreshortening and inverse squared distance
/// over the path's points within 6 m, or over the nearest one), in W at a time: where it is, for a camera that never
/// saw it.
Eigen::Vector3d visible_centroid_W(const Actor& actor, double at_s, const std::vector<Eigen::Vector3d>& path_W);

}  // namespace pllit
