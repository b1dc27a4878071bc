#include "pllit/slam/relocalisation.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <set>

#include "pllit/loop/descriptor.hpp"
#include "pllit/loop/registration.hpp"

namespace pllit {
namespace {

/// The surroundings of a point of the way, in a frame that lies there and is turned like the world.
struct Place {
  Vector3d p_W;
  Submap submap;
  PlaceDescriptor descriptor;

  SE3 T_W_H() const { return pose_from(SO3::Identity(), p_W); }
};

std::vector<Vector3d> along_way(const Trajectory& trajectory, double spacing_m) {
  std::vector<Vector3d> points_W;
  for (const StampedPose& pose : trajectory) {
    const Vector3d p_W = pose.T_W_I.translation();
    if (points_W.empty() || (p_W - points_W.back()).norm() >= spacing_m) points_W.push_back(p_W);
  }
  return points_W;
}

Place place_at(const Vector3d& p_W, const std::vector<Vector3f>& points_W, double range_m) {
  Place place{.p_W = p_W, .submap = {}, .descriptor = {}};
  const Vector3f origin_W = p_W.cast<float>();
  const auto range2_m2 = static_cast<float>(range_m * range_m);
  for (const Vector3f& point_W : points_W)
    if (const Vector3f p_H = point_W - origin_W; p_H.squaredNorm() < range2_m2) place.submap.points_H.push_back(p_H);
  place.submap.columns = columns_of(place.submap.points_H);
  place.descriptor = describe(place.submap.columns);
  return place;
}

std::vector<Place> places_of(const VisitMap& visit, const RelocalisationConfig& config) {
  std::vector<Place> places;
  for (const Vector3d& p_W : along_way(visit.trajectory, config.spacing_m))
    places.push_back(place_at(p_W, visit.points_W, config.range_m));
  return places;
}

/// One place of b laid on one of a.
struct Guess {
  const Place* place = nullptr;  ///< of b
  SE3 T_A_B;
  double overlap = 0.0;

  Vector3d p_A() const { return T_A_B.act(place->p_W); }
};

void add_guesses(const Place& here, const std::vector<Place>& places, const RelocalisationConfig& config,
                 std::vector<Guess>& guesses) {
  std::vector<std::pair<HeadingMatch, const Place*>> alike;
  for (const Place& place : places) alike.emplace_back(align(place.descriptor, here.descriptor), &place);
  std::ranges::stable_sort(alike, std::greater{}, [](const auto& match) { return match.first.score; });
  alike.resize(std::min<std::size_t>(alike.size(), static_cast<std::size_t>(config.tried)));
  for (const auto& [match, there] : alike) {
    const SearchWindow window{
        .centre = {.t_m = Eigen::Vector2d::Zero(), .yaw_rad = match.yaw_rad}, .reach_m = 6.0, .reach_rad = 0.2};
    const Registration found = register_submaps(there->submap, here.submap, window, config.registration);
    if (!refusal(found, config.registration).empty()) continue;
    const SE3 T_A_B = there->T_W_H() * found.T_a_b * here.T_W_H().inverse();
    guesses.push_back({&here, T_A_B, found.overlap});
  }
}

/// Guesses that take the place of one to nearly where it takes it, turned alike.
std::vector<const Guess*> agreeing_with(const Guess& one, const std::vector<Guess>& guesses,
                                        const RelocalisationConfig& config) {
  std::vector<const Guess*> agreeing;
  for (const Guess& other : guesses) {
    const double turn_rad = log_so3(one.T_A_B.asSO3().inverse() * other.T_A_B.asSO3()).norm();
    const double apart_m = (other.T_A_B.act(one.place->p_W) - one.p_A()).norm();
    if (apart_m < config.agree_m && turn_rad < config.agree_deg * M_PI / 180.0) agreeing.push_back(&other);
  }
  return agreeing;
}

/// One place that fits to several neighbours of a says it once.
int places_among(const std::vector<const Guess*>& guesses) {
  std::set<const Place*> places;
  for (const Guess* guess : guesses) places.insert(guess->place);
  return static_cast<int>(places.size());
}

/// All points of b on all of a, from a guess; frames with their origins at b's middle, so that turns have short levers.
Relocalisation refined(const VisitMap& a, const VisitMap& b, const SE3& T_A_B, const RelocalisationConfig& config) {
  Vector3d middle_B = Vector3d::Zero();
  for (const StampedPose& pose : b.trajectory) middle_B += pose.T_W_I.translation() / double(b.trajectory.size());
  const double reach_m = 60.0;
  const Place on = place_at(T_A_B.act(middle_B), a.points_W, reach_m), laid = place_at(middle_B, b.points_W, reach_m);
  const SE3 guess = on.T_W_H().inverse() * T_A_B * laid.T_W_H();
  const Registration found = refine(on.submap, laid.submap, guess, config.registration);
  return {.T_A_B = on.T_W_H() * found.T_a_b * laid.T_W_H().inverse(), .overlap = found.overlap, .rmse_m = found.rmse_m};
}

}  // namespace

Expected<Relocalisation> relocalise(const VisitMap& whole_a, const VisitMap& whole_b,
                                    const RelocalisationConfig& config) {
  for (const VisitMap* visit : {&whole_a, &whole_b})
    if (visit->trajectory.empty() || visit->points_W.empty())
      return input_error("a visit has no trajectory or an empty map; it cannot be compared");
  const auto thin = [&](const VisitMap& visit) {
    return VisitMap{visit.trajectory, thinned(visit.points_W, config.voxel_m)};
  };
  const VisitMap a = thin(whole_a), b = thin(whole_b);
  const std::vector<Place> places_a = places_of(a, config), places_b = places_of(b, config);
  std::vector<Guess> guesses;
  const std::size_t step = 1 + places_b.size() / static_cast<std::size_t>(config.most_places);
  int places = 0;
  for (std::size_t i = 0; i < places_b.size(); i += step, ++places) add_guesses(places_b[i], places_a, config, guesses);
  std::vector<const Guess*> best;
  int most = 0;
  for (const Guess& guess : guesses)
    if (auto agreeing = agreeing_with(guess, guesses, config); places_among(agreeing) > most) {
      best = std::move(agreeing);
      most = places_among(best);
    }
  if (most < std::max(1, std::min(config.agreeing, places)))
    return input_error(
        std::format("the visits share no place that could be recognised: of {} places of the second, at most {} agree "
                    "on where it lies in the first; are they of the same site?",
                    places, most));
  const Guess* widest = *std::ranges::max_element(best, {}, &Guess::overlap);
  Relocalisation result = refined(a, b, widest->T_A_B, config);
  result.places = places;
  result.agreeing = most;
  return result;
}

}  // namespace pllit
