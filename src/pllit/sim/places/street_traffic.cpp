#include "pllit/sim/places/street_traffic.hpp"

#include <algorithm>

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kOffLane_m = 1.6;
constexpr double kCarHalf_m = 2.35;  // of its length: on a bend it swings out

struct Mover {
  double aside_m;       ///< to the left of the line
  double half_m;        ///< of its body
  double above_m;       ///< of what it moves on
  std::size_t longest;  ///< stations to and fro
};

/// A stretch that is free all along, or nothing.
std::vector<Vector3d> stretch(const Mover& mover, const Site& site, const StreetLine& line, const Ground& ground,
                              Random& random) {
  const auto& stations = line.stations();
  const auto start = static_cast<std::size_t>(random.uniform() * static_cast<double>(stations.size()));
  const auto street = std::ranges::find_if(
      line.streets(), [&](const StreetLine::Piece& s) { return start >= s.first && start <= s.last; });
  std::vector<Vector3d> way;
  for (std::size_t i = start; i <= street->last && way.size() < mover.longest; ++i) {
    const Vector2d p = stations[i].p + mover.aside_m * stations[i].left;
    const double needed_m = kOffLane_m + mover.half_m;
    if (site.path_P.nearest(p, needed_m).distance_m < needed_m) break;
    way.emplace_back(p.x(), p.y(), ground.z(p) + mover.above_m);
  }
  return way;
}

}  // namespace

std::vector<Actor> street_traffic(const PlaceConfig& config, const Site& site, const StreetLine& line,
                                  const Ground& ground) {
  Random random(config.seed, 72);
  std::vector<Actor> actors;
  const auto add = [&](int wanted, const Mover& mover, std::size_t shortest, double speed_mps, const auto& body,
                       const char* name) {
    int count = 0;
    for (int attempt = 0; attempt < 60 * wanted && count < wanted; ++attempt) {
      Mover chosen = mover;
      if (mover.aside_m > kOffLane_m + 4.0 && random.uniform() < 0.5) chosen.aside_m = -mover.aside_m;
      auto way = stretch(chosen, site, line, ground, random);
      if (way.size() < shortest) continue;
      std::ranges::reverse(way);  // against the path
      actors.push_back(pacing(name, body(random), way, speed_mps * random.uniform(0.8, 1.2), random.uniform(),
                              config.duration_s, site.T_W_P));
      ++count;
    }
  };
  add(config.cars, {3.95, kCarHalf_m, 0.01, 250}, 40, 8.0, [](Random& r) { return shapes::car(r); }, "car");
  add(config.people, {7.7, 0.35, 0.12, 60}, 10, 1.3, [](Random& r) { return shapes::person(r); }, "person");
  return actors;
}

}  // namespace pllit
