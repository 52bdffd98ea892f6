// SPDX-License-Identifier: Apache-2.0
#include "core/graph/residual_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "core/graph/factors.hpp"
#include "core/graph/optimizer.hpp"
#include "tests/core/graph/scene.hpp"

namespace kinemap::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One block at its values, and at values moved in the tangent.
struct Probe {
  explicit Probe(const ResidualBlock& block) : block_(block) {}

  [[nodiscard]] int rows() const { return block_.cost->num_residuals(); }
  [[nodiscard]] int size(int k) const { return block_.cost->parameter_block_sizes()[static_cast<std::size_t>(k)]; }

  [[nodiscard]] VectorXd residuals(int k, const VectorXd& delta, bool is_pose) const {
    std::vector<double> x(block_.parameters[static_cast<std::size_t>(k)],
                          block_.parameters[static_cast<std::size_t>(k)] + size(k));
    if (is_pose) {
      const Pose moved = test::plus({{x[0], x[1], x[2]}, Eigen::Quaterniond(x[6], x[3], x[4], x[5])}, delta);
      x = {moved.p.x(), moved.p.y(), moved.p.z(), moved.q.x(), moved.q.y(), moved.q.z(), moved.q.w()};
    } else {
      for (std::size_t c = 0; c < x.size(); ++c) x[c] += delta(static_cast<Eigen::Index>(c));
    }
    std::array<const double*, 3> parameters{block_.parameters[0], block_.parameters[1], block_.parameters[2]};
    parameters[static_cast<std::size_t>(k)] = x.data();
    VectorXd r(rows());
    EXPECT_TRUE(block_.cost->Evaluate(parameters.data(), r.data(), nullptr));
    return r;
  }

  /// Analytic Jacobian of block k alone (the others are not asked for).
  [[nodiscard]] RowMajor jacobian(int k) const {
    RowMajor J = RowMajor::Constant(rows(), size(k), std::nan(""));  // every entry must be written
    std::array<double*, 3> jacobians{};
    jacobians[static_cast<std::size_t>(k)] = J.data();
    VectorXd r(rows());
    EXPECT_TRUE(block_.cost->Evaluate(block_.parameters.data(), r.data(), jacobians.data()));
    return J;
  }

 private:
  const ResidualBlock& block_;
};

Graph noisy_scene(Loss loss) {
  return test::perturbed(test::make_scene({.poses = 12, .noise = 1.0, .prior = true, .loss = loss, .seed = 5}).truth,
                         0.1, 6);
}

TEST(ResidualBlocks, JacobiansMatchDifferences) {
  const Graph graph = noisy_scene({});
  Values values(graph);
  const ResidualBlocks problem(graph, values, 0);
  ASSERT_GT(problem.blocks.size(), 60U);
  for (const ResidualBlock& block : problem.blocks) {
    const Probe probe(block);
    for (int k = 0; k < block.count; ++k) {
      const bool is_pose = block.variables[static_cast<std::size_t>(k)] < graph.poses.size();
      const int n = is_pose ? 6 : probe.size(k);
      const RowMajor J = probe.jacobian(k);
      const MatrixXd numeric =
          test::differentiate([&](const VectorXd& d) { return probe.residuals(k, d, is_pose); }, n);
      EXPECT_LT(test::relative_difference(J.leftCols(n), numeric), 2e-7);
      if (is_pose) {
        EXPECT_EQ(J.col(6).cwiseAbs().maxCoeff(), 0.0);
      }
    }
  }
}

TEST(ResidualBlocks, WithLossesJtrIsTheGradientOfTheRobustCost) {
  for (const Loss loss : {Loss{Loss::Kind::Huber, 0.7}, Loss{Loss::Kind::Cauchy, 0.7}}) {
    const Graph graph = noisy_scene(loss);
    Values values(graph);
    const ResidualBlocks problem(graph, values, 0);
    for (const ResidualBlock& block : problem.blocks) {
      const Probe probe(block);
      for (int k = 0; k < block.count; ++k) {
        const bool is_pose = block.variables[static_cast<std::size_t>(k)] < graph.poses.size();
        const int n = is_pose ? 6 : probe.size(k);
        const VectorXd r = probe.residuals(k, VectorXd::Zero(probe.size(k)), false);
        const VectorXd gradient = probe.jacobian(k).leftCols(n).transpose() * r;
        const MatrixXd numeric = test::differentiate(
            [&](const VectorXd& d) -> VectorXd {
              return VectorXd::Constant(1, 0.5 * probe.residuals(k, d, is_pose).squaredNorm());
            },
            n);
        EXPECT_LT(test::relative_difference(gradient.transpose(), numeric), 1e-6);
      }
    }
  }
}

/// The cost once more, factor by factor, from the definitions in graph.hpp.
double plain_cost(const Graph& g) {
  double sum = 0.0;
  for (const auto& f : g.between) {
    const Vector6 e = f.sqrt_information * between_error(g.poses[f.i], g.poses[f.j], f.T_i_j, nullptr, nullptr);
    sum += evaluate(f.loss, e.squaredNorm()).rho;
  }
  for (const auto& f : g.gravity) sum += (g.poses[f.i].q * f.up).head<2>().squaredNorm() / (f.sigma_rad * f.sigma_rad);
  for (const auto& f : g.floors)
    sum += evaluate(f.loss, std::pow(((g.poses[f.i] * f.p_i).z() - f.z) / f.sigma_m, 2)).rho;
  for (const auto& f : g.priors)
    sum += (f.sqrt_information * prior_error(g.poses[f.i], f.T_map_i, nullptr)).squaredNorm();
  for (const auto& f : g.compasses) {
    const double north = g.scalars[f.north];
    const double m_i = wrap_angle(heading_offset(g.poses[f.i].q, f.q_odom_i) - north);
    const double m_j = wrap_angle(heading_offset(g.poses[f.j].q, f.q_odom_j) - north);
    sum += std::pow((m_j - f.decay * m_i) / f.sigma_rad, 2);
  }
  for (const auto& f : g.drifts)
    sum += std::pow((wrap_angle(g.scalars[f.b] - g.scalars[f.a]) - g.scalars[f.rate] * f.dt_s) / f.sigma_rad, 2);
  for (const auto& f : g.scalar_priors) sum += std::pow((g.scalars[f.scalar] - f.mean) / f.sigma, 2);
  for (const auto& f : g.contacts) {
    if (!g.landmarks[f.landmark].active) continue;
    const Eigen::Vector3d p = g.poses[f.i] * (f.T_i_hand * g.touch_points[f.touch].p_hand);
    const Eigen::Vector3d e = contact_error(g.landmarks[f.landmark], p, f.edge, f.corner);
    const TouchPoint& t = g.touch_points[f.touch];
    const double k2 = t.fixed ? 0.0 : std::pow(t.turn_noise_rad_per_m, 2);
    const double wider = (1.0 + k2 * t.p_hand.squaredNorm()) / (1.0 + k2 * t.prior.squaredNorm());
    sum += evaluate(f.loss, (std::pow(e(0) / f.sigma_plane_m, 2) + std::pow(e(1) / f.sigma_edge_m, 2) +
                             std::pow(e(2) / f.sigma_corner_m, 2)) /
                                wider)
               .rho;
  }
  for (const auto& f : g.seats) {
    if (!g.landmarks[f.landmark].active) continue;
    const Eigen::Vector4d e = seat_error(g.poses[f.i], g.landmarks[f.landmark].x.data(), f.T_i_seat, nullptr, nullptr);
    sum += evaluate(f.loss, e.head<2>().squaredNorm() / std::pow(f.sigma_level_m, 2) + std::pow(e(2) / f.sigma_z_m, 2) +
                                std::pow(e(3) / f.sigma_heading_rad, 2))
               .rho;
  }
  for (const auto& f : g.parallels) {
    const Landmark &a = g.landmarks[f.a], &b = g.landmarks[f.b];
    if (!a.active || !b.active) continue;
    const double d =
        b.x[static_cast<std::size_t>(heading_index(b.kind))] - a.x[static_cast<std::size_t>(heading_index(a.kind))];
    sum += evaluate(f.loss, std::pow(wrap_angle(d - f.offset_rad) / f.sigma_rad, 2)).rho;
  }
  for (const auto& f : g.landmark_priors) {
    if (!g.landmarks[f.landmark].active) continue;
    sum += std::pow((g.landmarks[f.landmark].x[static_cast<std::size_t>(f.index)] - f.mean) / f.sigma, 2);
  }
  for (const auto& t : g.touch_points) {
    if (!t.fixed) sum += (t.p_hand - t.prior).cwiseQuotient(t.sigma).squaredNorm();
  }
  return 0.5 * sum;
}

TEST(ResidualBlocks, CostIsTheSumOverTheFactors) {
  for (const Loss loss : {Loss{}, Loss{Loss::Kind::Huber, 0.7}, Loss{Loss::Kind::Cauchy, 0.7}}) {
    Graph graph = noisy_scene(loss);
    EXPECT_NEAR(cost(graph), plain_cost(graph), 1e-10 * plain_cost(graph));
    graph.landmarks[test::Scene::kTable].active = false;
    graph.landmarks[test::Scene::kWallB].active = false;
    EXPECT_NEAR(cost(graph), plain_cost(graph), 1e-10 * plain_cost(graph));
  }
}

TEST(ResidualBlocks, OrderOfTheContactsDoesNotMatter) {
  Graph graph = noisy_scene({Loss::Kind::Huber, 1.0});
  const double before = cost(graph);
  std::reverse(graph.contacts.begin(), graph.contacts.end());
  EXPECT_NEAR(cost(graph), before, 1e-11 * before);
  Values values(graph);
  std::set<std::tuple<std::size_t, std::size_t, std::size_t>> triples;
  for (const ContactFactor& f : graph.contacts) triples.emplace(f.i, f.landmark, f.touch);
  const ResidualBlocks problem(graph, values, 0);
  const std::size_t others = graph.between.size() + graph.poses.size() + graph.seats.size() + graph.compasses.size() +
                             graph.drifts.size() + graph.scalar_priors.size() + 1 + 1 + 1;
  EXPECT_EQ(problem.blocks.size(), triples.size() + others);
}

TEST(ResidualBlocks, BlocksOnConstantPosesAreSetAside) {
  const Graph graph = noisy_scene({});
  Values values(graph);
  const ResidualBlocks all(graph, values, 0), part(graph, values, 5);
  EXPECT_TRUE(all.constant.empty());
  EXPECT_EQ(part.constant.size(), 4U + 5U);  // between factors 0–1 … 3–4 and the unary blocks of poses 0 … 4
  EXPECT_EQ(part.blocks.size() + part.constant.size(), all.blocks.size());
  EXPECT_NEAR(evaluate_cost(part.blocks) + evaluate_cost(part.constant), evaluate_cost(all.blocks),
              1e-9 * evaluate_cost(all.blocks));
}

}  // namespace
}  // namespace kinemap::graph
