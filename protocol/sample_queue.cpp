// SPDX-License-Identifier: Apache-2.0
#include "protocol/sample_queue.hpp"

#include <algorithm>

namespace kinemap {

namespace {

constexpr std::int64_t kFarthestStep =
    4096;  ///< a counter further ahead than this is not believed without silence (17 s at 240 Hz)
constexpr std::size_t kMostWaiting = 128;  ///< samples
constexpr std::size_t kMostWaitingItems = 8192;
constexpr std::size_t kMostRemembered = 256;
constexpr std::size_t kMostExtras = 64;
constexpr double kExtrasExpectedS = 0.5;  ///< type 23 or 24 is part of the stream while one came so lately
constexpr double kGuessedHz = 240.0;      ///< while the rate is unknown: hurries least
constexpr double kStartSpanS = 0.1;       ///< time code span that tells the rate
constexpr double kStartPatienceS = 0.3;
constexpr std::size_t kStartSamples = 64;

}  // namespace

bool SampleQueue::is_restart(std::int64_t step, double silence_s, double rate_hz) const {
  if (silence_s < config_.restart_silence_s) return false;
  if (step < 0) return true;
  if (step <= kFarthestStep) return false;
  // A long loss of the network: the counter went on meanwhile, about as long as nothing came.
  const double expected = silence_s * (rate_hz > 0.0 ? rate_hz : kGuessedHz);
  return static_cast<double>(step) < 0.5 * expected || static_cast<double>(step) > 2.0 * expected;
}

void SampleQueue::begin_anew(std::uint32_t counter, const Emit& emit) {
  flush(emit);
  extras_.clear();
  emitted_.clear();
  newest_counter_ = counter;
  ++newest_index_;
  restart_pending_ = true;
}

std::optional<std::int64_t> SampleQueue::place(const mxtp::Header& h, double arrival_s, double rate_hz,
                                               const Emit& emit) {
  if (!any_) {
    any_ = true;
    newest_counter_ = h.sample_counter;
    newest_index_ = h.sample_counter;
    newest_arrival_s_ = arrival_s;
    return newest_index_;
  }
  // Counters are compared modulo 2^32.
  const std::int64_t step = static_cast<std::int32_t>(h.sample_counter - newest_counter_);
  std::int64_t index = newest_index_ + step;
  const bool seen = std::find(emitted_.begin(), emitted_.end(), std::pair(index, h.time_code_ms)) != emitted_.end();
  if (seen) {
    ++stats_->duplicates;
    return std::nullopt;
  }
  const double silence_s = arrival_s - newest_arrival_s_;
  if (is_restart(step, silence_s, rate_hz)) {
    begin_anew(h.sample_counter, emit);
    index = newest_index_;
  } else if (index < 0 || (last_emitted_ && index <= *last_emitted_) ||
             (step > kFarthestStep && silence_s < config_.restart_silence_s)) {
    ++stats_->late;
    return std::nullopt;
  } else if (step > 0) {
    newest_counter_ = h.sample_counter;
    newest_index_ = index;
  }
  newest_arrival_s_ = std::max(newest_arrival_s_, arrival_s);
  return index;
}

bool SampleQueue::insert(Partial& p, const mxtp::Header& h, std::vector<mxtp::SegmentItem> items) {
  if (p.parts.contains(h.datagram_index)) {
    ++stats_->duplicates;
    return false;
  }
  const bool beyond_last = p.last && h.datagram_index > *p.last;
  const bool wrong_last =
      h.last_datagram && (p.last || (!p.parts.empty() && p.parts.rbegin()->first > h.datagram_index));
  if (beyond_last || wrong_last) {
    ++stats_->malformed;
    return false;
  }
  if (h.last_datagram) p.last = h.datagram_index;
  p.items += items.size();
  waiting_items_ += items.size();
  p.parts.emplace(h.datagram_index, std::move(items));
  ++stats_->waiting;
  return true;
}

void SampleQueue::add(const mxtp::Header& h, std::vector<mxtp::SegmentItem> items, double arrival_s, double rate_hz,
                      const Emit& emit) {
  const auto index = place(h, arrival_s, rate_hz, emit);
  if (!index) return;
  auto [it, fresh] = waiting_.try_emplace(*index);
  Partial& partial = it->second;
  if (fresh) {
    partial.header = h;
    partial.since_s = arrival_s;
    partial.restarted = std::exchange(restart_pending_, false);
  }
  insert(partial, h, std::move(items));
}

void SampleQueue::add_extras(std::uint32_t counter, const Extras& extras, double arrival_s) {
  const auto is_it = [counter](const auto& e) { return e.first == counter; };
  auto it = std::find_if(extras_.begin(), extras_.end(), is_it);
  if (it == extras_.end()) {
    if (extras_.size() == kMostExtras) extras_.pop_front();
    it = extras_.emplace(extras_.end(), counter, Extras{});
  }
  Extras& all = it->second;
  if (extras.center_of_mass) all.center_of_mass = extras.center_of_mass, center_arrival_s_ = arrival_s;
  if (extras.pelvis) all.pelvis = extras.pelvis, tracker_arrival_s_ = arrival_s;
  if (extras.right_forearm) all.right_forearm = extras.right_forearm;
}

bool SampleQueue::has_extras(const Partial& p, double now_s) const {
  const auto expected = [now_s](const auto& arrival_s) { return arrival_s && now_s - *arrival_s <= kExtrasExpectedS; };
  const bool center = expected(center_arrival_s_), trackers = expected(tracker_arrival_s_);
  if (!center && !trackers) return true;
  if (waiting_.size() > 1 && std::any_of(std::next(waiting_.begin()), waiting_.end(),
                                         [](const auto& later) { return later.second.whole(); })) {
    return true;  // the next sample is here: what belongs to this one is lost
  }
  return std::any_of(extras_.begin(), extras_.end(), [&](const auto& e) {
    return e.first == p.header.sample_counter && (!center || e.second.center_of_mass) && (!trackers || e.second.pelvis);
  });
}

bool SampleQueue::overdue(const Waiting::value_type& front, double now_s, double rate_hz) const {
  const double rate = rate_hz > 0.0 ? rate_hz : kGuessedHz;
  const double behind_s = static_cast<double>(newest_index_ - front.first) / rate;
  return now_s - front.second.since_s > config_.reorder_window_s || behind_s > config_.reorder_window_s ||
         waiting_.size() > kMostWaiting || waiting_items_ > kMostWaitingItems;
}

bool SampleQueue::may_start(double now_s) const {
  if (waiting_.empty()) return false;
  if (waiting_.size() > kStartSamples || waiting_items_ > kMostWaitingItems) return true;
  if (now_s - waiting_.begin()->second.since_s > kStartPatienceS) return true;
  const auto clocks = waiting_clocks();
  if (clocks.empty()) return false;
  const double span_s = time_code_step_s(clocks.front().time_code_ms, clocks.back().time_code_ms);
  return span_s >= kStartSpanS || span_s < 0.0;
}

bool SampleQueue::drain(double now_s, double rate_hz, const Emit& emit) {
  if (!started_ && !may_start(now_s)) return false;
  started_ = true;
  while (!waiting_.empty()) {
    const auto& front = *waiting_.begin();
    const bool whole = front.second.whole();
    const bool next = front.second.restarted || !last_emitted_ || front.first == *last_emitted_ + 1;
    if (whole && next && has_extras(front.second, now_s)) {
      emit_front(emit);
    } else if (!overdue(front, now_s, rate_hz)) {
      break;
    } else if (whole) {
      emit_front(emit);
    } else {
      drop_front();
    }
  }
  return true;
}

void SampleQueue::emit_front(const Emit& emit) {
  auto node = waiting_.extract(waiting_.begin());
  Partial& p = node.mapped();
  Sample out;
  out.header = p.header;
  out.clock = {node.key(), p.header.time_code_ms, p.since_s};
  out.datagrams = p.parts.size();
  out.restarted = p.restarted;
  out.items.reserve(p.items);
  for (const auto& [part, items] : p.parts) out.items.insert(out.items.end(), items.begin(), items.end());
  const auto extras =
      std::find_if(extras_.begin(), extras_.end(), [&](const auto& e) { return e.first == p.header.sample_counter; });
  if (extras != extras_.end()) out.extras = extras->second;
  if (last_emitted_ && !p.restarted)
    stats_->lost_samples += static_cast<std::uint64_t>(node.key() - *last_emitted_ - 1);
  last_emitted_ = node.key();
  emitted_.emplace_back(node.key(), p.header.time_code_ms);
  if (emitted_.size() > kMostRemembered) emitted_.pop_front();
  waiting_items_ -= p.items;
  stats_->waiting -= out.datagrams;
  emit(std::move(out));
}

void SampleQueue::drop_front() {
  const Partial& p = waiting_.begin()->second;
  restart_pending_ = restart_pending_ || p.restarted;
  if (auto next = std::next(waiting_.begin()); p.restarted && next != waiting_.end()) {
    next->second.restarted = true;
    restart_pending_ = false;
  }
  waiting_items_ -= p.items;
  stats_->waiting -= p.parts.size();
  stats_->incomplete_datagrams += p.parts.size();
  ++stats_->incomplete;
  waiting_.erase(waiting_.begin());
}

void SampleQueue::flush(const Emit& emit) {
  started_ = started_ || !waiting_.empty();
  while (!waiting_.empty()) {
    if (waiting_.begin()->second.whole()) {
      emit_front(emit);
    } else {
      drop_front();
    }
  }
}

void SampleQueue::discard(const std::function<void(std::size_t, std::uint64_t)>& count) {
  for (const auto& [index, p] : waiting_) {
    stats_->waiting -= p.parts.size();
    count(p.items, p.parts.size());
  }
  waiting_.clear();
  waiting_items_ = 0;
}

std::vector<SampleClock> SampleQueue::waiting_clocks() const {
  std::vector<SampleClock> out;
  for (const auto& [index, p] : waiting_) {
    if (p.whole()) out.push_back({index, p.header.time_code_ms, p.since_s});
  }
  return out;
}

}  // namespace kinemap
