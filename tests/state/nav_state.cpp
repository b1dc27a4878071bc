#include "pllit/state/nav_state.hpp"

#include <gtest/gtest.h>

#include "support/random_states.hpp"

namespace pllit {
namespace {

TEST(NavStateManifold, BoxminusUndoesBoxplus) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const NavState x = random.state();
    const Vector18 error = Vector18::NullaryExpr([&] { return random.normal(0.5); });
    EXPECT_LT((boxminus(boxplus(x, error), x) - error).norm(), 1e-12);
  }
}

TEST(NavStateManifold, BoxplusPerturbsTheRotationOnTheRight) {
  NavState x;
  x.R_W_I = exp_so3({0.0, 0.0, M_PI / 2.0});
  Vector18 error = Vector18::Zero();
  error[error_index::theta] = M_PI / 2.0;  // about the body's x axis, which points along y of the world
  const Vector3d up_W = boxplus(x, error).R_W_I.act(Vector3d::UnitZ());
  EXPECT_LT((up_W - Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
}

TEST(RightJacobian, IsTheDerivativeOfTheExponential) {
  test::Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Vector3d phi = random.vector(i % 2 ? 1.0 : 1e-7);
    const Matrix3d J = test::numerical_jacobian<3, 3>(
        [&](const Vector3d& d) { return log_so3(exp_so3(phi).inverse() * exp_so3(phi + d)); });
    EXPECT_LT((right_jacobian(phi) - J).norm(), 1e-8);
    EXPECT_LT((right_jacobian(phi) * right_jacobian_inverse(phi) - Matrix3d::Identity()).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace pllit
