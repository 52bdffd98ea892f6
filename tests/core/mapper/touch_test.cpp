// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/touch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/graph/optimizer.hpp"
#include "core/mapper/mapper.hpp"
#include "tests/core/mapper/wearer.hpp"

namespace kinemap {
namespace {

using Eigen::Vector3d;

Pivot pivot_at(double along_m, double sigma_m) {
  Pivot pivot;
  pivot.p_hand = {0.0, -along_m, -0.01};
  pivot.covariance = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
  return pivot;
}

TEST(TouchBelief, BeforeAnythingIsKnownItIsWideEnoughForBothParts) {
  TouchBelief belief({});
  belief.expect({}, 1.8);
  const auto prior = belief.prior();
  EXPECT_FALSE(prior.fixed);
  EXPECT_NEAR(belief.palm_probability(), 0.25, 1e-9);
  EXPECT_NEAR(-prior.prior.y(), 0.75 * 0.189 + 0.25 * 0.0945, 1e-6);
  EXPECT_GT(prior.sigma.y(), MapperConfig::Hand{}.tip_sigma_m + 0.01);
}

TEST(TouchBelief, BodyPointsAndConfigurationComeWithTheirOwnSigma) {
  MapperConfig::Hand config;
  config.palm_share = 0.0;
  WearerInfo wearer;
  wearer.p_hand_fingertip = Vector3d(0.01, -0.2, 0.0);
  TouchBelief belief(config);
  belief.expect(wearer, 1.6);
  // The suit's point is one of the skeleton; what touches is the skin beneath.
  const Vector3d skin = *wearer.p_hand_fingertip - Vector3d(0.0, 0.0, config.tip_thickness_m);
  EXPECT_LT((belief.prior().prior - skin).norm(), 1e-12);
  EXPECT_NEAR(belief.prior().sigma.y(), config.body_point_sigma_m, 1e-9);
  EXPECT_LT(config.body_point_sigma_m, config.tip_sigma_m);
  config.tip_m = 0.12;
  belief = TouchBelief(config);
  belief.expect(wearer, 1.6);
  EXPECT_NEAR(belief.prior().prior.y(), -0.12, 1e-12);
  EXPECT_NEAR(belief.prior().sigma.y(), config.body_point_sigma_m, 1e-9);
  config.tip_sigma_m = 0.0;
  EXPECT_TRUE(TouchBelief(config).prior().fixed);
}

TEST(TouchBelief, PivotsDecideThePartAndSharpenIt) {
  TouchBelief palm({}), tips({});
  for (auto* belief : {&palm, &tips}) belief->expect({}, 1.75);
  palm.add(pivot_at(0.09, 0.012));
  tips.add(pivot_at(0.18, 0.012));
  EXPECT_GT(palm.palm_probability(), 0.95);
  EXPECT_LT(tips.palm_probability(), 0.05);
  EXPECT_NEAR(palm.prior().prior.y(), -0.09, 0.01);
  EXPECT_NEAR(tips.prior().prior.y(), -0.18, 0.01);
  const double once = tips.prior().sigma.y();
  EXPECT_LT(once, 0.025);
  tips.add(pivot_at(0.175, 0.012));
  EXPECT_LT(tips.prior().sigma.y(), 0.85 * once);
}

TEST(TouchBelief, AnOpenDirectionOfAPivotLeavesWhatWasExpected) {
  TouchBelief belief({});
  belief.expect({}, 1.75);
  Pivot pivot = pivot_at(0.18, 0.01);
  pivot.p_hand.z() = 0.5;
  pivot.covariance(2, 2) = 1.0;
  belief.add(pivot);
  EXPECT_NEAR(belief.prior().prior.z(), -0.01, 0.005);
  EXPECT_NEAR(belief.prior().sigma.z(), MapperConfig::Hand{}.tip_sideways_sigma_m, 0.003);
}

TEST(TouchBelief, ContactsThatSayNothingChangeNothing) {
  TouchBelief belief({});
  belief.expect({}, 1.75);
  const auto prior = belief.prior();
  belief.judge(prior, prior.sigma.cwiseAbs2().asDiagonal().toDenseMatrix());
  EXPECT_NEAR(belief.palm_probability(), 0.25, 1e-6);
  EXPECT_LT((belief.prior().prior - prior.prior).norm(), 1e-6);
}

TEST(TouchBelief, ContactsTellTheParts) {
  for (const double along : {0.09, 0.18}) {
    TouchBelief belief({});
    belief.expect({}, 1.75);
    // The optimum that contacts with a sigma of 2 cm about the true point would give under the prior.
    graph::TouchPoint touch = belief.prior();
    const Eigen::Vector3d prior = touch.sigma.cwiseAbs2().cwiseInverse();
    const Eigen::Vector3d contacts = Vector3d::Constant(1.0 / (0.02 * 0.02));
    const Vector3d covariance = (prior + contacts).cwiseInverse();
    touch.p_hand =
        covariance.cwiseProduct(prior.cwiseProduct(touch.prior) + contacts.cwiseProduct(Vector3d(0.0, -along, -0.01)));
    belief.judge(touch, covariance.asDiagonal().toDenseMatrix());
    const double right = along < 0.1 ? belief.palm_probability() : 1.0 - belief.palm_probability();
    EXPECT_GT(right, 0.75) << along;
    EXPECT_LT(belief.prior().sigma.y(), touch.sigma.y()) << along;
  }
}

TEST(TouchBelief, FingersThatPointIntoTheSurfaceAreNoPalm) {
  graph::Graph graph;
  graph.poses = {Pose{}};
  Observation wall;
  wall.landmark.kind = graph::LandmarkKind::Wall;
  wall.landmark.x[0] = std::numbers::pi;  // normal towards −x
  wall.contacts = {0};
  wall.labels = {{}};
  const auto seen = [&](double slant) {
    Trace trace;
    // Fingers along y are in the wall's plane; turned by `slant` they point into it.
    const Eigen::Quaterniond q(Eigen::AngleAxisd(slant, Vector3d::UnitZ()));
    trace.contacts = {{0.0, 0, Pose{Vector3d::Zero(), q}}};
    TouchBelief belief({});
    belief.see(wall, trace, graph);
    return belief.palm_probability();
  };
  EXPECT_GT(seen(0.0), 0.35);
  EXPECT_LT(seen(0.0), 0.5) << "finger tips draw with a flat hand too";
  EXPECT_LT(seen(1.2), 0.15);
  EXPECT_GT(seen(1.2), 0.05) << "not every suit tells the hand's orientation";
}

/// One wall touched from fixed poses with the hand at many yaws; the reported yaw is noisy. Returns the estimate.
double estimated_reach(double turn_noise_rad_per_m) {
  constexpr double kReach = 0.18, kYawNoise = 0.15, kPositionNoise = 0.02;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> yaw(-0.7, 0.7);
  graph::Graph graph;
  graph.landmarks.push_back({});  // n = +x, offset 0
  graph.touch_points.push_back(
      {Vector3d(0, -0.15, 0), Vector3d(0, -0.15, 0), Vector3d(0.01, 0.2, 0.01), false, turn_noise_rad_per_m});
  for (std::size_t k = 0; k < 400; ++k) {
    graph.poses.push_back({});
    graph.priors.push_back({k, Pose{}, 1e3 * graph::Matrix6::Identity()});
    const Eigen::Quaterniond ahead(Eigen::AngleAxisd(std::numbers::pi / 2 + yaw(random), Vector3d::UnitZ()));
    graph::ContactFactor contact;
    contact.i = k;
    contact.T_i_hand.p = Vector3d(0.0, 0.01 * static_cast<double>(k), 0.0) - ahead * Vector3d(0, -kReach, 0);
    contact.T_i_hand.p.y() = 0.01 * static_cast<double>(k % 40);
    contact.T_i_hand.p.x() += kPositionNoise * normal(random);
    contact.T_i_hand.q = Eigen::AngleAxisd(kYawNoise * normal(random), Vector3d::UnitZ()) * ahead;
    contact.sigma_plane_m = 0.03;
    graph.contacts.push_back(contact);
  }
  EXPECT_TRUE(graph::optimize(graph, {}).usable);
  return -graph.touch_points[0].p_hand.y();
}

TEST(TouchingPoint, NoisyTurnsOfTheHandDoNotDrawItToTheWrist) {
  const double plain = estimated_reach(0.0), total = estimated_reach(3.0);
  EXPECT_LT(plain, 0.14);
  EXPECT_GT(total, 0.16);
  EXPECT_LT(total, 0.21);
}

/// A screen of 1.0 × 0.6 m drawn with the fingers always towards its middle; poses known. Sigmas of width and height.
std::array<double, 2> size_sigmas(bool fixed, double touch_sigma_m) {
  constexpr double kWidth = 1.0, kHeight = 0.6;
  graph::Graph graph;
  graph.poses = {Pose{}};
  graph.priors = {{0, Pose{}, 1e3 * graph::Matrix6::Identity()}};
  graph::Landmark screen;  // normal +x: u along +y, v up
  screen.kind = graph::LandmarkKind::Screen;
  screen.x = {0.0, 0.0, 0.0, 0.0, kWidth, kHeight, 0.0};
  graph.landmarks = {screen};
  const Vector3d touch(0.0, -0.18, 0.0);
  graph.touch_points = {{touch, touch, Vector3d::Constant(touch_sigma_m), fixed}};
  const auto draw = [&](graph::Edge edge, const Vector3d& from, const Vector3d& to, const Vector3d& inwards) {
    for (int k = 0; k <= 10; ++k) {
      graph::ContactFactor contact;
      contact.T_i_hand.q = Eigen::Quaterniond::FromTwoVectors(-Vector3d::UnitY(), inwards);
      contact.T_i_hand.p = from + 0.1 * k * (to - from) - contact.T_i_hand.q * touch;
      contact.edge = edge;
      graph.contacts.push_back(contact);
    }
  };
  const Vector3d u(0.0, 0.5 * kWidth, 0.0), v(0.0, 0.0, 0.5 * kHeight);
  draw(graph::Edge::MinusU, -u - v, -u + v, Vector3d::UnitY());
  draw(graph::Edge::PlusU, u - v, u + v, -Vector3d::UnitY());
  draw(graph::Edge::MinusV, -u - v, u - v, Vector3d::UnitZ());
  draw(graph::Edge::PlusV, -u + v, u + v, -Vector3d::UnitZ());
  const auto marginals = graph::Marginals::compute(graph);
  if (!marginals) return {};
  const std::array<graph::Variable, 1> variable{{{graph::Variable::Kind::Landmark, 0}}};
  const Eigen::MatrixXd covariance = marginals->joint(variable);
  return {std::sqrt(covariance(4, 4)), std::sqrt(covariance(5, 5))};
}

TEST(TouchingPoint, ItsUncertaintyIsCarriedIntoSizes) {
  const auto fixed = size_sigmas(true, 0.03), free = size_sigmas(false, 0.03);
  // All sides move outwards together: nothing in the drawing tells, so a size is uncertain by twice the point's sigma.
  for (const std::size_t side : {0, 1})
    EXPECT_NEAR(free[side], std::hypot(fixed[side], 2.0 * 0.03), 0.1 * free[side]) << fixed[side];
  EXPECT_LT(fixed[0], 0.02);
}

TEST(TouchingPoint, IsPublishedOnceSomethingWasTouched) {
  Mapper mapper({});
  EXPECT_FALSE(mapper.snapshot()->hand);
  test::Wearer wearer;
  for (const auto& event : wearer.events) mapper.add(event);
  mapper.add(pivot_at(0.19, 0.01));
  ASSERT_TRUE(mapper.snapshot()->hand);
  EXPECT_TRUE(mapper.snapshot()->objects.empty());
  EXPECT_EQ(mapper.snapshot()->hand->part, HandPart::Tips);
  EXPECT_NEAR(mapper.snapshot()->hand->p_hand.y(), -0.19, 0.01);
  EXPECT_LT(mapper.snapshot()->hand->sigma_m.y(), 0.015);
}

}  // namespace
}  // namespace kinemap
