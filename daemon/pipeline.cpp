// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace kinemap {
namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Pipeline::Pipeline(const TrackerConfig& tracker, const MapperConfig& mapper, const RingSizes& sizes)
    : frames_(sizes.frames),
      events_(sizes.events),
      notices_(sizes.notices),
      map_(std::make_shared<const MapSnapshot>()),
      tracker_(tracker),
      mapper_(mapper) {
  map_.set(mapper_.snapshot());
  solver_ = std::jthread([this](const std::stop_token& stop) { solve(stop); });
  detection_ = std::jthread([this](const std::stop_token& stop) { detect(stop); });
  pthread_setname_np(solver_.native_handle(), "solver");
  pthread_setname_np(detection_.native_handle(), "detection");
}

Pipeline::~Pipeline() {
  // Both are asked before either is joined (by destruction), so that they end side by side.
  detection_.request_stop();
  solver_.request_stop();
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

bool Pipeline::offer_silence() { return frames_.push({{}, nullptr, true}); }

PipelineStats Pipeline::stats() const {
  return {tracker_stats_.get(), solver_stats_.get(), frames_.stats(),
          events_.stats(),      notices_.stats(),    events_held_back_.load(std::memory_order_relaxed)};
}

void Pipeline::detect(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { frames_.wake(); });
  std::vector<Event> events;
  for (;;) {
    const auto ticket = frames_.ticket();  // before the check for a stop: its wake-up must not fall in between
    if (stop.stop_requested()) return;
    const auto message = frames_.pop();
    if (!message) {
      frames_.wait(ticket);
    } else if (message->wearer) {
      send(*message->wearer, stop);
    } else if (message->silence) {
      take_silence(events, stop);
    } else {
      take_frame(message->frame, events, stop);
    }
  }
}

void Pipeline::take_frame(const SuitFrame& frame, std::vector<Event>& events, const std::stop_token& stop) {
  live_body_.set(live_body_of(frame, now_s()));
  events.clear();
  tracker_.step(frame, events);
  tracker_stats_.set(tracker_.stats());
  for (Event& event : events) send(std::move(event), stop);
}

void Pipeline::take_silence(std::vector<Event>& events, const std::stop_token& stop) {
  events.clear();
  tracker_.finish(events);
  tracker_stats_.set(tracker_.stats());
  for (Event& event : events) send(std::move(event), stop);
  send(Silence{}, stop);
}

void Pipeline::send(MapperMessage message, const std::stop_token& stop) {
  const auto shared = std::make_shared<const MapperMessage>(std::move(message));
  if (events_.full()) {
    events_held_back_.fetch_add(1, std::memory_order_relaxed);
    // Half an hour behind: how soon the solver's progress is noticed does not matter any more.
    while (events_.full() && !stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (stop.stop_requested()) return;
  }
  events_.push(shared);
}

void Pipeline::solve(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { events_.wake(); });
  SolverStats stats;
  for (;;) {
    const auto ticket = events_.ticket();
    if (stop.stop_requested()) return;
    const auto message = events_.pop();
    if (!message) {
      events_.wait(ticket);
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    take_message(**message);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    ++stats.messages;
    stats.busy_s += seconds;
    stats.longest_s = std::max(stats.longest_s, seconds);
    solver_stats_.set(stats);
  }
}

void Pipeline::take_message(const MapperMessage& message) {
  if (const auto* wearer = std::get_if<WearerInfo>(&message)) {
    mapper_.set_wearer(*wearer);
    return;
  }
  if (std::holds_alternative<Silence>(message)) {
    mapper_.finish();
    map_.set(mapper_.snapshot());
    return;
  }
  const Event& event = std::get<Event>(message);
  if (mapper_.add(event)) map_.set(mapper_.snapshot());
  notify(event);
}

void Pipeline::notify(const Event& event) {
  if (const auto* trace = std::get_if<Trace>(&event))
    notices_.push({Notice::Kind::Trace, trace->begin_s, trace->end_s, trace->contacts.size(), 0.0});
  if (const auto* sitting = std::get_if<Sitting>(&event))
    notices_.push({Notice::Kind::Sitting, sitting->begin_s, sitting->end_s, 0, sitting->height_m});
}

}  // namespace kinemap
