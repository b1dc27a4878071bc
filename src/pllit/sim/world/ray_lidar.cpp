#include "pllit/sim/world/ray_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pllit/sim/random.hpp"
#include "pllit/sim/world/echoes.hpp"
#include "pllit/sim/world/pose_table.hpp"

namespace pllit {
namespace {

/// For how long actors stand still, and how much is cast at once where none moves.
constexpr Duration kStep = std::chrono::milliseconds(5), kLongStep = std::chrono::milliseconds(25);
/// Shots that one thread casts together.
constexpr std::size_t kChunk = 32;
/// How far a neighbour may lie off a surface and still be taken for a part of it.
constexpr float kSameSurface_m = 0.02F, kSameSurfaceShare = 0.002F;
/// Relative error of intensity, uniform within.
constexpr double kIntensityError = 0.05;

/// Cosine of incidence below which a surface stretches pulses no further.
constexpr double kLeastFacing = 0.01;
/// Square of a spread, in widths of the pulse, that is left alone: it moves the edge by half a thousandth of a width.
constexpr double kLeastSpread = 4e-4;

/// Share of the power of each ray at a beam's side, a third of the full divergence off its middle: about a Gaussian's.
constexpr double kSideShare = 0.15, kSideAngle = 1.0 / 3.0;

/// Shots that are cast together, their rays line by line: rays of one line in a row are neighbours.
struct Batch {
  std::size_t shots = 0;
  std::vector<Beam> beams;
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<Vector3d> points_W;  ///< where there is a hit

  void resize(std::size_t shot_count, std::size_t lasers) {
    shots = shot_count;
    beams.resize(shots * lasers);
    rays.resize(shots * lasers);
    hits.resize(shots * lasers);
    points_W.resize(shots * lasers);
  }
};

/// A pulse that neighbours on other surfaces, and to which sides.
struct Split {
  std::size_t pulse = 0;
  bool sideways = false, upwards = false;
};

struct Point {
  Vector3f p_L;
  float intensity;
};

/// Two unit vectors across a beam: to its left, level in L, and upwards.
struct Across {
  explicit Across(const Vector3d& direction_L)
      : left_L(Vector3d(-direction_L.y(), direction_L.x(), 0.0).normalized()), up_L(direction_L.cross(left_L)) {}
  Vector3d left_L, up_L;
};

/// Whether each of two hits lies on the plane through the other.
bool same_surface(const Batch& batch, std::size_t i, std::size_t j) {
  const Hit &hit = batch.hits[i], &other = batch.hits[j];
  if (!hit || !other) return !hit && !other;
  const Vector3f between_W = (batch.points_W[j] - batch.points_W[i]).cast<float>();
  const float off_m = std::max(std::abs(between_W.dot(hit.normal_W)), std::abs(between_W.dot(other.normal_W)));
  return off_m < kSameSurface_m + kSameSurfaceShare * std::min(hit.range_m, other.range_m);
}

/// One scan under way.
class Scanner {
 public:
  Scanner(const RayLidar& lidar, const LidarRun& run, std::int64_t index)
      : lidar_(lidar),
        run_(run),
        surfaces_(run.place.surfaces()),
        index_(index),
        start_(run.start + index * lidar.pattern.scan_period),
        seed_(Random(run.seed, static_cast<std::uint64_t>(index)).bits()),
        poses_(run.T_W_L, start_, start_ + lidar.pattern.scan_period + lidar.pattern.shot_period),
        order_(by_line(lidar.pattern)) {}

  LidarScan scan(Arena& arena) {
    LidarScan result;
    result.start = start_;
    const BeamPattern& pattern = lidar_.pattern;
    const std::int64_t last = first_shot_of(pattern, index_ + 1),
                       stride = (anything_moves() ? kStep : kLongStep) / pattern.shot_period;
    for (std::int64_t first = first_shot_of(pattern, index_); first < last; first += stride)
      add_step(first, static_cast<std::size_t>(std::min(stride, last - first)), arena, result);
    return result;
  }

 private:
  /// Laser indices by angle, so that neighbours in the list are neighbours in space.
  static std::vector<std::size_t> by_line(const BeamPattern& pattern) {
    std::vector<std::size_t> order(pattern.lasers.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, {}, [&](std::size_t i) { return pattern.lasers[i].angle_rad; });
    return order;
  }

  bool anything_moves() const {
    return std::ranges::any_of(run_.place.actors(), [](const Actor& actor) { return actor.path.size() > 1; });
  }

  void add_step(std::int64_t first, std::size_t shots, Arena& arena, LidarScan& result) {
    const std::size_t lasers = order_.size();
    const Time middle = run_.start + (first * 2 + static_cast<std::int64_t>(shots)) * lidar_.pattern.shot_period / 2;
    run_.caster.move_to(run_.T_W_L(middle).translation(), to_seconds(middle - run_.start));
    batch_.resize(shots, lasers);
    points_.assign(shots * lasers, std::nullopt);
    arena.for_chunks(shots, kChunk, [&](std::size_t begin, std::size_t end) { cast(first, begin, end); });
    arena.for_chunks(shots, kChunk, [&](std::size_t begin, std::size_t end) { measure(first, begin, end); });
    std::vector<std::size_t> row_of(lasers);
    for (std::size_t row = 0; row < lasers; ++row) row_of[order_[row]] = row;
    for (std::size_t shot = 0; shot < shots; ++shot)
      for (const std::size_t row : row_of) {
        const std::size_t i = row * shots + shot;
        if (!points_[i]) continue;
        result.points_L.push_back(points_[i]->p_L);
        result.offsets.push_back(batch_.beams[i].offset);
        result.intensity.push_back(points_[i]->intensity);
        result.rings.push_back(batch_.beams[i].line);
      }
  }

  /// Random numbers of one pulse: stage 0 where it points, 1 what becomes of it.
  Random random(std::int64_t shot, std::size_t laser, int stage) const {
    const auto pulse = static_cast<std::uint64_t>(shot) * lidar_.pattern.lasers.size() + laser;
    return Random(seed_, 2 * pulse + static_cast<std::uint64_t>(stage));
  }

  void cast(std::int64_t first, std::size_t begin, std::size_t end) {
    for (std::size_t shot = begin; shot < end; ++shot) {
      const std::int64_t number = first + static_cast<std::int64_t>(shot);
      const std::vector<Beam> beams = beams_of(lidar_.pattern, index_, number);
      for (std::size_t row = 0; row < order_.size(); ++row) {
        const Beam& beam = batch_.beams[row * batch_.shots + shot] = beams[order_[row]];
        batch_.rays[row * batch_.shots + shot] = sent(beam, random(number, order_[row], 0));
      }
    }
    for (std::size_t row = 0; row < order_.size(); ++row) {
      const std::size_t offset = row * batch_.shots + begin, count = end - begin;
      run_.caster.cast(std::span(batch_.rays).subspan(offset, count), std::span(batch_.hits).subspan(offset, count));
      for (std::size_t i = offset; i < offset + count; ++i) {
        const Ray& ray = batch_.rays[i];
        batch_.points_W[i] = ray.origin_W + static_cast<double>(batch_.hits[i].range_m) * ray.direction_W;
      }
    }
  }

  /// The ray that a beam really is.
  Ray sent(const Beam& beam, Random noise) const {
    const Across across(beam.direction_L);
    const Eigen::Vector2d own = lidar_.unit.aside_rad(beam);
    const double left = own.x() + lidar_.beam_sigma_rad * quick_gaussian(noise),
                 up = own.y() + lidar_.beam_sigma_rad * quick_gaussian(noise);
    return ray(beam, beam.direction_L + left * across.left_L + up * across.up_L);
  }

  Ray ray(const Beam& beam, const Vector3d& direction_L) const {
    const PoseTable::Placed placed = poses_.place(start_ + beam.offset, direction_L);
    return {.origin_W = placed.p_W, .direction_W = placed.direction_W};
  }

  void measure(std::int64_t first, std::size_t begin, std::size_t end) {
    const std::vector<Split> splits = lidar_.divergence_left_rad > 0.0 ? at_edges(begin, end) : std::vector<Split>();
    std::vector<Ray> aside;
    auto split = splits.begin();
    for (std::size_t row = 0; row < order_.size(); ++row)
      for (std::size_t shot = begin; shot < end; ++shot) {
        const std::size_t i = row * batch_.shots + shot;
        aside.clear();
        if (split != splits.end() && split->pulse == i) add_side_rays(*split++, aside);
        Echoes echoes;
        const double middle_share = 1.0 - kSideShare * static_cast<double>(aside.size());
        echoes.add(run_.caster, surfaces_, batch_.rays[i], batch_.hits[i], middle_share);
        for (const Ray& ray : aside) echoes.add(run_.caster, surfaces_, ray, run_.caster.cast(ray), kSideShare);
        if (echoes.empty()) continue;
        const double offset_m = lidar_.unit.offset_m(batch_.beams[i]) - (aside.empty() ? slant_m(i) : 0.0);
        points_[i] =
            point(batch_.beams[i], echoes, offset_m, random(first + static_cast<std::int64_t>(shot), order_[row], 1));
      }
  }

  /// By how much a pulse on one surface is measured too near. Beams are taken to be broad along the horizon and upright
  /// as in the LiDAR held level.
  double slant_m(std::size_t pulse) const {
    const Hit& hit = batch_.hits[pulse];
    if (!hit || lidar_.unit.leading_edge <= 0.0) return 0.0;
    const Vector3d &direction_W = batch_.rays[pulse].direction_W, normal_W = hit.normal_W.cast<double>();
    const double facing = -direction_W.dot(normal_W);
    // The full angle at 1/e2 of the power is four standard deviations of it.
    const double stretch_m = 0.25 * hit.range_m / std::max(facing, kLeastFacing);
    const double most_m = stretch_m * std::max(lidar_.divergence_left_rad, lidar_.divergence_up_rad);
    if (most_m * most_m * (1.0 - facing * facing) < kLeastSpread * lidar_.pulse_m * lidar_.pulse_m) return 0.0;
    const Vector3d slope_W = normal_W + facing * direction_W, up_W = Across(direction_W).up_L;
    const double up = lidar_.divergence_up_rad * slope_W.dot(up_W),
                 left2 = std::max(0.0, slope_W.squaredNorm() - slope_W.dot(up_W) * slope_W.dot(up_W));
    const double divergence2 = up * up + left2 * lidar_.divergence_left_rad * lidar_.divergence_left_rad;
    return slant_bias_m(lidar_.unit.leading_edge, lidar_.pulse_m, stretch_m * std::sqrt(divergence2));
  }

  /// Pulses, ascending, some of whose neighbours, before and after them or on the lines beside them, lie on other
  /// surfaces.
  std::vector<Split> at_edges(std::size_t begin, std::size_t end) const {
    const std::size_t shots = batch_.shots, rows = order_.size(), width = end - begin;
    std::vector<Split> pulses(rows * width);
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t shot = begin; shot < end; ++shot) {
        const std::size_t i = row * shots + shot, own = row * width + shot - begin;
        pulses[own].pulse = i;
        if (shot == begin && shot > 0 && !same_surface(batch_, i - 1, i)) pulses[own].sideways = true;
        if (shot + 1 < shots && !same_surface(batch_, i, i + 1)) {
          pulses[own].sideways = true;
          if (shot + 1 < end) pulses[own + 1].sideways = true;
        }
        if (row + 1 < rows && !same_surface(batch_, i, i + shots))
          pulses[own].upwards = pulses[own + width].upwards = true;
      }
    std::erase_if(pulses, [](const Split& split) { return !split.sideways && !split.upwards; });
    return pulses;
  }

  /// offset_m: by which the unit's ranges are wrong there.
  std::optional<Point> point(const Beam& beam, Echoes& echoes, double offset_m, Random random) const {
    const double luck = quick_gaussian(random), range_error = quick_gaussian(random),
                 intensity_error = random.uniform(-1.0, 1.0);
    const std::optional<Echo> echo = echoes.reported(lidar_, luck);
    if (!echo) return std::nullopt;
    double range_m = echo->range_m + offset_m + lidar_.range_sigma_m * range_error;
    if (lidar_.range_step_m > 0.0) range_m = lidar_.range_step_m * std::round(range_m / lidar_.range_step_m);
    if (range_m <= 0.0 || range_m < lidar_.min_range_m || range_m > lidar_.max_range_m) return std::nullopt;
    const double brightness = echo->brightness * (1.0 + kIntensityError * intensity_error);
    const double counts = std::clamp(std::round(static_cast<double>(lidar_.counts_at_white) * brightness), 0.0, 255.0);
    return Point{.p_L = (range_m * beam.direction_L).cast<float>(), .intensity = static_cast<float>(counts)};
  }

  void add_side_rays(const Split& split, std::vector<Ray>& rays) const {
    const Beam& beam = batch_.beams[split.pulse];
    const Ray& middle = batch_.rays[split.pulse];
    const Across across(beam.direction_L);
    const auto add_pair = [&](const Vector3d& aside_L, double divergence_rad) {
      const Vector3d aside_W = kSideAngle * divergence_rad * ray(beam, aside_L).direction_W;
      for (const double sign : {1.0, -1.0})
        rays.push_back(
            {.origin_W = middle.origin_W, .direction_W = (middle.direction_W + sign * aside_W).normalized()});
    };
    if (split.sideways) add_pair(across.left_L, lidar_.divergence_left_rad);
    if (split.upwards) add_pair(across.up_L, lidar_.divergence_up_rad);
  }

  const RayLidar& lidar_;
  const LidarRun& run_;
  const std::vector<Surface>& surfaces_;
  std::int64_t index_;
  Time start_;
  std::uint64_t seed_;
  PoseTable poses_;
  std::vector<std::size_t> order_;  ///< laser of each row of the batch
  Batch batch_;
  std::vector<std::optional<Point>> points_;
};

}  // namespace

LidarScan simulate_scan(const RayLidar& lidar, const LidarRun& run, std::int64_t index, Arena& arena) {
  return Scanner(lidar, run, index).scan(arena);
}

}  // namespace pllit
