// SPDX-License-Identifier: Apache-2.0
#include "core/graph/so3.hpp"

#include <gtest/gtest.h>

#include "tests/core/graph/numeric.hpp"

namespace kinemap::graph {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

/// Angles from nothing to a hair below π, and both sides of every series' switch.
const double kAngles[] = {0.0,    1e-12, 1e-9, 9.99e-5, 1.01e-4, 1.9e-4,     2.1e-4,     1e-3,       0.0999,
                          0.1001, 0.5,   1.5,  2.5,     3.1,     kPi - 1e-4, kPi - 1e-8, kPi - 1e-12};

TEST(So3, LogInvertsExpFromZeroToPi) {
  test::Random random(1);
  for (const double angle : kAngles) {
    for (int k = 0; k < 20; ++k) {
      const Vector3d theta = angle * random.direction();
      const Eigen::Quaterniond q = so3_exp(theta);
      EXPECT_NEAR(q.norm(), 1.0, 1e-15) << angle;
      EXPECT_LT((so3_log(q) - theta).norm(), 2e-15 * (1.0 + angle)) << angle;
    }
  }
}

TEST(So3, ExpIsTheRotationAboutTheAxis) {
  test::Random random(2);
  for (const double angle : kAngles) {
    const Vector3d axis = random.direction();
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((so3_exp(angle * axis).toRotationMatrix() - expected).norm(), 1e-14) << angle;
  }
}

TEST(So3, LogIgnoresTheSignOfTheQuaternion) {
  test::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Quaterniond q = random.rotation();
    EXPECT_LT((so3_log(q) - so3_log(Eigen::Quaterniond(-q.coeffs()))).norm(), 1e-15);
    EXPECT_LE(so3_log(q).norm(), kPi);
  }
}

TEST(So3, LogOfAHalfTurnHasLengthPi) {
  EXPECT_NEAR(so3_log(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)).norm(), kPi, 1e-15);
  EXPECT_NEAR(so3_log(Eigen::Quaterniond(-0.0, 0.0, 0.6, 0.8)).norm(), kPi, 1e-15);
}

TEST(So3, RightJacobianInverseIsTheDerivativeOfLog) {
  test::Random random(4);
  for (const double angle : kAngles) {
    if (angle > kPi - 1e-5) continue;  // a difference across π jumps
    const Vector3d theta = angle * random.direction();
    const Eigen::MatrixXd numeric = test::differentiate(
        [&](const Eigen::VectorXd& d) -> Eigen::VectorXd { return so3_log(so3_exp(theta) * so3_exp(d)); }, 3);
    EXPECT_LT(test::relative_difference(so3_right_jacobian_inverse(theta), numeric), 1e-8) << angle;
  }
}

TEST(So3, RightJacobianInverseIsContinuousAtItsSwitchAndFiniteAtPi) {
  const Vector3d axis = Vector3d(1.0, -2.0, 0.5).normalized();
  const Eigen::Matrix3d below = so3_right_jacobian_inverse(0.1 * (1.0 - 1e-14) * axis);
  const Eigen::Matrix3d above = so3_right_jacobian_inverse(0.1 * (1.0 + 1e-14) * axis);
  EXPECT_LT((below - above).cwiseAbs().maxCoeff(), 1e-14);
  // At π: Jr⁻¹ = I + ½[θ]× + [θ]×²/π², which is the projection on the axis plus ½[θ]×.
  const Eigen::Matrix3d expected = axis * axis.transpose() + 0.5 * hat(kPi * axis);
  EXPECT_LT((so3_right_jacobian_inverse(kPi * axis) - expected).norm(), 1e-14);
}

}  // namespace
}  // namespace kinemap::graph
