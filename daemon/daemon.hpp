// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/config.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/receiver.hpp"
#include "daemon/server.hpp"

namespace kinemap {

/// The whole daemon: suit → receiver → pipeline → server. It runs from `start` to its destruction.
class Daemon {
 public:
  static Started<Daemon> start(const Config& config);

  /// Takes over what can change in a running daemon (log.level, all of api but address and port), reads tokens and
  /// certificate again, and says which other changes need a restart.
  void reconfigure(const Config& config);

  /// Signs of life of the detection loop and the solver, for the watchdog (Pipeline::pulse).
  void ask_for_pulse() { pipeline_.ask_for_pulse(); }
  [[nodiscard]] std::uint64_t pulse() const { return pipeline_.pulse(); }
  [[nodiscard]] SolverProgress solver_progress() const { return pipeline_.solver_progress(); }
  /// How long the solver has been at its present entry; 0 when it is at none.
  [[nodiscard]] double solver_at_entry_s() const { return pipeline_.solver_at_entry_s(); }
  /// One line for `systemctl status`.
  [[nodiscard]] std::string summary() const;

  [[nodiscard]] std::uint16_t api_port() const { return server_->port(); }
  [[nodiscard]] std::uint16_t suit_port() const { return receiver_->port(); }

 private:
  Daemon(const Config& config, std::unique_ptr<SessionJournal> journal)
      : config_(config),
        pipeline_(config.tracker, config.mapper, {}, std::move(journal), config.detection.realtime_priority) {}
  [[nodiscard]] SuitSink suit_sink();
  [[nodiscard]] Sources sources();

  Config config_;
  Pipeline pipeline_;
  std::unique_ptr<Receiver> receiver_;  // offers to pipeline_
  std::unique_ptr<Server> server_;      // asks both; destroyed first
};

}  // namespace kinemap
