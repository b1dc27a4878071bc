#include "pllit/sim/world/echoes.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

/// Mirrors below this share are paint's gloss.
constexpr float kMirror = 0.05F;
constexpr double kDazzleCosine = 0.99996, kDazzle = 100.0;
/// Spread of the limit of detection, as a share of the power; at the rated range nine pulses in ten are seen.
constexpr double kLimitSpread = 0.15, kNineInTen = 1.2816;
/// Where a mirrored ray starts, off the mirror.
constexpr double kLiftOff_m = 1e-3;

/// Whether an echo of some power, in units of that at the rated range, is seen.
bool detected(double power, double luck) {
  // Far from the limit luck decides nothing, and exp() costs more than all the rest.
  if (power > 4.0 || power < 0.2) return power > 1.0;
  return power > std::exp(kLimitSpread * (luck - kNineInTen));
}

/// Power of an echo relative to that of a facing surface of reflectivity 1 at 1 m.
double power(const Echo& echo) { return echo.brightness / (echo.range_m * echo.range_m); }

double cosine(const Ray& ray, const Hit& hit) {
  return std::max(0.0, -ray.direction_W.dot(hit.normal_W.cast<double>()));
}

/// The ray that a mirror sends on.
Ray mirrored(const Ray& ray, const Hit& hit) {
  const Vector3d normal_W = hit.normal_W.cast<double>().normalized();
  const Vector3d direction_W = ray.direction_W - 2.0 * ray.direction_W.dot(normal_W) * normal_W;
  const Vector3d p_W = ray.origin_W + static_cast<double>(hit.range_m) * ray.direction_W;
  return {.origin_W = p_W + kLiftOff_m * normal_W, .direction_W = direction_W.normalized()};
}

}  // namespace

void Echoes::add(const RayCaster& caster, std::span<const Surface> surfaces, const Ray& ray, const Hit& hit,
                 double share) {
  if (!hit) return;
  const Surface& surface = surfaces[hit.surface];
  const double facing = cosine(ray, hit), range_m = static_cast<double>(hit.range_m);
  if (surface.mirror < kMirror) return add({.range_m = range_m, .brightness = share * surface.reflectivity * facing});

  const double mirror = static_cast<double>(surface.mirror);
  const double dazzle = facing > kDazzleCosine ? kDazzle * mirror : 0.0;
  add({.range_m = range_m, .brightness = share * ((1.0 - mirror) * surface.reflectivity * facing + dazzle)});
  const Ray onward = mirrored(ray, hit);
  const Hit ghost = caster.cast(onward);
  if (!ghost) return;
  const Surface& seen = surfaces[ghost.surface];
  const double scattered = (1.0 - static_cast<double>(seen.mirror)) * seen.reflectivity * cosine(onward, ghost);
  add({.range_m = range_m + static_cast<double>(ghost.range_m), .brightness = share * mirror * mirror * scattered});
}

std::optional<Echo> Echoes::reported(const RayLidar& lidar, double luck) {
  std::sort(echoes_.begin(), echoes_.begin() + count_,
            [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
  // Of a surface that reflects 10 % at the rated range.
  const double rated = 0.1 / (lidar.range_10_m * lidar.range_10_m);
  std::optional<Echo> best;
  for (std::size_t first = 0, next = 0; first < count_; first = next) {
    Echo merged;
    double sum = 0.0;
    for (; next < count_ && echoes_[next].range_m < echoes_[first].range_m + lidar.pulse_m; ++next) {
      merged.range_m += power(echoes_[next]) * echoes_[next].range_m;
      merged.brightness += echoes_[next].brightness;
      sum += power(echoes_[next]);
    }
    if (lidar.range_10_m > 0.0 ? !detected(sum / rated, luck) : !(sum > 0.0)) continue;
    merged.range_m /= sum;
    if (!best || (lidar.strongest_return && power(merged) > power(*best))) best = merged;
  }
  return best;
}

}  // namespace pllit
