// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tools/kinemap/session_folder.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* to_string(StoredSession::State state) {
  switch (state) {
    case StoredSession::State::Open:
      return "open";
    case StoredSession::State::Closed:
      return "closed";
    case StoredSession::State::Quarantined:
      return "quarantined";
    case StoredSession::State::Unreadable:
      break;
  }
  return "unreadable";
}

std::uint64_t damaged_bytes(const ReadJournal& read) {
  std::uint64_t bytes = 0;
  for (const auto& damage : read.contents.damage) bytes += damage.bytes;
  return bytes;
}

Json damage_json(const ReadJournal& read) {
  return {{"places", read.contents.damage.size()},
          {"bytes", damaged_bytes(read)},
          {"torn_bytes", read.contents.torn_bytes},
          {"key_poses_missing", read.mended.key_poses_missing},
          {"entries_left_out", read.mended.entries_left_out}};
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string damage_text(const ReadJournal& read) {
  if (!read.damaged() && read.contents.torn_bytes == 0) return "none";
  std::string text;
  if (read.damaged())
    text = format("damaged in %zu places (%s bytes): %zu key poses and %zu traces or seats are missing",
                  read.contents.damage.size(), grouped(damaged_bytes(read)).c_str(), read.mended.key_poses_missing,
                  read.mended.entries_left_out);
  if (read.contents.torn_bytes > 0)
    text += (text.empty() ? "" : "; ") + grouped(read.contents.torn_bytes) + " bytes at the end were being written";
  return text;
}

std::vector<std::string> session_row(const StoredSession& session) {
  const SessionSummary& sum = session.summary;
  if (!session.readable()) return {session.id, "", "", "", "", size_text(session.bytes), to_string(session.state)};
  return {session.id,
          utc_text(sum.begin_unix_ms),
          duration_text(sum.duration_s),
          sum.announced ? std::to_string(sum.announced->objects) : "?",
          format("%.0f m", sum.distance_m),
          size_text(session.bytes),
          to_string(session.state)};
}

std::string session_text(const StoredSession& session) {
  std::vector<std::vector<std::string>> rows = {{"session", session.id}, {"state", to_string(session.state)}};
  rows.push_back({"journal", session.path});
  if (!session.recordings.empty())
    rows.push_back({"recordings",
                    std::to_string(session.recordings.size()) + " of the suit, " + session.recordings.front() + " …"});
  rows.push_back({"size", size_text(session.bytes)});
  if (!session.readable()) {
    rows.push_back({"problem", session.problem});
    return text_table(rows, {0, 1});
  }
  const SessionSummary& sum = session.summary;
  rows.push_back({"begin", utc_text(sum.begin_unix_ms)});
  rows.push_back({"duration", duration_text(sum.duration_s)});
  rows.push_back({"begun by", "kinemapd " + (sum.software.empty() ? "?" : sum.software)});
  const auto version = session.read->contents.version;
  rows.push_back({"format", version > 0 ? std::to_string(version) : "first line damaged"});
  if (!sum.wearers.empty()) rows.push_back({"worn by", joined(sum.wearers)});
  rows.push_back({"distance", format("%.0f m, %zu key poses, %zu breaks", sum.distance_m, sum.key_poses, sum.breaks)});
  rows.push_back({"gestures", format("%zu traces of %s contacts, %zu pivots, %zu sittings", sum.traces,
                                     grouped(sum.contacts).c_str(), sum.pivots, sum.sittings)});
  if (sum.announced)
    rows.push_back({"map", format("%llu objects, %llu rooms, revision %llu",
                                  static_cast<unsigned long long>(sum.announced->objects),
                                  static_cast<unsigned long long>(sum.announced->rooms),
                                  static_cast<unsigned long long>(sum.announced->revision))});
  rows.push_back({"damage", damage_text(*session.read)});
  return text_table(rows, {0, 1});
}

Json session_json(const StoredSession& session) {
  Json json = {{"id", session.id},
               {"state", to_string(session.state)},
               {"journal", session.path},
               {"bytes", session.bytes},
               {"recordings", session.recordings}};
  if (!session.readable()) {
    json["problem"] = session.problem;
    return json;
  }
  const SessionSummary& sum = session.summary;
  if (sum.begin_unix_ms) json["begin"] = utc_text(sum.begin_unix_ms);
  json["duration_s"] = sum.duration_s;
  json["distance_m"] = sum.distance_m;
  if (sum.announced) {
    json["objects"] = sum.announced->objects;
    json["rooms"] = sum.announced->rooms;
    json["revision"] = sum.announced->revision;
  }
  json["software"] = sum.software;
  json["format"] = session.read->contents.version;
  json["wearers"] = sum.wearers;
  json["key_poses"] = sum.key_poses;
  json["breaks"] = sum.breaks;
  json["traces"] = sum.traces;
  json["contacts"] = sum.contacts;
  json["pivots"] = sum.pivots;
  json["sittings"] = sum.sittings;
  json["damage"] = damage_json(*session.read);
  return json;
}

}  // namespace kinemap::cli
