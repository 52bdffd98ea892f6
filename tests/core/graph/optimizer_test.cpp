// SPDX-License-Identifier: Apache-2.0
#include "core/graph/optimizer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/core/graph/scene.hpp"

namespace kinemap::graph {
namespace {

using Eigen::Vector3d;
using test::make_scene;
using test::moved;
using test::perturbed;
using test::Scene;

double pose_distance(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() + so3_log(a.q.conjugate() * b.q).norm();
}

double largest_pose_distance(const Graph& a, const Graph& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.poses.size(); ++i) largest = std::max(largest, pose_distance(a.poses[i], b.poses[i]));
  return largest;
}

double largest_landmark_difference(const Graph& a, const Graph& b) {
  double largest = 0.0;
  for (std::size_t l = 0; l < a.landmarks.size(); ++l) {
    for (int k = 0; k < dimension(a.landmarks[l].kind); ++k) {
      const auto c = static_cast<std::size_t>(k);
      largest = std::max(largest, std::abs(a.landmarks[l].x[c] - b.landmarks[l].x[c]));
    }
  }
  return largest;
}

/// All variables, bit by bit.
bool same_values(const Graph& a, const Graph& b) {
  const auto same = [](const double* x, const double* y, std::size_t n) {
    return std::memcmp(x, y, n * sizeof(double)) == 0;
  };
  bool equal = a.poses.size() == b.poses.size();
  for (std::size_t i = 0; equal && i < a.poses.size(); ++i) {
    equal = same(a.poses[i].p.data(), b.poses[i].p.data(), 3) &&
            same(a.poses[i].q.coeffs().data(), b.poses[i].q.coeffs().data(), 4);
  }
  for (std::size_t i = 0; equal && i < a.landmarks.size(); ++i)
    equal = same(a.landmarks[i].x.data(), b.landmarks[i].x.data(), 7);
  for (std::size_t i = 0; equal && i < a.touch_points.size(); ++i) {
    equal = same(a.touch_points[i].p_hand.data(), b.touch_points[i].p_hand.data(), 3);
  }
  return equal;
}

OptimizerOptions precise() {
  OptimizerOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-12;
  return options;
}

TEST(Optimize, RecoversTheSceneFromExactMeasurements) {
  for (const Loss loss : {Loss{}, Loss{Loss::Kind::Huber, 1.5}, Loss{Loss::Kind::Cauchy, 3.0}}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Graph truth = make_scene({.loss = loss, .seed = seed}).truth;
      Graph graph = perturbed(truth, 0.1, seed + 100);
      const Verdict verdict = optimize(graph, precise());
      ASSERT_TRUE(verdict.usable) << verdict.message;
      EXPECT_TRUE(verdict.converged) << verdict.message;
      EXPECT_LT(verdict.final_cost, 1e-9);
      EXPECT_GT(verdict.initial_cost, 100.0);
      EXPECT_LT(largest_pose_distance(graph, truth), 1e-6);
      EXPECT_LT(largest_landmark_difference(graph, truth), 1e-6);
      EXPECT_LT((graph.touch_points[0].p_hand - truth.touch_points[0].p_hand).norm(), 1e-6);
    }
  }
}

TEST(Optimize, NoisyMeasurementsGiveTheCostOfTheirDegreesOfFreedom) {
  const Graph truth = make_scene({.noise = 1.0, .seed = 3}).truth;
  Graph graph = truth;
  const Verdict verdict = optimize(graph, precise());
  ASSERT_TRUE(verdict.usable);
  EXPECT_LT(verdict.final_cost, cost(truth));
  EXPECT_NEAR(verdict.final_cost, cost(graph), 1e-9 * verdict.final_cost);
  EXPECT_LT(largest_pose_distance(graph, truth), 0.05);
  EXPECT_LT(largest_landmark_difference(graph, truth), 0.05);
}

TEST(Optimize, MovingTheWorldMovesTheSolution) {
  const Graph graph = make_scene({.noise = 1.0, .loss = {Loss::Kind::Huber, 1.5}, .seed = 4}).truth;
  const double yaw = 2.1;
  const Vector3d shift(10.0, -20.0, 3.0);
  Graph here = graph, there = moved(graph, yaw, shift);
  EXPECT_NEAR(cost(there), cost(here), 1e-8 * cost(here));
  const Verdict a = optimize(here, precise()), b = optimize(there, precise());
  ASSERT_TRUE(a.usable && b.usable);
  EXPECT_NEAR(a.final_cost, b.final_cost, 1e-7 * a.final_cost);
  EXPECT_LT(largest_pose_distance(moved(here, yaw, shift), there), 1e-5);
  EXPECT_LT(largest_landmark_difference(moved(here, yaw, shift), there), 1e-5);
}

TEST(Optimize, TwoSolvesAreEqualToTheBit) {
  const Graph graph = perturbed(make_scene({.poses = 150, .noise = 1.0}).truth, 0.05, 9);
  Graph a = graph, b = graph;
  ASSERT_TRUE(optimize(a, {}).usable);
  ASSERT_TRUE(optimize(b, {}).usable);
  EXPECT_TRUE(same_values(a, b));
  EXPECT_FALSE(same_values(a, graph));
}

TEST(Optimize, WithoutPriorTheFirstPoseIsTheGauge) {
  const Graph truth = make_scene({.prior = false}).truth;
  Graph graph = perturbed(truth, 0.05, 2);
  graph.poses[0] = truth.poses[0];
  ASSERT_TRUE(optimize(graph, precise()).usable);
  EXPECT_EQ(graph.poses[0].p, truth.poses[0].p);
  EXPECT_EQ(graph.poses[0].q.coeffs(), truth.poses[0].q.coeffs());
  EXPECT_LT(largest_pose_distance(graph, truth), 1e-6);
}

TEST(Optimize, PosesBeforeTheFirstFreeOneStay) {
  const Graph before = make_scene({.noise = 1.0}).truth;
  Graph graph = before;
  OptimizerOptions options = precise();
  options.first_free_pose = 15;
  const Verdict verdict = optimize(graph, options);
  ASSERT_TRUE(verdict.usable);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(graph.poses[i].p, before.poses[i].p) << i;
  for (std::size_t i = 15; i < graph.poses.size(); ++i) EXPECT_NE(graph.poses[i].p, before.poses[i].p) << i;
  // The cost is that of the whole graph, constant parts included.
  EXPECT_NEAR(verdict.initial_cost, cost(before), 1e-9 * cost(before));
  EXPECT_NEAR(verdict.final_cost, cost(graph), 1e-9 * cost(graph));
}

TEST(Optimize, AllPosesHeldLeavesOnlyTheLandmarksToMove) {
  const Graph truth = make_scene({}).truth;
  Graph graph = truth;
  graph.landmarks[Scene::kTable].x[4] += 0.2;
  OptimizerOptions options = precise();
  options.first_free_pose = 1000;
  ASSERT_TRUE(optimize(graph, options).usable);
  EXPECT_LT(largest_pose_distance(graph, truth), 1e-15);
  EXPECT_LT(largest_landmark_difference(graph, truth), 1e-7);
}

TEST(Optimize, InactiveLandmarksAndTheirFactorsAreLeftOut) {
  const Graph truth = make_scene({}).truth;
  Graph graph = perturbed(truth, 0.05, 8);
  graph.landmarks[Scene::kTable].active = false;
  graph.landmarks[Scene::kTable].x = {9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 0.0};
  graph.landmarks[Scene::kWallA].active = false;  // drags its parallel factor along
  const Landmark table = graph.landmarks[Scene::kTable], wall = graph.landmarks[Scene::kWallA];
  const Verdict verdict = optimize(graph, precise());
  ASSERT_TRUE(verdict.usable);
  EXPECT_LT(verdict.final_cost, 1e-9);
  EXPECT_EQ(graph.landmarks[Scene::kTable].x, table.x);
  EXPECT_EQ(graph.landmarks[Scene::kWallA].x, wall.x);
  EXPECT_LT(largest_pose_distance(graph, truth), 1e-6);
}

TEST(Optimize, FixedTouchPointsStay) {
  const Graph truth = make_scene({.noise = 1.0}).truth;
  Graph graph = truth;
  ASSERT_TRUE(optimize(graph, {}).usable);
  EXPECT_EQ(graph.touch_points[1].p_hand, truth.touch_points[1].p_hand);
  EXPECT_NE(graph.touch_points[0].p_hand, truth.touch_points[0].p_hand);
}

TEST(Optimize, HeadingsStayUnwrapped) {
  const Graph truth = make_scene({}).truth;
  Graph graph = truth;
  const double turns = 2.0 * std::numbers::pi;
  graph.landmarks[Scene::kWallA].x[0] += 3.0 * turns + 0.05;
  graph.landmarks[Scene::kSeat].x[3] -= turns + 0.05;
  const Verdict verdict = optimize(graph, precise());
  ASSERT_TRUE(verdict.usable);
  EXPECT_LT(verdict.final_cost, 1e-9);
  EXPECT_NEAR(graph.landmarks[Scene::kWallA].x[0], truth.landmarks[Scene::kWallA].x[0] + 3.0 * turns, 1e-6);
  EXPECT_NEAR(graph.landmarks[Scene::kSeat].x[3], truth.landmarks[Scene::kSeat].x[3] - turns, 1e-6);
}

TEST(Optimize, ARobustLossHoldsAgainstWrongContacts) {
  const auto length_error = [](Loss loss) {
    const Graph truth = make_scene({.loss = loss}).truth;
    Graph graph = truth;
    for (std::size_t k = 0; k < graph.contacts.size(); k += 10) {  // a tenth of the contacts is 30 cm off
      graph.contacts[k].T_i_hand.p += Vector3d(0.2, 0.2, 0.1);
    }
    EXPECT_TRUE(optimize(graph, precise()).usable);
    return largest_landmark_difference(graph, truth);
  };
  const double none = length_error({}), huber = length_error({Loss::Kind::Huber, 1.0}),
               cauchy = length_error({Loss::Kind::Cauchy, 1.0});
  EXPECT_GT(none, 0.02);
  EXPECT_LT(huber, 0.5 * none);
  EXPECT_LT(cauchy, 0.1 * none);
}

TEST(Optimize, UndeterminedLandmarkNumbersDoNotSpoilTheRest) {
  // Nobody touched the table's +u side: its length is free together with its centre.
  const Graph truth = make_scene({}).truth;
  Graph graph = perturbed(truth, 0.05, 3);
  std::erase_if(graph.contacts, [](const ContactFactor& f) {
    return f.landmark == Scene::kTable && (f.edge == Edge::PlusU || f.corner == Edge::PlusU);
  });
  const Verdict verdict = optimize(graph, precise());
  ASSERT_TRUE(verdict.usable) << verdict.message;
  EXPECT_LT(verdict.final_cost, 1e-6);
  EXPECT_LT(largest_pose_distance(graph, truth), 1e-4);
  EXPECT_TRUE(std::isfinite(graph.landmarks[Scene::kTable].x[4]));
}

void expect_refused(Graph graph, const char* reason) {
  const Graph before = graph;
  const Verdict verdict = optimize(graph, {});
  EXPECT_FALSE(verdict.usable);
  EXPECT_FALSE(verdict.converged);
  EXPECT_NE(verdict.message.find(reason), std::string::npos) << verdict.message;
  EXPECT_TRUE(same_values(graph, before));
  EXPECT_TRUE(std::isnan(cost(graph)));
}

TEST(Optimize, FaultyGraphsAreRefusedWithTheReasonAndUntouched) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Graph good = make_scene({}).truth;
  const auto with = [&](auto&& change) {
    Graph graph = good;
    change(graph);
    return graph;
  };
  expect_refused(with([](Graph& g) { g.poses[3].p.x() = kNan; }), "pose 3");
  expect_refused(with([](Graph& g) { g.poses[3].q.coeffs() *= 2.0; }), "unit length");
  expect_refused(with([](Graph& g) { g.landmarks[1].x[1] = kNan; }), "landmark 1");
  expect_refused(with([](Graph& g) { g.touch_points[0].p_hand.z() = kNan; }), "touch point 0");
  expect_refused(with([](Graph& g) { g.touch_points[0].sigma.z() = 0.0; }), "touch point 0");
  expect_refused(with([](Graph& g) { g.between[2].j = 40; }), "between factor 2");
  expect_refused(with([](Graph& g) { g.between[2].j = g.between[2].i; }), "between factor 2");
  expect_refused(with([](Graph& g) { g.between[2].sqrt_information(0, 0) = kNan; }), "between factor 2");
  expect_refused(with([](Graph& g) { g.between[1].loss = {Loss::Kind::Huber, 0.0}; }), "between factor 1");
  expect_refused(with([](Graph& g) { g.gravity[1].i = 99; }), "gravity factor 1");
  expect_refused(with([](Graph& g) { g.gravity[1].sigma_rad = 0.0; }), "gravity factor 1");
  expect_refused(with([](Graph& g) { g.floors[5].i = 99; }), "floor factor 5");
  expect_refused(with([](Graph& g) { g.floors[5].z = kNan; }), "floor factor 5");
  expect_refused(with([](Graph& g) { g.priors[0].i = 99; }), "prior factor 0");
  expect_refused(with([](Graph& g) { g.priors[0].T_map_i.p.y() = kNan; }), "prior factor 0");
  expect_refused(with([](Graph& g) { g.contacts[7].i = 99; }), "contact factor 7");
  expect_refused(with([](Graph& g) { g.contacts[7].landmark = 99; }), "contact factor 7");
  expect_refused(with([](Graph& g) { g.contacts[7].landmark = Scene::kSeat; }), "contact factor 7");
  expect_refused(with([](Graph& g) { g.contacts[7].touch = 99; }), "contact factor 7");
  expect_refused(with([](Graph& g) { g.contacts[7].sigma_edge_m = -1.0; }), "contact factor 7");
  expect_refused(with([](Graph& g) { g.seats[0].landmark = Scene::kTable; }), "seat factor 0");
  expect_refused(with([](Graph& g) { g.seats[0].i = 99; }), "seat factor 0");
  expect_refused(with([](Graph& g) { g.seats[0].sigma_z_m = kNan; }), "seat factor 0");
  expect_refused(with([](Graph& g) { g.parallels[0].b = 99; }), "parallel factor 0");
  expect_refused(with([](Graph& g) { g.parallels[0].b = g.parallels[0].a; }), "parallel factor 0");
  expect_refused(with([](Graph& g) { g.parallels[0].offset_rad = kNan; }), "parallel factor 0");
  expect_refused(with([](Graph& g) { g.landmark_priors[0].index = 7; }), "landmark prior 0");
  expect_refused(with([](Graph& g) { g.landmark_priors[0].landmark = 5; }), "landmark prior 0");
  expect_refused(with([](Graph& g) { g.landmark_priors[0].sigma = 0.0; }), "landmark prior 0");
}

TEST(Optimize, OverflowInsideASolveLeavesTheGraphUntouched) {
  Graph graph = make_scene({}).truth;
  graph.floors[3].p_i = Vector3d::Constant(1e200);  // finite, but its square is not
  const Graph before = graph;
  const Verdict verdict = optimize(graph, {});
  EXPECT_FALSE(verdict.usable);
  EXPECT_TRUE(same_values(graph, before));
}

TEST(Optimize, SaysNothingOnStderr) {
  testing::internal::CaptureStderr();
  Graph graph = make_scene({}).truth;
  graph.floors[3].p_i = Vector3d::Constant(1e200);
  EXPECT_FALSE(optimize(graph, {}).usable);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Optimize, AnEmptyGraphIsSolved) {
  Graph graph;
  const Verdict verdict = optimize(graph, {});
  EXPECT_TRUE(verdict.usable) << verdict.message;
  EXPECT_EQ(verdict.final_cost, 0.0);
}

}  // namespace
}  // namespace kinemap::graph
