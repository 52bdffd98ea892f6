// SPDX-License-Identifier: Apache-2.0
#include "core/graph/variance_components.hpp"

#include <cstdint>

#include "core/graph/linearised.hpp"
#include "core/graph/normal_equations.hpp"

namespace kinemap::graph {
namespace {

constexpr int kProbes = 16;  // vectors of random signs per group

/// A bit for each probe, as good as random (the finaliser of splitmix64).
std::uint64_t signs(std::uint64_t row) {
  row = (row ^ (row >> 30)) * 0xbf58476d1ce4e5b9;
  row = (row ^ (row >> 27)) * 0x94d049bb133111eb;
  return row ^ (row >> 31);
}

/// Jᵀz for each probe z, and r² of the rows: with LLᵀ = JᵀJ the trace of J Σ Jᵀ is E‖L⁻¹Jᵀz‖². All probes of a row side
/// by side, so that what is done to one is done to all at once.
class Probes {
 public:
  explicit Probes(const Factorisation& system) : system_(system), Jtz_(Rows::Zero(system.L().cols(), kProbes)) {}

  void add(const ResidualBlock& block, const Linearised& linearised) {
    for (Eigen::Index row = 0; row < linearised.residuals().size(); ++row) {
      const Row z = probes(++rows_);
      bool changes = false;  // nothing changes the last row of a block with a loss
      for (int k = 0; k < block.count; ++k) {
        const ColumnRange& range = system_.columns[block.variables[static_cast<std::size_t>(k)]];
        const auto J = linearised.jacobian(k, range.size).row(row);
        if (J.isZero(0.0)) continue;
        changes = true;
        for (int c = 0; c < range.size; ++c) Jtz_.row(range.start + c) += J[c] * z;
      }
      if (!changes) continue;
      squares_ += linearised.residuals()[row] * linearised.residuals()[row];
      n_ += 1.0;
    }
  }
  [[nodiscard]] double squares() const { return squares_; }
  [[nodiscard]] double n() const { return n_; }
  [[nodiscard]] double trace() const {
    const Eigen::SparseMatrix<double>& L = system_.L();
    Rows x = Jtz_;
    for (Eigen::Index j = 0; j < L.cols(); ++j) {
      Eigen::SparseMatrix<double>::InnerIterator below(L, j);  // begins on the diagonal
      const Row solved = x.row(j) / below.value();
      x.row(j) = solved;
      for (++below; below; ++below) x.row(below.row()) -= below.value() * solved;
    }
    return x.squaredNorm() / kProbes;
  }

 private:
  using Row = Eigen::Matrix<double, 1, kProbes>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kProbes, Eigen::RowMajor>;

  static Row probes(std::uint64_t row) {
    const std::uint64_t bits = signs(row * 0x9e3779b97f4a7c15);
    Row z;
    for (int p = 0; p < kProbes; ++p) z[p] = (bits >> p & 1U) != 0 ? 1.0 : -1.0;
    return z;
  }

  const Factorisation& system_;
  Rows Jtz_;
  std::uint64_t rows_ = 0;
  double squares_ = 0.0, n_ = 0.0;
};

double independent_rows(const Graph& graph) {
  double sum = 0.0;
  for (const ContactFactor& f : graph.contacts)
    if (const Landmark& l = graph.landmarks[f.landmark]; l.active) sum += f.share * rows_of(f, l.kind);
  return sum;
}

}  // namespace

std::optional<VarianceComponents> variance_components(const Graph& graph) {
  const std::optional<Factorisation> system = factorise(graph);
  if (!system) return std::nullopt;

  Values values(graph);
  const ResidualBlocks problem(graph, values, graph.first_free_pose);
  Probes headings(*system), contacts(*system);
  Linearised linearised;
  for (const ResidualBlock& block : problem.blocks) {
    if (block.group == Group::Other) continue;
    if (!linearised.evaluate(block)) return std::nullopt;
    (block.group == Group::Heading ? headings : contacts).add(block, linearised);
  }
  VarianceComponents out;
  out.heading = {headings.squares(), headings.n() - headings.trace()};
  out.contact = {contacts.squares(), independent_rows(graph) - contacts.trace()};
  return out;
}

}  // namespace kinemap::graph
