// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/body.hpp"
#include "core/map.hpp"
#include "protocol/foxglove/scene.hpp"
#include "protocol/mcap.hpp"

namespace kinemap::foxglove {

/// session.mcap while a session is mapped: what a viewer would have seen live, with the whole body. Nothing is kept but
/// the chunk that is being filled.
class SessionRecorder {
 public:
  /// `transforms_hz`: of stream time; 24 transforms take 4.5 kB.
  explicit SessionRecorder(mcap::Writer::Sink sink, double transforms_hz = 10.0);
  /// The next frame, and the map as it is by then.
  void add(const SuitFrame& frame, const MapSnapshot& map);
  /// The final map; ends the file.
  void finish(const MapSnapshot& map);

 private:
  void write(const Message& message);
  void take(const MapSnapshot& map);
  void take_state(const MapSnapshot& map);

  mcap::Writer writer_;
  double period_s_;
  double transforms_due_s_ = 0.0, state_due_s_ = 0.0;
  std::optional<MapSnapshot> map_;  // the one taken last, without its trajectory
  Scene scene_;
};

/// session.mcap of what a map holds: the pelvis at the key poses, each object from when it was first seen, every visit
/// in the log, the trajectory and the floor from the start.
std::string mcap_bytes(const MapSnapshot& map);

}  // namespace kinemap::foxglove
