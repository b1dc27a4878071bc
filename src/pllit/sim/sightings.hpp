// When a camera first had a chance to see what is to be found, and which part of it it ever saw.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/geometry/voxel_table.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// What a camera saw of an actor.
class Sighting {
 public:
  static constexpr double kPatch_m = 0.02;

  /// Of a point in the actor's frame.
  void add(const Vector3f& p_O, double range_m);
  /// Centroid of the surface that was seen, each patch of it once; nothing where none was.
  std::optional<Vector3d> centroid_O() const;

  std::optional<double> first_s;    ///< first frame with enough unoccluded pixels, since the start
  std::optional<double> nearest_m;  ///< from how near it was seen

 private:
  struct Patch {
    Vector3f sum_m = Vector3f::Zero();
    float points = 0.0F;
  };
  std::map<VoxelKey, Patch> patches_;
};

/// One entry an actor of the place; those that are no findings are never seen.
class Sightings {
 public:
  static constexpr int kPixels = 25;           ///< unoccluded ones that make a sighting
  static constexpr double kFarthest_m = 10.0;  ///< what of it is farther away is not counted

  explicit Sightings(const Place* place) : place_(place), seen_(place ? place->actors().size() : 0) {}

  /// A frame at t_s since the start: findings that are hot by then and fill enough pixels.
  void look(const RayCaster& caster, const Camera& camera, const SE3& T_W_C, double t_s);
  const std::vector<Sighting>& seen() const { return seen_; }

 private:
  const Place* place_;
  std::vector<Sighting> seen_;
};

/// When an actor becomes a finding: as it appears, or with its first heating.
double begins_s(const Actor& actor);
/// From when on it is hot: as it appears, or once its first heating has warmed it by 5 K, or by four fifths where that
/// is less.
double hot_from_s(const Actor& actor);

}  // namespace pllit
