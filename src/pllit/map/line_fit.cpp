#include "pllit/map/line_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace pllit {

namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Matrix3x2 = Eigen::Matrix<double, 3, 2>;

struct WorldPoint {
  Vector3d p_W, ray_W, slide_W;
  double ray_m2, across_m2;  ///< variances
  std::size_t sighting;
  bool on_line = true;
};

std::vector<WorldPoint> in_world(std::span<const LineSighting> sightings) {
  std::vector<WorldPoint> points;
  for (std::size_t s = 0; s < sightings.size(); ++s)
    for (const EdgePoint& point : sightings[s].points) {
      const Matrix3d R_W_C = sightings[s].T_W_C.rotation();
      points.push_back({.p_W = R_W_C * point.p_C + sightings[s].T_W_C.translation(),
                        .ray_W = R_W_C * point.p_C.normalized(),
                        .slide_W = R_W_C * point.slide_C_m,
                        .ray_m2 = point.sigma_ray_m * point.sigma_ray_m,
                        .across_m2 = point.sigma_across_m * point.sigma_across_m,
                        .sighting = s});
    }
  return points;
}

/// Two unit vectors that with d make a right-handed frame.
Matrix3x2 across(const Vector3d& d) {
  Matrix3x2 axes;
  axes.col(0) = d.unitOrthogonal();
  axes.col(1) = d.cross(axes.col(0));
  return axes;
}

/// Covariance of a point across a line, but for what it shares with the others of its sighting.
Matrix2d noise_across(const WorldPoint& point, const Matrix3x2& axes, double common_m2) {
  const Vector2d ray = axes.transpose() * point.ray_W;
  return (point.across_m2 + common_m2) * Matrix2d::Identity() +
         (point.ray_m2 - point.across_m2) * ray * ray.transpose();
}

/// Squared distance of a point from a line in its own standard deviations.
double squared_distance(const WorldPoint& point, const Vector3d& on_line_W, const Matrix3x2& axes, double common_m2) {
  const Vector2d off = axes.transpose() * (point.p_W - on_line_W), slide = axes.transpose() * point.slide_W;
  return off.dot((noise_across(point, axes, common_m2) + slide * slide.transpose()).inverse() * off);
}

int mark_inliers(std::vector<WorldPoint>& points, const Vector3d& on_line_W, const Vector3d& d,
                 const LineFitConfig& config) {
  const Matrix3x2 axes = across(d);
  const double common_m2 = config.common_sigma_m * config.common_sigma_m;
  int inliers = 0;
  for (WorldPoint& point : points) {
    point.on_line = squared_distance(point, on_line_W, axes, common_m2) <= config.gate * config.gate;
    inliers += point.on_line ? 1 : 0;
  }
  return inliers;
}

/// Marks the inliers of the pair of points that most others agree with (Fischler and Bolles 1981), and counts them.
int agree_on_line(std::vector<WorldPoint>& points, const LineFitConfig& config) {
  constexpr int trials = 40;
  std::mt19937 engine(static_cast<unsigned>(points.size()));  // the same trials for the same points
  int best = 0;
  std::pair<Vector3d, Vector3d> best_line;
  for (int trial = 0; trial < trials; ++trial) {
    const Vector3d a = points[engine() % points.size()].p_W, b = points[engine() % points.size()].p_W;
    if ((b - a).norm() < 0.5 * config.min_length_m) continue;
    const Vector3d d = (b - a).normalized();
    if (const int inliers = mark_inliers(points, a, d, config); inliers > best) {
      best = inliers;
      best_line = {a, d};
    }
  }
  return best > 0 ? mark_inliers(points, best_line.first, best_line.second, config) : 0;
}

/// Centroid, direction and variances of the inliers by principal components, each by its own noise.
struct Axis {
  Vector3d centre_W, direction, variances_m2;
};
Axis principal_axis(std::span<const WorldPoint> points) {
  Axis axis{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::Zero()};
  Matrix3d squares = Matrix3d::Zero();
  double weights = 0.0;
  const Vector3d origin = points.front().p_W;
  for (const WorldPoint& point : points) {
    if (!point.on_line) continue;
    const double weight = 1.0 / (point.ray_m2 + 2.0 * point.across_m2 + point.slide_W.squaredNorm());
    axis.centre_W += weight * (point.p_W - origin);
    squares += weight * (point.p_W - origin) * (point.p_W - origin).transpose();
    weights += weight;
  }
  if (weights == 0.0) return axis;
  axis.centre_W /= weights;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(squares / weights - axis.centre_W * axis.centre_W.transpose());
  axis.centre_W += origin;
  axis.direction = eigen.eigenvectors().col(2);
  axis.variances_m2 = eigen.eigenvalues().cwiseMax(0.0);
  return axis;
}

/// Where the inliers begin and end along the axis, but for the outermost twentieth on each side.
std::pair<double, double> extent(std::span<const WorldPoint> points, const Axis& axis) {
  std::vector<double> along;
  for (const WorldPoint& point : points)
    if (point.on_line) along.push_back((point.p_W - axis.centre_W).dot(axis.direction));
  std::ranges::sort(along);
  const std::size_t cut = along.size() / 20;
  return {along[cut], along[along.size() - 1 - cut]};
}

/// Where along the line, from 0 at its first end to 1 at the other, and how far a point slides across it.
struct Slide {
  double share;
  Vector2d across_m;
};

/// Covariance of the four shifts as one sighting shows them, its points' own noise aside: the two ends of the observed
/// segment err in the image, which moves them over their surface, and what they are off there reaches the line's ends.
Matrix4d shared_covariance(const Slide& first, const Slide& last, double common_m2) {
  const double apart = std::max(last.share - first.share, 1e-2);
  Eigen::Matrix<double, 4, 2> slides;
  slides << first.across_m * last.share / apart, -last.across_m * first.share / apart,
      first.across_m * (last.share - 1.0) / apart, last.across_m * (1.0 - first.share) / apart;
  return common_m2 * Matrix4d::Identity() + slides * slides.transpose();
}

/// What one sighting's points say about the four shifts.
struct Sums {
  Matrix4d H = 1e-2 * Matrix4d::Identity();  // far less than a point tells
  Vector4d b = Vector4d::Zero();
  std::optional<Slide> first, last;
};

/// The weighted step of both ends, with its covariance.
struct Step {
  Vector4d shifts;
  Matrix4d covariance;
};
Step weighted_step(std::span<const WorldPoint> points, const LineLandmark& line, std::size_t sightings,
                   const LineFitConfig& config) {
  Matrix3x2 axes;
  axes << line.u, line.v;
  std::vector<Sums> seen(sightings);
  for (const WorldPoint& point : points) {
    if (!point.on_line) continue;
    const Vector3d from_centre = point.p_W - line.centroid;
    const double share = 0.5 + 0.5 * from_centre.dot(line.axis.direction) / line.half_length_m;
    Eigen::Matrix<double, 2, 4> J;
    J << (1.0 - share) * Matrix2d::Identity(), share * Matrix2d::Identity();
    const Eigen::Matrix<double, 4, 2> JtW = J.transpose() * noise_across(point, axes, 0.0).inverse();
    Sums& sums = seen[point.sighting];
    sums.H += JtW * J;
    sums.b += JtW * (axes.transpose() * from_centre);
    const Slide slide{share, axes.transpose() * point.slide_W};
    if (!sums.first || share < sums.first->share) sums.first = slide;
    if (!sums.last || share > sums.last->share) sums.last = slide;
  }
  // Each sighting as one measurement of the four shifts, its common error on top.
  const double common_m2 = config.common_sigma_m * config.common_sigma_m;
  Matrix4d information = Matrix4d::Zero();
  Vector4d pull = Vector4d::Zero();
  for (const Sums& sums : seen) {
    if (!sums.first) continue;
    const Matrix4d own = sums.H.inverse();
    const Matrix4d weight = (own + shared_covariance(*sums.first, *sums.last, common_m2)).inverse();
    information += weight;
    pull += weight * (own * sums.b);
  }
  const Matrix4d covariance = information.inverse();
  return {covariance * pull, 0.5 * (covariance + covariance.transpose())};
}

LineLandmark landmark(const Vector3d& a_W, const Vector3d& b_W) {
  LineLandmark line;
  line.axis = Line3::through(a_W, b_W - a_W);
  line.centroid = 0.5 * (a_W + b_W);
  line.half_length_m = 0.5 * (b_W - a_W).norm();
  const Matrix3x2 axes = across(line.axis.direction);
  line.u = axes.col(0);
  line.v = axes.col(1);
  return line;
}

}  // namespace

std::optional<LineLandmark> fit_line(std::span<const LineSighting> sightings, const LineFitConfig& config) {
  std::vector<WorldPoint> points = in_world(sightings);
  if (static_cast<int>(points.size()) < config.min_points) return std::nullopt;
  if (agree_on_line(points, config) < config.min_points) return std::nullopt;
  // The axis of all that agree is better than the pair's, and more agree with it.
  const Axis first = principal_axis(points);
  const int inliers = mark_inliers(points, first.centre_W, first.direction, config);
  const double least_inliers =
      std::max<double>(config.min_points, config.min_inliers * static_cast<double>(points.size()));
  if (inliers < least_inliers) return std::nullopt;

  const Axis axis = principal_axis(points);
  const auto [from_m, to_m] = extent(points, axis);
  const double rms_m = std::sqrt(axis.variances_m2[0] + axis.variances_m2[1]);
  if (to_m - from_m < config.min_length_m || rms_m > config.max_rms_m ||
      axis.variances_m2[2] < config.min_linearity * axis.variances_m2[1])
    return std::nullopt;

  LineLandmark line = landmark(axis.centre_W + from_m * axis.direction, axis.centre_W + to_m * axis.direction);
  for (int round = 0; round < 2; ++round) {
    const Step step = weighted_step(points, line, sightings.size(), config);
    const Vector3d half = line.half_length_m * line.axis.direction;
    const Vector3d a_W = line.centroid - half + step.shifts[0] * line.u + step.shifts[1] * line.v;
    const Vector3d b_W = line.centroid + half + step.shifts[2] * line.u + step.shifts[3] * line.v;
    line = landmark(a_W, b_W);
    if (mark_inliers(points, line.centroid, line.axis.direction, config) < least_inliers) return std::nullopt;
  }
  line.covariance_m2 = weighted_step(points, line, sightings.size(), config).covariance;
  return line;
}

LineLandmark with_ends(const LineLandmark& line, double from_m, double to_m) {
  assert(from_m < to_m && line.half_length_m > 0.0);
  LineLandmark result = line;
  result.centroid += 0.5 * (from_m + to_m) * line.axis.direction;
  result.half_length_m = 0.5 * (to_m - from_m);
  Matrix4d J_new_old;
  for (int end = 0; end < 2; ++end) {
    const double share = 0.5 + 0.5 * (end == 0 ? from_m : to_m) / line.half_length_m;
    J_new_old.block<2, 4>(2 * end, 0) << (1.0 - share) * Matrix2d::Identity(), share * Matrix2d::Identity();
  }
  result.covariance_m2 = J_new_old * line.covariance_m2 * J_new_old.transpose();
  return result;
}

}  // namespace pllit
