// SPDX-License-Identifier: Apache-2.0
#include "daemon/status.hpp"

#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/pose.hpp"
#include "daemon/process_stats.hpp"
#include "daemon/stream_counters.hpp"
#include "protocol/json_text.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSilenceS = 2.0;  // without frames for so long, the suit does not send

double rounded(double value, double per_unit = 1e3) { return std::round(value * per_unit) / per_unit + 0.0; }

Json stream_json(const AssemblerStats& s) {
  Json faults = Json::object();
  for (std::size_t i = 0; i < s.faults.size(); ++i) faults[mxtp::to_string(static_cast<mxtp::Fault>(i))] = s.faults[i];
  Json json = {{"datagrams", s.datagrams}, {"bytes", s.bytes}, {"faults", std::move(faults)}};
  // Up to refused_bones each datagram is in exactly one counter; the rest counts samples and events.
  for (const StreamCounter& counter : kStreamCounters) json[counter.name] = s.*counter.value;
  return json;
}

Json socket_json(const ReceiverCounts& c) {
  return {{"kernel_drops", c.kernel_drops},
          {"truncated", c.truncated},
          {"not_allowed", c.not_allowed},
          {"tcp_open", c.tcp_open},
          {"tcp_accepted", c.tcp_accepted},
          {"tcp_refused", c.tcp_refused},
          {"tcp_closed_garbage", c.tcp_closed_garbage},
          {"tcp_skipped_bytes", c.tcp_skipped_bytes}};
}

Json wearer_json(const WearerInfo& wearer) {
  Json json = Json::object();
  if (!wearer.name.empty()) json["name"] = wearer.name;
  if (wearer.stature_m) json["stature"] = rounded(*wearer.stature_m);
  json["hand_points"] = wearer.p_hand_fingertip.has_value() || wearer.p_hand_palm.has_value();
  return json;
}

Json suit_json(const Status& status) {
  const ReceiverState& suit = status.suit;
  Json json = {{"receiving", is_receiving(suit)},
               {"transport", status.suit_config.transport},
               {"address", status.suit_config.address},
               {"port", status.suit_port}};
  if (suit.counts.rate_hz > 0.0) json["rate_hz"] = rounded(suit.counts.rate_hz);
  if (suit.counts.last_frame_s >= 0.0) json["silence_s"] = rounded(suit.now_s - suit.counts.last_frame_s);
  if (!suit.news->sender.empty()) json["sender"] = suit.news->sender;
  if (suit.news->refusal) json["refusal"] = *suit.news->refusal;
  json["wearer"] = wearer_json(suit.news->wearer);
  json["stream"] = stream_json(suit.counts.stream);
  json["socket"] = socket_json(suit.counts);
  return json;
}

Json tracker_json(const TrackerStats& t) {
  return {{"frames", t.frames},
          {"key_poses", t.key_poses},
          {"traces", t.traces},
          {"traces_rejected", t.traces_rejected},
          {"pivots", t.pivots},
          {"sittings", t.sittings},
          {"contacts_thinned_out", t.contacts_thinned_out},
          {"path_m", rounded(t.path_m)}};
}

/// Nothing where no real-time priority is asked for.
Json detection_json(const PipelineStats& p) {
  Json json = {{"realtime_priority", p.realtime_priority}, {"in_force", p.realtime_refusal.empty()}};
  if (!p.realtime_refusal.empty()) json["refusal"] = p.realtime_refusal;
  return json;
}

Json ring_json(const RingStats& ring) {
  return {{"capacity", ring.capacity}, {"fill", ring.fill}, {"dropped", ring.refused}};
}

Json rings_json(const PipelineStats& p) {
  Json json = {{"frames", ring_json(p.frames)}, {"events", ring_json(p.events)}, {"notices", ring_json(p.notices)}};
  json["events"]["held_back"] = p.events_held_back;
  return json;
}

Json recording_json(const RecorderStats& r) {
  return {{"healthy", r.healthy},     {"files", r.files},     {"bytes", r.bytes},
          {"datagrams", r.datagrams}, {"dropped", r.dropped}, {"waiting_bytes", r.waiting_bytes}};
}

/// Nothing where no journal is kept.
Json journal_json(const PipelineStats& p) {
  const JournalStats& j = p.journal;
  return {{"healthy", j.healthy},
          {"bytes", j.bytes},
          {"entries", j.entries},
          {"waiting_entries", p.unwritten.fill},
          {"waiting_bytes", j.waiting_bytes},
          {"lost_entries", j.lost_entries},
          {"lag_entries", p.journal_lag_entries},
          {"lag_s", rounded(p.journal_lag_s)},
          {"free_bytes", j.free_bytes},
          {"min_free_bytes", j.min_free_bytes},
          {"longest_sync_s", rounded(j.longest_sync_s, 1e6)},
          {"restored_entries", p.entries_restored},
          {"entries_to_restore", p.entries_to_restore}};
}

Json map_json(const Status& status) {
  const MapSnapshot& map = *status.map;
  const SolverStats& solver = status.pipeline.solver;
  Json objects = Json::object();
  for (const auto type : {ObjectType::Wall, ObjectType::Table, ObjectType::Screen, ObjectType::Chair}) {
    std::uint64_t count = 0;
    for (const auto& object : map.objects) count += object.type == type;
    objects[to_string(type)] = count;
  }
  Json json = {{"revision", map.revision},
               {"time", rounded(map.time_s)},
               {"objects", std::move(objects)},
               {"rooms", map.rooms.size()},
               {"unresolved_traces", map.unresolved.size()},
               {"key_poses", map.graph.key_poses},
               {"landmarks", map.graph.landmarks},
               {"contacts", map.graph.contacts},
               {"loop_closures", map.graph.loop_closures},
               {"loop_closures_revoked", map.graph.loop_closures_revoked},
               {"optimisations", map.graph.optimisations},
               {"optimisations_failed", map.graph.optimisations_failed},
               {"last_cost", rounded(map.graph.last_cost)},
               {"solver",
                {{"messages", solver.messages},
                 {"longest_s", rounded(solver.longest_s, 1e6)},
                 {"at_entry_s", rounded(status.pipeline.solver_at_entry_s)},
                 {"busy_s", rounded(solver.busy_s)}}}};
  if (const auto drift = corrected_drift(status))
    json["drift"] = {{"distance", rounded(drift->distance_m)}, {"turn", rounded(drift->turn_rad)}};
  if (map.hand)
    json["hand"] = {{"part", to_string(map.hand->part)},
                    {"probability", rounded(map.hand->probability)},
                    {"from_wrist", rounded(-map.hand->p_hand.y())},
                    {"sigma", rounded(map.hand->sigma_m.y())}};
  return json;
}

Json api_json(const ApiCounts& api) {
  return {{"connections", api.connections},
          {"streams", api.streams},
          {"accepted", api.accepted},
          {"refused", api.refused},
          {"requests", api.requests},
          {"errors", api.errors},
          {"messages_skipped", api.messages_skipped},
          {"slow_clients_closed", api.slow_clients_closed},
          {"slow_requests_closed", api.slow_requests_closed},
          {"gave_way", api.gave_way},
          {"displaced", api.displaced},
          {"revoked", api.revoked},
          {"handshakes_failed", api.handshakes_failed},
          {"unauthorized", api.unauthorized},
          {"forbidden", api.forbidden},
          {"throttled", api.throttled}};
}

Json process_json() { return {{"pid", ::getpid()}, {"rss_bytes", process_stats().resident_bytes}}; }

}  // namespace

std::optional<Drift> corrected_drift(const Status& status) {
  if (!status.body.known) return std::nullopt;
  const Pose& T_map_odom = status.map->T_map_odom;
  const Pose T_odom_pelvis = status.body.T_odom(Segment::Pelvis);
  const Eigen::Vector3d x_map = T_map_odom.q * Eigen::Vector3d::UnitX();
  return Drift{((T_map_odom * T_odom_pelvis).p - T_odom_pelvis.p).norm(), std::abs(std::atan2(x_map.y(), x_map.x()))};
}

bool is_receiving(const ReceiverState& suit) {
  return suit.counts.last_frame_s >= 0.0 && suit.now_s - suit.counts.last_frame_s < kSilenceS;
}

std::string status_text(const Status& status) {
  Json json({{"version", KINEMAP_VERSION},
             {"uptime_s", rounded(status.uptime_s)},
             {"suit", suit_json(status)},
             {"tracker", tracker_json(status.pipeline.tracker)},
             {"rings", rings_json(status.pipeline)},
             {"map", map_json(status)},
             {"clients", api_json(status.api)},
             {"process", process_json()}});
  if (status.pipeline.has_journal) json["journal"] = journal_json(status.pipeline);
  if (status.pipeline.realtime_priority > 0) json["detection"] = detection_json(status.pipeline);
  if (status.pipeline.has_recorder) json["recording"] = recording_json(status.pipeline.recorder);
  return compact_text(json);
}

std::string health_text(const Status& status) {
  const std::string transport = status.suit_config.transport == "tcp" ? "TCP " : "UDP ";
  const std::string where = transport + status.suit_config.address + ":" + std::to_string(status.suit_port);
  if (status.suit.news->refusal) return compact_text({{"status", "refused"}, {"message", *status.suit.news->refusal}});
  if (is_receiving(status.suit))
    return compact_text({{"status", "ok"}, {"message", "receiving from " + status.suit.news->sender}});
  const bool ever = status.suit.counts.last_frame_s >= 0.0;
  const std::string message =
      (ever ? "the suit has fallen silent; listening on " : "no suit yet; listening on ") + where;
  return compact_text({{"status", "waiting"}, {"message", message}});
}

}  // namespace kinemap
