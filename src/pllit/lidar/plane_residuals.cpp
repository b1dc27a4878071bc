#include "pllit/lidar/plane_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {

namespace ix = error_index;

namespace {

/// Variance along `normal_W` of a point measured from the LiDAR: range noise along the ray, beam noise across it.
double point_variance_m2(const Vector3d& from_lidar_W, const Vector3d& normal_W, const LidarModel& lidar) {
  const double range2 = from_lidar_W.squaredNorm();
  const double along = normal_W.dot(from_lidar_W);
  const double cos2 = along * along / std::max(range2, 1e-12);
  const double across = lidar.beam_sigma_rad * lidar.beam_sigma_rad * range2;
  return lidar.range_sigma_m * lidar.range_sigma_m * cos2 + across * (1.0 - cos2);
}

struct Loss {
  double weight, cost;
};

/// Huber's loss of a whitened residual.
Loss huber(double whitened, double k) {
  const double size = std::abs(whitened);
  if (k <= 0.0 || size <= k) return {1.0, size * size};
  return {k / size, k * (2.0 * size - k)};
}

}  // namespace

PlaneEquations& PlaneEquations::operator+=(const PlaneEquations& other) {
  sums += other.sums;
  noise_information += other.noise_information;
  weight += other.weight;
  lever2_m2 += other.lever2_m2;
  return *this;
}

PlaneResiduals::PlaneResiduals(const PointCloud& cloud, const PlaneMap& map, const Rig& rig,
                               const Matrix6& search_covariance, const PlaneResidualConfig& config, Arena& arena)
    : cloud_(cloud),
      map_(map),
      rig_(rig),
      search_covariance_(search_covariance),
      config_(config),
      arena_(arena),
      associations_(cloud.points_I.size()) {}

PlaneEquations PlaneResiduals::operator()(const NavState& state) {
  constexpr std::size_t chunk = 128;
  PlaneEquations equations =
      arena_.sum_chunks(cloud_.points_I.size(), chunk, PlaneEquations{}, [&](std::size_t begin, std::size_t end) {
        PlaneEquations part;
        for (std::size_t i = begin; i < end; ++i) add_point(i, state, part);
        return part;
      });
  // Thousands of points share the errors of calibration, de-skew and map: together they may claim only so much.
  if (config_.max_information > 0.0 && equations.sums.inliers > config_.max_information) {
    const double share = config_.max_information / equations.sums.inliers;
    equations.sums.H *= share;
    equations.sums.b *= share;
    equations.sums.cost *= share;
    equations.noise_information *= share;
    equations.weight *= share;
    equations.lever2_m2 *= share;
  }
  return equations;
}

void PlaneResiduals::add_point(std::size_t i, const NavState& state, PlaneEquations& equations) {
  const Matrix3d R = state.R_W_I.rotation();
  const Vector3d p_I = cloud_.points_I[i].cast<double>();
  const Vector3d p_W = R * p_I + state.p_W;
  Association& association = associations_[i];
  const PlaneMap::Window window = map_.window_at(p_W);
  if (!association.looked_up || association.window != window)
    association = {.window = window, .looked_up = true, .plane = map_.plane_at(p_W)};
  if (!association.plane) return;
  ++equations.sums.candidates;
  const PlanePatch& plane = *association.plane;
  const Vector3d normal_W = plane.normal_W();
  const double r = plane.distance_m(p_W);

  Vector6 J;  // of r to (theta, p), eq. (7)
  J << p_I.cross(R.transpose() * normal_W), normal_W;

  // The plane's own scatter stands in for the point's noise where the surface is rougher than the sensor.
  const double share = std::max(1.0, plane.points / config_.plane_points);
  const double point =
      std::max(point_variance_m2(R * (p_I - rig_.T_I_L.translation()), normal_W, rig_.lidar), plane.variances_m2[0]);
  const double variance = point + share * plane.height_variance_m2(p_W);
  const double gate_m = config_.gate * std::sqrt(variance + J.dot(search_covariance_ * J));
  if (std::abs(r) > std::min(gate_m, config_.max_distance * plane.voxel_m)) return;

  const Loss loss = huber(r / std::sqrt(variance), config_.huber);
  const double weight = loss.weight / variance;
  equations.sums.H.topLeftCorner<6, 6>().noalias() += weight * J * J.transpose();
  equations.sums.b.head<6>().noalias() -= weight * r * J;
  equations.sums.cost += loss.cost;
  equations.sums.squared_m2 += r * r;
  ++equations.sums.inliers;
  equations.weight += weight;
  equations.lever2_m2 += weight * p_I.squaredNorm();

  Eigen::Matrix<double, 6, 3> J_row_normal;
  J_row_normal << skew(p_I) * R.transpose(), Matrix3d::Identity();
  equations.noise_information.noalias() +=
      weight * share * J_row_normal * plane.normal_covariance() * J_row_normal.transpose();
}

}  // namespace pllit
