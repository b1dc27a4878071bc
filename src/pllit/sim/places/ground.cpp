#include "pllit/sim/places/ground.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kSupport_m = 2.5;  // between the points that carry the ground
constexpr double kSoft_m = 3.0;     // within which support points count alike
constexpr double kSameStreet_m = 7.0;
constexpr double kParallel = 0.7;    // cosine between ways along the same street, either sense
constexpr std::size_t kReturn = 30;  // stations after which nearness means coming back

/// Every point that is at least spacing_m from the one taken before.
std::vector<Vector3d> thinned(const std::vector<Vector3d>& points, double spacing_m) {
  std::vector<Vector3d> few;
  for (const Vector3d& p : points)
    if (few.empty() || (p - few.back()).head<2>().norm() >= spacing_m) few.push_back(p);
  return few;
}

Vector2d left_at(const std::vector<Vector3d>& way, std::size_t i) {
  const Vector2d along = (way[std::min(i + 2, way.size() - 1)] - way[i >= 2 ? i - 2 : 0]).head<2>();
  return along.norm() > 1e-9 ? Vector2d(Vector2d(-along.y(), along.x()).normalized()) : Vector2d::UnitY();
}

std::vector<Vector3d> positions(const std::vector<StreetLine::Station>& stations) {
  std::vector<Vector3d> points;
  for (const auto& s : stations) points.emplace_back(s.p.x(), s.p.y(), 0.0);
  return points;
}

struct Streets {
  std::vector<StreetLine::Station> stations;
  std::vector<StreetLine::Piece> runs;
};

/// Keeps stations that are not beside an earlier one of a like direction, in runs of two and more.
Streets streets_along(const std::vector<Vector3d>& way) {
  Streets streets;
  bool joined = false;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Vector2d p = way[i].head<2>(), left = left_at(way, i);
    bool again = false;
    for (std::size_t k = 0; k + kReturn < i && !again; ++k)
      again = (way[k].head<2>() - p).norm() < kSameStreet_m && std::abs(left_at(way, k).dot(left)) > kParallel;
    if (!again) {
      if (!joined) streets.runs.push_back({streets.stations.size(), streets.stations.size()});
      streets.runs.back().last = streets.stations.size();
      streets.stations.push_back({p, left});
    }
    joined = !again;
  }
  return streets;
}

}  // namespace

Ground::Ground(const Site& site) : support_(thinned(site.path_P.points(), kSupport_m)) {
  for (Vector3d& p : support_) p.z() -= site.height_m;
}

double Ground::z(const Vector2d& p_P) const {
  double sum = 0.0, weights = 0.0;
  for (const Vector3d& s : support_) {
    const double d2 = (s.head<2>() - p_P).squaredNorm() + kSoft_m * kSoft_m, weight = 1.0 / (d2 * d2);
    sum += weight * s.z();
    weights += weight;
  }
  return sum / weights;
}

StreetLine::StreetLine(const Site& site) : index_({}) {
  Streets streets = streets_along(thinned(site.path_P.points(), kStation_m));
  stations_ = std::move(streets.stations);
  streets_ = std::move(streets.runs);
  for (const Piece& run : streets_)
    for (std::size_t first = run.first; first < run.last || first == run.first; first += kPiece)
      pieces_.push_back({first, std::min(first + kPiece, run.last)});
  index_ = PathIndex(positions(stations_));
}

std::ptrdiff_t StreetLine::owner(const Vector2d& p_P, double reach_m) const {
  const auto [distance_m, station] = index_.nearest(p_P, reach_m);
  if (distance_m >= reach_m) return -1;
  // The last piece that starts at or before the station: a shared station belongs to the later one.
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), station,
                                      [](std::size_t s, const Piece& piece) { return s < piece.first; });
  return after - pieces_.begin() - 1;
}

}  // namespace pllit
