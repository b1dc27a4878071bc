#include "pllit/lidar/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <format>

namespace pllit {

namespace {

/// Pose information of a scan in metres, and how much of it a direction needs.
struct Information {
  Matrix6 H, noise;
  double weight;

  double needed(const Vector6& direction, const DegeneracyConfig& config) const {
    const double share = config.min_share * (direction.tail<3>().squaredNorm() + 0.1 * direction.head<3>().squaredNorm());
    return std::max(config.min_over_noise * direction.dot(noise * direction), share * weight);
  }
  double along(const Vector6& direction) const { return direction.dot(H * direction); }
};

/// Adds what of the direction is new, unless it is nearly within the others.
void add_direction(DegenerateDirections& directions, const Vector6& direction) {
  constexpr double sin_of_same = 0.17;  // within 10 degrees
  const Vector6 beyond = direction - directions * (directions.transpose() * direction);
  if (beyond.norm() < sin_of_same) return;
  directions.conservativeResize(6, directions.cols() + 1);
  directions.col(directions.cols() - 1) = beyond.normalized();
}

DegenerateDirections unobserved_directions(const Information& information,
                                           const Eigen::SelfAdjointEigenSolver<Matrix6>& eigen,
                                           const DegenerateDirections& held, const DegeneracyConfig& config) {
  DegenerateDirections directions(6, 0);
  for (Eigen::Index i = 0; i < held.cols(); ++i)
    if (information.along(held.col(i)) < config.release * information.needed(held.col(i), config))
      add_direction(directions, held.col(i));
  for (int i = 0; i < 6; ++i)
    if (eigen.eigenvalues()[i] < information.needed(eigen.eigenvectors().col(i), config))
      add_direction(directions, eigen.eigenvectors().col(i));
  return directions;
}

}  // namespace

ObservedEquations observed_part(const PlaneEquations& equations, const SO3& R_W_I, const DegenerateDirections& held,
                                const DegeneracyConfig& config) {
  ObservedEquations result{.sums = equations.sums, .localizability = {}};
  if (equations.sums.inliers == 0 || equations.weight <= 0.0) return result;
  // From metres in W to the error state: theta_I = R' theta_W / lever.
  const double lever_m = std::max(1e-3, std::sqrt(equations.lever2_m2 / equations.weight));
  Matrix6 S = Matrix6::Identity(), S_inverse = Matrix6::Identity();
  S.topLeftCorner<3, 3>() = R_W_I.rotation().transpose() / lever_m;
  S_inverse.topLeftCorner<3, 3>() = R_W_I.rotation() * lever_m;

  const Information information{.H = S.transpose() * equations.sums.H.topLeftCorner<6, 6>() * S,
                                .noise = S.transpose() * equations.noise_information * S,
                                .weight = equations.weight};
  const Matrix6& H = information.H;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(H);

  Localizability& report = result.localizability;
  report.axis_share << H.diagonal().tail<3>() / equations.weight, H.diagonal().head<3>() / equations.weight;
  report.weakest_share = eigen.eigenvalues()[0] / equations.weight;
  result.unobserved = unobserved_directions(information, eigen, held, config);
  report.degenerate = static_cast<int>(result.unobserved.cols());
  if (report.degenerate == 0) return result;
  report.worst = result.unobserved.col(0);
  const Matrix6 observed = Matrix6::Identity() - result.unobserved * result.unobserved.transpose();
  result.sums.H.topLeftCorner<6, 6>() = S_inverse.transpose() * (observed * H * observed) * S_inverse;
  result.sums.b.head<6>() = S_inverse.transpose() * (observed * (S.transpose() * equations.sums.b.head<6>()));
  return result;
}

std::string describe_degeneracy(const Localizability& localizability) {
  if (localizability.degenerate == 0) return "none";
  const Vector6& direction = localizability.worst;
  const bool turning = direction.head<3>().norm() > direction.tail<3>().norm();
  const Vector3d axis = (turning ? direction.head<3>() : direction.tail<3>()).normalized();
  return std::format("{} along ({:.2f}, {:.2f}, {:.2f})", turning ? "rotation" : "translation", axis.x(), axis.y(), axis.z());
}

}  // namespace pllit
