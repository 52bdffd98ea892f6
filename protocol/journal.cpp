// SPDX-License-Identifier: Apache-2.0
#include "protocol/journal.hpp"

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <charconv>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "protocol/journal_entries.hpp"

namespace kinemap::journal {
namespace {

constexpr std::string_view kName = "kinemap-journal ";
constexpr std::string_view kMarker = "\xA5kjr";
constexpr std::size_t kHead = 12;                     // marker, length, checksum
constexpr std::uint32_t kLongest = 64 * 1024 * 1024;  // a trace of an hour has a hundredth of that

std::uint32_t checksum(std::string_view payload) {
  boost::crc_32_type crc;
  crc.process_bytes(payload.data(), payload.size());
  return crc.checksum();
}

void put_u32(std::string& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(value >> shift & 0xFF));
}

std::uint32_t get_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

/// The payload of the record that begins here; nullopt where none does.
std::optional<std::string_view> payload_at(std::string_view bytes, std::size_t at) {
  if (at > bytes.size() || bytes.size() - at < kHead || bytes.substr(at, kMarker.size()) != kMarker)
    return std::nullopt;
  const std::uint32_t length = get_u32(bytes, at + 4);
  if (length > kLongest || bytes.size() - at - kHead < length) return std::nullopt;
  const auto payload = bytes.substr(at + kHead, length);
  if (checksum(payload) != get_u32(bytes, at + 8)) return std::nullopt;
  return payload;
}

/// Where the next whole record begins; bytes.size() when there is none.
std::size_t next_record(std::string_view bytes, std::size_t from) {
  for (auto at = bytes.find(kMarker, from); at != std::string_view::npos; at = bytes.find(kMarker, at + 1))
    if (payload_at(bytes, at)) return at;
  return bytes.size();
}

struct FirstLine {
  std::uint32_t version = 0;  ///< 0: no first line of a journal
  std::size_t length = 0;
};

FirstLine first_line(std::string_view bytes) {
  const auto end = bytes.substr(0, 40).find('\n');
  FirstLine line;
  if (!bytes.starts_with(kName) || end == std::string_view::npos) return line;
  const char* last = bytes.data() + end;
  const auto [rest, error] = std::from_chars(bytes.data() + kName.size(), last, line.version);
  if (error != std::errc() || rest != last || line.version == 0) return {};
  line.length = end + 1;
  return line;
}

/// The first entry that can be read.
std::optional<Entry> first_entry(std::string_view bytes) {
  const auto payload = payload_at(bytes, next_record(bytes, 0));
  return payload ? decode(*payload) : std::nullopt;
}

/// The first line, or why this is nothing that can be read.
Result<FirstLine> check_first_line(std::string_view bytes, const std::string& path) {
  const FirstLine line = first_line(bytes);
  if (line.version >= 1 && line.version <= kVersion) return line;
  // A flipped bit in the first line cannot change what the first entry says.
  const auto entry = first_entry(bytes);
  const auto* start = entry ? std::get_if<SessionStart>(&*entry) : nullptr;
  const auto format = start != nullptr ? start->format.value_or(1) : 0;
  if (start != nullptr && format <= kVersion) return FirstLine{};
  // A page was lost with both: what can be read is taken for ours.
  if (entry && start == nullptr && line.version == 0) return FirstLine{};
  const auto newer = std::max(line.version, format);
  if (newer > kVersion)
    return Error{path + ": a journal of format " + std::to_string(newer) +
                 ", of a newer version of Kinemap; this one reads up to format " + std::to_string(kVersion) +
                 ": use that version, or begin with another journal.directory"};
  return Error{path + ": no journal of Kinemap; expected \"kinemap-journal " + std::to_string(kVersion) +
               "\" in its first line"};
}

void add_damage(std::vector<Damage>& damage, std::size_t begin, std::size_t end) {
  if (!damage.empty() && damage.back().offset + damage.back().bytes == begin)
    damage.back().bytes += end - begin;
  else
    damage.push_back({begin, end - begin});
}

/// Pieces are of no use any more once the whole comes, and many. `from`: none is before it.
void leave_out_finished(std::vector<Entry>& entries, const Entry& whole, std::size_t& from) {
  const bool traced = std::holds_alternative<Trace>(whole) || std::holds_alternative<Pivot>(whole);
  const bool sat = std::holds_alternative<Sitting>(whole);
  if (!traced && !sat) return;
  const auto finished = [&](const Entry& e) {
    return (traced && std::holds_alternative<UnfinishedTrace>(e)) ||
           (sat && std::holds_alternative<UnfinishedSitting>(e));
  };
  const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(from);
  entries.erase(std::remove_if(begin, entries.end(), finished), entries.end());
  while (from < entries.size() && !is_piece(entries[from])) ++from;
}

using Renamed = std::unordered_map<KeyPoseId, KeyPoseId>;

/// Leaves out what hangs on key poses that are lost.
template <class T>
void rename(std::vector<T>& list, const Renamed& renamed) {
  std::erase_if(list, [&](const T& item) { return !renamed.contains(item.key_pose); });
  for (T& item : list) item.key_pose = renamed.at(item.key_pose);
}

}  // namespace

bool is_piece(const Entry& entry) {
  return std::holds_alternative<UnfinishedTrace>(entry) || std::holds_alternative<UnfinishedSitting>(entry);
}

Entry entry_of(const Event& event) {
  return std::visit([](const auto& e) -> Entry { return e; }, event);
}

std::optional<Event> event_of(const Entry& entry) {
  return std::visit(
      [](const auto& e) -> std::optional<Event> {
        if constexpr (std::is_constructible_v<Event, decltype(e)>) return Event(e);
        return std::nullopt;
      },
      entry);
}

std::string header() { return std::string(kName) + std::to_string(kVersion) + "\n"; }

std::string record(const Entry& entry) {
  const std::string payload = encode(entry);
  std::string out(kMarker);
  put_u32(out, static_cast<std::uint32_t>(payload.size()));
  put_u32(out, checksum(payload));
  return out += payload;
}

std::string file_of(const std::vector<Entry>& entries) {
  std::string bytes = header();
  for (const auto& entry : entries) {
    const auto* start = std::get_if<SessionStart>(&entry);
    bytes += start == nullptr ? record(entry)
                              : record(SessionStart{start->id, start->created_unix_ms, start->software, kVersion});
  }
  return bytes;
}

Result<Contents> read(std::string_view bytes, const std::string& path) {
  const auto line = check_first_line(bytes, path);
  if (!line) return Error{line.error()};
  Contents contents;
  contents.version = line->version;
  std::size_t gesture = 0;
  for (std::size_t at = line->length; at < bytes.size();) {
    const auto payload = payload_at(bytes, at);
    const std::size_t next = payload ? at + kHead + payload->size() : next_record(bytes, at + 1);
    if (auto entry = payload ? decode(*payload) : std::nullopt) {
      leave_out_finished(contents.entries, *entry, gesture);
      contents.entries.push_back(std::move(*entry));
    } else if (payload || next < bytes.size()) {
      add_damage(contents.damage, at, next);
    } else {
      contents.torn_bytes = next - at;
    }
    at = next;
  }
  contents.sound_bytes = bytes.size() - contents.torn_bytes;
  return contents;
}

Mended mend(std::vector<Entry>& entries) {
  Mended report;
  Renamed renamed;
  KeyPoseId expected = 0;
  std::vector<Entry> kept;
  kept.reserve(entries.size());
  for (auto& entry : entries) {
    if (auto* key_pose = std::get_if<KeyPose>(&entry)) {
      if (key_pose->id < expected) continue;  // written twice
      report.key_poses_missing += key_pose->id - expected;
      key_pose->discontinuity = key_pose->discontinuity || (key_pose->id > expected && !renamed.empty());
      expected = key_pose->id + 1;
      const auto id = static_cast<KeyPoseId>(renamed.size());
      renamed.emplace(key_pose->id, id);
      key_pose->id = id;
    } else if (auto* trace = std::get_if<Trace>(&entry)) {
      rename(trace->contacts, renamed);
      if (trace->contacts.empty()) {
        ++report.entries_left_out;
        continue;
      }
    } else if (auto* sitting = std::get_if<Sitting>(&entry)) {
      const auto known = renamed.find(sitting->key_pose);
      if (known == renamed.end()) {
        ++report.entries_left_out;
        continue;
      }
      sitting->key_pose = known->second;
    } else if (auto* drawing = std::get_if<UnfinishedTrace>(&entry)) {
      rename(drawing->contacts, renamed);
    } else if (auto* bout = std::get_if<UnfinishedSitting>(&entry)) {
      rename(bout->samples, renamed);
    }
    kept.push_back(std::move(entry));
  }
  entries = std::move(kept);
  return report;
}

}  // namespace kinemap::journal
