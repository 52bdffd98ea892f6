// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace kinemap::sim {

enum class Severity : std::uint8_t { Good, Default, Bad };  ///< columns of the error table, see drift.hpp
enum class Shell : std::uint8_t { Auto, Rectangle, LShape };
/// Things that can be taken for each other, and shells that are hard to tell; the last five are shapes of the shell.
enum class Scene : std::uint8_t {
  Auto,         ///< drawn: mostly Plain
  Plain,        ///< nothing in particular
  TwinTables,   ///< two tables of one size side by side
  ChairRow,     ///< three or four chairs in a row
  TwinScreens,  ///< two monitors of one size side by side on a desk
  FlushScreen,  ///< big screens hang close to the wall's plane
  ThinWall,     ///< two rooms; both faces of the partition of 10–20 cm are drawn
  Hall,         ///< 3–4 × 9 m
  LRoom,
  ObliqueWall,  ///< one wall 20–40° off
  Flat,         ///< two rooms whose outer walls are in line across the partition
};
enum class Format : std::uint8_t { Pcap, Mvnx };

/// What to simulate. Everything that is not given is drawn from the seed.
struct SimOptions {
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> wearer_seed;  ///< another wearer in the same building; unset: of `seed`
  Severity drift = Severity::Default;
  std::optional<int> rooms;  ///< 1–3
  Shell shell = Shell::Auto;
  Scene scene = Scene::Auto;
  std::optional<std::array<double, 2>> room_size;  ///< m, inner length and width of every room, 3–9
  std::optional<int> rounds;                       ///< 1–500; unset: 2 or 3; more than 4 are a session of hours
  double rate_hz = 120.0;                          ///< 60, 100, 120 or 240 in MVN
  std::optional<double> stature_m;                 ///< 1.55–1.95
  double speed = 1.0;                              ///< factor on walking and tracing speed, 0.5–2
  std::optional<double>
      closure_spacing_m;  ///< walked at least between touches of something known, 5–30; unset: 5–10 at most

  bool hold_feet = true;    ///< the suit keeps standing feet where they are, as MVN does; else they slip along
                            ///< with the body
  bool distractors = true;  ///< gestures that mean nothing
  double sloppiness = 0.5;  ///< 0 careful … 1 careless, see habits.hpp
  std::optional<double> packet_loss;  ///< 0–0.9; unset: from `drift`
  bool send_meta = true;              ///< type 12 about once a second
  bool send_scale = true;             ///< type 13 about once a second
  bool send_center_of_mass = false;   ///< type 24 with every sample
  bool send_tracker = false;          ///< type 23 with every sample; MVN sends it only when asked to
  Format format = Format::Pcap;
  std::string out_dir = ".";
  std::uint16_t port = 9763;  ///< destination port written to the .pcap
};

/// What is wrong with the options, naming the option and its range; nullopt when they can be used.
std::optional<std::string> check(const SimOptions& options);

std::optional<Severity> severity_from(const std::string& name);  ///< "good", "default", "bad"
const char* to_string(Severity severity);

}  // namespace kinemap::sim
