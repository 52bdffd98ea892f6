// SPDX-License-Identifier: Apache-2.0
#include "core/graph/initialize.hpp"

#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <numeric>
#include <optional>

#include "core/graph/check.hpp"
#include "core/graph/factors.hpp"

namespace kinemap::graph {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

/// For each pose the pose of its connected part that keeps its value.
std::vector<std::size_t> anchors(const Graph& graph) {
  std::vector<std::size_t> root(graph.poses.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const BetweenFactor& f : graph.between) {
    const std::size_t a = find(f.i), b = find(f.j);
    root[std::max(a, b)] = std::min(a, b);  // the root is the part's first pose
  }
  std::vector<std::optional<std::size_t>> prior(graph.poses.size());
  for (const PriorFactor& f : graph.priors) {
    if (!prior[find(f.i)]) prior[find(f.i)] = f.i;
  }
  std::vector<std::size_t> anchor(graph.poses.size());
  for (std::size_t i = 0; i < anchor.size(); ++i) anchor[i] = prior[find(i)].value_or(find(i));
  return anchor;
}

/// Numbers the poses that are free; anchors get −1.
std::vector<int> number_free(const std::vector<std::size_t>& anchor, int& count) {
  std::vector<int> number(anchor.size(), -1);
  count = 0;
  for (std::size_t i = 0; i < anchor.size(); ++i) {
    if (anchor[i] != i) number[i] = count++;
  }
  return number;
}

/// Least squares of Σ w‖A·x_i + b − x_j‖² over blocks x of `size` rows and 3 columns; anchored blocks are known.
class BlockLeastSquares {
 public:
  BlockLeastSquares(const std::vector<int>& number, int count, int size)
      : number_(number), size_(size), right_(MatrixXd::Zero(count * size, 3)) {}

  void add(std::size_t i, std::size_t j, const MatrixXd& A, const MatrixXd& b, const MatrixXd& known_i,
           const MatrixXd& known_j, double w) {
    const int ni = number_[i], nj = number_[j];
    // r = A·x_i − x_j + c, with what is known moved into c.
    MatrixXd c = b;
    if (ni < 0) c += A * known_i;
    if (nj < 0) c -= known_j;
    if (ni >= 0) {
      place(ni, ni, w * A.transpose() * A);
      right_.middleRows(ni * size_, size_) -= w * A.transpose() * c;
    }
    if (nj >= 0) {
      place(nj, nj, w * MatrixXd::Identity(size_, size_));
      right_.middleRows(nj * size_, size_) += w * c;
    }
    if (ni >= 0 && nj >= 0) {
      place(ni, nj, -w * A.transpose());
      place(nj, ni, -w * A);
    }
  }

  [[nodiscard]] std::optional<MatrixXd> solve() const {
    if (right_.rows() == 0) return right_;
    Sparse H(right_.rows(), right_.rows());
    H.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Sparse> ldlt(H);
    if (ldlt.info() != Eigen::Success) return std::nullopt;
    MatrixXd x = ldlt.solve(right_);
    if (!x.allFinite()) return std::nullopt;
    return x;
  }

 private:
  void place(int row, int col, const MatrixXd& block) {
    for (int r = 0; r < size_; ++r) {
      for (int c = 0; c < size_; ++c) entries_.emplace_back(row * size_ + r, col * size_ + c, block(r, c));
    }
  }

  const std::vector<int>& number_;
  int size_;
  MatrixXd right_;
  std::vector<Eigen::Triplet<double>> entries_;
};

Matrix3d nearest_rotation(const Matrix3d& m) {
  const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  return U * svd.matrixV().transpose();
}

/// Information of a factor's rotation or position as one number.
double mean_information(const BetweenFactor& f, int first) {
  return f.sqrt_information.middleCols<3>(first).squaredNorm() / 3.0;
}

/// R_j = R_i·R_ij, transposed so that the unknown stands on the right: R_jᵀ = R_ijᵀ·R_iᵀ.
bool solve_rotations(const Graph& graph, const std::vector<int>& number, int count, std::vector<Pose>& poses) {
  BlockLeastSquares system(number, count, 3);
  for (const BetweenFactor& f : graph.between) {
    system.add(f.i, f.j, f.T_i_j.q.toRotationMatrix().transpose(), Matrix3d::Zero(),
               poses[f.i].q.toRotationMatrix().transpose(), poses[f.j].q.toRotationMatrix().transpose(),
               mean_information(f, 3));
  }
  const std::optional<MatrixXd> x = system.solve();
  if (!x) return false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (number[i] < 0) continue;
    poses[i].q = Eigen::Quaterniond(nearest_rotation(x->middleRows<3>(3 * number[i]).transpose())).normalized();
  }
  return true;
}

/// p_j = p_i + R_i·p_ij with the rotations just found.
bool solve_positions(const Graph& graph, const std::vector<int>& number, int count, std::vector<Pose>& poses) {
  BlockLeastSquares system(number, count, 1);
  const MatrixXd one = MatrixXd::Identity(1, 1);
  for (const BetweenFactor& f : graph.between) {
    system.add(f.i, f.j, one, (poses[f.i].q * f.T_i_j.p).transpose(), poses[f.i].p.transpose(),
               poses[f.j].p.transpose(), mean_information(f, 0));
  }
  const std::optional<MatrixXd> x = system.solve();
  if (!x) return false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (number[i] >= 0) poses[i].p = x->row(number[i]).transpose();
  }
  return true;
}

}  // namespace

double largest_rotation_error(const Graph& graph) {
  double largest = 0.0;
  for (const BetweenFactor& f : graph.between) {
    const Vector6 e = between_error(graph.poses[f.i], graph.poses[f.j], f.T_i_j, nullptr, nullptr);
    largest = std::max(largest, e.tail<3>().norm());
  }
  return largest;
}

bool chordal_start(Graph& graph) {
  if (!graph.contacts.empty() || !graph.seats.empty() || find_fault(graph)) return false;
  int count = 0;
  const std::vector<int> number = number_free(anchors(graph), count);
  std::vector<Pose> poses = graph.poses;
  for (const PriorFactor& f : graph.priors) {
    if (number[f.i] < 0) poses[f.i] = f.T_map_i;
  }
  if (!solve_rotations(graph, number, count, poses) || !solve_positions(graph, number, count, poses)) return false;
  graph.poses = std::move(poses);
  return true;
}

}  // namespace kinemap::graph
