// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "daemon/stream_protocol.hpp"
#include "daemon/websocket_session.hpp"

namespace kinemap {
namespace {

constexpr double kBodyRateHz = 30.0;  // unless the client chooses

class StreamSession : public WebSocketSession, public Subscriber {
 public:
  StreamSession(NetStream stream, WebContext& context, ConnectionSlot slot)
      : WebSocketSession(std::move(stream), context, std::move(slot)), outbox_(context.config.client_buffer_bytes) {}

  [[nodiscard]] double rate_hz() const override {
    return std::max(at(Topic::Pose).wanted ? rate_of(Topic::Pose) : 0.0,
                    at(Topic::Body).wanted ? rate_of(Topic::Body) : 0.0);
  }

  void offer(Clock::time_point now) override {
    check_stall(now);
    if (ended()) return;
    offer_map();
    for (const Topic topic : {Topic::Pose, Topic::Body, Topic::Status}) offer_newest(topic, now);
    if (at(Topic::Events).wanted)
      for (const auto& text : context().hub.new_events())
        if (!add_news(Topic::Events, text)) ++context().api.counts().messages_skipped;
    write();
  }

 private:
  struct Subscription {
    bool wanted = false;
    std::optional<double> rate_hz;  // as chosen
    Clock::time_point due{};
    SharedText seen;  // the newest that went to the outbox
  };

  [[nodiscard]] const Subscription& at(Topic topic) const { return topics_[static_cast<std::size_t>(topic)]; }
  Subscription& at(Topic topic) { return topics_[static_cast<std::size_t>(topic)]; }
  [[nodiscard]] static bool has_rate(Topic topic) { return topic == Topic::Pose || topic == Topic::Body; }
  [[nodiscard]] double rate_of(Topic topic) const {
    return at(topic).rate_hz.value_or(topic == Topic::Body ? kBodyRateHz : context().hub.pose_rate_hz());
  }

  bool add_news(Topic topic, const SharedText& text) {
    const auto [added, skipped] = outbox_.add_news(topic, text);
    context().api.counts().messages_skipped += skipped;
    return added;
  }

  /// A delta that still waits gives way to one on the same base: what the client has is what was taken to be sent.
  void offer_map() {
    if (!at(Topic::Map).wanted) return;
    const auto& map = context().api.history().map();
    if (map == map_offered_ || !add_news(Topic::Map, context().hub.map_message(known_))) return;
    map_offered_ = map;
  }

  void offer_newest(Topic topic, Clock::time_point now) {
    Subscription& subscription = at(topic);
    if (!subscription.wanted || now < subscription.due) return;
    const SharedText text = context().hub.newest(topic);
    if (!text || text == subscription.seen || !add_news(topic, text)) return;
    subscription.seen = text;
    if (!has_rate(topic)) return;
    // On the beat of the rate, so that late ticks do not lower it; from now on after a pause.
    const auto step = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_of(topic)));
    subscription.due += step;
    if (subscription.due < now) subscription.due = now + step;
  }

  void on_open() override { context().hub.join(std::static_pointer_cast<StreamSession>(shared_from_this())); }
  void on_end() override {
    topics_ = {};
    map_offered_.reset();
    outbox_.clear();
  }

  Outgoing next() override {
    auto [text, is_map] = outbox_.next();
    if (is_map) known_ = KnownMap{map_offered_->revision, context().api.history().run()};
    return {{}, std::move(text)};
  }

  void on_message(std::string_view text, bool is_text) override {
    auto message =
        is_text ? parse_client_message(text)
                : ClientMessage(BadMessage{"", {400, "bad_message", "messages are JSON in text frames, not binary"}});
    std::visit([this](auto& m) { handle(m); }, message);
  }

  void handle(const Subscribe& message) {
    for (const Topic topic : message.topics) {
      at(topic).wanted = true;
      if (has_rate(topic) && message.rate_hz) at(topic).rate_hz = message.rate_hz;
      at(topic).due = {};
      at(topic).seen.reset();  // subscribing anew brings the state anew
      if (topic != Topic::Map) continue;
      known_ = message.known;
      map_offered_.reset();
      outbox_.forget(topic);
    }
    answer(subscribed());
  }
  void handle(const Unsubscribe& message) {
    for (const Topic topic : message.topics) {
      at(topic) = {};
      outbox_.forget(topic);
      if (topic != Topic::Map) continue;
      map_offered_.reset();
      known_.reset();
    }
    answer(subscribed());
  }
  void handle(const StreamQuery& query) {
    ++context().api.counts().requests;
    const Reply reply = context().api.query(query.path, query.params);
    if (reply.status < 400) return answer(result_text(query.id, *reply.body));
    ++context().api.counts().errors;
    answer(stream_error_text(query.id, *reply.body));
  }
  void handle(const BadMessage& message) {
    ++context().api.counts().errors;
    answer(stream_error_text(message.id, error_text(message.error)));
  }

  [[nodiscard]] std::string subscribed() const {
    std::vector<Topic> list;
    std::vector<std::pair<Topic, double>> rates_hz;
    for (std::size_t i = 0; i < kTopicCount; ++i) {
      const auto topic = static_cast<Topic>(i);
      if (!at(topic).wanted) continue;
      list.push_back(topic);
      if (has_rate(topic)) rates_hz.emplace_back(topic, rate_of(topic));
    }
    return subscribed_text(list, rates_hz);
  }

  void answer(std::string text) {
    if (!outbox_.add_answer(std::make_shared<const std::string>(std::move(text))))
      give_up("slow reader: you ask faster than you read the answers");
  }

  Outbox outbox_;
  std::array<Subscription, kTopicCount> topics_;
  std::shared_ptr<const MapSnapshot> map_offered_;  // the newest that went to the outbox
  std::optional<KnownMap> known_;                   // the map that the client has, once the messages before arrive
};

}  // namespace

void serve_stream(NetStream stream, http::request<http::string_body> request, WebContext& context,
                  ConnectionSlot slot) {
  std::make_shared<StreamSession>(std::move(stream), context, std::move(slot))->accept(std::move(request));
}

}  // namespace kinemap
