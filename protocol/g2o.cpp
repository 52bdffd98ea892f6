// SPDX-License-Identifier: Apache-2.0
#include "protocol/g2o.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <istream>
#include <string_view>
#include <unordered_map>

namespace kinemap {
namespace {

using graph::Matrix6;

constexpr std::size_t kLinesKept = 10;
/// σ of a FIX: far below anything measured, far above what would ruin the condition of the normal equations.
constexpr double kFixedSqrtInformation = 1e5;

/// e_quaternion = S·e_tangent to first order, because the vector part is half the angle.
Matrix6 quaternion_scale() {
  Matrix6 s = Matrix6::Identity();
  s.diagonal().tail<3>().setConstant(0.5);
  return s;
}

/// Eigenvalues below this part of the largest are taken as not positive: files carry six digits, so that what is left
/// there is rounding.
constexpr double kSmallestEigenvalue = 1e-9;

/// Upper U with Ω = UᵀU. An Ω that is not positive definite is first moved to the nearest matrix that is.
std::optional<Matrix6> upper_factor(const Matrix6& information, bool& clamped) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(information);
  const double smallest = kSmallestEigenvalue * eigen.eigenvalues().maxCoeff();
  if (!(smallest > 0.0)) return std::nullopt;
  clamped = eigen.eigenvalues().minCoeff() < smallest;
  if (!clamped) return Matrix6(information.llt().matrixU());
  const Eigen::Matrix<double, 6, 1> roots = eigen.eigenvalues().cwiseMax(smallest).cwiseSqrt();
  const Matrix6 root = roots.asDiagonal() * eigen.eigenvectors().transpose();
  return Matrix6(root.householderQr().matrixQR().triangularView<Eigen::Upper>());
}

/// The fields of one line, taken from the left.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}

  std::string_view word() {
    const auto begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return rest_ = {};
    const auto end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view w = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return w;
  }
  template <class T>
  bool number(T& value) {
    const std::string_view w = word();
    const auto [end, code] = std::from_chars(w.data(), w.data() + w.size(), value);
    return !w.empty() && code == std::errc{} && end == w.data() + w.size();
  }
  template <std::size_t N>
  bool finite_numbers(std::array<double, N>& values) {
    return std::all_of(values.begin(), values.end(), [this](double& v) { return number(v) && std::isfinite(v); });
  }
  bool at_end() { return word().empty(); }

 private:
  std::string_view rest_;
};

/// x y z qx qy qz qw; the quaternion as written is rounded, so it is made unit again. nullopt when it is far from unit.
std::optional<Pose> pose_from(const double* v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > 1e-2) return std::nullopt;
  return Pose{{v[0], v[1], v[2]}, q.normalized()};
}

class Parser {
 public:
  explicit Parser(std::string name) : name_(std::move(name)) {}

  Result<G2oGraph> run(std::istream& in) {
    std::string line;
    while (!error_ && std::getline(in, line)) {
      ++line_;
      parse_line(line);
    }
    if (!error_ && in.bad()) fail("cannot be read further");
    if (!error_) resolve();
    if (error_) return *error_;
    return std::move(out_);
  }

 private:
  struct Edge {
    std::int64_t i = 0, j = 0;
    std::size_t line = 0;
    graph::BetweenFactor factor;
  };
  struct Fix {
    std::int64_t id = 0;
    std::size_t line = 0;
  };

  void fail(const std::string& what) {
    if (!error_) error_ = Error{name_ + ":" + std::to_string(line_) + ": " + what};
  }

  void parse_line(std::string_view line) {
    Fields fields(line);
    const std::string tag(fields.word());
    if (tag.empty() || tag.front() == '#') return;
    if (tag == "VERTEX_SE3:QUAT") return parse_vertex(fields);
    if (tag == "EDGE_SE3:QUAT") return parse_edge(fields);
    if (tag == "FIX") return parse_fix(fields);
    if (tag == "VERTEX_SE2" || tag == "EDGE_SE2")
      return fail("is a 2-D graph (" + tag + "); only SE(3) graphs (VERTEX_SE3:QUAT) can be optimised");
    ++out_.skipped[tag];
  }

  void parse_vertex(Fields& fields) {
    std::int64_t id = 0;
    std::array<double, 7> v{};
    if (!fields.number(id) || !fields.finite_numbers(v) || !fields.at_end())
      return fail("expected VERTEX_SE3:QUAT id x y z qx qy qz qw, all finite");
    const std::optional<Pose> pose = pose_from(v.data());
    if (!pose) return fail("the quaternion of vertex " + std::to_string(id) + " is not of unit length");
    if (!vertices_.emplace(id, *pose).second) return fail("vertex " + std::to_string(id) + " is defined twice");
  }

  void parse_edge(Fields& fields) {
    Edge edge;
    std::array<double, 7> v{};
    std::array<double, 21> upper{};
    if (!fields.number(edge.i) || !fields.number(edge.j) || !fields.finite_numbers(v) ||
        !fields.finite_numbers(upper) || !fields.at_end()) {
      return fail(
          "expected EDGE_SE3:QUAT i j x y z qx qy qz qw and 21 numbers of the information's upper triangle, all "
          "finite");
    }
    if (edge.i == edge.j) return fail("edge from vertex " + std::to_string(edge.i) + " to itself");
    const std::optional<Pose> pose = pose_from(v.data());
    if (!pose) return fail("the quaternion of this edge is not of unit length");
    Matrix6 information;
    auto next = upper.begin();
    for (int r = 0; r < 6; ++r) {
      for (int c = r; c < 6; ++c) information(r, c) = information(c, r) = *next++;
    }
    bool clamped = false;
    const std::optional<Matrix6> U = upper_factor(information, clamped);
    if (!U) return fail("the information matrix has no positive eigenvalue");
    if (clamped && ++out_.clamped <= kLinesKept) out_.clamped_lines.push_back(line_);
    edge.line = line_;
    edge.factor.T_i_j = *pose;
    edge.factor.sqrt_information = *U * quaternion_scale();
    edges_.push_back(std::move(edge));
  }

  void parse_fix(Fields& fields) {
    Fix fix{0, line_};
    if (!fields.number(fix.id)) return fail("expected FIX id");
    fixes_.push_back(fix);
    while (!fields.at_end()) {
    }
  }

  /// From ids to indices, once all vertices are known: the file may name them in any order.
  void resolve() {
    if (vertices_.empty()) return fail("no VERTEX_SE3:QUAT in the file");
    std::unordered_map<std::int64_t, std::size_t> index;
    index.reserve(vertices_.size());
    for (const auto& [id, pose] : vertices_) {
      index.emplace(id, out_.ids.size());
      out_.ids.push_back(id);
      out_.graph.poses.push_back(pose);
    }
    const auto find = [&](std::int64_t id, std::size_t line, std::size_t& to) {
      const auto it = index.find(id);
      line_ = line;
      if (it == index.end()) return fail("vertex " + std::to_string(id) + " is not defined anywhere in the file");
      to = it->second;
    };
    for (Edge& e : edges_) {
      find(e.i, e.line, e.factor.i);
      find(e.j, e.line, e.factor.j);
      out_.graph.between.push_back(e.factor);
    }
    for (const Fix& f : fixes_) {
      graph::PriorFactor prior;
      find(f.id, f.line, prior.i);
      prior.T_map_i = out_.graph.poses[prior.i];
      prior.sqrt_information *= kFixedSqrtInformation;
      out_.graph.priors.push_back(prior);
    }
  }

  std::string name_;
  std::size_t line_ = 0;
  std::optional<Error> error_;
  G2oGraph out_;
  std::map<std::int64_t, Pose> vertices_;
  std::vector<Edge> edges_;
  std::vector<Fix> fixes_;
};

}  // namespace

Result<G2oGraph> parse_g2o(std::istream& in, const std::string& name) { return Parser(name).run(in); }

Result<G2oGraph> read_g2o(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return Error{path.string() + ": cannot be opened: " + std::strerror(errno)};
  return parse_g2o(in, path.string());
}

}  // namespace kinemap
