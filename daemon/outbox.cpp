// SPDX-License-Identifier: Apache-2.0
#include "daemon/outbox.hpp"

#include <utility>

namespace kinemap {

bool Outbox::add_answer(Text text) {
  // A single answer larger than the budget is sent all the same, when nothing else waits.
  if (!answers_.empty() && bytes_ + text->size() > budget_) return false;
  bytes_ += text->size();
  answers_.push_back(std::move(text));
  return true;
}

Outbox::Added Outbox::add_news(Topic topic, Text text) {
  std::size_t skipped = 0;
  Text& place = newest_[static_cast<std::size_t>(topic)];
  if (topic != Topic::Events && place) {
    forget(topic);
    ++skipped;
  }
  while (bytes_ + text->size() > budget_ && drop_oldest_event()) ++skipped;
  if (bytes_ != 0 && bytes_ + text->size() > budget_) return {false, skipped};
  bytes_ += text->size();
  if (topic == Topic::Events)
    events_.push_back(std::move(text));
  else
    place = std::move(text);
  return {true, skipped};
}

void Outbox::forget(Topic topic) {
  if (topic == Topic::Events)
    while (drop_oldest_event()) {
    }
  Text& place = newest_[static_cast<std::size_t>(topic)];
  if (place) bytes_ -= place->size();
  place.reset();
}

bool Outbox::drop_oldest_event() {
  if (events_.empty()) return false;
  bytes_ -= events_.front()->size();
  events_.pop_front();
  return true;
}

Outbox::Next Outbox::next() {
  Next next;
  for (auto* queue : {&answers_, &events_}) {
    if (next.text || queue->empty()) continue;
    next.text = std::move(queue->front());
    queue->pop_front();
  }
  for (std::size_t i = 0; i < kTopicCount && !next.text; ++i)
    next = {std::exchange(newest_[i], nullptr), static_cast<Topic>(i) == Topic::Map};
  if (next.text) bytes_ -= next.text->size();
  return next;
}

void Outbox::clear() { *this = Outbox(budget_); }

}  // namespace kinemap
