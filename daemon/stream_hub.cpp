// SPDX-License-Identifier: Apache-2.0
#include "daemon/stream_hub.hpp"

#include <algorithm>
#include <utility>

#include "daemon/queries.hpp"
#include "daemon/stream_protocol.hpp"

namespace kinemap {
namespace {

constexpr std::chrono::milliseconds kLongestPeriod{50};  // how late a new map may come
constexpr std::chrono::seconds kStatusPeriod{1};

SharedText shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

std::chrono::milliseconds StreamHub::period() const {
  const std::chrono::milliseconds pose(std::max<std::int64_t>(1, static_cast<std::int64_t>(1000.0 / pose_rate_hz_)));
  return std::min(pose, kLongestPeriod);
}

void StreamHub::tick(TimePoint now) {
  std::vector<std::shared_ptr<Subscriber>> everyone;
  for (const auto& weak : subscribers_)
    if (auto subscriber = weak.lock()) everyone.push_back(std::move(subscriber));
  std::erase_if(subscribers_, [](const auto& weak) { return weak.expired(); });
  for (std::size_t i = 0; i < kTopicCount; ++i)
    wanted_[i] = std::any_of(everyone.begin(), everyone.end(),
                             [i](const auto& subscriber) { return subscriber->wants(static_cast<Topic>(i)); });
  update_map();
  update_pose(now);
  update_status(now);
  take_events();
  for (const auto& subscriber : everyone) subscriber->offer(news_, now);
}

void StreamHub::update_map() {
  if (!wanted(Topic::Map)) {
    newest(Topic::Map).reset();
    map_of_news_.reset();
    return;
  }
  const auto text = api_.map_text();
  if (text == map_of_news_) return;
  map_of_news_ = text;
  newest(Topic::Map) = shared(news_text(Topic::Map, *text));
}

void StreamHub::update_pose(TimePoint now) {
  if (!wanted(Topic::Pose)) {
    newest(Topic::Pose).reset();
    pose_time_s_ = -1.0;
    return;
  }
  if (now < pose_due_) return;
  const LiveBody body = api_.sources().body();
  const auto map = api_.sources().map();
  // A new map corrects the pose even of a wearer whose suit is silent.
  if (!body.known || (body.time_s == pose_time_s_ && map->revision == pose_revision_)) return;
  const Answer answer = query_pose(*map, body);
  newest(Topic::Pose) = shared(news_text(Topic::Pose, std::get<std::string>(answer)));
  pose_time_s_ = body.time_s;
  pose_revision_ = map->revision;
  const auto step = std::chrono::duration_cast<TimePoint::duration>(std::chrono::duration<double>(1.0 / pose_rate_hz_));
  // On the grid of the rate, so that late ticks do not lower it; from now on after a pause.
  pose_due_ = std::max(pose_due_ + step, now - step);
}

void StreamHub::update_status(TimePoint now) {
  if (!wanted(Topic::Status)) {
    newest(Topic::Status).reset();
    status_due_ = {};
    return;
  }
  if (now < status_due_) return;
  newest(Topic::Status) = shared(news_text(Topic::Status, api_.status_text()));
  status_due_ = now + kStatusPeriod;
}

void StreamHub::take_events() {
  news_.events.clear();
  while (const auto notice = api_.sources().take_notice())
    news_.events.push_back(shared(news_text(Topic::Events, notice_text(*notice))));
}

}  // namespace kinemap
