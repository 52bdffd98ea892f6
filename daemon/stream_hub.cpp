// SPDX-License-Identifier: Apache-2.0
#include "daemon/stream_hub.hpp"

#include <algorithm>
#include <utility>

#include "daemon/queries.hpp"
#include "daemon/stream_protocol.hpp"

namespace kinemap {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestPeriod{50};             // how late a new map or event may come
constexpr milliseconds kShortestPeriod{2}, kEven{10};  // kEven: what a rate may be off its beat
constexpr std::chrono::seconds kStatusPeriod{1};

SharedText shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

milliseconds StreamHub::period() const {
  if (fastest_hz_ <= 0.0) return kLongestPeriod;
  return std::clamp(milliseconds(static_cast<std::int64_t>(500.0 / fastest_hz_)), kShortestPeriod, kEven);
}

void StreamHub::tick(TimePoint now) {
  now_ = now;
  std::vector<std::shared_ptr<Subscriber>> everyone;
  for (const auto& weak : subscribers_)
    if (auto subscriber = weak.lock()) everyone.push_back(std::move(subscriber));
  std::erase_if(subscribers_, [](const auto& weak) { return weak.expired(); });
  api_.look(now);
  take_events();
  fastest_hz_ = 0.0;
  for (const auto& subscriber : everyone) {
    subscriber->offer(now);
    fastest_hz_ = std::max(fastest_hz_, subscriber->rate_hz());
  }
}

SharedText StreamHub::map_message(const std::optional<KnownMap>& known) {
  const SharedText text = known ? api_.history().since(*known) : api_.history().whole();
  auto& [message, of] = known ? delta_map_ : whole_map_;
  if (text != of) {
    message = shared(news_text(Topic::Map, *text));
    of = text;
  }
  return message;
}

SharedText StreamHub::newest(Topic topic) {
  Made& made = made_[static_cast<std::size_t>(topic)];
  if (topic == Topic::Pose) make_pose(made, query_pose, topic);
  if (topic == Topic::Body) make_pose(made, query_body, topic);
  if (topic == Topic::Status && now_ >= status_due_) {
    made.text = shared(news_text(topic, api_.status_text()));
    status_due_ = now_ + kStatusPeriod;
  }
  return made.text;
}

void StreamHub::make_pose(Made& made, Answer (*query)(const MapSnapshot&, const LiveBody&, double), Topic topic) {
  const LiveBody body = api_.sources().body();
  const auto map = api_.sources().map();
  // A new map corrects the pose even of a wearer whose suit is silent.
  if (!body.known || (body.time_s == made.time_s && map->revision == made.revision)) return;
  const Answer answer = query(*map, body, std::chrono::duration<double>(now_.time_since_epoch()).count());
  made = {shared(news_text(topic, std::get<std::string>(answer))), body.time_s, map->revision};
}

void StreamHub::take_events() {
  new_events_.clear();
  const auto& events = api_.events().all();
  const auto fresh = std::min<std::uint64_t>(api_.events().newest() - events_seen_, events.size());
  for (auto it = events.end() - static_cast<std::ptrdiff_t>(fresh); it != events.end(); ++it)
    new_events_.push_back(shared(news_text(Topic::Events, *it->data)));
  events_seen_ = api_.events().newest();
}

}  // namespace kinemap
