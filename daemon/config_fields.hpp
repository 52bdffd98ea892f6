// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <limits>

#include "daemon/config.hpp"

/// The one list of everything that can be configured. Reading, printing, checking and the documentation's test all walk
/// it, so adding a field to a struct means adding one line here (tests/daemon/config_test.cpp fails until that is done:
/// it counts the members).
///
/// A visitor `v` offers: section(key, struct) · number(key, ref, Range) · flag(key, ref) · choice(key, ref, {…}) ·
/// address(key, ref) · path(key, ref) · list(key, ref, ListOf) ·
/// at_most(key a, a, key b, b): a ≤ b.
namespace kinemap {

/// What a number may be; `unit` is for people ("m", "rad", "s", "Hz", "1" for plain numbers).
struct Range {
  const char* unit;
  double min;
  double max;
};

/// What the texts of a list may be.
struct ListOf {
  const char* allowed;
  bool (*matches)(const std::string& text);
};
bool is_address_or_network(const std::string& text);
bool is_host_name(const std::string& text);
bool is_origin(const std::string& text);
inline constexpr ListOf kNetworks{"a list of addresses and networks, as \"192.168.1.0/24\"", is_address_or_network};
inline constexpr ListOf kHostNames{"a list of host names, without ports", is_host_name};
inline constexpr ListOf kOrigins{"a list of origins, as \"https://app.foxglove.dev\"", is_origin};

template <class V>
void fields(V& v, Config::Suit& c) {
  v.choice("transport", c.transport, {"udp", "tcp"});
  v.address("address", c.address);
  v.number("port", c.port, Range{"port", 0, 65535});
  v.number("receive_buffer_bytes", c.receive_buffer_bytes, Range{"B", 65536, 268435456});
  v.list("allow", c.allow, kNetworks);
}

template <class V>
void fields(V& v, AssemblerConfig& c) {
  v.number("character", c.character, Range{"id", -1, 255});
  v.number("reorder_window_s", c.reorder_window_s, Range{"s", 0, 2});
  v.number("restart_silence_s", c.restart_silence_s, Range{"s", 0.05, 60});
}

template <class V>
void fields(V& v, TrackerConfig::KeyPoses& c) {
  v.number("distance_m", c.distance_m, Range{"m", 0.001, 100});
  v.number("turn_rad", c.turn_rad, Range{"rad", 0.0001, 3.1416});
  v.number("tracing_s", c.tracing_s, Range{"s", 0.001, 3600});
  v.number("idle_s", c.idle_s, Range{"s", 0.001, 3600});
  v.number("path_step_m", c.path_step_m, Range{"m", 0.001, 100});
  v.number("turn_step_rad", c.turn_step_rad, Range{"rad", 0.0001, 3.1416});
}

template <class V>
void fields(V& v, TrackerConfig::Stance& c) {
  v.number("rest_speed_mps", c.rest_speed_mps, Range{"m/s", 0.001, 100});
  v.number("smoothing_s", c.smoothing_s, Range{"s", 0.001, 3600});
  v.number("rest_s", c.rest_s, Range{"s", 0, 3600});
  v.number("flat_rad", c.flat_rad, Range{"rad", 0, 3.1416});
  v.number("ball_height_m", c.ball_height_m, Range{"m", 0, 100});
  v.number("level_m", c.level_m, Range{"m", 0, 100});
}

template <class V>
void fields(V& v, TrackerConfig::Slip& c) {
  v.number("speed_mps", c.speed_mps, Range{"m/s", 0.001, 100});
  v.number("turn_rad_per_s", c.turn_rad_per_s, Range{"rad/s", 0.0001, 100});
  v.number("settle_s", c.settle_s, Range{"s", 0, 3600});
  v.number("held_m", c.held_m, Range{"m", 0, 100});
}

template <class V>
void fields(V& v, TrackerConfig::Magnetic& c) {
  v.number("norm_on", c.norm_on, Range{"1", 0, 10});
  v.number("norm_off", c.norm_off, Range{"1", 0, 10});
  v.number("dip_on_rad", c.dip_on_rad, Range{"rad", 0, 3.1416});
  v.number("dip_off_rad", c.dip_off_rad, Range{"rad", 0, 3.1416});
  v.number("smoothing_s", c.smoothing_s, Range{"s", 0.001, 3600});
  v.number("gap_s", c.gap_s, Range{"s", 0.001, 3600});
  v.number("place_m", c.place_m, Range{"m", 0.001, 100});
  v.number("min_places", c.min_places, Range{"1", 1, 100000});
  v.number("max_places", c.max_places, Range{"1", 1, 100000});
  v.at_most("norm_off", c.norm_off, "norm_on", c.norm_on);
  v.at_most("dip_off_rad", c.dip_off_rad, "dip_on_rad", c.dip_on_rad);
  v.at_most("min_places", static_cast<double>(c.min_places), "max_places", static_cast<double>(c.max_places));
}

template <class V>
void fields(V& v, TrackerConfig::Gesture& c) {
  v.number("elbow_on_rad", c.elbow_on_rad, Range{"rad", 0, 3.1416});
  v.number("elbow_off_rad", c.elbow_off_rad, Range{"rad", 0, 3.1416});
  v.number("hip_on_m", c.hip_on_m, Range{"m", 0, 100});
  v.number("hip_off_m", c.hip_off_m, Range{"m", 0, 100});
  v.number("crest_up_m", c.crest_up_m, Range{"m", 0, 100});
  v.number("crest_out_m", c.crest_out_m, Range{"m", 0, 100});
  v.number("below_hip_on_m", c.below_hip_on_m, Range{"m", 0, 100});
  v.number("below_hip_off_m", c.below_hip_off_m, Range{"m", 0, 100});
  v.number("outside_hip_on_m", c.outside_hip_on_m, Range{"m", 0.001, 100});
  v.number("outside_hip_off_m", c.outside_hip_off_m, Range{"m", -0.5, 0.5});
  v.number("rest_speed_mps", c.rest_speed_mps, Range{"m/s", 0.001, 100});
  v.number("hold_s", c.hold_s, Range{"s", 0, 3600});
  v.number("both_hip_m", c.both_hip_m, Range{"m", 0, 100});
  v.number("both_hold_s", c.both_hold_s, Range{"s", 0, 3600});
  v.number("walk_speed_mps", c.walk_speed_mps, Range{"m/s", 0, 100});
  v.number("swing_m", c.swing_m, Range{"m", 0.001, 100});
  v.number("swing_hold_s", c.swing_hold_s, Range{"s", 0, 3600});
  v.number("rest_m", c.rest_m, Range{"m", 0, 100});
  v.number("rest_hold_s", c.rest_hold_s, Range{"s", 0.05, 3600});
  v.number("hang_before_hip_m", c.hang_before_hip_m, Range{"m", 0, 100});
  v.number("hang_rad", c.hang_rad, Range{"rad", 0, 3.1416});
  v.number("hang_elbow_rad", c.hang_elbow_rad, Range{"rad", 0, 3.1416});
  v.number("hang_over_hip_m", c.hang_over_hip_m, Range{"m", -100, 100});
  v.number("velocity_smoothing_s", c.velocity_smoothing_s, Range{"s", 0.001, 3600});
  v.number("speed_smoothing_s", c.speed_smoothing_s, Range{"s", 0.001, 3600});
  v.number("palm_m", c.palm_m, Range{"m", 0, 100});
  v.number("finger_m", c.finger_m, Range{"m", 0, 100});
  v.at_most("elbow_on_rad", c.elbow_on_rad, "elbow_off_rad", c.elbow_off_rad);
  v.at_most("hip_on_m", c.hip_on_m, "hip_off_m", c.hip_off_m);
  v.at_most("below_hip_on_m", c.below_hip_on_m, "below_hip_off_m", c.below_hip_off_m);
  v.at_most("outside_hip_off_m", c.outside_hip_off_m, "outside_hip_on_m", c.outside_hip_on_m);
}

template <class V>
void fields(V& v, TrackerConfig::Traces& c) {
  v.number("min_duration_s", c.min_duration_s, Range{"s", 0, 3600});
  v.number("min_extent_m", c.min_extent_m, Range{"m", 0, 100});
  v.number("dropout_s", c.dropout_s, Range{"s", 0, 3600});
  v.number("gap_s", c.gap_s, Range{"s", 0.001, 3600});
  v.number("spacing_m", c.spacing_m, Range{"m", 0.001, 100});
  v.number("spacing_s", c.spacing_s, Range{"s", 0.001, 3600});
  v.number("hand_point_m", c.hand_point_m, Range{"m", 0, 100});
  v.number("max_contacts", c.max_contacts, Range{"1", 100, 1000000});
}

template <class V>
void fields(V& v, TrackerConfig::Pivot& c) {
  v.number("min_duration_s", c.min_duration_s, Range{"s", 0, 3600});
  v.number("reach_max_s", c.reach_max_s, Range{"s", 0, 3600});
  v.number("min_turn_rad", c.min_turn_rad, Range{"rad", 0.1, 3.1416});
  v.number("max_residual_m", c.max_residual_m, Range{"m", 0.001, 1});
  v.number("useful_m", c.useful_m, Range{"m", 0.001, 1});
  v.number("noise_m", c.noise_m, Range{"m", 0.0001, 1});
  v.number("independent_s", c.independent_s, Range{"s", 0.001, 3600});
  v.number("systematic_m", c.systematic_m, Range{"m", 0.0001, 1});
}

template <class V>
void fields(V& v, TrackerConfig::Sitting& c) {
  v.number("thigh_on", c.thigh_on, Range{"1", 0, 1});
  v.number("thigh_low_on", c.thigh_low_on, Range{"1", 0, 1});
  v.number("thigh_off", c.thigh_off, Range{"1", 0, 1});
  v.number("thigh_spread", c.thigh_spread, Range{"1", 0, 1});
  v.number("low_hips_m", c.low_hips_m, Range{"m", 0, 100});
  v.number("hips_min_share", c.hips_min_share, Range{"1", 0, 1});
  v.number("hips_max_share", c.hips_max_share, Range{"1", 0, 1});
  v.number("shank_min", c.shank_min, Range{"1", 0, 1});
  v.number("trunk_min", c.trunk_min, Range{"1", -1, 1});
  v.number("speed_on_mps", c.speed_on_mps, Range{"m/s", 0.001, 100});
  v.number("speed_off_mps", c.speed_off_mps, Range{"m/s", 0.001, 100});
  v.number("smoothing_s", c.smoothing_s, Range{"s", 0.001, 3600});
  v.number("outside_on_m", c.outside_on_m, Range{"m", 0.001, 100});
  v.number("outside_off_m", c.outside_off_m, Range{"m", 0.001, 100});
  v.number("min_unsupported_share", c.min_unsupported_share, Range{"1", 0, 1});
  v.number("min_unsupported_s", c.min_unsupported_s, Range{"s", 0, 3600});
  v.number("min_still_s", c.min_still_s, Range{"s", 0, 3600});
  v.number("surely_still_s", c.surely_still_s, Range{"s", 0, 3600});
  v.number("dropout_s", c.dropout_s, Range{"s", 0, 3600});
  v.number("gap_s", c.gap_s, Range{"s", 0.001, 3600});
  v.number("moved_m", c.moved_m, Range{"m", 0, 100});
  v.number("hip_to_seat_m", c.hip_to_seat_m, Range{"m", 0, 100});
  v.number("seat_behind_hip_m", c.seat_behind_hip_m, Range{"m", 0, 100});
  v.number("sample_s", c.sample_s, Range{"s", 0.001, 3600});
  v.number("max_samples", c.max_samples, Range{"1", 10, 1000000});
  v.at_most("thigh_on", c.thigh_on, "thigh_off", c.thigh_off);
  v.at_most("hips_min_share", c.hips_min_share, "hips_max_share", c.hips_max_share);
  v.at_most("speed_on_mps", c.speed_on_mps, "speed_off_mps", c.speed_off_mps);
  v.at_most("outside_off_m", c.outside_off_m, "outside_on_m", c.outside_on_m);
}

template <class V>
void fields(V& v, TrackerConfig& c) {
  v.section("key_poses", c.key_poses);
  v.section("stance", c.stance);
  v.section("slip", c.slip);
  v.section("magnetic", c.magnetic);
  v.section("gesture", c.gesture);
  v.section("traces", c.traces);
  v.section("pivot", c.pivot);
  v.section("sitting", c.sitting);
}

template <class V>
void fields(V& v, MapperConfig::Odometry& c) {
  v.number("translation_m_per_sqrt_m", c.translation_m_per_sqrt_m, Range{"m/√m", 0.0001, 1});
  v.number("translation_m_per_sqrt_s", c.translation_m_per_sqrt_s, Range{"m/√s", 1e-05, 1});
  v.number("feet_m_per_sqrt_m", c.feet_m_per_sqrt_m, Range{"m/√m", 0.0001, 1});
  v.number("feet_rad_per_sqrt_s", c.feet_rad_per_sqrt_s, Range{"rad/√s", 1e-05, 1});
  v.number("vertical_m_per_sqrt_m", c.vertical_m_per_sqrt_m, Range{"m/√m", 0.0001, 1});
  v.number("heading_rad_per_sqrt_s", c.heading_rad_per_sqrt_s, Range{"rad/√s", 1e-05, 1});
  v.number("magnetic_rad_per_sqrt_s", c.magnetic_rad_per_sqrt_s, Range{"rad/√s", 1e-05, 1});
  v.number("magnetic_after_s", c.magnetic_after_s, Range{"s", 0, 3600});
  v.number("heading_return_s", c.heading_return_s, Range{"s", 0.1, 1e6});
  v.number("heading_rad_per_rad", c.heading_rad_per_rad, Range{"rad/rad", 0, 1});
  v.number("north_sigma_rad", c.north_sigma_rad, Range{"rad", 1e-05, 3.1416});
  v.number("north_rate_rad_per_s", c.north_rate_rad_per_s, Range{"rad/s", 1e-07, 1});
  v.number("north_rad_per_sqrt_s", c.north_rad_per_sqrt_s, Range{"rad/√s", 1e-05, 1});
  v.number("scale_sigma", c.scale_sigma, Range{"1", 0, 1});
  v.number("tilt_rad", c.tilt_rad, Range{"rad", 0.0001, 3.1416});
  v.number("floor_m", c.floor_m, Range{"m", 0.0001, 10});
}

template <class V>
void fields(V& v, MapperConfig::Hand& c) {
  v.number("tip_m", c.tip_m, Range{"m", 0, 100});
  v.number("tip_per_stature", c.tip_per_stature, Range{"1", 0, 0.3});
  v.number("tip_thickness_m", c.tip_thickness_m, Range{"m", 0, 0.1});
  v.number("tip_sigma_m", c.tip_sigma_m, Range{"m", 0, 1});
  v.number("body_point_sigma_m", c.body_point_sigma_m, Range{"m", 0.0001, 1});
  v.number("tip_sideways_sigma_m", c.tip_sideways_sigma_m, Range{"m", 0.0001, 1});
  v.number("palm_share", c.palm_share, Range{"1", 0, 1});
  v.number("palm_per_stature", c.palm_per_stature, Range{"1", 0, 0.3});
  v.number("palm_thickness_m", c.palm_thickness_m, Range{"m", 0, 0.1});
  v.number("palm_sigma_m", c.palm_sigma_m, Range{"m", 0.0001, 1});
  v.number("turn_noise_rad_per_m", c.turn_noise_rad_per_m, Range{"rad/m", 0, 10});
  v.number("contact_sigma_m", c.contact_sigma_m, Range{"m", 0.0001, 10});
  v.number("contact_correlation_s", c.contact_correlation_s, Range{"s", 0.001, 3600});
  v.number("contact_spacing_m", c.contact_spacing_m, Range{"m", 0.001, 100});
  v.number("corner_sigma_m", c.corner_sigma_m, Range{"m", 0.0001, 10});
  v.number("loss_scale", c.loss_scale, Range{"1", 0.01, 1000});
}

template <class V>
void fields(V& v, MapperConfig::Seats& c) {
  v.number("level_sigma_m", c.level_sigma_m, Range{"m", 0.0001, 10});
  v.number("height_sigma_m", c.height_sigma_m, Range{"m", 0.0001, 10});
  v.number("heading_sigma_rad", c.heading_sigma_rad, Range{"rad", 0.0001, 3.1416});
  v.number("loss_scale", c.loss_scale, Range{"1", 0.01, 1000});
}

template <class V>
void fields(V& v, MapperConfig::Walls& c) {
  v.number("height_m", c.height_m, Range{"m", 0, 100});
  v.number("right_angle_sigma_rad", c.right_angle_sigma_rad, Range{"rad", 0, 1});
  v.number("oblique_share", c.oblique_share, Range{"1", 0.001, 0.9});
  v.number("join_max_m", c.join_max_m, Range{"m", 0, 100});
}

template <class V>
void fields(V& v, MapperConfig::Association& c) {
  v.number("doubt", c.doubt, Range{"1", 1, 10});
  v.number("gate_sigma", c.gate_sigma, Range{"1", 0.1, 100});
  v.number("position_sigma_m", c.position_sigma_m, Range{"m", 0.0001, 10});
  v.number("heading_sigma_rad", c.heading_sigma_rad, Range{"rad", 0.0001, 3.1416});
  v.number("size_sigma_m", c.size_sigma_m, Range{"m", 0.0001, 10});
  v.number("size_sigma_per_m", c.size_sigma_per_m, Range{"m/m", 0, 10});
  v.number("wall_density_per_m", c.wall_density_per_m, Range{"1/m", 0.0001, 100});
  v.number("table_density_per_m2", c.table_density_per_m2, Range{"1/m²", 0.0001, 100});
  v.number("screen_density_per_m2", c.screen_density_per_m2, Range{"1/m²", 0.0001, 100});
  v.number("seat_density_per_m2", c.seat_density_per_m2, Range{"1/m²", 0.0001, 100});
  v.number("look_alike_share", c.look_alike_share, Range{"1", 0, 1});
  v.number("neighbour_share", c.neighbour_share, Range{"1", 0, 1});
  v.number("min_evidence", c.min_evidence, Range{"1", -1000, 1000});
  v.number("joint_evidence", c.joint_evidence, Range{"1", -1000, 1000});
  v.number("free_space_most", c.free_space_most, Range{"1", 0, 1000});
  v.number("max_cost_increase", c.max_cost_increase, Range{"1", 0, 1000000});
  v.number("min_relief", c.min_relief, Range{"1", 0, 1000000});
  v.number("ambiguity", c.ambiguity, Range{"1", 0, 1000000});
}

template <class V>
void fields(V& v, MapperConfig::Solver& c) {
  v.number("closure_iterations", c.closure_iterations, Range{"1", 1, 1000});
  v.number("final_iterations", c.final_iterations, Range{"1", 1, 1000});
  v.number("most_free_key_poses", c.most_free_key_poses, Range{"1", 100, 1000000});
  v.number("kept_free_key_poses", c.kept_free_key_poses, Range{"1", 50, 1000000});
}

template <class V>
void fields(V& v, LandmarkConfig& c) {
  v.number("plane_tolerance_m", c.plane_tolerance_m, Range{"m", 0, 100});
  v.number("plane_tolerance_per_m", c.plane_tolerance_per_m, Range{"m/m", 0, 10});
  v.number("reach_speed_m_per_s", c.reach_speed_m_per_s, Range{"m/s", 0.001, 100});
  v.number("reach_max_s", c.reach_max_s, Range{"s", 0, 3600});
  v.number("wall_min_extent_m", c.wall_min_extent_m, Range{"m", 0, 100});
  v.number("rectangle_min_side_m", c.rectangle_min_side_m, Range{"m", 0.001, 100});
  v.number("rectangle_max_side_m", c.rectangle_max_side_m, Range{"m", 0.001, 100});
  v.number("corner_window_m", c.corner_window_m, Range{"m", 0.001, 100});
  v.number("corner_angle_rad", c.corner_angle_rad, Range{"rad", 0, 3.1416});
  v.number("table_min_height_m", c.table_min_height_m, Range{"m", 0, 100});
  v.number("table_max_height_m", c.table_max_height_m, Range{"m", 0, 100});
  v.number("max_slant_rad", c.max_slant_rad, Range{"rad", 0, 3.1416});
  v.at_most("rectangle_min_side_m", c.rectangle_min_side_m, "rectangle_max_side_m", c.rectangle_max_side_m);
  v.at_most("table_min_height_m", c.table_min_height_m, "table_max_height_m", c.table_max_height_m);
}

template <class V>
void fields(V& v, MapperConfig& c) {
  v.section("odometry", c.odometry);
  v.section("hand", c.hand);
  v.section("seats", c.seats);
  v.section("walls", c.walls);
  v.section("association", c.association);
  v.section("solver", c.solver);
  v.section("landmarks", c.landmarks);
}

template <class V>
void fields(V& v, Config::Detection& c) {
  v.number("realtime_priority", c.realtime_priority, Range{"1", 0, 99});
}

template <class V>
void fields(V& v, Config::Api& c) {
  v.address("address", c.address);
  v.number("port", c.port, Range{"port", 0, 65535});
  v.choice("auth", c.auth, {"remote", "always", "none"});
  v.path("tokens", c.tokens);
  v.path("certificate", c.certificate);
  v.path("key", c.key);
  v.list("allowed_hosts", c.allowed_hosts, kHostNames);
  v.list("allowed_origins", c.allowed_origins, kOrigins);
  v.number("pose_rate_hz", c.pose_rate_hz, Range{"Hz", 0.1, 240});
  v.number("max_clients", c.max_clients, Range{"1", 1, 10000});
  v.number("max_clients_per_address", c.max_clients_per_address, Range{"1", 1, 10000});
  v.number("max_requests_per_s", c.max_requests_per_s, Range{"1/s", 1, 1000000});
  v.number("client_buffer_bytes", c.client_buffer_bytes, Range{"B", 65536, 1073741824});
}

template <class V>
void fields(V& v, Config::Journal& c) {
  v.path("directory", c.directory);
  v.number("keep_days", c.keep_days, Range{"d", 0, 36500});
  v.number("keep_mb", c.keep_mb, Range{"MiB", 0, 1e9});
  v.number("min_free_mb", c.min_free_mb, Range{"MiB", 0, 1e9});
  v.flag("record", c.record);
  v.number("record_file_mb", c.record_file_mb, Range{"MiB", 0.01, 4096});
  v.number("record_file_min", c.record_file_min, Range{"min", 0.1, 1440});
}

template <class V>
void fields(V& v, Config::Log& c) {
  v.choice("level", c.level, {"trace", "debug", "info", "warn", "error"});
}

template <class V>
void fields(V& v, Config& c) {
  v.section("suit", c.suit);
  v.section("stream", c.stream);
  v.section("tracker", c.tracker);
  v.section("mapper", c.mapper);
  v.section("detection", c.detection);
  v.section("api", c.api);
  v.section("journal", c.journal);
  v.section("log", c.log);
}

}  // namespace kinemap
