#include "pllit/lidar/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <format>

namespace pllit {

ObservedEquations observed_part(const PlaneEquations& equations, const DegeneracyConfig& config) {
  ObservedEquations result{.sums = equations.sums, .localizability = {}};
  if (equations.sums.inliers == 0 || equations.weight <= 0.0) return result;
  const double lever_m = std::max(1e-3, std::sqrt(equations.lever2_m2 / equations.weight));
  Vector6 to_metres;
  to_metres << Vector3d::Constant(1.0 / lever_m), Vector3d::Ones();
  const auto S = to_metres.asDiagonal();

  const Matrix6 H = S * equations.sums.H.topLeftCorner<6, 6>() * S;
  const Matrix6 noise = S * equations.noise_information * S;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(H);

  Localizability& report = result.localizability;
  report.axis_share << H.diagonal().tail<3>() / equations.weight, H.diagonal().head<3>() / equations.weight;
  report.weakest_share = eigen.eigenvalues()[0] / equations.weight;
  Matrix6 observed = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6 direction = eigen.eigenvectors().col(i);
    const double information = eigen.eigenvalues()[i];
    const bool held = information > config.min_over_noise * direction.dot(noise * direction) &&
                      information > config.min_share * equations.weight;
    if (held)
      observed += direction * direction.transpose();
    else
      report.degenerate_directions.col(report.degenerate++) = direction;
  }
  if (report.degenerate == 0) return result;
  const auto S_inverse = to_metres.cwiseInverse().asDiagonal();
  result.sums.H.topLeftCorner<6, 6>() = S_inverse * (observed * H * observed) * S_inverse;
  result.sums.b.head<6>() = S_inverse * (observed * (S * equations.sums.b.head<6>()));
  return result;
}

std::string describe_degeneracy(const Localizability& localizability) {
  if (localizability.degenerate == 0) return "none";
  const Vector6 direction = localizability.degenerate_directions.col(0);
  const bool turning = direction.head<3>().norm() > direction.tail<3>().norm();
  const Vector3d axis = (turning ? direction.head<3>() : direction.tail<3>()).normalized();
  return std::format("{} along ({:.2f}, {:.2f}, {:.2f})", turning ? "rotation" : "translation", axis.x(), axis.y(), axis.z());
}

}  // namespace pllit
