// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/pose.hpp"

/// The estimation problem as plain values: variables with their current values, and factors that refer to them by
/// index. core/graph/optimizer.hpp solves it, core/graph/marginals.hpp says how certain the solution is. Nothing here
/// knows Ceres.
///
/// Tangent of a pose: right perturbation δ = [δp; δθ] (6), T ⊞ δ = {p + q·δp, q·exp(δθ)}; metres, radians.
namespace kinemap::graph {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

enum class LandmarkKind : std::uint8_t { Wall, Table, Screen, Seat, Direction };

/// A landmark with the fewest numbers its nature leaves free (`dimension(kind)` of `x` are used):
/// - Wall (2): heading ψ of the normal, offset d; n = (cos ψ, sin ψ, 0), n·(p − anchor) = d.
/// - Table (6): centre x, y, z; heading of the first side; length along it (u), width across it (v). Local axes u level
/// along the
///   heading, v level to its left, w up.
/// - Screen (7): centre x, y, z; heading ψ of the normal; width (u), height (v); tilt τ. Local axes w = normal, tilted
/// up from the level by
///   τ; u = level, ẑ × n; v = w × u, up in the plane.
/// - Seat (4): x, y, z; heading where the sitter faces.
/// - Direction (1): heading that walls are parallel or perpendicular to; not a thing, nothing touches it.
struct Landmark {
  LandmarkKind kind = LandmarkKind::Wall;
  std::array<double, 7> x{};
  Eigen::Vector3d anchor =
      Eigen::Vector3d::Zero();  ///< walls only: fixed point near the contacts, keeps offset and heading apart
  bool active = true;           ///< inactive landmarks and their factors are left out of the problem
};
constexpr int dimension(LandmarkKind kind) {
  constexpr int sizes[] = {2, 6, 7, 4, 1};
  return sizes[static_cast<int>(kind)];
}

/// Where the hand touches, in the hand segment's frame (m); a variable with a Gaussian prior, or fixed.
///
/// The hand's orientation is noisy itself, so the noise of a contact grows with the lever: its variance at p_hand is
/// (1 + k²‖p_hand‖²) / (1 + k²‖prior‖²) of what the contact factor says, with k = turn_noise_rad_per_m, the noise of
/// the orientation over that of the wrist's position. Without that term the estimate is drawn to the wrist, where noisy
/// turns do no harm (errors in variables; with it, this is total least squares: Golub and Van Loan 1980).
struct TouchPoint {
  Eigen::Vector3d p_hand = Eigen::Vector3d::Zero();
  Eigen::Vector3d prior = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Constant(0.02);
  bool fixed = true;
  double turn_noise_rad_per_m = 0.0;
};

/// A robust loss on the squared, whitened norm of one factor's residual; `scale` in standard deviations.
struct Loss {
  enum class Kind : std::uint8_t { None, Huber, Cauchy } kind = Kind::None;
  double scale = 1.0;
};

/// Relative motion between two poses (paper eq. 1, 2): e = [R_ij^T (T_i^-1 T_j).p − …; log(q_ij^-1 q_i^-1 q_j)],
/// whitened.
struct BetweenFactor {
  std::size_t i = 0, j = 0;
  Pose T_i_j;
  Matrix6 sqrt_information = Matrix6::Identity();  ///< upper factor U of Ω = UᵀU, residual = U·e
  Loss loss;
};

/// The suit's compass. Pose k is turned about the vertical by o_k = yaw(q_map_k · q_odom_k⁻¹) against what the suit
/// says, of which `north` is the lasting part; the rest, m_k = o_k − north, is a first-order Gauss-Markov process that
/// decays with time: e = m_j − decay·m_i, over sigma. With i = j and decay 0 it says how large m_j may be at all.
struct CompassFactor {
  std::size_t i = 0, j = 0;
  std::size_t north = 0;  ///< index in Graph::scalars, rad
  Eigen::Quaterniond q_odom_i = Eigen::Quaterniond::Identity(), q_odom_j = Eigen::Quaterniond::Identity();
  double decay = 1.0;  ///< e^(−Δt/τ)
  double sigma_rad = 0.01;
};

/// An angle drifts at an unknown constant rate: wrap(b − a) − rate·dt, over sigma. Indices in Graph::scalars.
struct DriftFactor {
  std::size_t a = 0, b = 0;  ///< rad
  std::size_t rate = 0;      ///< rad/s
  double dt_s = 1.0;
  double sigma_rad = 0.01;
};

/// Gaussian prior on a scalar.
struct ScalarPrior {
  std::size_t scalar = 0;
  double mean = 0.0;
  double sigma = 1.0;
};

/// Gravity: the direction up, seen in the pose's frame (unit). Residual: the level part of R_map_i·up, over sigma
/// (rad).
struct GravityFactor {
  std::size_t i = 0;
  Eigen::Vector3d up;
  double sigma_rad = 0.01;
};

/// The stance foot is on its level: z of T_map_i·p_i equals `z`.
struct FloorFactor {
  std::size_t i = 0;
  Eigen::Vector3d p_i;
  double z = 0.0;
  double sigma_m = 0.02;
  Loss loss;
};

/// Anchors a pose (the gauge): residual as BetweenFactor's with T_map_i.
struct PriorFactor {
  std::size_t i = 0;
  Pose T_map_i;
  Matrix6 sqrt_information = Matrix6::Identity();
};

/// Side of a rectangle: the line u = ∓x_u/2 or v = ∓x_v/2 of its plane.
enum class Edge : std::uint8_t { None, MinusU, PlusU, MinusV, PlusV };

/// One hand contact: the touching point p = T_map_i · T_i_hand · p_hand lies on the landmark's plane (paper eq. 4) and,
/// for rectangles, on the side it was drawn along; `corner` names the second side where the contact is a corner (end of
/// an open contour). Residuals: [plane distance / sigma_plane, edge distance / sigma_edge, corner distance /
/// sigma_corner], those that apply.
struct ContactFactor {
  std::size_t i = 0;
  std::size_t landmark = 0;
  std::size_t touch = 0;
  Pose T_i_hand;
  Edge edge = Edge::None;
  Edge corner = Edge::None;
  double sigma_plane_m = 0.02;
  double sigma_edge_m = 0.02;
  double sigma_corner_m = 0.05;
  double share = 1.0;  ///< contacts that err together count as one; of that one it is so much
  Loss loss;
};

/// A seat seen from a pose (paper eq. 3): position and heading of `T_i_seat`.
struct SeatFactor {
  std::size_t i = 0;
  std::size_t landmark = 0;
  Pose T_i_seat;
  double sigma_level_m = 0.05;
  double sigma_z_m = 0.03;
  double sigma_heading_rad = 0.1;
  Loss loss;
};

/// Two landmarks' headings differ by a multiple of 90°: wrap(ψ_b − ψ_a − offset) / sigma, under a loss that lets an
/// oblique wall go.
struct ParallelFactor {
  std::size_t a = 0, b = 0;
  double offset_rad = 0.0;
  double sigma_rad = 0.02;
  Loss loss;
};

/// Gaussian prior on one number of a landmark (for example a screen's tilt).
struct LandmarkPrior {
  std::size_t landmark = 0;
  int index = 0;
  double mean = 0.0;
  double sigma = 1.0;
};

/// What contacts or seats that are no more in the graph said of a landmark and of a touching point
/// (core/graph/fold.hpp makes it): a Gaussian on the numbers that the landmark had when they were folded, whatever it
/// is called since. Residual: [sqrt_information·δ + residual; rest] with δ the change of these numbers, then that of
/// the touching point.
struct FoldedFactor {
  std::size_t landmark = 0;
  std::size_t touch = 0;
  Landmark at;                                       ///< as it was
  Eigen::Vector3d p_hand = Eigen::Vector3d::Zero();  ///< as it was
  int quarter_turns = 0;             ///< tables: the axes are turned so many times 90° against the landmark's of now
  Eigen::MatrixXd sqrt_information;  ///< a column for each number; three more when the touching point was free
  Eigen::VectorXd residual;          ///< at `at` and `p_hand`
  double rest = 0.0;                 ///< no numbers change it; the cost goes on as it was
  double weighted_squares = 0.0;     ///< Σ weighted_square() of the contacts
};

/// Errors of some kinds over what their factors' sigmas say: the sigmas are multiplied by it.
struct NoiseScales {
  double heading = 1.0;  ///< compasses, drifts and the priors of scalars
  double contact = 1.0;
  double way = 1.0;  ///< translations of between factors; of breaks too, whose sigmas are guesses anyway
};

struct Graph {
  std::vector<Pose> poses;          ///< T_map_i
  std::size_t first_free_pose = 0;  ///< those before are constants: they move no more, and have no covariance
  std::vector<Landmark> landmarks;
  std::vector<TouchPoint> touch_points;
  std::vector<double> scalars;  ///< slow states of the suit: where its norths are (rad), and how fast they turn (rad/s)
  NoiseScales noise;

  std::vector<BetweenFactor> between;
  std::vector<CompassFactor> compasses;
  std::vector<DriftFactor> drifts;
  std::vector<ScalarPrior> scalar_priors;
  std::vector<GravityFactor> gravity;
  std::vector<FloorFactor> floors;
  std::vector<PriorFactor> priors;
  std::vector<ContactFactor> contacts;
  std::vector<SeatFactor> seats;
  std::vector<ParallelFactor> parallels;
  std::vector<LandmarkPrior> landmark_priors;
  std::vector<FoldedFactor> folded;
};

/// Local frame of a table or screen (`T_map_rectangle`, axes u, v, w as documented at Landmark) or seat (level, +x =
/// heading).
Pose landmark_pose(const Landmark& landmark);

/// Unwhitened contact errors, m: distance to the plane (along w), to `edge` and to `corner` (0 where None).
Eigen::Vector3d contact_error(const Landmark& landmark, const Eigen::Vector3d& p_map, Edge edge, Edge corner);

/// ρ'‖r‖² of a contact as the graph stands, at the noise that the factor names (the lever of the hand left aside).
double weighted_square(const Graph& graph, const ContactFactor& contact);

}  // namespace kinemap::graph
