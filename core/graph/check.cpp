// SPDX-License-Identifier: Apache-2.0
#include "core/graph/check.hpp"

#include <cmath>
#include <initializer_list>

namespace kinemap::graph {
namespace {

bool unit(const Eigen::Quaterniond& q) { return q.coeffs().allFinite() && std::abs(q.squaredNorm() - 1.0) < 1e-6; }
bool finite(const Pose& T) { return T.p.allFinite() && unit(T.q); }
bool positive(double sigma) { return std::isfinite(sigma) && sigma > 0.0; }
bool sound(const Loss& loss) { return loss.kind == Loss::Kind::None || positive(loss.scale); }

/// Collects the first fault; the messages are built only when there is one.
class Check {
 public:
  explicit Check(const Graph& graph) : g_(graph) {}

  void variables() {
    for (std::size_t i = 0; i < g_.poses.size(); ++i)
      require(finite(g_.poses[i]), "pose", i, "is not finite or not of unit length");
    for (std::size_t i = 0; i < g_.landmarks.size(); ++i) {
      const Landmark& l = g_.landmarks[i];
      bool ok = l.anchor.allFinite();
      for (int k = 0; k < dimension(l.kind); ++k) ok = ok && std::isfinite(l.x[static_cast<std::size_t>(k)]);
      require(ok || !l.active, "landmark", i, "is not finite");
    }
    for (std::size_t i = 0; i < g_.touch_points.size(); ++i) {
      const TouchPoint& t = g_.touch_points[i];
      require(t.p_hand.allFinite() && t.prior.allFinite(), "touch point", i, "is not finite");
      require(std::isfinite(t.turn_noise_rad_per_m), "touch point", i, "is not finite");
      require(t.fixed || (t.sigma.allFinite() && t.sigma.minCoeff() > 0.0), "touch point", i,
              "has a sigma that is not positive");
    }
    for (std::size_t i = 0; i < g_.scalars.size(); ++i)
      require(std::isfinite(g_.scalars[i]), "scalar", i, "is not finite");
  }

  void pose_factors() {
    for (std::size_t k = 0; k < g_.between.size(); ++k) {
      const BetweenFactor& f = g_.between[k];
      require(f.i < g_.poses.size() && f.j < g_.poses.size() && f.i != f.j, "between factor", k,
              "does not join two poses of the graph");
      require(finite(f.T_i_j) && f.sqrt_information.allFinite() && sound(f.loss), "between factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.gravity.size(); ++k) {
      const GravityFactor& f = g_.gravity[k];
      pose_exists(f.i, "gravity factor", k);
      require(f.up.allFinite() && positive(f.sigma_rad), "gravity factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.floors.size(); ++k) {
      const FloorFactor& f = g_.floors[k];
      pose_exists(f.i, "floor factor", k);
      require(f.p_i.allFinite() && std::isfinite(f.z) && positive(f.sigma_m) && sound(f.loss), "floor factor", k,
              kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.priors.size(); ++k) {
      const PriorFactor& f = g_.priors[k];
      pose_exists(f.i, "prior factor", k);
      require(finite(f.T_map_i) && f.sqrt_information.allFinite(), "prior factor", k, kBadNumbers);
    }
  }

  void heading_factors() {
    for (std::size_t k = 0; k < g_.compasses.size(); ++k) {
      const CompassFactor& f = g_.compasses[k];
      pose_exists(f.i, "compass factor", k), pose_exists(f.j, "compass factor", k);
      scalar_exists(f.north, "compass factor", k);
      require(unit(f.q_odom_i) && unit(f.q_odom_j) && std::isfinite(f.decay) && positive(f.sigma_rad), "compass factor",
              k, kBadNumbers);
      require(f.i != f.j || f.decay == 0.0, "compass factor", k, "compares a pose with itself");
    }
    for (std::size_t k = 0; k < g_.drifts.size(); ++k) {
      const DriftFactor& f = g_.drifts[k];
      for (const std::size_t scalar : {f.a, f.b, f.rate}) scalar_exists(scalar, "drift factor", k);
      require(f.a != f.b && f.a != f.rate && f.b != f.rate, "drift factor", k, "names one scalar twice");
      require(std::isfinite(f.dt_s) && positive(f.sigma_rad), "drift factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.scalar_priors.size(); ++k) {
      const ScalarPrior& f = g_.scalar_priors[k];
      scalar_exists(f.scalar, "scalar prior", k);
      require(std::isfinite(f.mean) && positive(f.sigma), "scalar prior", k, kBadNumbers);
    }
  }

  void landmark_factors() {
    for (std::size_t k = 0; k < g_.contacts.size(); ++k) {
      const ContactFactor& f = g_.contacts[k];
      pose_exists(f.i, "contact factor", k);
      if (!landmark_exists(f.landmark, "contact factor", k)) return;
      require(f.touch < g_.touch_points.size(), "contact factor", k,
              "refers to a touch point that the graph does not have");
      require(g_.landmarks[f.landmark].kind != LandmarkKind::Seat &&
                  g_.landmarks[f.landmark].kind != LandmarkKind::Direction,
              "contact factor", k, "is on a seat or direction, which has no surface");
      require(finite(f.T_i_hand) && positive(f.sigma_plane_m) && positive(f.sigma_edge_m) &&
                  positive(f.sigma_corner_m) && sound(f.loss),
              "contact factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.seats.size(); ++k) {
      const SeatFactor& f = g_.seats[k];
      pose_exists(f.i, "seat factor", k);
      if (!landmark_exists(f.landmark, "seat factor", k)) return;
      require(g_.landmarks[f.landmark].kind == LandmarkKind::Seat, "seat factor", k,
              "is on a landmark that is no seat");
      require(finite(f.T_i_seat) && positive(f.sigma_level_m) && positive(f.sigma_z_m) &&
                  positive(f.sigma_heading_rad) && sound(f.loss),
              "seat factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.parallels.size(); ++k) {
      const ParallelFactor& f = g_.parallels[k];
      if (!landmark_exists(f.a, "parallel factor", k) || !landmark_exists(f.b, "parallel factor", k)) return;
      require(f.a != f.b, "parallel factor", k, "compares a landmark with itself");
      require(std::isfinite(f.offset_rad) && positive(f.sigma_rad) && sound(f.loss), "parallel factor", k, kBadNumbers);
    }
    for (std::size_t k = 0; k < g_.landmark_priors.size(); ++k) {
      const LandmarkPrior& f = g_.landmark_priors[k];
      if (!landmark_exists(f.landmark, "landmark prior", k)) return;
      require(f.index >= 0 && f.index < dimension(g_.landmarks[f.landmark].kind), "landmark prior", k,
              "is on a number that its landmark does not have");
      require(std::isfinite(f.mean) && positive(f.sigma), "landmark prior", k, kBadNumbers);
    }
  }

  void folded_factors() {
    for (std::size_t k = 0; k < g_.folded.size(); ++k) {
      const FoldedFactor& f = g_.folded[k];
      if (!landmark_exists(f.landmark, "folded factor", k)) return;
      require(f.touch < g_.touch_points.size(), "folded factor", k,
              "refers to a touch point that the graph does not have");
      const int size = dimension(f.at.kind);
      require(g_.landmarks[f.landmark].kind == f.at.kind && f.residual.size() == f.sqrt_information.rows() &&
                  (f.sqrt_information.cols() == size || f.sqrt_information.cols() == size + 3),
              "folded factor", k, "has not the numbers of its landmark");
      require(f.sqrt_information.allFinite() && f.residual.allFinite() && f.p_hand.allFinite() && std::isfinite(f.rest),
              "folded factor", k, kBadNumbers);
    }
  }

  std::optional<std::string> fault;

 private:
  static constexpr const char* kBadNumbers =
      "has numbers that are not finite, or a sigma or loss scale that is not positive";

  void require(bool ok, const char* what, std::size_t index, const char* why) {
    if (!ok && !fault) fault = std::string(what) + " " + std::to_string(index) + " " + why;
  }
  void pose_exists(std::size_t i, const char* what, std::size_t index) {
    require(i < g_.poses.size(), what, index, "refers to a pose that the graph does not have");
  }
  void scalar_exists(std::size_t i, const char* what, std::size_t index) {
    require(i < g_.scalars.size(), what, index, "refers to a scalar that the graph does not have");
  }
  bool landmark_exists(std::size_t i, const char* what, std::size_t index) {
    require(i < g_.landmarks.size(), what, index, "refers to a landmark that the graph does not have");
    return i < g_.landmarks.size();
  }

  const Graph& g_;
};

}  // namespace

std::optional<std::string> find_fault(const Graph& graph) {
  Check check(graph);
  check.variables();
  check.pose_factors();
  check.heading_factors();
  check.landmark_factors();
  check.folded_factors();
  return check.fault;
}

}  // namespace kinemap::graph
