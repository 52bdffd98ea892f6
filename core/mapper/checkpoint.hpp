// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/archive.hpp"
#include "core/body.hpp"
#include "core/events.hpp"
#include "core/map.hpp"
#include "core/mapper/state.hpp"
#include "core/mapper/wearers.hpp"

/// Private to core/mapper: the members of all that Mapper::checkpoint() saves. Whoever adds one to a type adds it here,
/// and counts kCheckpointVersion up.
namespace kinemap {

constexpr std::uint32_t kCheckpointVersion = 5;

inline void fields(Archive& a, Pose& x) { a(x.p, x.q); }

namespace graph {

inline void fields(Archive& a, Landmark& x) { a(x.kind, x.x, x.anchor, x.active); }
inline void fields(Archive& a, TouchPoint& x) { a(x.p_hand, x.prior, x.sigma, x.fixed, x.turn_noise_rad_per_m); }
inline void fields(Archive& a, Loss& x) { a(x.kind, x.scale); }
inline void fields(Archive& a, BetweenFactor& x) { a(x.i, x.j, x.T_i_j, x.sqrt_information, x.loss); }
inline void fields(Archive& a, CompassFactor& x) { a(x.i, x.j, x.north, x.q_odom_i, x.q_odom_j, x.decay, x.sigma_rad); }
inline void fields(Archive& a, DriftFactor& x) { a(x.a, x.b, x.rate, x.dt_s, x.sigma_rad); }
inline void fields(Archive& a, ScalarPrior& x) { a(x.scalar, x.mean, x.sigma); }
inline void fields(Archive& a, GravityFactor& x) { a(x.i, x.up, x.sigma_rad); }
inline void fields(Archive& a, FloorFactor& x) { a(x.i, x.p_i, x.z, x.sigma_m, x.loss); }
inline void fields(Archive& a, PriorFactor& x) { a(x.i, x.T_map_i, x.sqrt_information); }
inline void fields(Archive& a, ContactFactor& x) {
  a(x.i, x.landmark, x.touch, x.T_i_hand, x.edge, x.corner, x.sigma_plane_m, x.sigma_edge_m, x.sigma_corner_m, x.share,
    x.loss);
}
inline void fields(Archive& a, SeatFactor& x) {
  a(x.i, x.landmark, x.T_i_seat, x.sigma_level_m, x.sigma_z_m, x.sigma_heading_rad, x.loss);
}
inline void fields(Archive& a, ParallelFactor& x) { a(x.a, x.b, x.offset_rad, x.sigma_rad, x.loss); }
inline void fields(Archive& a, LandmarkPrior& x) { a(x.landmark, x.index, x.mean, x.sigma); }
inline void fields(Archive& a, FoldedFactor& x) {
  a(x.landmark, x.touch, x.at, x.p_hand, x.quarter_turns, x.sqrt_information, x.residual, x.rest, x.weighted_squares);
}
inline void fields(Archive& a, NoiseScales& x) { a(x.heading, x.contact, x.way); }
inline void fields(Archive& a, Graph& x) {
  a(x.noise, x.poses, x.first_free_pose, x.landmarks, x.touch_points, x.scalars, x.compasses, x.drifts, x.scalar_priors,
    x.between, x.gravity, x.floors, x.priors, x.contacts, x.seats, x.parallels, x.landmark_priors, x.folded);
}

}  // namespace graph

inline void fields(Archive& a, LandmarkRecord& x) { a(x.id, x.observations, x.first_seen_s, x.last_seen_s, x.floor_z); }
inline void fields(Archive& a, SettledVisit& x) { a(x.first_pose, x.last_pose, x.touched); }
inline void fields(Archive& a, ObservationRecord& x) {
  a(x.landmark, x.key_pose, x.first_contact, x.contacts, x.seat, x.begin_s, x.end_s, x.settled);
}
inline void fields(Archive& a, GraphSummary& x) {
  a(x.key_poses, x.landmarks, x.contacts, x.loop_closures, x.loop_closures_revoked, x.optimisations,
    x.optimisations_failed, x.last_cost);
}
inline void fields(Archive& a, MapState& x) { a(x.graph, x.landmarks, x.observations, x.direction, x.summary); }
inline void fields(Archive& a, Slip& x) { a(x.turn_rad, x.way_m, x.stood_s, x.apart_rad); }
inline void fields(Archive& a, KeyPose& x) {
  a(x.id, x.time_s, x.T_odom_pelvis, x.path_m, x.turn_rad, x.discontinuity, x.p_pelvis_stance, x.field_disturbed,
    x.slip);
}
inline void fields(Archive& a, HandContact& x) { a(x.time_s, x.key_pose, x.T_key_hand); }
inline void fields(Archive& a, Trace& x) { a(x.begin_s, x.end_s, x.stature_m, x.contacts); }
inline void fields(Archive& a, WearerInfo& x) { a(x.name, x.p_hand_fingertip, x.p_hand_palm, x.stature_m); }
inline void fields(Archive& a, Wearers::Known& x) { a(x.info, x.stature_m); }
inline void fields(Archive& a, StepSigma& x) { a(x.level_m, x.up_m, x.tilt_rad, x.heading_rad); }
inline void fields(Archive& a, TrajectoryPose& x) { a(x.id, x.time_s, x.T_map_pelvis, x.T_odom_pelvis, x.step); }
inline void fields(Archive& a, UnresolvedTrace& x) { a(x.begin_s, x.end_s, x.reason); }

}  // namespace kinemap
