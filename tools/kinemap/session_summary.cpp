// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/session_summary.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "protocol/text_format.hpp"

namespace kinemap::cli {
namespace {

/// One `add` an entry that tells something.
struct Adder {
  SessionSummary& sum;

  void until(double time_s) const { sum.duration_s = std::max(sum.duration_s, time_s); }

  void operator()(const journal::SessionStart& start) const {
    sum.begin_unix_ms = start.created_unix_ms;
    sum.software = start.software;
  }
  void operator()(const journal::StreamMark& mark) const {
    until(mark.time_s);
    // Of a journal whose first entry is lost.
    if (!sum.begin_unix_ms) sum.begin_unix_ms = mark.unix_ms - std::llround(1000.0 * mark.time_s);
  }
  void operator()(const journal::StreamSilence&) const {}
  void operator()(const UnfinishedTrace&) const {}
  void operator()(const UnfinishedSitting&) const {}
  void operator()(const WearerInfo& wearer) const {
    const auto& names = sum.wearers;
    if (!wearer.name.empty() && std::find(names.begin(), names.end(), wearer.name) == names.end())
      sum.wearers.push_back(wearer.name);
  }
  void operator()(const KeyPose& key_pose) const {
    until(key_pose.time_s);
    ++sum.key_poses;
    sum.breaks += key_pose.discontinuity;
    sum.distance_m += key_pose.path_m;
  }
  void operator()(const Trace& trace) const {
    until(trace.end_s);
    ++sum.traces;
    sum.contacts += trace.contacts.size();
  }
  void operator()(const Pivot& pivot) const {
    until(pivot.end_s);
    ++sum.pivots;
  }
  void operator()(const Sitting& sitting) const {
    until(sitting.end_s);
    ++sum.sittings;
  }
  void operator()(const journal::Announced& announced) const { sum.announced = announced; }
};

}  // namespace

SessionSummary summary_of(const std::vector<journal::Entry>& entries) {
  SessionSummary summary;
  for (const auto& entry : entries) std::visit(Adder{summary}, entry);
  return summary;
}

std::string utc_text(const std::optional<std::int64_t>& unix_ms) {
  if (!unix_ms) return "?";
  const std::time_t seconds = *unix_ms / 1000;
  std::tm utc{};
  char text[64];
  if (gmtime_r(&seconds, &utc) == nullptr || std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0)
    return "?";
  return text;
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(seconds);
  return format("%lld:%02lld:%02lld", s / 3600, s / 60 % 60, s % 60);
}

std::string size_text(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 1e6) return format("%.1f kB", size / 1e3);
  return size < 1e9 ? format("%.1f MB", size / 1e6) : format("%.2f GB", size / 1e9);
}

}  // namespace kinemap::cli
