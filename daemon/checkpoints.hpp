// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/crc.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/mapper/mapper.hpp"
#include "daemon/session_journal.hpp"
#include "protocol/journal.hpp"

namespace kinemap {

/// The mapper's state in a file beside the journal, now and then, so that a session of hours is back within seconds. A
/// cache and no more: the journal has everything. A checkpoint counts only where it was taken by the same version with
/// the same configuration and after exactly those entries that the journal begins with; else all are mapped again. What
/// cannot be written is left out. Solver thread only.
class Checkpoints {
 public:
  /// `journal` outlives this; null: nothing is kept.
  Checkpoints(const SessionJournal* journal, const MapperConfig& config) : journal_(journal), config_(config) {}

  struct Restored {
    Mapper mapper;
    std::size_t entries = 0;  ///< so many of the stored ones it has been told
  };
  /// What a checkpoint of the session with these entries was taken of; nullopt where there is none that counts.
  std::optional<Restored> restore(const std::vector<journal::Entry>& stored);

  /// The mapper is told this entry next.
  void add(const journal::Entry& entry);
  /// It has been told: takes a checkpoint when the last one is some minutes of the session old.
  void keep(const journal::Entry& entry, const Mapper& mapper);

 private:
  void begin(const journal::SessionStart& start);
  [[nodiscard]] bool write(const Mapper& mapper) const;

  const SessionJournal* journal_;
  MapperConfig config_;
  std::filesystem::path path_;  // of the session under way; empty before the first
  std::uint64_t entries_ = 0;   // that the mapper was told in it
  boost::crc_32_type crc_;      // of their records
  double taken_s_ = 0.0;        // stream time of the last checkpoint
};

}  // namespace kinemap
