// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/graph/graph.hpp"
#include "core/map.hpp"
#include "core/mapper/config.hpp"

namespace kinemap {

/// Owns the graph: adds events, extracts landmarks, associates, closes loops, optimises and publishes snapshots. A fold
/// over events: the same events give the same map, byte for byte. Not thread-safe: one thread owns it; snapshots may go
/// anywhere.
class Mapper {
 public:
  /// `revision`: of the empty map, for one that takes the place of another before the same clients.
  explicit Mapper(const MapperConfig& config, std::uint64_t revision = 0);
  ~Mapper();
  Mapper(Mapper&&) noexcept;
  Mapper& operator=(Mapper&&) noexcept;

  /// What is known of the wearer: whoever draws next (and what that wearer has drawn before, at the next optimisation).
  void set_wearer(const WearerInfo& wearer);

  /// Takes one event. Optimises when it closes a loop. True when a new snapshot was published: after each trace and
  /// sitting, and every few key poses, so that the trajectory keeps up with a wearer who only walks.
  bool add(const Event& event);

  /// No more events: optimises to convergence, takes back what the optimum contradicts, and publishes a last snapshot.
  /// On a long day that is minutes of work; it ends early, with a map that is whole, once `enough` says so (asked
  /// between trials; none: never).
  void finish(const std::function<bool()>& enough = {});

  /// All that it knows, as bytes that only the same program with the same configuration can go on from. Best taken when
  /// a trace or sitting has just been published: then what goes on from it gives the same map, byte for byte.
  [[nodiscard]] std::string checkpoint() const;
  /// What a checkpoint was taken of, published; nullopt where it is none of this program.
  static std::optional<Mapper> restore(const MapperConfig& config, std::string_view checkpoint);

  /// The newest snapshot; never null (the first revision is the empty map).
  [[nodiscard]] std::shared_ptr<const MapSnapshot> snapshot() const;

  /// The graph as it stands (poses by KeyPoseId), for export.
  [[nodiscard]] const graph::Graph& graph() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
