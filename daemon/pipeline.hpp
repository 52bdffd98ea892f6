// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <variant>

#include "core/body.hpp"
#include "core/events.hpp"
#include "core/map.hpp"
#include "core/mapper/mapper.hpp"
#include "core/tracker/tracker.hpp"
#include "daemon/checkpoints.hpp"
#include "daemon/durations.hpp"
#include "daemon/latest.hpp"
#include "daemon/live_body.hpp"
#include "daemon/resume.hpp"
#include "daemon/ring.hpp"
#include "daemon/session_journal.hpp"
#include "daemon/watchdog.hpp"

namespace kinemap {

/// Something the wearer did, for those who listen to the stream of events.
struct Notice {
  enum class Kind : std::uint8_t { Trace, Sitting } kind = Kind::Trace;
  double begin_s = 0.0;
  double end_s = 0.0;
  std::uint64_t contacts = 0;  ///< of a trace
  double seat_height_m = 0.0;  ///< of a sitting
};

struct SolverStats {
  std::uint64_t messages = 0;
  double longest_s = 0.0;   ///< the longest time one message took
  double busy_s = 0.0;      ///< all of them together
  Durations events;         ///< each of them
  Durations optimisations;  ///< of these, those in which the graph was optimised
};

struct PipelineStats {
  TrackerStats tracker;
  Durations tracker_steps;  ///< one for each frame
  SolverStats solver;
  double solver_at_entry_s = 0.0;  ///< for so long it has been at its present entry; 0: it is at none
  RingStats frames, events, notices;
  std::uint64_t events_held_back = 0;  ///< events that had to wait because the solver was that far behind
  bool has_journal = false;
  RingStats unwritten;  ///< on their way to the journal
  JournalStats journal;
  /// What happened and is not safe on the disk yet: entries, and for how long the oldest has not been.
  std::uint64_t journal_lag_entries = 0;
  double journal_lag_s = 0.0;
  std::uint64_t entries_restored = 0;    ///< of the session that was found at the start
  std::uint64_t entries_to_restore = 0;  ///< so many it has
  bool has_recorder = false;
  RecorderStats recorder;
  int realtime_priority = 0;     ///< asked for the detection thread; 0: none
  std::string realtime_refusal;  ///< why it is not in force; empty where it is
};

struct RingSizes {
  std::size_t frames = 1024;   ///< 4 s at 240 Hz, 1.6 MB
  std::size_t events = 16384;  ///< more than half an hour of walking
  std::size_t notices = 256;
};

/// The threads between the suit and the map, and the queues between them. With a journal a third one stands between
/// detection and solver: what the solver is told, and so all that it announces, is on the disk before.
///
/// What is lost when somebody is too slow, and why just that: a frame may be lost (the suit's poses are absolute, the
/// next frame says all that the lost one said about the drift), an event may not (key poses are a chain, and traces
/// refer to them). So:
/// - detection behind → `frames_` fills, the newest frames are refused and counted; the tracker sees a gap as it sees
/// one of the network;
/// - solver behind → `events_` fills (half an hour); then detection takes no frame until there is room, which leads to
/// the case before;
/// - nobody listens to notices → they are refused and counted.
/// Memory is bounded in each case and nothing on the way from the network ever waits for the solver or for a client.
class Pipeline {
 public:
  /// With a journal, the session that it holds is mapped again first; it goes on when the suit's stream turns out to be
  /// the same, and gives way to a new one with the first frame of another.
  /// `realtime_priority`: of the detection thread, 1 to 99; 0: none. A refusal is logged and told by stats().
  Pipeline(const TrackerConfig& tracker, const MapperConfig& mapper, const RingSizes& sizes = {},
           std::unique_ptr<SessionJournal> journal = nullptr, int realtime_priority = 0);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Network thread only; never waits. False, and counted, when the ring is full. Wearer information must be offered
  /// again then.
  bool offer(const SuitFrame& frame);
  bool offer(const WearerInfo& wearer);

  /// A datagram as it came, for the recording; nothing where none is made. Network thread only; never waits.
  void offer(std::span<const std::byte> datagram, const std::string& sender, std::uint16_t port);

  /// The suit has fallen silent: what is open is closed and the map optimised to the end, as at the end of a recording.
  /// Frames may follow all the same.
  bool offer_silence();

  /// Any thread: asks the detection loop for a sign of life, which `pulse()` counts as soon as the loop comes round.
  void ask_for_pulse();
  [[nodiscard]] std::uint64_t pulse() const { return pulse_.load(std::memory_order_relaxed); }

  /// Any thread: how far the solver is, for the watchdog.
  [[nodiscard]] SolverProgress solver_progress() const;
  /// Any thread: how long the solver has been at its present entry; 0 when it is at none.
  [[nodiscard]] double solver_at_entry_s() const;

  /// Any thread. The map is never null.
  [[nodiscard]] std::shared_ptr<const MapSnapshot> map() const { return map_.get(); }
  [[nodiscard]] LiveBody live_body() const { return live_body_.get(); }
  [[nodiscard]] PipelineStats stats() const;

  /// One listener's thread only.
  std::optional<Notice> take_notice() { return notices_.pop(); }

 private:
  struct SuitMessage {
    SuitFrame frame;
    std::shared_ptr<const WearerInfo> wearer;  ///< when set: news of the wearer, and no frame
    bool silence = false;                      ///< when set: the suit has fallen silent, and no frame
  };
  using Entry = journal::Entry;
  /// What the solver has published, and of which session (0: the one that was stored).
  struct Published : journal::Announced {
    std::uint64_t session = 0;
  };
  using Queue = Ring<std::shared_ptr<const Entry>>;  // by pointer: a trace is not copied on the fast thread

  void detect(const std::stop_token& stop);
  void record(const std::stop_token& stop);
  void solve(const std::stop_token& stop);
  void begin_session(SuitFrame& first, const std::stop_token& stop);
  void take_frame(SuitFrame& frame, std::vector<Event>& events, const std::stop_token& stop);
  void note_progress(const SuitFrame& frame, const std::stop_token& stop);
  void take_silence(std::vector<Event>& events, const std::stop_token& stop);
  void send(Entry entry, const std::stop_token& stop);
  Queue* first_queue();  ///< the one that detection writes to
  void beat();           ///< detection thread only
  void push(Queue& queue, std::shared_ptr<const Entry> entry, const std::stop_token& stop);
  void note_map();
  void publish();
  void restore(const std::stop_token& stop);
  void take_entry(const Entry& entry);
  void fold(const journal::SessionStart& start);
  void fold(const journal::StreamMark&) {}
  void fold(const journal::Announced&) {}
  void fold(const UnfinishedTrace&) {}
  void fold(const UnfinishedSitting&) {}
  void fold(const journal::StreamSilence&);
  void fold(const WearerInfo& wearer) { mapper_.set_wearer(wearer); }
  template <class E>
  void fold(const E& event);
  void notify(const Event& event);

  bool discontinuity_lost_ = false;  // network thread only: a refused frame said so, the next one must
  Ring<SuitMessage> frames_;         // network → detection
  Queue unwritten_;                  // detection → journal
  Queue events_;                     // detection or journal → solver
  Ring<Notice> notices_;             // solver → the one listener
  Latest<MapSnapshot> map_;          // solver → everyone who asks
  LatestValue<LiveBody> live_body_;  // detection → everyone who asks
  std::atomic<std::uint64_t> pulse_asked_{0}, pulse_{0};
  LatestValue<TrackerStats> tracker_stats_;         // detection → everyone who asks
  LatestValue<Durations> tracker_steps_;            // detection → everyone who asks
  LatestValue<SolverStats> solver_stats_;           // solver → everyone who asks
  std::atomic<std::uint64_t> events_held_back_{0};  // detection → everyone who asks
  LatestValue<JournalStats> journal_stats_;         // journal → everyone who asks
  std::atomic<double> writing_since_s_{-1.0};       // journal → everyone who asks; negative: nothing is being written
  std::atomic<std::uint64_t> entries_restored_{0};  // solver → everyone who asks
  std::atomic<std::uint64_t> solver_steps_{0};      // solver → everyone who asks
  std::atomic<double> solver_since_s_{-1.0};        // solver → everyone who asks; negative: it is at no entry
  LatestValue<Published> published_;                // solver → journal

  const MapperConfig mapper_config_;
  const std::unique_ptr<SessionJournal> journal_;  // journal thread only, but for new_id()
  std::vector<Entry> stored_;                      // solver thread only: what it maps again first
  const std::uint64_t entries_to_restore_;

  // Detection thread only.
  Tracker tracker_;
  std::optional<ResumePoint> resume_;
  bool session_open_ = false;         // it is decided whether the stored session goes on
  std::optional<WearerInfo> wearer_;  // told before that
  double time_offset_s_ = 0.0;        // stream time of the session at the stream's time 0
  double next_mark_s_ = 0.0;
  Durations steps_;

  std::uint64_t sessions_written_ = 0;  // journal thread only
  Published noted_;                     // journal thread only

  std::uint64_t sessions_begun_ = 0;  // solver thread only
  Mapper mapper_;                     // solver thread only
  Checkpoints checkpoints_;           // solver thread only

  const int realtime_priority_;
  std::string realtime_refusal_;  // written by the constructor only
  clockid_t solver_clock_{};      // written by the constructor only
  std::jthread solver_, recorder_, detection_;
};

}  // namespace kinemap
