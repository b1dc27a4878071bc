// Where a second visit lies in the map of the first, found without a guess.
#pragma once

#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/loop/loop_config.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// What a visit left: its way, and the points of its map, both in its world, whose z axis points up.
struct VisitMap {
  Trajectory trajectory;
  std::vector<Vector3f> points_W;
};

struct RelocalisationConfig {
  double spacing_m = 4.0;  ///< of the way between places that are compared
  double range_m = 40.0;   ///< of the map around a place
  double voxel_m = 0.1;    ///< spacing of its points
  int tried = 3;           ///< places of the first visit that are looked at for each of the second
  int most_places = 40;    ///< of the second visit; more say no more
  double agree_m = 0.5, agree_deg = 2.0;
  int agreeing = 2;  ///< places that must agree; all, where there are fewer
  /// Finer than for loops: rooms are narrow.
  RegistrationConfig registration{.coarse_m = 0.75,
                                  .fine_m = 0.25,
                                  .iterations = 20,
                                  .min_overlap = 0.6,
                                  .max_rmse_m = 0.12,
                                  .min_information = 0.003};
};

struct Relocalisation {
  SE3 T_A_B;  ///< p_A = T_A_B p_B, A the first visit's world
  int places = 0, agreeing = 0;
  double overlap = 0.0, rmse_m = 0.0;  ///< of the final registration
};

/// Registers places of visit b with places of visit a that look alike, takes the motion that most agree on, and refines
/// it over all points. Input errors say that the visits do not share a place, or that a map is empty.
Expected<Relocalisation> relocalise(const VisitMap& a, const VisitMap& b, const RelocalisationConfig& config = {});

}  // namespace pllit
