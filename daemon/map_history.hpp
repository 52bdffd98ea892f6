// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/map.hpp"
#include "daemon/answer.hpp"

namespace kinemap {

/// A state of the map that a client has.
struct KnownMap {
  std::uint64_t revision = 0;
  std::string run = {};  ///< of which daemon's run; empty: the client does not say, and is believed
};

/// When each object and room last changed and which are gone, so that a client that has a revision is told only what is
/// new since. It may miss revisions: what changed in them counts as changed in the next one it sees, which says too
/// much, never too little. Memory: the map's JSON, and kTombstones removals.
class MapHistory {
 public:
  static constexpr std::size_t kTombstones = 4096;

  /// `run` tells this run of the daemon from others: after a restart the revisions begin anew, and a delta on a
  /// revision of the run before would be wrong.
  explicit MapHistory(std::string run) : run_(std::move(run)) {}

  /// Takes note of a map; revisions grow.
  void update(std::shared_ptr<const MapSnapshot> map);

  /// The newest map; null before the first.
  [[nodiscard]] const std::shared_ptr<const MapSnapshot>& map() const { return map_; }
  [[nodiscard]] const std::string& run() const { return run_; }

  /// The whole map as JSON, made once for everyone who asks.
  SharedText whole();
  /// What changed since `known`: an object of the map's own shape with `since` and `removed` (protocol/README.md). The
  /// whole map with a `note` when it is not known what changed since.
  SharedText since(const KnownMap& known);

 private:
  struct Item {
    std::string text;
    std::uint64_t changed = 0;  ///< revision
  };
  using Items = std::map<std::uint32_t, Item>;
  enum class Kind : std::uint8_t { Object, Room };
  struct Tombstone {
    Kind kind;
    std::uint32_t id;
    std::uint64_t revision;
  };

  template <class List>
  void note(const List& list, Kind kind, Items& items);
  void bury(Kind kind, std::uint32_t id);
  /// Why there is no delta on it; nullopt: there is.
  [[nodiscard]] std::optional<std::string> unknown(const KnownMap& known) const;
  [[nodiscard]] std::string delta_text(std::uint64_t revision) const;

  std::string run_;
  std::shared_ptr<const MapSnapshot> map_;
  Items objects_, rooms_;
  Item doorways_, unresolved_;  // whole lists: they have no ids
  std::deque<Tombstone> tombstones_;
  std::uint64_t oldest_ = 0;  // what changed since this revision, or a later one, is known
  SharedText whole_;
  std::map<std::uint64_t, SharedText> deltas_;  // on which revision → to the newest; forgotten when a newer one comes
};

}  // namespace kinemap
