// Ground under a path that goes up and down.
#pragma once

#include <vector>

#include "pllit/sim/places/site.hpp"

namespace pllit {

/// Height of the ground at any place: that of the path less the rig's, averaged with weights that fall with the fourth
/// power of the distance (Shepard's method). One height a place, however often the path passes there.
class Ground {
 public:
  explicit Ground(const Site& site);
  double z(const Eigen::Vector2d& p_P) const;

 private:
  std::vector<Vector3d> support_;
};

/// Places at even distances along a path, with the way's direction, as pieces of street: where the path comes back
/// along a street that it has passed before, nothing is added.
class StreetLine {
 public:
  struct Station {
    Eigen::Vector2d p;
    Eigen::Vector2d left;  ///< unit
  };
  struct Piece {
    std::size_t first,
        last;  ///< stations, both included; the next piece of the same street starts with this one's last
  };
  static constexpr double kStation_m = 1.0;
  static constexpr std::size_t kPiece = 50;  ///< stations a piece

  explicit StreetLine(const Site& site);
  const std::vector<Station>& stations() const { return stations_; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// The piece whose street is nearest, or none within reach_m.
  std::ptrdiff_t owner(const Eigen::Vector2d& p_P, double reach_m) const;
  double distance_m(const Eigen::Vector2d& p_P, double reach_m) const {
    return index_.nearest(p_P, reach_m).distance_m;
  }
  /// Stations without a gap, as [first, last].
  const std::vector<Piece>& streets() const { return streets_; }

 private:
  std::vector<Station> stations_;
  std::vector<Piece> streets_, pieces_;
  PathIndex index_;
};

}  // namespace pllit
