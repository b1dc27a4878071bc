#include "pllit/slam/config_section.hpp"

namespace pllit {
namespace {

void list(Section section, LoopKeyframeConfig& config) {
  section.add(PLLIT_KEY(spacing_m), "Way between two keyframes.", "m", {0.1, 100.0});
  section.add(PLLIT_KEY(spacing_deg), "Or a turn.", "deg", {1.0, 180.0});
  section.add(PLLIT_KEY(voxel_m), "Spacing of the points that are kept.", "m", {0.05, 5.0});
  section.add(PLLIT_KEY(range_m), "Points farther from the rig are not kept.", "m", {5.0, 300.0});
}

void list(Section section, CandidateConfig& config) {
  section.add(PLLIT_KEY(anchor_m), "Way between two places that are compared with earlier ones.", "m", {0.5, 100.0});
  section.add(PLLIT_KEY(reach_m), "Way before and after a place whose keyframes make its submap.", "m", {1.0, 100.0});
  section.add(PLLIT_KEY(min_way_m), "An earlier place lies at least this much way back.", "m", {5.0, 10000.0});
  section.add(PLLIT_KEY(radius_m), "Earlier places this near, and three sigmas of the drift, are looked at.", "m",
              {0.5, 100.0});
  section.add(PLLIT_KEY(min_score), "Others must look alike by this correlation of their descriptors.", "", {0.0, 1.0});
  section.add(PLLIT_KEY(tried), "At most so many candidates of a place are verified.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(drift_share), "Odometry never drifts by more than this share of the way ...", "", {0.0, 1.0});
  section.add(PLLIT_KEY(drift_m), "... beyond this.", "m", {0.0, 100.0});
  section.add(PLLIT_KEY(turn_deg_per_min), "Odometry never turns away faster.", "deg/min", {0.0, 100.0});
}

void list(Section section, RegistrationConfig& config) {
  section.add(PLLIT_KEY(coarse_m), "Points match planes this near, first.", "m", {0.1, 10.0});
  section.add(PLLIT_KEY(fine_m), "Then this near; planes span twice as much.", "m", {0.05, 5.0});
  section.add(PLLIT_KEY(iterations), "Most iterations of each.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(min_overlap), "Smaller share of upright structure that meets the other submap's: no loop.", "",
              {0.0, 1.0});
  section.add(PLLIT_KEY(max_rmse_m), "Larger distance of points from their planes: no loop,", "m", {0.001, 1.0});
  section.add(PLLIT_KEY(max_rmse_of_own), "if also larger than so many times that of the earlier place's own points.",
              "", {0.0, 10.0});
  section.add(PLLIT_KEY(min_information), "Less information in some direction, as a share of the most: no loop.", "",
              {0.0, 1.0});
  section.add(PLLIT_KEY(sigma_m), "Least uncertainty of a loop, one sigma.", "m", {0.001, 10.0});
  section.add(PLLIT_KEY(sigma_deg), "Least uncertainty of a loop, one sigma.", "deg", {0.001, 10.0});
}

void list(Section section, ConsistencyConfig& config) {
  section.add(PLLIT_KEY(max_squared), "Squared error, in sigmas, with which two loops still agree.", "", {1.0, 1000.0});
  section.add(PLLIT_KEY(agreeing), "Loops that must agree where the odometry allows them.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(agreeing_against), "Loops that must agree where it does not.", "", {1.0, 100.0});
  section.add(PLLIT_KEY(window_m), "Way within which they are looked for.", "m", {1.0, 1000.0});
}

}  // namespace

void list_loop(Section section, LoopConfig& config) {
  section.add(PLLIT_KEY(gravity_sigma_deg), "How well a keyframe knows the vertical, one sigma.", "deg", {0.01, 10.0});
  list(section.section("keyframes", "What is kept of the way."), config.keyframes);
  list(section.section("candidates", "Which earlier places are looked at."), config.candidates);
  list(section.section("registration", "When two places are taken to be the same."), config.registration);
  list(section.section("consistency", "When loops are believed."), config.consistency);
}

}  // namespace pllit
