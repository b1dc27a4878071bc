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
    const double share =
        config.min_share * (direction.tail<3>().squaredNorm() + 0.1 * direction.head<3>().squaredNorm());
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

/// Where planes say nothing of a shift, they say nothing of it at any attitude: what turning the eigenvector of a shift
/// holds is noise.
Vector6 without_noise(Vector6 direction) {
  constexpr double mostly_shift = 0.9;
  if (direction.tail<3>().norm() > mostly_shift) direction.head<3>().setZero();
  return direction.normalized();
}

/// The held direction, moved a little towards the weakest one of this scan where that is near.
Vector6 followed(const Vector6& held, const Eigen::SelfAdjointEigenSolver<Matrix6>& eigen, double rate) {
  Vector6 now = without_noise(eigen.eigenvectors().col(0));
  if (now.dot(held) < 0.0) now = -now;
  constexpr double near = 0.98;
  return now.dot(held) > near ? Vector6((held + rate * (now - held)).normalized()) : held;
}

DegenerateDirections unobserved_directions(const Information& information,
                                           const Eigen::SelfAdjointEigenSolver<Matrix6>& eigen,
                                           const DegenerateDirections& held, const DegeneracyConfig& config) {
  DegenerateDirections directions(6, 0);
  for (Eigen::Index i = 0; i < held.cols(); ++i)
    if (information.along(held.col(i)) < config.release * information.needed(held.col(i), config))
      add_direction(directions, followed(held.col(i), eigen, config.follow));
  for (int i = 0; i < 6; ++i)
    if (eigen.eigenvalues()[i] < information.needed(eigen.eigenvectors().col(i), config))
      add_direction(directions, without_noise(eigen.eigenvectors().col(i)));
  return directions;
}

/// The states that an unobserved shift along a direction of W carries with it:
/// position, velocity, gravity and accelerometer bias are known along it only
/// through each other. An unobserved turn leaves heading and gyroscope bias alone.
Eigen::Matrix<double, error_index::size, Eigen::Dynamic> in_error_state(const DegenerateDirections& directions,
                                                                        const SO3& R_W_I) {
  namespace ix = error_index;
  const Matrix3d to_I = R_W_I.rotation().transpose();
  Eigen::Matrix<double, ix::size, Eigen::Dynamic> states(ix::size, 0);
  const auto add = [&states](int row, const Vector3d& direction) {
    Vector18 column = Vector18::Zero();
    column.segment<3>(row) = direction;
    column -= states * (states.transpose() * column);
    if (column.norm() < 1e-3) return;
    states.conservativeResize(ix::size, states.cols() + 1);
    states.col(states.cols() - 1) = column.normalized();
  };
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Vector3d turn_W = directions.col(i).head<3>(), shift_W = directions.col(i).tail<3>();
    if (shift_W.norm() > turn_W.norm()) {
      for (const int row : {ix::p, ix::v, ix::g}) add(row, shift_W.normalized());
      add(ix::ba, to_I * shift_W.normalized());
    } else {
      for (const int row : {ix::theta, ix::bg}) add(row, to_I * turn_W.normalized());
    }
  }
  return states;
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
  result.sums.unobserved = in_error_state(result.unobserved, R_W_I);
  return result;
}

std::string describe_degeneracy(const Localizability& localizability) {
  if (localizability.degenerate == 0) return "none";
  const Vector6& direction = localizability.worst;
  const bool turning = direction.head<3>().norm() > direction.tail<3>().norm();
  const Vector3d axis = (turning ? direction.head<3>() : direction.tail<3>()).normalized();
  return std::format("{} along ({:.2f}, {:.2f}, {:.2f})", turning ? "rotation" : "translation", axis.x(), axis.y(),
                     axis.z());
}

}  // namespace pllit
