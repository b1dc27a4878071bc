// From what a pulse meets to the one return that a LiDAR reports.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "pllit/sim/world/lidar_models.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// Light that comes back from one distance.
struct Echo {
  double range_m = 0.0;
  double brightness = 0.0;  ///< reflectivity times cosine of incidence, times the share of the pulse that got there
};

/// The echoes of one pulse. A pulse is up to five rays, and each may find a surface and something mirrored in it.
class Echoes {
 public:
  /// Adds what a ray with a share of the pulse's power finds. A mirroring surface scatters little itself; what it
  /// mirrors appears behind it along the beam, weaker by the mirror's share on the way there and back, and where it
  /// faces the beam (within half a degree) it dazzles.
  void add(const RayCaster& caster, std::span<const Surface> surfaces, const Ray& ray, const Hit& hit, double share);

  bool empty() const { return count_ == 0; }

  /// The return that is reported, if any. Echoes nearer each other than half a pulse's length merge at their power's
  /// centre, which puts points between the surfaces at an edge; of those that are farther apart, the lidar takes the
  /// first or the strongest that it detects. Power falls with the square of the range; `luck` (standard normal) decides
  /// near the limit of detection.
  std::optional<Echo> reported(const RayLidar& lidar, double luck);

 private:
  void add(const Echo& echo) { echoes_[count_++] = echo; }

  std::array<Echo, 10> echoes_;
  std::size_t count_ = 0;
};

}  // namespace pllit
