// SPDX-License-Identifier: Apache-2.0
#include "core/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinemap {
namespace {

/// Shortest augmenting paths with potentials (Kuhn 1955, in the O(n³) form). `cost` is square and finite; returns for
/// each column its row. Row and column 0 of the arrays are a sentinel.
std::vector<Eigen::Index> solve_square(const Eigen::MatrixXd& cost) {
  const Eigen::Index n = cost.rows();
  std::vector<double> u(n + 1, 0.0), v(n + 1, 0.0);
  std::vector<Eigen::Index> row_of(n + 1, 0), from(n + 1, 0);
  for (Eigen::Index row = 1; row <= n; ++row) {
    row_of[0] = row;
    Eigen::Index column = 0;
    std::vector<double> slack(n + 1, std::numeric_limits<double>::infinity());
    std::vector<char> used(n + 1, 0);
    while (row_of[column] != 0) {
      used[column] = 1;
      double delta = std::numeric_limits<double>::infinity();
      Eigen::Index next = 0;
      for (Eigen::Index j = 1; j <= n; ++j) {
        if (used[j]) continue;
        const double reduced = cost(row_of[column] - 1, j - 1) - u[row_of[column]] - v[j];
        if (reduced < slack[j]) {
          slack[j] = reduced;
          from[j] = column;
        }
        if (slack[j] < delta) {
          delta = slack[j];
          next = j;
        }
      }
      for (Eigen::Index j = 0; j <= n; ++j) {
        if (used[j]) {
          u[row_of[j]] += delta;
          v[j] -= delta;
        } else {
          slack[j] -= delta;
        }
      }
      column = next;
    }
    for (; column != 0; column = from[column]) row_of[column] = row_of[from[column]];
  }
  return row_of;
}

}  // namespace

std::vector<std::optional<std::size_t>> assign(const Eigen::MatrixXd& cost) {
  std::vector<std::optional<std::size_t>> columns(static_cast<std::size_t>(cost.rows()));
  const Eigen::Index n = std::max(cost.rows(), cost.cols());
  if (cost.size() == 0) return columns;
  // A pair that is not allowed costs more than all allowed ones together, so that it is never taken for the sake of
  // cost alone.
  const auto allowed = [](double c) { return std::isfinite(c) ? c : 0.0; };
  const double forbidden = 1.0 + cost.unaryExpr(allowed).sum();
  Eigen::MatrixXd square = Eigen::MatrixXd::Constant(n, n, forbidden);
  for (Eigen::Index r = 0; r < cost.rows(); ++r)
    for (Eigen::Index c = 0; c < cost.cols(); ++c)
      if (std::isfinite(cost(r, c))) square(r, c) = cost(r, c);
  const std::vector<Eigen::Index> row_of = solve_square(square);
  for (Eigen::Index c = 0; c < cost.cols(); ++c)
    if (const Eigen::Index r = row_of[c + 1] - 1; r < cost.rows() && std::isfinite(cost(r, c)))
      columns[static_cast<std::size_t>(r)] = static_cast<std::size_t>(c);
  return columns;
}

}  // namespace kinemap
