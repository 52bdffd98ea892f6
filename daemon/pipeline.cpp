// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/reach.hpp"
#include "daemon/realtime.hpp"
#include "protocol/journal_map.hpp"

namespace kinemap {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::int64_t unix_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

constexpr double kMarkS = 1.0;        // between marks of the stream in the journal
constexpr double kStrideS = 1.0;      // within this time one walks straight
constexpr double kUnseenSpeed = 1.0;  // m/s that the wearer is taken to have walked while nobody looked

std::vector<journal::Entry> stored_entries(SessionJournal* journal) {
  auto stored = journal != nullptr ? journal->take_stored() : std::nullopt;
  return stored ? std::move(stored->entries) : std::vector<journal::Entry>{};
}

}  // namespace

Pipeline::Pipeline(const TrackerConfig& tracker, const MapperConfig& mapper, const RingSizes& sizes,
                   std::unique_ptr<SessionJournal> journal, int realtime_priority)
    : frames_(sizes.frames),
      unwritten_(sizes.events),
      events_(sizes.events),
      notices_(sizes.notices),
      map_(std::make_shared<const MapSnapshot>()),
      mapper_config_(mapper),
      journal_(std::move(journal)),
      stored_(stored_entries(journal_.get())),
      entries_to_restore_(stored_.size()),
      tracker_(tracker),
      resume_(resume_point(stored_)),
      mapper_(mapper),
      checkpoints_(journal_.get(), mapper),
      realtime_priority_(realtime_priority) {
  map_.set(mapper_.snapshot());
  solver_ = std::jthread([this](const std::stop_token& stop) { solve(stop); });
  pthread_setname_np(solver_.native_handle(), "solver");
  pthread_getcpuclockid(solver_.native_handle(), &solver_clock_);
  if (journal_) {
    recorder_ = std::jthread([this](const std::stop_token& stop) { record(stop); });
    pthread_setname_np(recorder_.native_handle(), "journal");
  }
  detection_ = std::jthread([this](const std::stop_token& stop) { detect(stop); });
  pthread_setname_np(detection_.native_handle(), "detection");
  if (realtime_priority_ == 0) return;
  realtime_refusal_ = set_realtime(detection_.native_handle(), realtime_priority_);
  if (!realtime_refusal_.empty()) spdlog::warn("detection.realtime_priority: {}", realtime_refusal_);
}

Pipeline::~Pipeline() {
  solver_.request_stop();
  detection_.request_stop();
  detection_.join();  // what it still sent is written
  recorder_.request_stop();
}

bool Pipeline::offer(const SuitFrame& frame) {
  SuitMessage message{frame, nullptr, false};
  message.frame.discontinuity |= discontinuity_lost_;
  const bool taken = frames_.push(message);
  discontinuity_lost_ = !taken && message.frame.discontinuity;
  return taken;
}
bool Pipeline::offer(const WearerInfo& wearer) {
  return frames_.push({{}, std::make_shared<const WearerInfo>(wearer), false});
}

void Pipeline::offer(std::span<const std::byte> datagram, const std::string& sender, std::uint16_t port) {
  if (journal_ && journal_->recorder() != nullptr) journal_->recorder()->offer(datagram, sender, port);
}

void Pipeline::ask_for_pulse() {
  pulse_asked_.fetch_add(1, std::memory_order_relaxed);
  frames_.wake();
  unwritten_.wake();  // a disk that was full may have room, and the suit be silent
}

bool Pipeline::offer_silence() { return frames_.push({{}, nullptr, true}); }

SolverProgress Pipeline::solver_progress() const {
  timespec cpu{};
  ::clock_gettime(solver_clock_, &cpu);
  return {solver_steps_.load(std::memory_order_relaxed),
          static_cast<std::uint64_t>(cpu.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(cpu.tv_nsec),
          solver_since_s_.load(std::memory_order_relaxed) >= 0.0 || events_.stats().fill > 0};
}

double Pipeline::solver_at_entry_s() const {
  const double since_s = solver_since_s_.load(std::memory_order_relaxed);
  return since_s >= 0.0 ? now_s() - since_s : 0.0;
}

PipelineStats Pipeline::stats() const {
  const Recorder* recorder = journal_ ? journal_->recorder() : nullptr;
  const auto unwritten = unwritten_.stats();
  const auto journal = journal_stats_.get();
  // A disk that hangs keeps the journal's thread from telling what it is at.
  const double writing_s = writing_since_s_.load(std::memory_order_relaxed);
  const double since_s = journal.unsafe_since_s >= 0.0 ? journal.unsafe_since_s : writing_s;
  return {tracker_stats_.get(),
          tracker_steps_.get(),
          solver_stats_.get(),
          solver_at_entry_s(),
          frames_.stats(),
          events_.stats(),
          notices_.stats(),
          events_held_back_.load(std::memory_order_relaxed),
          journal_ != nullptr,
          unwritten,
          journal,
          unwritten.fill + journal.unsafe_entries + (journal.unsafe_since_s < 0.0 && writing_s >= 0.0 ? 1U : 0U),
          since_s >= 0.0 ? now_s() - since_s : 0.0,
          entries_restored_.load(std::memory_order_relaxed),
          entries_to_restore_,
          recorder != nullptr,
          recorder != nullptr ? recorder->stats() : RecorderStats{},
          realtime_priority_,
          realtime_refusal_};
}

void Pipeline::detect(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { frames_.wake(); });
  std::vector<Event> events;
  for (;;) {
    const auto ticket = frames_.ticket();  // before the check for a stop: its wake-up must not fall in between
    if (stop.stop_requested()) return;
    beat();
    auto message = frames_.pop();
    if (!message) {
      frames_.wait(ticket);
    } else if (message->wearer) {
      wearer_ = *message->wearer;
      if (session_open_) send(*wearer_, stop);
    } else if (message->silence) {
      take_silence(events, stop);
    } else {
      take_frame(message->frame, events, stop);
    }
  }
}

/// With the first frame it shows whether the stored session goes on.
void Pipeline::begin_session(SuitFrame& first, const std::stop_token& stop) {
  session_open_ = true;
  const auto now = unix_ms();
  const auto since_s = resume_ ? time_since(*resume_, first, now) : std::nullopt;
  if (since_s) {
    time_offset_s_ = resume_->mark.time_s + *since_s - first.time_s;
    const double unseen_s = std::max(0.0, resume_->mark.time_s + *since_s - resume_->seen_s());
    first.discontinuity |= !within_reach(resume_->T_odom_pelvis(), first[Segment::Pelvis], unseen_s);
    tracker_.resume(resume_->tracker, kUnseenSpeed * std::max(0.0, unseen_s - kStrideS));
    spdlog::info("journal: the suit's stream goes on after {:.1f} s, and so does the session", *since_s);
  } else if (journal_) {
    send(journal::SessionStart{journal_->new_id(now), now, KINEMAP_VERSION, journal::kVersion}, stop);
  }
  if (wearer_) send(*wearer_, stop);
}

void Pipeline::take_frame(SuitFrame& frame, std::vector<Event>& events, const std::stop_token& stop) {
  if (!session_open_) begin_session(frame, stop);
  frame.time_s += time_offset_s_;
  const double begin_s = now_s();
  live_body_.set(live_body_of(frame, begin_s));
  events.clear();
  tracker_.step(frame, events);
  steps_.add(now_s() - begin_s);
  tracker_steps_.set(steps_);
  tracker_stats_.set(tracker_.stats());
  for (Event& event : events) send(journal::entry_of(std::move(event)), stop);
  if (journal_) note_progress(frame, stop);
}

/// What another daemon will need to go on from here, should this one die.
void Pipeline::note_progress(const SuitFrame& frame, const std::stop_token& stop) {
  if (frame.time_s >= next_mark_s_) {
    const SinceKeyPose since = tracker_.since_key_pose();
    send(journal::StreamMark{frame.time_s, frame.counter, unix_ms(), frame.time_code_ms, since.T_odom_pelvis,
                             since.path_m, since.turn_rad},
         stop);
    next_mark_s_ = frame.time_s + kMarkS;
  }
  if (auto piece = tracker_.take_unfinished_trace()) send(std::move(*piece), stop);
  if (auto piece = tracker_.take_unfinished_sitting()) send(std::move(*piece), stop);
}

void Pipeline::take_silence(std::vector<Event>& events, const std::stop_token& stop) {
  events.clear();
  tracker_.finish(events);
  tracker_stats_.set(tracker_.stats());
  for (Event& event : events) send(journal::entry_of(std::move(event)), stop);
  send(journal::StreamSilence{}, stop);
}

void Pipeline::send(Entry entry, const std::stop_token& stop) {
  push(*first_queue(), std::make_shared<const Entry>(std::move(entry)), stop);
}

Pipeline::Queue* Pipeline::first_queue() { return journal_ ? &unwritten_ : &events_; }

void Pipeline::beat() { pulse_.store(pulse_asked_.load(std::memory_order_relaxed), std::memory_order_relaxed); }

void Pipeline::push(Queue& queue, std::shared_ptr<const Entry> entry, const std::stop_token& stop) {
  if (queue.full()) {
    events_held_back_.fetch_add(1, std::memory_order_relaxed);
    // Half an hour behind: how soon the other side's progress is noticed does not matter any more.
    while (queue.full() && !stop.stop_requested()) {
      if (&queue == first_queue()) beat();  // waiting for room, not stuck: systemd is not to end us for it
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (stop.stop_requested()) return;
  }
  queue.push(entry);
}

void Pipeline::record(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { unwritten_.wake(); });
  for (;;) {
    const auto ticket = unwritten_.ticket();
    auto entry = unwritten_.pop();
    if (entry) {
      sessions_written_ += std::holds_alternative<journal::SessionStart>(**entry);
      writing_since_s_.store(now_s(), std::memory_order_relaxed);
      journal_->append(**entry);
      note_map();
      journal_stats_.set(journal_->stats());
      writing_since_s_.store(-1.0, std::memory_order_relaxed);
      if (!journal::is_piece(**entry)) push(events_, std::move(*entry), stop);
    } else if (stop.stop_requested()) {
      return note_map();  // all is written
    } else {
      journal_->retry();
      journal_stats_.set(journal_->stats());
      unwritten_.wait(ticket);
    }
  }
}

/// Writes down what the map has become when it has other numbers than before; the solver may still be at the session
/// before.
void Pipeline::note_map() {
  const Published map = published_.get();
  if (map.session != sessions_written_) return;
  if (map.session != noted_.session) noted_ = {{}, map.session};
  if (map.objects == noted_.objects && map.rooms == noted_.rooms) return;
  noted_ = map;
  journal_->append(map);
}

void Pipeline::publish() {
  const auto map = mapper_.snapshot();
  map_.set(map);
  published_.set({{map->time_s, map->revision, map->objects.size(), map->rooms.size()}, sessions_begun_});
}

/// Solver thread.
void Pipeline::solve(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { events_.wake(); });
  restore(stop);
  SolverStats stats;
  for (;;) {
    const auto ticket = events_.ticket();
    if (stop.stop_requested()) return;
    const auto message = events_.pop();
    if (!message) {
      events_.wait(ticket);
      continue;
    }
    const auto optimisations = mapper_.snapshot()->graph.optimisations;
    const double begin_s = now_s();
    solver_since_s_.store(begin_s, std::memory_order_relaxed);
    checkpoints_.add(**message);
    take_entry(**message);
    checkpoints_.keep(**message, mapper_);
    solver_since_s_.store(-1.0, std::memory_order_relaxed);
    solver_steps_.fetch_add(1, std::memory_order_relaxed);
    const double seconds = now_s() - begin_s;
    ++stats.messages;
    stats.events.add(seconds);
    if (mapper_.snapshot()->graph.optimisations > optimisations) stats.optimisations.add(seconds);
    stats.busy_s += seconds;
    stats.longest_s = std::max(stats.longest_s, seconds);
    solver_stats_.set(stats);
  }
}

/// Maps the stored session again, from its checkpoint on. Nobody is told of what happened in it; the map appears when
/// it is whole.
void Pipeline::restore(const std::stop_token& stop) {
  if (stored_.empty()) return;
  const auto begin = std::chrono::steady_clock::now();
  solver_since_s_.store(now_s(), std::memory_order_relaxed);
  std::size_t next = 0;
  if (auto checkpoint = checkpoints_.restore(stored_)) {
    mapper_ = std::move(checkpoint->mapper);
    next = checkpoint->entries;
    spdlog::info("journal: {} of {} entries are back from a checkpoint", next, stored_.size());
  }
  for (; next < stored_.size(); ++next) {
    entries_restored_.store(next, std::memory_order_relaxed);
    if (stop.stop_requested()) return;
    solver_since_s_.store(now_s(), std::memory_order_relaxed);
    checkpoints_.add(stored_[next]);
    journal::tell(mapper_, stored_[next]);
    solver_steps_.fetch_add(1, std::memory_order_relaxed);
  }
  entries_restored_.store(next, std::memory_order_relaxed);
  solver_since_s_.store(-1.0, std::memory_order_relaxed);
  stored_ = {};
  publish();
  spdlog::info("journal: {} objects and {} key poses are back, after {:.1f} s", map_.get()->objects.size(),
               map_.get()->trajectory.size(),
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
}

void Pipeline::take_entry(const Entry& entry) {
  std::visit([this](const auto& e) { fold(e); }, entry);
}

/// Another session: nothing of the one before is known of the rooms that follow. The revisions go on, for the clients.
void Pipeline::fold(const journal::SessionStart&) {
  ++sessions_begun_;
  const auto revision = mapper_.snapshot()->revision;
  if (revision == 0) return;
  mapper_ = Mapper(mapper_config_, revision + 1);
  publish();
}

void Pipeline::fold(const journal::StreamSilence&) {
  // Whoever stops the daemon does not wait for the last trials: the journal has all that they would start from.
  mapper_.finish([stop = solver_.get_stop_token()] { return stop.stop_requested(); });
  publish();
}

template <class E>
void Pipeline::fold(const E& event) {
  if (mapper_.add(event)) publish();
  notify(event);
}

void Pipeline::notify(const Event& event) {
  if (const auto* trace = std::get_if<Trace>(&event))
    notices_.push({Notice::Kind::Trace, trace->begin_s, trace->end_s, trace->contacts.size(), 0.0});
  if (const auto* sitting = std::get_if<Sitting>(&event))
    notices_.push({Notice::Kind::Sitting, sitting->begin_s, sitting->end_s, 0, sitting->height_m});
}

}  // namespace kinemap
