// SPDX-License-Identifier: Apache-2.0
#include "protocol/assembler.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "protocol/frame_maker.hpp"
#include "protocol/sample_queue.hpp"
#include "protocol/wearer.hpp"

namespace kinemap {

namespace {

constexpr std::size_t kMostCandidates = 64;
constexpr std::size_t kMostCollectors = 16;
constexpr double kTakeOverS = 30.0;  // silence after which another character or another machine may take over
constexpr std::uint64_t kHopelessDatagrams = 120;

const char* const kObjectsMessage =
    "only tracked objects or part of a body are streamed (no character with 23 body segments). In MVN choose a "
    "whole-body configuration and "
    "stream the wearer";
const char* const kTypesMessage =
    "no pose datagrams are streamed. In MVN's Network Streamer switch on \"Position + Orientation (Quaternion)\" (type "
    "02)";

std::string_view address_of(std::string_view sender) { return sender.substr(0, sender.rfind(':')); }

/// A tracked object: one item, all of it in one datagram.
bool is_object(const mxtp::Header& h, std::size_t items) {
  return h.datagram_index == 0 && h.last_datagram && items == 1;
}

struct Key {
  std::string sender;
  std::uint8_t character = 0;
  bool operator==(const Key&) const = default;
};

/// The same character of the same machine; its ports may differ.
bool same_source(const Key& a, const Key& b) {
  return a.character == b.character && address_of(a.sender) == address_of(b.sender);
}

/// Of all trackers those whose field is used.
Extras extras_of(const mxtp::TrackerItems& trackers) {
  constexpr auto id_of = [](Segment s) { return static_cast<std::int32_t>(s) + 1; };
  Extras out;
  for (const mxtp::TrackerItem& item : trackers.items) {
    if (item.id == id_of(Segment::Pelvis)) out.pelvis = item;
    if (item.id == id_of(Segment::RightForearm)) out.right_forearm = item;
  }
  return out;
}

/// One sender's pose stream of one character.
struct Stream {
  Stream(Key k, const AssemblerConfig& config, AssemblerStats& stats) : key(std::move(k)), queue(config, stats) {}
  Key key;
  SampleQueue queue;
  int pose_type = 0;      ///< 1 or 2; type 02 is preferred
  double type02_s = 0.0;  ///< when one came last
  double last_s = 0.0;
  std::uint64_t datagrams = 0;
};

}  // namespace

std::uint64_t AssemblerStats::accounted() const {
  return std::accumulate(faults.begin(), faults.end(), std::uint64_t{0}) + used + waiting + skipped_types + meta +
         duplicates + late + incomplete_datagrams + malformed + other_character + other_sender + not_a_person +
         refused_pinned + refused_bones;
}

class Assembler::Impl {
 public:
  explicit Impl(const AssemblerConfig& c) : config(c) {}

  void add(std::span<const std::byte> bytes, double arrival_s, std::string_view sender, const FrameSink& sink);
  void flush(const FrameSink& sink);

  AssemblerConfig config;
  AssemblerStats stats;
  FrameMaker maker{stats};
  WearerInfo wearer;
  std::uint64_t wearer_revision = 0;
  std::optional<std::string> refusal;

 private:
  using Streams = std::vector<std::unique_ptr<Stream>>;

  void route(mxtp::Datagram& datagram, std::string_view sender, const FrameSink& sink);
  void add_poses(const mxtp::Header& h, std::vector<mxtp::SegmentItem> items, Key key, const FrameSink& sink);
  void add_extras(const Extras& extras, std::uint32_t counter, const Key& key);
  void add_wearer(const mxtp::Datagram& datagram, const Key& key);
  void publish_wearer();
  void update_refusal();

  [[nodiscard]] bool wants(const Key& key) const { return config.character < 0 || config.character == key.character; }
  [[nodiscard]] bool may_take_over(const Key& key) const;
  void count_foreign(const Key& key, bool object, std::uint64_t datagrams);
  void feed(Stream& stream, const mxtp::Header& h, std::vector<mxtp::SegmentItem> items, const SampleQueue::Emit& emit);
  Streams::iterator candidate(const Key& key);
  Streams::iterator least_active();
  void forget(std::unique_ptr<Stream> stream);
  void consider(Streams::iterator candidate, const std::vector<Sample>& due, const FrameSink& sink);
  void select(Streams::iterator candidate, const FrameSink& sink);

  double now_s_ = 0.0;
  std::unique_ptr<Stream> selected_;
  Streams candidates_;
  std::size_t turn_ = 0;  ///< candidate that made way last
  std::vector<std::pair<Key, WearerCollector>> collectors_;
};

void Assembler::Impl::add(std::span<const std::byte> bytes, double arrival_s, std::string_view sender,
                          const FrameSink& sink) {
  if (std::isfinite(arrival_s)) now_s_ = arrival_s;
  ++stats.datagrams;
  stats.bytes += bytes.size();
  auto decoded = mxtp::decode(bytes);
  if (const auto* fault = std::get_if<mxtp::Fault>(&decoded)) {
    ++stats.faults[static_cast<std::size_t>(*fault)];
  } else {
    route(std::get<mxtp::Datagram>(decoded), sender, sink);
  }
  update_refusal();
}

void Assembler::Impl::route(mxtp::Datagram& datagram, std::string_view sender, const FrameSink& sink) {
  const mxtp::Header& h = datagram.header;
  if (std::holds_alternative<mxtp::Skipped>(datagram.payload)) {
    ++stats.skipped_types;
    return;
  }
  Key key{std::string(sender), h.character};
  if (auto* poses = std::get_if<mxtp::PoseItems>(&datagram.payload)) {
    add_poses(h, std::move(poses->items), std::move(key), sink);
    return;
  }
  if (!wants(key) || (selected_ && !same_source(key, selected_->key) && !may_take_over(key))) {
    count_foreign(key, false, 1);
  } else if (const auto* com = std::get_if<mxtp::CenterOfMass>(&datagram.payload)) {
    add_extras({com->position, {}, {}}, h.sample_counter, key);
  } else if (const auto* trackers = std::get_if<mxtp::TrackerItems>(&datagram.payload)) {
    add_extras(extras_of(*trackers), h.sample_counter, key);
  } else {
    add_wearer(datagram, key);
  }
}

void Assembler::Impl::count_foreign(const Key& key, bool object, std::uint64_t datagrams) {
  const bool same = selected_ && selected_->key.character == key.character;
  (object ? stats.not_a_person : same ? stats.other_sender : stats.other_character) += datagrams;
}

/// A sender that starts anew has another port. Another machine or another wearer gets its turn only when the one mapped
/// is long gone.
bool Assembler::Impl::may_take_over(const Key& key) const {
  return now_s_ - selected_->last_s >= (same_source(key, selected_->key) ? config.restart_silence_s : kTakeOverS);
}

void Assembler::Impl::add_poses(const mxtp::Header& h, std::vector<mxtp::SegmentItem> items, Key key,
                                const FrameSink& sink) {
  if (selected_ && selected_->key == key) {
    for (auto& other : std::exchange(candidates_, {})) forget(std::move(other));  // it is back
    feed(*selected_, h, std::move(items), [&](const Sample& s) { maker.take(s, sink); });
    return;
  }
  if (!wants(key) || (selected_ && !may_take_over(key))) {
    count_foreign(key, is_object(h, items.size()), 1);
    return;
  }
  const auto stream = candidate(key);
  std::vector<Sample> due;
  feed(**stream, h, std::move(items), [&due](Sample&& s) { due.push_back(std::move(s)); });
  consider(stream, due, sink);
}

void Assembler::Impl::feed(Stream& s, const mxtp::Header& h, std::vector<mxtp::SegmentItem> items,
                           const SampleQueue::Emit& emit) {
  ++s.datagrams;
  if (h.type == 1 && s.pose_type == 2 && now_s_ - s.type02_s < config.restart_silence_s) {
    ++stats.skipped_types;
    return;
  }
  if (s.pose_type != 0 && s.pose_type != h.type) {
    // Both types number the same samples: what waits of the other type makes way.
    s.queue.discard([this](std::size_t, std::uint64_t datagrams) { stats.skipped_types += datagrams; });
  }
  s.pose_type = h.type;
  if (h.type == 2) s.type02_s = now_s_;
  s.last_s = now_s_;
  const double rate_hz = maker.rate_hz();
  s.queue.add(h, std::move(items), now_s_, rate_hz, emit);
  s.queue.drain(now_s_, rate_hz, emit);
}

Assembler::Impl::Streams::iterator Assembler::Impl::candidate(const Key& key) {
  const auto it = std::find_if(candidates_.begin(), candidates_.end(), [&](const auto& s) { return s->key == key; });
  if (it != candidates_.end()) return it;
  auto fresh = std::make_unique<Stream>(key, config, stats);
  if (candidates_.size() < kMostCandidates) {
    candidates_.push_back(std::move(fresh));
    return std::prev(candidates_.end());
  }
  const auto gone = least_active();
  forget(std::exchange(*gone, std::move(fresh)));
  return gone;
}

/// Of those with the fewest datagrams the next in turn: a flood of senders that come once cannot push out one that
/// comes again.
Assembler::Impl::Streams::iterator Assembler::Impl::least_active() {
  const auto fewer = [](const auto& a, const auto& b) { return a->datagrams < b->datagrams; };
  const std::uint64_t least = (*std::min_element(candidates_.begin(), candidates_.end(), fewer))->datagrams;
  do {
    turn_ = (turn_ + 1) % candidates_.size();
  } while (candidates_[turn_]->datagrams != least);
  return candidates_.begin() + static_cast<std::ptrdiff_t>(turn_);
}

void Assembler::Impl::forget(std::unique_ptr<Stream> stream) {
  stream->queue.discard(
      [&](std::size_t items, std::uint64_t datagrams) { count_foreign(stream->key, items == 1, datagrams); });
}

/// The first candidate with a whole body is the one that is mapped.
void Assembler::Impl::consider(Streams::iterator stream, const std::vector<Sample>& due, const FrameSink& sink) {
  if (std::any_of(due.begin(), due.end(), [](const Sample& s) { return shape_of(s) == Shape::Person; })) {
    std::vector<SampleClock> clocks;
    for (const Sample& s : due) clocks.push_back(s.clock);
    const auto waiting = (*stream)->queue.waiting_clocks();
    clocks.insert(clocks.end(), waiting.begin(), waiting.end());
    select(stream, sink);
    maker.prime(clocks);
  }
  for (const Sample& s : due) maker.take(s, sink);
}

void Assembler::Impl::select(Streams::iterator stream, const FrameSink& sink) {
  auto chosen = std::move(*stream);
  candidates_.erase(stream);
  if (selected_) {
    selected_->queue.flush([&](const Sample& s) { maker.take(s, sink); });
    const bool other_wearer = selected_->key.character != chosen->key.character;
    maker.restart(other_wearer);
    if (other_wearer) wearer = {}, ++wearer_revision;
  }
  selected_ = std::move(chosen);
  for (auto& other : std::exchange(candidates_, {})) forget(std::move(other));
  std::erase_if(collectors_, [&](const auto& c) { return !same_source(c.first, selected_->key); });
  publish_wearer();
}

void Assembler::Impl::add_extras(const Extras& extras, std::uint32_t counter, const Key& key) {
  ++stats.meta;
  Stream* stream = nullptr;
  if (selected_ && same_source(selected_->key, key)) stream = selected_.get();
  for (const auto& c : candidates_) {
    if (!stream && same_source(c->key, key)) stream = c.get();
  }
  if (stream) stream->queue.add_extras(counter, extras, now_s_);
}

void Assembler::Impl::add_wearer(const mxtp::Datagram& datagram, const Key& key) {
  auto it =
      std::find_if(collectors_.begin(), collectors_.end(), [&](const auto& c) { return same_source(c.first, key); });
  if (it == collectors_.end()) {
    if (collectors_.size() == kMostCollectors) collectors_.erase(collectors_.begin());
    it = collectors_.emplace(collectors_.end(), key, WearerCollector{});
  }
  std::optional<mxtp::Fault> fault;
  if (const auto* meta = std::get_if<mxtp::MetaData>(&datagram.payload)) it->second.add(*meta);
  if (const auto* part = std::get_if<mxtp::ScaleFragment>(&datagram.payload))
    fault = it->second.add(datagram.header, *part);
  ++(fault ? stats.faults[static_cast<std::size_t>(*fault)] : stats.meta);
  publish_wearer();
}

void Assembler::Impl::publish_wearer() {
  if (!selected_) return;
  const auto it = std::find_if(collectors_.begin(), collectors_.end(),
                               [&](const auto& c) { return same_source(c.first, selected_->key); });
  if (it == collectors_.end() || it->second.info() == wearer) return;
  wearer = it->second.info();
  ++wearer_revision;
}

void Assembler::Impl::update_refusal() {
  const char* why = nullptr;
  if (selected_) {
    if (maker.pinned()) why = kPinnedMessage;
  } else if (stats.not_a_person >= kHopelessDatagrams) {
    why = kObjectsMessage;
  } else if (candidates_.empty() && stats.skipped_types >= kHopelessDatagrams) {
    why = kTypesMessage;
  }
  if (!why) {
    refusal.reset();
  } else if (!refusal || *refusal != why) {
    refusal = why;
  }
}

void Assembler::Impl::flush(const FrameSink& sink) {
  if (selected_) selected_->queue.flush([&](const Sample& s) { maker.take(s, sink); });
  while (!candidates_.empty()) {
    const auto stream = candidates_.begin();
    const Key key = (*stream)->key;
    std::vector<Sample> due;
    (*stream)->queue.flush([&due](Sample&& s) { due.push_back(std::move(s)); });
    consider(stream, due, sink);
    if (!selected_) candidates_.erase(candidates_.begin());
    if (selected_ && selected_->key != key) {
      for (auto& other : std::exchange(candidates_, {})) forget(std::move(other));
    }
  }
  update_refusal();
}

Assembler::Assembler(const AssemblerConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Assembler::~Assembler() = default;
Assembler::Assembler(Assembler&&) noexcept = default;
Assembler& Assembler::operator=(Assembler&&) noexcept = default;

void Assembler::add(std::span<const std::byte> datagram, double arrival_s, std::string_view sender,
                    const FrameSink& sink) {
  impl_->add(datagram, arrival_s, sender, sink);
}
void Assembler::flush(const FrameSink& sink) { impl_->flush(sink); }
const AssemblerStats& Assembler::stats() const { return impl_->stats; }
const WearerInfo& Assembler::wearer() const { return impl_->wearer; }
std::uint64_t Assembler::wearer_revision() const { return impl_->wearer_revision; }
double Assembler::rate_hz() const { return impl_->maker.rate_hz(); }
const std::optional<std::string>& Assembler::refusal() const { return impl_->refusal; }

}  // namespace kinemap
