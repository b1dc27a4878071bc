#include "pllit/lidar/degeneracy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// Equations of points on planes with the given normals, as a scan
/// would give them; `tilt_rad`: error of the planes' normals.
PlaneEquations equations_of(Random& random, const std::vector<Vector3d>& normals, double tilt_rad, int points = 3000) {
  PlaneEquations equations;
  constexpr double weight = 1.0 / (0.02 * 0.02);
  for (int i = 0; i < points; ++i) {
    const Vector3d n = (normals[i % normals.size()] + random.vector(tilt_rad)).normalized();
    const Vector3d p = random.vector(5.0);
    Vector6 J;
    J << p.cross(n), n;
    equations.sums.H.topLeftCorner<6, 6>() += weight * J * J.transpose();
    equations.sums.b.head<6>() += weight * random.normal(0.02) * J;
    equations.weight += weight;
    equations.lever2_m2 += weight * p.squaredNorm();
    ++equations.sums.inliers;
    Eigen::Matrix<double, 6, 3> J_row_normal;
    J_row_normal << skew(p), Matrix3d::Identity();
    equations.noise_information += weight * J_row_normal *
                                   (tilt_rad * tilt_rad * (Matrix3d::Identity() - n * n.transpose())) *
                                   J_row_normal.transpose();
  }
  return equations;
}

const std::vector<Vector3d> box{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
const std::vector<Vector3d> corridor{Vector3d::UnitY(), Vector3d::UnitZ()};

TEST(Degeneracy, LeavesAFullyObservedScanUntouched) {
  Random random(41);
  const PlaneEquations equations = equations_of(random, box, 0.01);
  const ObservedEquations observed = observed_part(equations, SO3::Identity(), {}, {});
  EXPECT_EQ(observed.localizability.degenerate, 0);
  EXPECT_EQ(observed.sums.H, equations.sums.H);
  EXPECT_EQ(observed.sums.b, equations.sums.b);
  EXPECT_NEAR(observed.localizability.axis_share.head<3>().sum(), 1.0, 1e-9);
  EXPECT_NEAR(observed.localizability.axis_share[0], 1.0 / 3.0, 0.02);
}

TEST(Degeneracy, FindsTheAxisOfACorridorThatNoisyNormalsSeemToObserve) {
  Random random(42);
  for (const double tilt_rad : {0.0, 0.01, 0.05, 0.1}) {
    const PlaneEquations equations = equations_of(random, corridor, tilt_rad);
    const ObservedEquations observed = observed_part(equations, SO3::Identity(), {}, {});
    ASSERT_EQ(observed.localizability.degenerate, 1) << tilt_rad;
    EXPECT_GT(std::abs(observed.localizability.worst[3]), 0.99);
    EXPECT_NE(describe_degeneracy(observed.localizability).find("translation"), std::string::npos);
    // Nothing is left along x, everything across it.
    EXPECT_LT(observed.sums.H(3, 3), 1e-3 * equations.sums.H(4, 4));
    EXPECT_NEAR(observed.sums.H(4, 4) / equations.sums.H(4, 4), 1.0, 0.02);
  }
}

TEST(Degeneracy, FollowsACorridorByTheRevealsOfItsDoorsFewAsTheyAre) {
  // Left to the IMU for minutes, a rig would be hundreds of metres off, where so little holds it to centimetres.
  Random random(47);
  const DegenerateDirections held =
      observed_part(equations_of(random, corridor, 0.005, 30'000), SO3::Identity(), {}, {}).unobserved;
  ASSERT_EQ(held.cols(), 1);
  PlaneEquations equations = equations_of(random, corridor, 0.005, 30'000);
  equations += equations_of(random, {Vector3d::UnitX()}, 0.005, 9);
  const ObservedEquations observed = observed_part(equations, SO3::Identity(), held, {});
  EXPECT_EQ(observed.localizability.degenerate, 0);
  EXPECT_EQ(observed.sums.H, equations.sums.H);
}

TEST(Degeneracy, FindsAllThreeFreedomsOnASinglePlane) {
  Random random(43);
  const ObservedEquations observed =
      observed_part(equations_of(random, {Vector3d::UnitZ()}, 0.0), SO3::Identity(), {}, {});
  EXPECT_EQ(observed.localizability.degenerate, 3);  // x, y and heading
}

TEST(Degeneracy, GivesNormalEquationsWithoutNegativeInformation) {
  Random random(44);
  for (int i = 0; i < 20; ++i) {
    const ObservedEquations observed =
        observed_part(equations_of(random, {random.vector().normalized(), random.vector().normalized()}, 0.02),
                      SO3::Identity(), {}, {});
    const Matrix6 H = observed.sums.H.topLeftCorner<6, 6>();
    EXPECT_LT((H - H.transpose()).norm(), 1e-6 * H.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(H).eigenvalues()[0], -1e-6 * H.norm());
  }
}

TEST(Degeneracy, GivesNoInformationAlongACorridorHoweverManyNoisyScansAddUp) {
  // Each scan's weakest direction is off the axis by the noise of its normals. Taken out as it is, every scan would
  // leave a little information along the true axis, and hundreds of them much.
  Random random(45);
  DegenerateDirections held;
  double information = 0.0, across = 0.0, naive = 0.0;
  for (int i = 0; i < 200; ++i) {
    const PlaneEquations equations = equations_of(random, corridor, 0.02, 300);
    const ObservedEquations observed = observed_part(equations, SO3::Identity(), held, {});
    held = observed.unobserved;
    ASSERT_EQ(held.cols(), 1);
    Vector6 axis = held.col(0);  // back from metres to the error state
    axis.head<3>() /= std::sqrt(equations.lever2_m2 / equations.weight);
    information += axis.dot(observed.sums.H.topLeftCorner<6, 6>() * axis);
    across += observed.sums.H(4, 4);
    naive += observed_part(equations, SO3::Identity(), {}, {})
                 .sums.H.topLeftCorner<6, 6>()
                 .cwiseProduct(axis * axis.transpose())
                 .sum();
  }
  EXPECT_LT(information, 1e-9 * across);
  EXPECT_GT(naive, 1e-8 * across);
}

TEST(Degeneracy, FollowsACorridorThatTurns) {
  Random random(46);
  const auto held = observed_part(equations_of(random, corridor, 0.01), SO3::Identity(), {}, {}).unobserved;
  const std::vector<Vector3d> turned{Vector3d::UnitX(), Vector3d::UnitZ()};
  const ObservedEquations observed = observed_part(equations_of(random, turned, 0.01), SO3::Identity(), held, {});
  ASSERT_EQ(observed.unobserved.cols(), 1);
  EXPECT_GT(std::abs(observed.unobserved(4, 0)), 0.99);
}

TEST(Degeneracy, SaysNothingOfAScanWithoutMatches) {
  const ObservedEquations observed = observed_part(PlaneEquations{}, SO3::Identity(), {}, {});
  EXPECT_EQ(observed.localizability.degenerate, 0);
  EXPECT_EQ(observed.sums.inliers, 0);
}

}  // namespace
}  // namespace pllit
