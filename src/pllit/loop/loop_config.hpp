// What loop closing can be told.
#pragma once

namespace pllit {

struct LoopKeyframeConfig {
  double spacing_m = 2.0;     ///< way between two keyframes
  double spacing_deg = 30.0;  ///< or a turn
  double voxel_m = 0.3;       ///< spacing of the points that are kept
  double range_m = 60.0;      ///< farther points are not kept
};

struct CandidateConfig {
  double anchor_m = 4.0;          ///< way between two places that are compared with earlier ones
  double reach_m = 12.0;          ///< way before and after an anchor whose keyframes make its submap
  double min_way_m = 40.0;        ///< a place is earlier where at least this much way lies between
  double radius_m = 6.0;          ///< earlier places this near are looked at, three sigmas of the drift added
  double min_score = 0.5;         ///< of two descriptors (1: equal) before the places are looked at
  int tried = 3;                  ///< at most so many candidates of a place are verified
  double drift_share = 0.02;      ///< of the way: odometry never drifts more ...
  double drift_m = 1.0;           ///< ... beyond this
  double turn_deg_per_min = 3.0;  ///< nor turns away faster
};

struct RegistrationConfig {
  double coarse_m = 1.5, fine_m = 0.5;  ///< voxels of the planes; points match planes within this distance
  int iterations = 12;                  ///< at most, of each
  double min_overlap = 0.6;             ///< share of the upright structure that meets the other submap's
  double max_rmse_m = 0.09;             ///< of the matched points across their planes,
  double max_rmse_of_own = 1.25;        ///< or this many times what the earlier place's own points are off them
  double min_information = 0.005;       ///< of the weakest direction, as a share of what planes facing it would give
  double sigma_m = 0.04, sigma_deg = 0.15;  ///< least uncertainty of a registration: submaps bend
};

struct ConsistencyConfig {
  double max_squared = 16.8;  ///< squared whitened error of a cycle; a right one in a hundred exceeds it
  int agreeing = 2;           ///< loops that must agree, this one counted, where odometry's covariance allows it
  int agreeing_against = 4;   ///< where it does not
  double window_m = 40.0;     ///< way within which they are looked for
};

struct LoopConfig {
  bool enabled = true;
  LoopKeyframeConfig keyframes;
  CandidateConfig candidates;
  RegistrationConfig registration;
  ConsistencyConfig consistency;
  double gravity_sigma_deg = 0.3;  ///< of a keyframe's vertical
};

}  // namespace pllit
