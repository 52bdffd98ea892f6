// SPDX-License-Identifier: Apache-2.0
#include "protocol/g2o.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/graph/initialize.hpp"
#include "core/graph/optimizer.hpp"
#include "core/graph/so3.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kIdentityInformation = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1";

Result<G2oGraph> parse(const std::string& text) {
  std::istringstream in(text);
  return parse_g2o(in, "in.g2o");
}

TEST(G2o, ReadsVerticesEdgesAndFixInAnyOrder) {
  const auto g = parse(
      "# a comment\n"
      "EDGE_SE3:QUAT 40 7 1 2 3 0 0 1 0" +
      kIdentityInformation +
      "\r\n"
      "FIX 40\n\n"
      "VERTEX_SE3:QUAT 40 1.5 -2e-1 0 0 0 0 1\n"
      "\tVERTEX_SE3:QUAT  7 0 0 1 0 0 0.6 0.8   \n");
  ASSERT_TRUE(g) << g.error();
  EXPECT_THAT(g->ids, testing::ElementsAre(7, 40));
  ASSERT_EQ(g->graph.between.size(), 1U);
  EXPECT_EQ(g->graph.between[0].i, 1U);
  EXPECT_EQ(g->graph.between[0].j, 0U);
  EXPECT_EQ(g->graph.between[0].T_i_j.p, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(g->graph.between[0].T_i_j.q.z(), 1.0);
  EXPECT_EQ(g->graph.poses[1].p, Eigen::Vector3d(1.5, -0.2, 0.0));
  EXPECT_EQ(g->graph.poses[0].q.w(), 0.8);
  ASSERT_EQ(g->graph.priors.size(), 1U);
  EXPECT_EQ(g->graph.priors[0].i, 1U);
  EXPECT_EQ(g->graph.priors[0].T_map_i.p, g->graph.poses[1].p);
  EXPECT_EQ(g->clamped, 0U);
}

TEST(G2o, InformationOfTheQuaternionIsFourTimesThatOfTheAngle) {
  // Upper triangle: translation 1, 2, 3; rotation 4, 16, 100 with 2 between x and qz.
  const auto g = parse(
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n"
      "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1  1 0 0 0 0 2  2 0 0 0 0  3 0 0 0  4 0 0  16 0  100\n");
  ASSERT_TRUE(g) << g.error();
  const graph::Matrix6& U = g->graph.between[0].sqrt_information;
  EXPECT_TRUE(U.isUpperTriangular());
  graph::Matrix6 expected = graph::Matrix6::Zero();
  expected.diagonal() << 1.0, 2.0, 3.0, 1.0, 4.0, 25.0;
  expected(0, 5) = expected(5, 0) = 1.0;
  EXPECT_LT((U.transpose() * U - expected).norm(), 1e-14);
}

TEST(G2o, CostUsesTheVectorPartWhateverTheSignOfTheQuaternion) {
  for (const char* measured : {"0 0 0 1", "0 0 0 -1"}) {
    const auto g =
        parse(std::string(
                  "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0.1 0 0 0 0 0.6 0.8\nEDGE_SE3:QUAT 0 1 0 0 0 ") +
              measured + kIdentityInformation + "\n");
    ASSERT_TRUE(g) << g.error();
    EXPECT_NEAR(g2o_cost(g->graph), 0.01 + 0.36, 1e-14);
  }
}

TEST(G2o, InformationThatIsNotPositiveDefiniteIsClampedAndCounted) {
  const std::string vertices = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n";
  const std::string edge = "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 ";
  // [[1, 2], [2, 1]] in x, y has eigenvalues 3 and −1; the nearest definite matrix is [[1.5, 1.5], [1.5, 1.5]].
  const auto g =
      parse(vertices + edge + kIdentityInformation + "\n" + edge + "1 2 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  ASSERT_TRUE(g) << g.error();
  EXPECT_EQ(g->clamped, 1U);
  EXPECT_THAT(g->clamped_lines, testing::ElementsAre(4));
  const graph::Matrix6& U = g->graph.between[1].sqrt_information;
  EXPECT_TRUE(U.allFinite());
  EXPECT_LT(((U.transpose() * U).topLeftCorner<2, 2>() - Eigen::Matrix2d::Constant(1.5)).norm(), 1e-8);
}

TEST(G2o, UnknownTagsAreCounted) {
  const auto g = parse(
      "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 1 0 0 0\nVERTEX_TRACKXYZ 2 0 "
      "0 0\n");
  ASSERT_TRUE(g) << g.error();
  EXPECT_EQ(g->skipped.size(), 2U);
  EXPECT_EQ(g->skipped.at("VERTEX_TRACKXYZ"), 2U);
}

TEST(G2o, ErrorsNameTheLine) {
  const std::string v0 = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", v1 = "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n";
  const auto expect_error = [](const std::string& text, const std::string& line, const std::string& reason) {
    const auto g = parse(text);
    ASSERT_FALSE(g) << text;
    EXPECT_THAT(g.error(), StartsWith("in.g2o:" + line + ": "));
    EXPECT_THAT(g.error(), HasSubstr(reason));
  };
  expect_error("", "0", "no VERTEX_SE3:QUAT");
  expect_error(v0 + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0\n", "2", "expected VERTEX_SE3:QUAT");
  expect_error(v0 + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1 5\n", "2", "expected VERTEX_SE3:QUAT");
  expect_error(v0 + "VERTEX_SE3:QUAT 1 0 0 x 0 0 0 1\n", "2", "expected VERTEX_SE3:QUAT");
  expect_error(v0 + "VERTEX_SE3:QUAT 1 0 0 nan 0 0 0 1\n", "2", "finite");
  expect_error(v0 + "VERTEX_SE3:QUAT 1 0 0 inf 0 0 0 1\n", "2", "finite");
  expect_error(v0 + "VERTEX_SE3:QUAT 1.5 0 0 0 0 0 0 1\n", "2", "expected VERTEX_SE3:QUAT");
  expect_error("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 0\n", "1", "unit length");
  expect_error(v0 + v1 + v0, "3", "vertex 0 is defined twice");
  expect_error(v0 + v1 + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 1 0 0\n", "3", "21 numbers");
  expect_error(v0 + v1 + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1" + kIdentityInformation + " 1\n", "3", "21 numbers");
  expect_error(v0 + v1 + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 2" + kIdentityInformation + "\n", "3", "unit length");
  expect_error(v0 + v1 + "EDGE_SE3:QUAT 1 1 0 0 0 0 0 0 1" + kIdentityInformation + "\n", "3", "itself");
  expect_error(v0 + v1 + "EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n", "3",
               "no positive eigenvalue");
  expect_error(v0 + "\nEDGE_SE3:QUAT 0 9 0 0 0 0 0 0 1" + kIdentityInformation + "\n" + v1, "3",
               "vertex 9 is not defined");
  expect_error(v0 + "FIX\n", "2", "expected FIX");
  expect_error(v0 + "FIX 3\n", "2", "vertex 3 is not defined");
  expect_error("VERTEX_SE2 0 0 0 0\n", "1", "2-D graph");
  expect_error(v0 + "EDGE_SE2 0 1 0 0 0 1 0 0 1 0 1\n", "2", "2-D graph");
}

TEST(G2o, EveryTruncationIsAValueOrAnError) {
  const std::string text =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\nFIX 0\nEDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1" +
      kIdentityInformation + "\n";
  for (std::size_t n = 0; n < text.size(); ++n) {
    const auto g = parse(text.substr(0, n));
    if (!g) {
      EXPECT_THAT(g.error(), StartsWith("in.g2o:")) << n;
    }
  }
}

TEST(G2o, UnreadablePathsAreErrors) {
  const auto g = read_g2o("/nonexistent/in.g2o");
  ASSERT_FALSE(g);
  EXPECT_THAT(g.error(), HasSubstr("/nonexistent/in.g2o: cannot be opened"));
}

graph::Graph small_graph() {
  graph::Graph g;
  for (int i = 0; i < 4; ++i) {
    g.poses.push_back({{0.1 * i, 1.0 / 3.0, -1.0 * i}, graph::so3_exp({0.3 * i, -0.2, 0.7})});
    if (i == 0) continue;
    graph::BetweenFactor f;
    f.i = static_cast<std::size_t>(i - 1), f.j = static_cast<std::size_t>(i);
    f.T_i_j = {{1.0 / 7.0, 0.0, 0.5}, graph::so3_exp({0.1, 0.2, 0.1 * i})};
    f.sqrt_information.triangularView<Eigen::StrictlyUpper>().setConstant(0.25);
    f.sqrt_information.diagonal() << 10.0, 20.0, 30.0, 100.0, 200.0, 300.0;
    g.between.push_back(f);
  }
  g.priors.push_back({2, g.poses[2], graph::Matrix6::Identity()});
  return g;
}

TEST(G2o, WhatIsWrittenIsReadBack) {
  const graph::Graph g = small_graph();
  const std::int64_t ids[] = {5, 10, 11, 200};
  const auto back = parse(g2o_text(g, ids));
  ASSERT_TRUE(back) << back.error();
  EXPECT_THAT(back->ids, testing::ElementsAreArray(ids));
  ASSERT_EQ(back->graph.poses.size(), g.poses.size());
  for (std::size_t i = 0; i < g.poses.size(); ++i) {
    EXPECT_EQ(back->graph.poses[i].p, g.poses[i].p);
    EXPECT_LT((back->graph.poses[i].q.coeffs() - g.poses[i].q.coeffs()).norm(), 1e-15);
  }
  ASSERT_EQ(back->graph.between.size(), g.between.size());
  for (std::size_t k = 0; k < g.between.size(); ++k) {
    EXPECT_EQ(back->graph.between[k].j, g.between[k].j);
    EXPECT_EQ(back->graph.between[k].T_i_j.p, g.between[k].T_i_j.p);
    EXPECT_LT((back->graph.between[k].sqrt_information - g.between[k].sqrt_information).norm(), 1e-9);
  }
  ASSERT_EQ(back->graph.priors.size(), 1U);
  EXPECT_EQ(back->graph.priors[0].i, 2U);
}

TEST(G2o, AMapIsItsKeyPosesAndOdometryWithObjectsAsComments) {
  MapSnapshot map = sample_map();
  for (TrajectoryPose& pose : map.trajectory) pose.step = {0.1, 0.2, 0.01, 0.02};
  const std::string text = g2o_text(map);
  EXPECT_THAT(text, HasSubstr("# object 2 table 2 1 0.74 "));
  EXPECT_THAT(text, HasSubstr(" 1.6 0.8\n"));
  const auto back = parse(text);
  ASSERT_TRUE(back) << back.error();
  EXPECT_TRUE(back->skipped.empty());
  ASSERT_EQ(back->graph.poses.size(), 4U);
  EXPECT_EQ(back->graph.poses[3].p, map.trajectory[3].T_map_pelvis.p);
  ASSERT_EQ(back->graph.between.size(), 3U);
  const graph::BetweenFactor& step = back->graph.between[2];
  const Pose& from = map.trajectory[2].T_odom_pelvis;
  EXPECT_LT((from * step.T_i_j.p - map.trajectory[3].T_odom_pelvis.p).norm(), 1e-12);
  const Eigen::Matrix<double, 6, 1> information = step.sqrt_information.diagonal();
  EXPECT_THAT(information, testing::Pointwise(testing::DoubleNear(1e-9), {10.0, 10.0, 5.0, 100.0, 100.0, 50.0}));
  EXPECT_THAT(g2o_text(MapSnapshot{}), testing::Not(HasSubstr("VERTEX")));
}

struct Benchmark {
  const char* file;
  std::size_t poses, edges, clamped;
  double best_cost, tolerance;
};

class G2oBenchmark : public testing::TestWithParam<Benchmark> {};

/// Best known costs of the public sets, Σ eᵀΩe. Ours minimises over the rotation vector instead of the quaternion's
/// vector part, which puts the optimum of the noisy sphere 5e-8 of its cost beside; the tolerances are what that
/// explains.
TEST_P(G2oBenchmark, ReachesTheBestKnownCost) {
  const Benchmark& b = GetParam();
  const std::filesystem::path path = std::filesystem::path(KINEMAP_SHARED_DATA) / b.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "NOT TESTED: " << path << " is not there";
  auto g = read_g2o(path);
  ASSERT_TRUE(g) << g.error();
  EXPECT_EQ(g->graph.poses.size(), b.poses);
  EXPECT_EQ(g->graph.between.size(), b.edges);
  EXPECT_EQ(g->clamped, b.clamped);
  graph::OptimizerOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-10;
  const graph::Verdict verdict = graph::optimize(g->graph, options);
  EXPECT_TRUE(verdict.usable && verdict.converged) << verdict.message;
  EXPECT_NEAR(g2o_cost(g->graph), b.best_cost, b.tolerance);
}

TEST_P(G2oBenchmark, ReachesItWithoutAnyStart) {
  const Benchmark& b = GetParam();
  const std::filesystem::path path = std::filesystem::path(KINEMAP_SHARED_DATA) / b.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "NOT TESTED: " << path << " is not there";
  auto g = read_g2o(path);
  ASSERT_TRUE(g) << g.error();
  for (Pose& T : g->graph.poses) T = Pose{};
  ASSERT_TRUE(graph::chordal_start(g->graph));
  graph::OptimizerOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-10;
  EXPECT_TRUE(graph::optimize(g->graph, options).usable);
  EXPECT_NEAR(g2o_cost(g->graph), b.best_cost, b.tolerance);
}

INSTANTIATE_TEST_SUITE_P(Public, G2oBenchmark,
                         testing::Values(Benchmark{"sphere2500.g2o", 2500, 4949, 0, 727.14967, 1e-4},
                                         Benchmark{"parking-garage.g2o", 1661, 6275, 3, 1.2386906, 1e-7}));

}  // namespace
}  // namespace kinemap
