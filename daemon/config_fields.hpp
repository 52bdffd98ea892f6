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
/// address(key, ref).
namespace kinemap {

/// What a number may be; `unit` is for people ("m", "rad", "s", "Hz", "1" for plain numbers).
struct Range {
  const char* unit;
  double min;
  double max;
};

template <class V>
void fields(V& v, Config::Suit& c) {
  v.choice("transport", c.transport, {"udp", "tcp"});
  v.address("address", c.address);
  v.number("port", c.port, Range{"port", 0, 65535});
  v.number("receive_buffer_bytes", c.receive_buffer_bytes, Range{"B", 65536, 268435456});
}

template <class V>
void fields(V& v, AssemblerConfig& c) {
  v.number("character", c.character, Range{"id", -1, 255});
  v.number("reorder_window_s", c.reorder_window_s, Range{"s", 0, 2});
  v.number("restart_silence_s", c.restart_silence_s, Range{"s", 0.05, 60});
}

template <class V>
void fields(V& v, TrackerConfig::KeyPoses& c) {
  v.number("distance_m", c.distance_m, Range{"m", 0.01, 10});
  v.number("turn_rad", c.turn_rad, Range{"rad", 0.01, 3.15});
  v.number("tracing_s", c.tracing_s, Range{"s", 0.05, 60});
  v.number("idle_s", c.idle_s, Range{"s", 0.05, 3600});
}

template <class V>
void fields(V& v, TrackerConfig& c) {
  v.section("key_poses", c.key_poses);
}

template <class V>
void fields(V& v, MapperConfig::Odometry& c) {
  v.number("translation_m_per_sqrt_m", c.translation_m_per_sqrt_m, Range{"m/√m", 1e-4, 1});
  v.number("heading_rad_per_sqrt_s", c.heading_rad_per_sqrt_s, Range{"rad/√s", 1e-5, 1});
}

template <class V>
void fields(V& v, MapperConfig& c) {
  v.section("odometry", c.odometry);
}

template <class V>
void fields(V& v, Config::Api& c) {
  v.address("address", c.address);
  v.number("port", c.port, Range{"port", 0, 65535});
  v.number("pose_rate_hz", c.pose_rate_hz, Range{"Hz", 0.1, 240});
  v.number("max_clients", c.max_clients, Range{"1", 1, 10000});
  v.number("client_buffer_bytes", c.client_buffer_bytes, Range{"B", 65536, 1073741824});
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
  v.section("api", c.api);
  v.section("log", c.log);
}

}  // namespace kinemap
