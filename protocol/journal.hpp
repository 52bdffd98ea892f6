// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/tracker/unfinished.hpp"
#include "protocol/wire/result.hpp"

/// A session on disk: everything that the mapper was told, in its order. The mapper is a fold over events, so the same
/// entries give the same map; what it decided (associations, closures, calibration) needs no entries of its own, and a
/// later version of Kinemap makes a better map of an old journal. protocol/README.md has the bytes.
namespace kinemap::journal {

/// The first entry.
struct SessionStart {
  std::string id;                    ///< as the session's folder: UTC, "20261122T103303Z"
  std::int64_t created_unix_ms = 0;  ///< wall clock
  std::string software;              ///< version that began it
  /// Of the file, once more and under a checksum, so that a damaged first line is known for what it is. Absent in
  /// format 1.
  std::optional<std::uint32_t> format;
};

/// Where the suit's stream was, about once a second: tells, after a crash, whether the stream that comes is still the
/// same, and where the wearer was.
struct StreamMark {
  double time_s = 0.0;       ///< stream time of the session
  std::uint64_t index = 0;   ///< sample counter
  std::int64_t unix_ms = 0;  ///< wall clock
  // Since format 3.
  std::optional<std::uint32_t> time_code_ms;  ///< the suit's clock
  std::optional<Pose> T_odom_pelvis;
  std::optional<double> path_m, turn_rad;  ///< since the latest key pose, as in KeyPose
};

/// The suit fell silent and the map was optimised to the end.
struct StreamSilence {};

/// What the map had become when this was written; for lists of sessions, nothing is mapped from it. Since format 2.
struct Announced {
  double time_s = 0.0;         ///< of the newest event in the map
  std::uint64_t revision = 0;  ///< of the map
  std::uint64_t objects = 0;
  std::uint64_t rooms = 0;
};

/// The pieces of an unfinished gesture are for a daemon that has to go on with it; the mapper is told the whole. Since
/// format 3.
using Entry = std::variant<SessionStart, StreamMark, StreamSilence, WearerInfo, KeyPose, Trace, Pivot, Sitting,
                           Announced, UnfinishedTrace, UnfinishedSitting>;

Entry entry_of(const Event& event);
/// nullptr when the entry is no event.
std::optional<Event> event_of(const Entry& entry);

/// Whether it is a piece of a gesture that is not finished: of no use to a mapper.
bool is_piece(const Entry& entry);

inline constexpr std::uint32_t kVersion = 3;  ///< of the format

/// The first bytes of a journal, "kinemap-journal 3\n".
std::string header();
/// One entry as its record: marker, length, CRC-32, CBOR.
std::string record(const Entry& entry);
/// A whole journal in the current format: what older ones are migrated to.
std::string file_of(const std::vector<Entry>& entries);

/// A place where a journal could not be read.
struct Damage {
  std::uint64_t offset = 0;  ///< first byte
  std::uint64_t bytes = 0;
};

struct Contents {
  std::uint32_t version = 0;  ///< of the format; 0: the first line is damaged, the records tell that it can be read
  std::vector<Entry> entries;
  std::vector<Damage> damage;     ///< before and between whole records, and whole records that say nothing known
  std::uint64_t sound_bytes = 0;  ///< length up to the end of the last whole record: append here
  std::uint64_t torn_bytes = 0;   ///< after that: a record whose writing was cut short
};

/// Reads what can be read, but for the pieces of gestures that are there as a whole. An Error only when there is
/// nothing to read: no journal, or one of a newer version. `path` is for the message.
Result<Contents> read(std::string_view bytes, const std::string& path);

/// What `mend` had to leave out.
struct Mended {
  std::size_t key_poses_missing = 0;
  std::size_t entries_left_out = 0;  ///< traces and seats that refer to key poses that are lost
};

/// Entries with gaps as entries that the mapper can take: key poses numbered anew, with a discontinuity where some are
/// missing; contacts and seats that hang on a lost key pose are left out. Changes nothing when nothing is missing.
Mended mend(std::vector<Entry>& entries);

}  // namespace kinemap::journal
