// SPDX-License-Identifier: Apache-2.0
#include "core/graph/factors.hpp"

#include <gtest/gtest.h>

#include "tests/core/graph/numeric.hpp"

namespace kinemap::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::differentiate;
using test::plus;
using test::relative_difference;

constexpr double kTolerance = 1e-7;
constexpr int kSamples = 200;

TEST(Between, IsZeroWhereTheMeasurementHolds) {
  test::Random random(1);
  for (int k = 0; k < kSamples; ++k) {
    const Pose a = random.pose(), z = random.pose();
    EXPECT_LT(between_error(a, a * z, z, nullptr, nullptr).norm(), 1e-13);
  }
}

TEST(Between, IsThePoseOfJInTheMeasuredFrame) {
  // Turned by 90° about z and 1 m ahead where nothing was measured: 1 m along x, π/2 about z.
  const Pose j = level_pose({1.0, 0.0, 0.0}, std::numbers::pi / 2.0);
  Vector6 expected;
  expected << 1.0, 0.0, 0.0, 0.0, 0.0, std::numbers::pi / 2.0;
  EXPECT_LT((between_error(Pose{}, j, Pose{}, nullptr, nullptr) - expected).norm(), 1e-14);
}

TEST(Between, JacobiansMatchDifferences) {
  test::Random random(2);
  for (int k = 0; k < kSamples; ++k) {
    const Pose a = random.pose(), b = random.pose();
    // Errors up to 2.8 rad: at π the logarithm jumps, and differences say nothing.
    const Pose z = (a.inverse() * b) * random.pose(1.0, k % 4 == 0 ? 1e-7 : 2.8).inverse();
    Matrix6 d_a, d_b;
    between_error(a, b, z, &d_a, &d_b);
    const MatrixXd n_a = differentiate(
        [&](const VectorXd& d) -> VectorXd { return between_error(plus(a, d), b, z, nullptr, nullptr); }, 6);
    const MatrixXd n_b = differentiate(
        [&](const VectorXd& d) -> VectorXd { return between_error(a, plus(b, d), z, nullptr, nullptr); }, 6);
    EXPECT_LT(relative_difference(d_a, n_a), kTolerance);
    EXPECT_LT(relative_difference(d_b, n_b), kTolerance);
  }
}

TEST(Prior, JacobianMatchesDifferences) {
  test::Random random(3);
  for (int k = 0; k < kSamples; ++k) {
    const Pose z = random.pose(), a = z * random.pose(1.0, 2.8);
    Matrix6 d;
    const Vector6 e = prior_error(a, z, &d);
    EXPECT_LT((e - between_error(Pose{}, a, z, nullptr, nullptr)).norm(), 1e-15);
    const MatrixXd n =
        differentiate([&](const VectorXd& x) -> VectorXd { return prior_error(plus(a, x), z, nullptr); }, 6);
    EXPECT_LT(relative_difference(d, n), kTolerance);
  }
}

TEST(Gravity, MeasuresTheTiltAndItsJacobianMatchesDifferences) {
  const Pose tilted{{1.0, 2.0, 3.0}, so3_exp({0.01, 0.0, 0.0})};
  EXPECT_NEAR(gravity_error(tilted, Vector3d::UnitZ(), nullptr).norm(), 0.01, 1e-6);
  test::Random random(4);
  for (int k = 0; k < kSamples; ++k) {
    const Pose a = random.pose();
    const Vector3d up = random.direction();
    Eigen::Matrix<double, 2, 6> d;
    gravity_error(a, up, &d);
    const MatrixXd n =
        differentiate([&](const VectorXd& x) -> VectorXd { return gravity_error(plus(a, x), up, nullptr); }, 6);
    EXPECT_LT(relative_difference(d, n), kTolerance);
  }
}

TEST(Floor, MeasuresTheHeightAndItsJacobianMatchesDifferences) {
  EXPECT_NEAR(floor_error(level_pose({5.0, 6.0, 1.0}, 0.7), {0.1, 0.2, -0.95}, 0.02, nullptr), 0.03, 1e-15);
  test::Random random(5);
  for (int k = 0; k < kSamples; ++k) {
    const Pose a = random.pose();
    const Vector3d p = random.vector(1.0);
    Row6 d;
    floor_error(a, p, 0.3, &d);
    const MatrixXd n = differentiate(
        [&](const VectorXd& x) -> VectorXd { return VectorXd::Constant(1, floor_error(plus(a, x), p, 0.3, nullptr)); },
        6);
    EXPECT_LT(relative_difference(d, n), kTolerance);
  }
}

TEST(Seat, IsZeroAtTheSeatAndItsJacobiansMatchDifferences) {
  test::Random random(6);
  for (int k = 0; k < kSamples; ++k) {
    const Pose pelvis = random.pose(3.0, 0.5);
    const Pose T_i_seat = random.pose(0.5, 0.5);
    const Pose at = pelvis * T_i_seat;
    Eigen::Vector4d seat(at.p.x(), at.p.y(), at.p.z(), heading_of(at.q) + 2.0 * std::numbers::pi * (k % 3 - 1));
    EXPECT_LT(seat_error(pelvis, seat.data(), T_i_seat, nullptr, nullptr).norm(), 1e-13);

    seat += Eigen::Vector4d(0.1, -0.2, 0.3, 0.4);
    Eigen::Matrix<double, 4, 6> d_i;
    Eigen::Matrix4d d_seat;
    seat_error(pelvis, seat.data(), T_i_seat, &d_i, &d_seat);
    const MatrixXd n_i = differentiate(
        [&](const VectorXd& x) -> VectorXd {
          return seat_error(plus(pelvis, x), seat.data(), T_i_seat, nullptr, nullptr);
        },
        6);
    const MatrixXd n_seat = differentiate(
        [&](const VectorXd& x) -> VectorXd {
          const Eigen::Vector4d moved = seat + x;
          return seat_error(pelvis, moved.data(), T_i_seat, nullptr, nullptr);
        },
        4);
    EXPECT_LT(relative_difference(d_i, n_i), kTolerance);
    EXPECT_LT(relative_difference(d_seat, n_seat), kTolerance);
  }
}

TEST(Seat, FacingStraightUpHasNoHeadingAndStaysFinite) {
  const Pose up{Vector3d::Zero(), so3_exp({0.0, -std::numbers::pi / 2.0, 0.0})};
  const double seat[4] = {0.0, 0.0, 0.0, 0.0};
  Eigen::Matrix<double, 4, 6> d;
  EXPECT_TRUE(seat_error(Pose{}, seat, up, &d, nullptr).allFinite());
  EXPECT_TRUE(d.allFinite());
}

Landmark random_landmark(LandmarkKind kind, test::Random& random) {
  Landmark l;
  l.kind = kind;
  l.anchor = random.vector(3.0);
  for (double& x : l.x) x = random.uniform(-3.0, 3.0);
  if (kind == LandmarkKind::Screen) l.x[6] = random.uniform(-1.2, 1.2);
  return l;
}

class SurfaceOf : public testing::TestWithParam<LandmarkKind> {};

TEST_P(SurfaceOf, PlaneGradientsMatchDifferences) {
  test::Random random(7);
  for (int k = 0; k < kSamples; ++k) {
    const Landmark l = random_landmark(GetParam(), random);
    const Vector3d p = random.vector(4.0);
    const SurfaceError e = Surface(l.kind, l.x.data(), l.anchor).plane(p);
    const int size = dimension(l.kind);
    const MatrixXd n = differentiate(
        [&](const VectorXd& d) -> VectorXd {
          Landmark moved = l;
          for (int c = 0; c < size; ++c) moved.x[static_cast<std::size_t>(c)] += d(3 + c);
          return VectorXd::Constant(1, Surface(l.kind, moved.x.data(), l.anchor).plane(p + d.head<3>()).value);
        },
        3 + size);
    MatrixXd analytic(1, 3 + size);
    analytic << e.d_point.transpose(), Eigen::Map<const Eigen::RowVectorXd>(e.d_landmark.data(), size);
    EXPECT_LT(relative_difference(analytic, n), kTolerance);
  }
}

TEST_P(SurfaceOf, FrameIsRightHandedAndThePlaneContainsTheOrigin) {
  test::Random random(8);
  for (int k = 0; k < 50; ++k) {
    const Landmark l = random_landmark(GetParam(), random);
    const Surface s(l.kind, l.x.data(), l.anchor);
    EXPECT_LT((s.u().cross(s.v()) - s.w()).norm(), 1e-14);
    EXPECT_NEAR(s.plane(s.origin()).value, 0.0, 1e-14);
    const Pose T = landmark_pose(l);
    EXPECT_LT((T * Vector3d(0.3, 0.5, 0.7) - (s.origin() + 0.3 * s.u() + 0.5 * s.v() + 0.7 * s.w())).norm(), 1e-13);
    EXPECT_NEAR(contact_error(l, T * Vector3d(0.3, 0.5, 0.7), Edge::None, Edge::None)(0), 0.7, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SurfaceOf,
                         testing::Values(LandmarkKind::Wall, LandmarkKind::Table, LandmarkKind::Screen,
                                         LandmarkKind::Seat));

TEST(Surface, AxesAreThoseOfTheDocumentation) {
  // A wall seen from −x (normal −x through the anchor), a table along +y, a screen whose normal +x is tilted up by 0.1.
  const double wall[2] = {std::numbers::pi, 0.25};
  EXPECT_NEAR(Surface(LandmarkKind::Wall, wall, {2.0, 1.0, 0.0}).plane({1.5, 7.0, 9.0}).value, 0.25, 1e-14);
  const double table[6] = {0.0, 0.0, 0.7, std::numbers::pi / 2.0, 2.0, 1.0};
  const Surface t(LandmarkKind::Table, table, {});
  EXPECT_LT((t.u() - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((t.v() + Vector3d::UnitX()).norm(), 1e-15);
  const double screen[7] = {0.0, 0.0, 1.0, 0.0, 1.0, 0.6, 0.1};
  const Surface s(LandmarkKind::Screen, screen, {});
  EXPECT_LT((s.u() - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((s.w() - Vector3d(std::cos(0.1), 0.0, std::sin(0.1))).norm(), 1e-15);
  EXPECT_GT(s.v().z(), 0.9);
}

class SideOf : public testing::TestWithParam<std::tuple<LandmarkKind, Edge>> {};

TEST_P(SideOf, GradientsMatchDifferences) {
  const auto [kind, edge] = GetParam();
  test::Random random(9);
  for (int k = 0; k < kSamples; ++k) {
    const Landmark l = random_landmark(kind, random);
    const Vector3d p = random.vector(4.0);
    const int size = dimension(kind);
    const SurfaceError e = Surface(kind, l.x.data(), l.anchor).side(p, edge);
    const MatrixXd n = differentiate(
        [&, edge = edge](const VectorXd& d) -> VectorXd {
          Landmark moved = l;
          for (int c = 0; c < size; ++c) moved.x[static_cast<std::size_t>(c)] += d(3 + c);
          return VectorXd::Constant(1, Surface(l.kind, moved.x.data(), l.anchor).side(p + d.head<3>(), edge).value);
        },
        3 + size);
    MatrixXd analytic(1, 3 + size);
    analytic << e.d_point.transpose(), Eigen::Map<const Eigen::RowVectorXd>(e.d_landmark.data(), size);
    EXPECT_LT(relative_difference(analytic, n), kTolerance);
  }
}

TEST_P(SideOf, IsZeroOnTheSideAndPositiveBeyondTheUpperOnes) {
  const auto [kind, edge] = GetParam();
  test::Random random(10);
  const Landmark l = [&] {
    Landmark made = random_landmark(kind, random);
    made.x[4] = 1.6, made.x[5] = 0.9;
    return made;
  }();
  const double u = edge == Edge::MinusU ? -0.8 : edge == Edge::PlusU ? 0.8 : 0.123;
  const double v = edge == Edge::MinusV ? -0.45 : edge == Edge::PlusV ? 0.45 : 0.123;
  const Pose T = landmark_pose(l);
  EXPECT_LT(contact_error(l, T * Vector3d(u, v, 0.0), edge, edge).norm(), 1e-13);
  const Eigen::Vector3d further = contact_error(l, T * Vector3d(u + 0.05, v + 0.05, 0.0), edge, Edge::None);
  EXPECT_NEAR(further(1), 0.05, 1e-13);
  EXPECT_EQ(further(2), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, SideOf,
                         testing::Combine(testing::Values(LandmarkKind::Table, LandmarkKind::Screen),
                                          testing::Values(Edge::MinusU, Edge::PlusU, Edge::MinusV, Edge::PlusV)));

TEST(ContactError, WallsHaveNoSides) {
  test::Random random(11);
  const Landmark wall = random_landmark(LandmarkKind::Wall, random);
  const Eigen::Vector3d e = contact_error(wall, random.vector(2.0), Edge::PlusU, Edge::MinusV);
  EXPECT_NE(e(0), 0.0);
  EXPECT_EQ(e(1), 0.0);
  EXPECT_EQ(e(2), 0.0);
}

TEST(LossFunctions, ValuesAndWeights) {
  const Loss none{}, huber{Loss::Kind::Huber, 2.0}, cauchy{Loss::Kind::Cauchy, 2.0};
  EXPECT_EQ(evaluate(none, 9.0).rho, 9.0);
  EXPECT_EQ(evaluate(huber, 3.9).rho, 3.9);
  EXPECT_EQ(evaluate(huber, 3.9).weight, 1.0);
  EXPECT_NEAR(evaluate(huber, 25.0).rho, 2.0 * 2.0 * 5.0 - 4.0, 1e-14);
  EXPECT_NEAR(evaluate(cauchy, 12.0).rho, 4.0 * std::log(4.0), 1e-14);
  for (const Loss& loss : {none, huber, cauchy}) {
    for (const double s : {0.1, 3.0, 5.0, 40.0, 1e4}) {
      const double h = 1e-5 * s;
      const double slope = (evaluate(loss, s + h).rho - evaluate(loss, s - h).rho) / (2.0 * h);
      EXPECT_NEAR(evaluate(loss, s).weight, slope, 1e-8) << s;
      EXPECT_GE(evaluate(loss, s).rho - evaluate(loss, s).weight * s, 0.0);  // what makes the extra row real
    }
    EXPECT_EQ(evaluate(loss, 0.0).rho, 0.0);
    EXPECT_EQ(evaluate(loss, 0.0).weight, 1.0);
  }
}

}  // namespace
}  // namespace kinemap::graph
