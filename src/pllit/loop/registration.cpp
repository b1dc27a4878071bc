#include "pllit/loop/registration.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <format>

namespace pllit {
namespace {

constexpr std::size_t matched_points = 2500;  // more add nothing but time
constexpr std::size_t searched_columns = 400;
constexpr double overlap_radius_m = 20.0;  // what is farther away may be seen from one of two neighbouring places only

std::optional<PlaneGrid::Plane> fitted(const Vector3f& sum, const Eigen::Matrix3f& products, float count,
                                       double voxel_m) {
  constexpr float least_points = 5.0F, flattest = 0.12F;
  if (count < least_points) return std::nullopt;
  const Vector3f mean = sum / count;
  const Eigen::Matrix3f covariance = products / count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes(covariance);
  const Vector3f variances = axes.eigenvalues().cwiseMax(0.0F);
  if (variances[0] > flattest * variances[1]) return std::nullopt;
  if (std::sqrt(variances[0]) > 0.08F * static_cast<float>(voxel_m)) return std::nullopt;
  return PlaneGrid::Plane{mean, axes.eigenvectors().col(0)};
}

/// Sums over the points that meet a plane; the perturbation of T_a_b is (theta, p) on the right.
struct Sums {
  Matrix6 H = Matrix6::Zero();         ///< weighted
  Matrix6 geometry = Matrix6::Zero();  ///< unweighted
  Vector6 b = Vector6::Zero();
  double squared_m2 = 0.0, levers_m2 = 0.0;
  int matched = 0;
};

Sums linearised(const PlaneGrid& planes, const std::vector<Vector3f>& points_b, const SE3& T_a_b, double scale_m) {
  const Matrix3d R = T_a_b.rotation();
  const Vector3d t = T_a_b.translation();
  Sums sums;
  for (const Vector3f& point : points_b) {
    const Vector3d p_b = point.cast<double>();
    const Vector3d p_a = R * p_b + t;
    const PlaneGrid::Plane* plane = planes.find(p_a.cast<float>());
    if (!plane) continue;
    const Vector3d normal_b = R.transpose() * plane->normal.cast<double>();
    const double residual = plane->normal.cast<double>().dot(p_a - plane->centroid.cast<double>());
    Vector6 J;  // d residual / d (theta, p)
    J << p_b.cross(normal_b), normal_b;
    const double weight = 1.0 / (1.0 + residual * residual / (scale_m * scale_m));  // Cauchy
    sums.H += weight * J * J.transpose();
    sums.geometry += J * J.transpose();
    sums.b -= weight * residual * J;
    sums.squared_m2 += residual * residual;
    sums.levers_m2 += p_b.squaredNorm();
    ++sums.matched;
  }
  return sums;
}

double rmse_m(const Sums& sums) { return std::sqrt(sums.squared_m2 / sums.matched); }

struct Fit {
  SE3 T_a_b;
  Sums sums;
};

Fit iterated(const PlaneGrid& planes, const std::vector<Vector3f>& points_b, SE3 T_a_b, double scale_m,
             int iterations) {
  Sums sums;
  for (int i = 0; i < iterations; ++i) {
    sums = linearised(planes, points_b, T_a_b, scale_m);
    if (sums.matched < 20) break;
    const Matrix6 damped = sums.H + 1e-3 * sums.matched * Matrix6::Identity();
    const Vector6 step = damped.ldlt().solve(sums.b);
    T_a_b = T_a_b * pose_from(exp_so3(step.head<3>()), step.tail<3>());
    if (step.head<3>().norm() < 1e-4 && step.tail<3>().norm() < 1e-3) break;
  }
  return {T_a_b, linearised(planes, points_b, T_a_b, scale_m)};
}

/// The least information over all directions, turns measured by what they move at the mean lever, as a share of what
/// every plane facing that direction would give.
double weakest_information(const Sums& sums) {
  const double lever_m = std::sqrt(sums.levers_m2 / sums.matched);
  Vector6 scale = Vector6::Ones();
  scale.head<3>().setConstant(1.0 / lever_m);
  const Matrix6 scaled = scale.asDiagonal() * sums.geometry * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix6>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[0] / sums.matched;
}

Matrix6 covariance_of(const Sums& sums, double rmse_m, const RegistrationConfig& config) {
  constexpr double independent_points = 60.0;  // errors of neighbouring points are alike
  Matrix6 covariance = rmse_m * rmse_m * sums.matched / independent_points *
                       (sums.geometry + 1e-9 * sums.matched * Matrix6::Identity()).inverse();
  const double sigma_rad = config.sigma_deg * M_PI / 180.0;
  covariance.diagonal().head<3>().array() += sigma_rad * sigma_rad;
  covariance.diagonal().tail<3>().array() += config.sigma_m * config.sigma_m;
  return covariance;
}

Registration refined(const Submap& a, const ColumnField& field, const Submap& b, const SE3& guess,
                     const RegistrationConfig& config) {
  const std::vector<Vector3f> points_b = evenly(b.points_H, matched_points);
  const Fit coarse =
      iterated(PlaneGrid(a.points_H, config.coarse_m), points_b, guess, 0.3 * config.coarse_m, config.iterations);
  const PlaneGrid planes(a.points_H, config.fine_m);
  const double scale_m = 0.2 * config.fine_m;
  const Fit fine = iterated(planes, points_b, coarse.T_a_b, scale_m, config.iterations);
  Registration result{.T_a_b = fine.T_a_b};
  if (fine.sums.matched < 20) return result;
  result.overlap = overlap(field, b.columns, in_plane(fine.T_a_b), overlap_radius_m);
  result.matched = static_cast<double>(fine.sums.matched) / static_cast<double>(points_b.size());
  result.rmse_m = rmse_m(fine.sums);
  result.own_rmse_m = rmse_m(linearised(planes, evenly(a.points_H, matched_points), SE3::Identity(), scale_m));
  result.information = weakest_information(fine.sums);
  result.covariance = covariance_of(fine.sums, result.rmse_m, config);
  return result;
}

}  // namespace

PlaneGrid::PlaneGrid(const std::vector<Vector3f>& points, double match_m) : match_m_(match_m) {
  struct Moments {
    Vector3f sum = Vector3f::Zero();
    Eigen::Matrix3f products = Eigen::Matrix3f::Zero();
    float count = 0.0F;
  };
  const double voxel_m = 2.0 * match_m;
  VoxelTable<Moments> moments;
  for (const Vector3f& p : points) {
    const Eigen::Vector3i voxel = voxel_of(p, 1.0 / voxel_m);
    Moments& cell = *moments.insert(voxel_key(voxel)).first;
    const Vector3f from_centre = p - static_cast<float>(voxel_m) * (voxel.cast<float>() + Vector3f::Constant(0.5F));
    cell.sum += from_centre;
    cell.products += from_centre * from_centre.transpose();
    cell.count += 1.0F;
  }
  moments.for_each([&](VoxelKey key, const Moments& cell) {
    auto plane = fitted(cell.sum, cell.products, cell.count, voxel_m);
    if (!plane) return;
    plane->centroid += static_cast<float>(voxel_m) * (voxel_of_key(key).cast<float>() + Vector3f::Constant(0.5F));
    *planes_.insert(key).first = *plane;
  });
}

const PlaneGrid::Plane* PlaneGrid::find(const Vector3f& p) const {
  const double voxel_m = 2.0 * match_m_;
  // The voxel whose lower corner's surroundings p is nearest to: its own and its neighbours on p's side.
  const Eigen::Vector3i corner =
      voxel_of(Vector3f(p - Vector3f::Constant(static_cast<float>(match_m_))), 1.0 / voxel_m);
  const Plane* nearest = nullptr;
  float nearest2_m2 = static_cast<float>(voxel_m * voxel_m);
  for (int n = 0; n < 8; ++n) {
    const Plane* plane = planes_.find(voxel_key(corner + Eigen::Vector3i(n & 1, n >> 1 & 1, n >> 2)));
    if (!plane) continue;
    const Vector3f difference = p - plane->centroid;
    if (std::abs(plane->normal.dot(difference)) > static_cast<float>(match_m_)) continue;
    if (const float distance2_m2 = difference.squaredNorm(); distance2_m2 < nearest2_m2) {
      nearest2_m2 = distance2_m2;
      nearest = plane;
    }
  }
  return nearest;
}

Registration register_submaps(const Submap& a, const Submap& b, const SearchWindow& window,
                              const RegistrationConfig& config) {
  const ColumnField field(a.columns);
  const ColumnMatch match = search(field, evenly(b.columns, searched_columns), window);
  const SE3 guess = pose_from(exp_so3(Vector3d(0.0, 0.0, match.T_a_b.yaw_rad)),
                              Vector3d(match.T_a_b.t_m.x(), match.T_a_b.t_m.y(), 0.0));
  Registration result = refined(a, field, b, guess, config);
  result.columns = match;
  return result;
}

std::string refusal(const Registration& registration, const RegistrationConfig& config) {
  constexpr double least_score = 0.3, clutter = 0.3;  // of the matching distance: points anywhere come to 0.4
  const double max_rmse_m =
      std::max(config.max_rmse_m, std::min(config.max_rmse_of_own * registration.own_rmse_m, clutter * config.fine_m));
  if (registration.columns.score < least_score) return "the places do not look alike";
  if (registration.overlap < config.min_overlap) return std::format("overlap {:.2f}", registration.overlap);
  if (registration.rmse_m > max_rmse_m)
    return std::format("rmse {:.3f} m of at most {:.3f} m", registration.rmse_m, max_rmse_m);
  if (registration.information < config.min_information)
    return std::format("degenerate: {:.4f} of full information", registration.information);
  return "";
}

Registration refine(const Submap& a, const Submap& b, const SE3& T_a_b, const RegistrationConfig& config) {
  return refined(a, ColumnField(a.columns), b, T_a_b, config);
}

}  // namespace pllit
