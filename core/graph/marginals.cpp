// SPDX-License-Identifier: Apache-2.0
#include "core/graph/marginals.hpp"

#include <algorithm>
#include <cassert>

#include "core/graph/normal_equations.hpp"

namespace kinemap::graph {

/// A = LLᵀ in the permuted order. Σ of some columns E is EᵀA⁻¹E = YᵀY with LY = E, and a unit vector's forward solve
/// only touches its path to the root of the elimination tree: a query costs far less than one full back-substitution.
class Marginals::Impl {
 public:
  Impl(Factorisation found, std::size_t poses, std::size_t landmarks)
      : system_(std::move(found)), poses_(poses), landmarks_(landmarks), L_(system_.L()) {}

  [[nodiscard]] Eigen::MatrixXd joint(std::span<const Variable> variables) const {
    std::vector<int> wanted;  // scalar columns, stacked
    for (const Variable& v : variables) {
      const ColumnRange range = columns_of(v);
      for (int k = 0; k < range.size; ++k) wanted.push_back(range.start + k);
    }
    std::vector<int> row_of(static_cast<std::size_t>(L_.cols()), -1);
    const std::vector<int> path = ancestors(wanted, row_of);

    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor Y = RowMajor::Zero(static_cast<Eigen::Index>(path.size()), static_cast<Eigen::Index>(wanted.size()));
    for (std::size_t k = 0; k < wanted.size(); ++k)
      Y(row_of[static_cast<std::size_t>(wanted[k])], static_cast<Eigen::Index>(k)) = 1.0;
    for (std::size_t r = 0; r < path.size(); ++r) {
      Eigen::SparseMatrix<double>::InnerIterator it(L_, path[r]);  // the diagonal comes first
      Y.row(static_cast<Eigen::Index>(r)) /= it.value();
      for (++it; it; ++it) {
        Y.row(row_of[static_cast<std::size_t>(it.row())]) -= it.value() * Y.row(static_cast<Eigen::Index>(r));
      }
    }
    const Eigen::MatrixXd covariance = Y.transpose() * Y;
    return covariance.selfadjointView<Eigen::Lower>();  // symmetric to the bit
  }

 private:
  [[nodiscard]] ColumnRange columns_of(const Variable& v) const {
    const std::size_t offset = v.kind == Variable::Kind::Pose       ? 0
                               : v.kind == Variable::Kind::Landmark ? poses_
                                                                    : poses_ + landmarks_;
    assert(offset + v.index < system_.columns.size());
    return system_.columns[offset + v.index];
  }

  /// The given columns and all their ancestors in the elimination tree, ascending; `row_of` gets each one's place in
  /// the list.
  [[nodiscard]] std::vector<int> ancestors(const std::vector<int>& from, std::vector<int>& row_of) const {
    std::vector<int> path;
    for (int j : from) {
      while (j >= 0 && row_of[static_cast<std::size_t>(j)] < 0) {
        row_of[static_cast<std::size_t>(j)] = 0;
        path.push_back(j);
        const int first = L_.outerIndexPtr()[j], last = L_.outerIndexPtr()[j + 1];
        j = last - first > 1 ? L_.innerIndexPtr()[first + 1] : -1;  // parent: first row below the diagonal
      }
    }
    std::sort(path.begin(), path.end());
    for (std::size_t r = 0; r < path.size(); ++r) row_of[static_cast<std::size_t>(path[r])] = static_cast<int>(r);
    return path;
  }

  Factorisation system_;
  std::size_t poses_, landmarks_;
  const Eigen::SparseMatrix<double>& L_;
};

std::optional<Marginals> Marginals::compute(const Graph& graph) {
  std::optional<Factorisation> found = factorise(graph);
  if (!found) return std::nullopt;
  return Marginals(std::make_unique<Impl>(std::move(*found), graph.poses.size(), graph.landmarks.size()));
}

Eigen::MatrixXd Marginals::joint(std::span<const Variable> variables) const { return impl_->joint(variables); }

Marginals::Marginals(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Marginals::~Marginals() = default;
Marginals::Marginals(Marginals&&) noexcept = default;
Marginals& Marginals::operator=(Marginals&&) noexcept = default;

}  // namespace kinemap::graph
