// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics.hpp"

#include <array>
#include <utility>

#include "daemon/metrics_text.hpp"
#include "daemon/process_stats.hpp"
#include "daemon/stream_counters.hpp"

namespace kinemap {
namespace {

void write_process(MetricsText& out, const Status& status) {
  out.gauge("kinemap_build_info", "Always 1; the labels say what runs.");
  out.sample({{"version", KINEMAP_VERSION}, {"compiler", __VERSION__}}, std::uint64_t{1});
  out.gauge("kinemap_uptime_seconds", "Since the daemon was started.", status.uptime_s);
  const ProcessStats process = process_stats();
  out.counter("process_cpu_seconds_total", "CPU time of all threads.", process.cpu_s);
  out.gauge("process_resident_memory_bytes", "Memory in RAM.", process.resident_bytes);
  out.gauge("process_virtual_memory_bytes", "Address space.", process.virtual_bytes);
  out.gauge("process_open_fds", "Open files and sockets.", process.open_files);
  out.gauge("process_max_fds", "How many files and sockets may be open.", process.max_open_files);
  out.gauge("process_threads", "Threads.", process.threads);
}

void write_suit(MetricsText& out, const Status& status) {
  const ReceiverCounts& counts = status.suit.counts;
  out.gauge("kinemap_suit_receiving", "1 while frames come.", std::uint64_t{is_receiving(status.suit)});
  out.gauge("kinemap_suit_refused", "1 while the stream is one that cannot be mapped; the status says why.",
            std::uint64_t{status.suit.news->refusal.has_value()});
  if (counts.last_frame_s >= 0.0)
    out.gauge("kinemap_suit_silence_seconds", "Since the newest frame.", status.suit.now_s - counts.last_frame_s);
  out.gauge("kinemap_suit_rate_hertz", "Frames a second as the stream has them; 0 while unknown.", counts.rate_hz);
  out.gauge("kinemap_suit_tcp_connections", "Connections of MVN open now.", counts.tcp_open);
  out.counter("kinemap_suit_tcp_connections_total", "Connections of MVN, by what became of them.");
  out.sample({{"result", "accepted"}}, counts.tcp_accepted);
  out.sample({{"result", "refused"}}, counts.tcp_refused);
  out.sample({{"result", "closed_garbage"}}, counts.tcp_closed_garbage);
  out.counter("kinemap_suit_tcp_skipped_bytes_total", "Bytes between datagrams on TCP.", counts.tcp_skipped_bytes);
}

void write_kind(MetricsText& out, const AssemblerStats& stream, StreamCounter::Kind kind, std::string_view label) {
  for (const StreamCounter& counter : kStreamCounters)
    if (counter.kind == kind) out.sample({{label, counter.name}}, stream.*counter.value);
}

void write_stream(MetricsText& out, const Status& status) {
  const AssemblerStats& stream = status.suit.counts.stream;
  out.counter("kinemap_suit_datagrams_total", "Datagrams received.", stream.datagrams);
  out.counter("kinemap_suit_received_bytes_total", "Bytes received.", stream.bytes);
  out.counter("kinemap_suit_frames_total", "Whole samples of the wearer's body handed on.", stream.frames);
  out.counter("kinemap_suit_datagrams_used_total", "Datagrams used, by what for.");
  out.sample({{"for", "frames"}}, stream.used);
  out.sample({{"for", "wearer"}}, stream.meta);
  out.gauge("kinemap_suit_datagrams_waiting", "Datagrams of samples that are not whole or not due yet.",
            stream.waiting);
  out.counter("kinemap_suit_datagrams_dropped_total", "Datagrams that were not used, by cause.");
  for (std::size_t i = 0; i < stream.faults.size(); ++i)
    out.sample({{"cause", mxtp::to_string(static_cast<mxtp::Fault>(i))}}, stream.faults[i]);
  write_kind(out, stream, StreamCounter::Kind::Dropped, "cause");
  out.sample({{"cause", "kernel_buffer_full"}}, status.suit.counts.kernel_drops);
  out.sample({{"cause", "truncated"}}, status.suit.counts.truncated);
  out.counter("kinemap_frames_lost_total", "Frames that the map did not get, by cause; ring_full is our own fault.");
  write_kind(out, stream, StreamCounter::Kind::LostFrame, "cause");
  out.sample({{"cause", "ring_full"}}, status.pipeline.frames.refused);
  out.counter("kinemap_suit_events_total", "What befell the stream.");
  write_kind(out, stream, StreamCounter::Kind::Incident, "event");
}

void write_rings(MetricsText& out, const PipelineStats& pipeline) {
  const std::array<std::pair<const char*, const RingStats*>, 4> rings{{{"frames", &pipeline.frames},
                                                                       {"unwritten", &pipeline.unwritten},
                                                                       {"events", &pipeline.events},
                                                                       {"notices", &pipeline.notices}}};
  out.gauge("kinemap_ring_capacity", "How many fit between two threads.");
  for (const auto& [name, ring] : rings) out.sample({{"ring", name}}, ring->capacity);
  out.gauge("kinemap_ring_depth", "How many wait between two threads.");
  for (const auto& [name, ring] : rings) out.sample({{"ring", name}}, ring->fill);
  out.counter("kinemap_ring_refused_total", "How many found no room between two threads.");
  for (const auto& [name, ring] : rings) out.sample({{"ring", name}}, ring->refused);
  out.counter("kinemap_events_held_back_total", "Events that had to wait since the solver was half an hour behind.",
              pipeline.events_held_back);
}

void write_tracker(MetricsText& out, const PipelineStats& pipeline) {
  const TrackerStats& tracker = pipeline.tracker;
  out.histogram("kinemap_tracker_step_seconds", "Time that one frame took in the detection thread.",
                pipeline.tracker_steps);
  out.counter("kinemap_tracker_events_total", "What the wearer was seen to do.");
  const std::array<std::pair<const char*, std::uint64_t>, 5> events{{{"key_pose", tracker.key_poses},
                                                                     {"trace", tracker.traces},
                                                                     {"trace_rejected", tracker.traces_rejected},
                                                                     {"pivot", tracker.pivots},
                                                                     {"sitting", tracker.sittings}}};
  for (const auto& [name, count] : events) out.sample({{"event", name}}, count);
  out.counter("kinemap_tracker_contacts_left_out_total", "Contacts beyond the longest trace.",
              tracker.contacts_thinned_out);
  out.counter("kinemap_tracker_path_meters_total", "Length of the way walked.", tracker.path_m);
}

void write_drift(MetricsText& out, const Status& status) {
  const auto drift = corrected_drift(status);
  if (!drift) return;
  out.gauge("kinemap_drift_corrected_meters", "How far from where the suit says the wearer is on the map.",
            drift->distance_m);
  out.gauge("kinemap_drift_corrected_radians", "How far the heading is turned against the suit's.", drift->turn_rad);
}

void write_map(MetricsText& out, const Status& status) {
  const MapSnapshot& map = *status.map;
  out.gauge("kinemap_map_revision", "Grows with each map that is published.", map.revision);
  out.gauge("kinemap_map_objects", "Objects in the map.");
  for (const auto type : {ObjectType::Wall, ObjectType::Table, ObjectType::Screen, ObjectType::Chair}) {
    std::uint64_t count = 0;
    for (const auto& object : map.objects) count += object.type == type;
    out.sample({{"type", to_string(type)}}, count);
  }
  out.gauge("kinemap_map_rooms", "Closed rooms.", std::uint64_t{map.rooms.size()});
  out.gauge("kinemap_map_unresolved_traces", "Traces that were neither wall nor rectangle.",
            std::uint64_t{map.unresolved.size()});
  out.gauge("kinemap_map_key_poses", "Key poses in the graph.", std::uint64_t{map.graph.key_poses});
  out.gauge("kinemap_map_contacts", "Hand contacts in the graph.", std::uint64_t{map.graph.contacts});
  out.gauge("kinemap_map_loop_closures", "Observations of objects that were known; of this session.",
            std::uint64_t{map.graph.loop_closures});
  out.gauge("kinemap_map_loop_closures_revoked", "Closures taken back; of this session.",
            std::uint64_t{map.graph.loop_closures_revoked});
  out.gauge("kinemap_map_optimisations_failed", "Optimisations without a usable outcome; of this session.",
            std::uint64_t{map.graph.optimisations_failed});
}

void write_solver(MetricsText& out, const PipelineStats& pipeline) {
  const SolverStats& solver = pipeline.solver;
  out.histogram("kinemap_solver_event_seconds", "Time that one event took in the solver thread.", solver.events);
  out.histogram("kinemap_solver_optimisation_seconds", "Of these, those in which the graph was optimised.",
                solver.optimisations);
  out.gauge("kinemap_solver_entry_age_seconds", "How long the solver has been at its present entry; 0: at none.",
            pipeline.solver_at_entry_s);
}

void write_journal(MetricsText& out, const PipelineStats& pipeline) {
  out.gauge("kinemap_journal_enabled", "1 where sessions are kept on disk.", std::uint64_t{pipeline.has_journal});
  if (!pipeline.has_journal) return;
  const JournalStats& journal = pipeline.journal;
  out.gauge("kinemap_journal_healthy",
            "0 while writing is suspended: the disk does not take it, or less than journal.min_free_mb is free.",
            std::uint64_t{journal.healthy});
  out.gauge("kinemap_journal_file_bytes", "Length of the session's journal.", journal.bytes);
  out.gauge("kinemap_journal_waiting_bytes", "What the disk has not taken yet.", journal.waiting_bytes);
  out.gauge("kinemap_journal_lag_entries", "What has happened and is not safe on the disk yet.",
            pipeline.journal_lag_entries);
  out.gauge("kinemap_journal_lag_seconds", "For how long the oldest of these has not been.", pipeline.journal_lag_s);
  out.gauge("kinemap_disk_free_bytes", "Free on the disk of the sessions.", journal.free_bytes);
  out.gauge("kinemap_disk_min_free_bytes", "With less, writing is suspended (journal.min_free_mb).",
            journal.min_free_bytes);
  out.counter("kinemap_journal_entries_total", "Entries handed to the journal.", journal.entries);
  out.counter("kinemap_journal_lost_entries_total", "Entries given up since too much was waiting.",
              journal.lost_entries);
  out.counter("kinemap_journal_syncs_total", "Times that the disk said it has it all.", journal.syncs);
  out.gauge("kinemap_journal_longest_sync_seconds", "The longest of these.", journal.longest_sync_s);
}

void write_recording(MetricsText& out, const PipelineStats& pipeline) {
  if (!pipeline.has_recorder) return;
  const RecorderStats& recorder = pipeline.recorder;
  out.gauge("kinemap_recording_healthy",
            "0 while the disk does not take the suit's datagrams, or has no room for more.",
            std::uint64_t{recorder.healthy});
  out.gauge("kinemap_recording_waiting_bytes", "What the disk has not taken yet.", recorder.waiting_bytes);
  out.counter("kinemap_recording_files_total", "Files begun.", recorder.files);
  out.counter("kinemap_recording_bytes_total", "Length of all of them.", recorder.bytes);
  out.counter("kinemap_recording_datagrams_total", "Datagrams recorded.", recorder.datagrams);
  out.counter("kinemap_recording_dropped_total", "Datagrams that are not in the recording.", recorder.dropped);
}

void write_clients(MetricsText& out, const ApiCounts& api) {
  out.gauge("kinemap_clients", "Connections open now.");
  out.sample({{"kind", "http"}}, api.connections - std::min(api.connections, api.streams));
  out.sample({{"kind", "websocket"}}, api.streams);
  out.counter("kinemap_connections_accepted_total", "Connections of clients.", api.accepted);
  out.counter("kinemap_connections_refused_total", "Connections beyond api.max_clients.", api.refused);
  out.counter("kinemap_clients_kept_out_total", "Connections and requests that were closed or not answered, by cause.");
  const std::array<std::pair<const char*, std::uint64_t>, 8> kept_out{{{"slow_request", api.slow_requests_closed},
                                                                       {"gave_way", api.gave_way},
                                                                       {"displaced", api.displaced},
                                                                       {"revoked", api.revoked},
                                                                       {"handshake_failed", api.handshakes_failed},
                                                                       {"unauthorized", api.unauthorized},
                                                                       {"forbidden", api.forbidden},
                                                                       {"throttled", api.throttled}}};
  for (const auto& [cause, count] : kept_out) out.sample({{"cause", cause}}, count);
  out.counter("kinemap_http_requests_total", "Requests over HTTP.", api.requests);
  out.counter("kinemap_http_errors_total", "Answers with a status of 400 and above.", api.errors);
  out.counter("kinemap_stream_messages_skipped_total", "News that slow clients did not get, since newer ones came.",
              api.messages_skipped);
  out.counter("kinemap_stream_slow_clients_closed_total", "Clients that were too slow for too long.",
              api.slow_clients_closed);
}

}  // namespace

std::string metrics_text(const Status& status) {
  MetricsText out;
  write_process(out, status);
  write_suit(out, status);
  write_stream(out, status);
  write_rings(out, status.pipeline);
  write_tracker(out, status.pipeline);
  write_solver(out, status.pipeline);
  write_map(out, status);
  write_drift(out, status);
  write_journal(out, status.pipeline);
  write_recording(out, status.pipeline);
  write_clients(out, status.api);
  return out.take();
}

}  // namespace kinemap
