// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "daemon/stream_protocol.hpp"
#include "daemon/websocket_session.hpp"

namespace kinemap {
namespace {

class StreamSession : public WebSocketSession, public Subscriber {
 public:
  StreamSession(beast::tcp_stream stream, WebContext& context, ConnectionSlot slot)
      : WebSocketSession(std::move(stream), context, std::move(slot)), outbox_(context.client_buffer_bytes) {}

  [[nodiscard]] bool wants(Topic topic) const override { return wants_[static_cast<std::size_t>(topic)]; }

  void offer(const News& news, std::chrono::steady_clock::time_point now) override {
    check_stall(now);
    if (ended()) return;
    for (std::size_t i = 0; i < kTopicCount; ++i) {
      const auto& text = news.newest[i];
      if (!wants_[i] || !text || text == seen_[i]) continue;
      if (add_news(static_cast<Topic>(i), text)) seen_[i] = text;
    }
    if (wants(Topic::Events))
      for (const auto& text : news.events)
        if (!add_news(Topic::Events, text)) ++context().api.counts().messages_skipped;
    write();
  }

 private:
  bool add_news(Topic topic, const SharedText& text) {
    const auto [added, skipped] = outbox_.add_news(topic, text);
    context().api.counts().messages_skipped += skipped;
    return added;
  }

  void on_open() override { context().hub.join(std::static_pointer_cast<StreamSession>(shared_from_this())); }
  void on_end() override { wants_ = {}; }
  Outgoing next() override { return {{}, outbox_.next()}; }

  void on_message(std::string_view text, bool is_text) override {
    auto message =
        is_text ? parse_client_message(text)
                : ClientMessage(BadMessage{"", {400, "bad_message", "messages are JSON in text frames, not binary"}});
    std::visit([this](auto& m) { handle(m); }, message);
  }

  void handle(const Subscribe& message) {
    for (const Topic topic : message.topics) wants_[static_cast<std::size_t>(topic)] = true;
    answer(subscribed_text(topics()));
  }
  void handle(const Unsubscribe& message) {
    for (const Topic topic : message.topics) {
      wants_[static_cast<std::size_t>(topic)] = false;
      seen_[static_cast<std::size_t>(topic)].reset();
      outbox_.forget(topic);
    }
    answer(subscribed_text(topics()));
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

  [[nodiscard]] std::vector<Topic> topics() const {
    std::vector<Topic> list;
    for (std::size_t i = 0; i < kTopicCount; ++i)
      if (wants_[i]) list.push_back(static_cast<Topic>(i));
    return list;
  }

  void answer(std::string text) {
    if (!outbox_.add_answer(std::make_shared<const std::string>(std::move(text)))) give_up();
  }

  Outbox outbox_;
  std::array<bool, kTopicCount> wants_{};
  std::array<SharedText, kTopicCount> seen_;
};

}  // namespace

void serve_stream(beast::tcp_stream stream, http::request<http::string_body> request, WebContext& context,
                  ConnectionSlot slot) {
  std::make_shared<StreamSession>(std::move(stream), context, std::move(slot))->accept(std::move(request));
}

}  // namespace kinemap
