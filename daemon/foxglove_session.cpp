// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "daemon/foxglove_feed.hpp"
#include "daemon/foxglove_protocol.hpp"
#include "daemon/websocket_session.hpp"

namespace kinemap {
namespace {

using foxglove::Channel;
using foxglove::kChannelCount;

/// A viewer. Answers to its own messages wait in a queue within a byte budget; data it fetches from the feed whenever
/// the one before has been sent, so that it always gets the newest.
class FoxgloveSession : public WebSocketSession, public foxglove::Listener {
 public:
  FoxgloveSession(NetStream stream, WebContext& context, ConnectionSlot slot)
      : WebSocketSession(std::move(stream), context, std::move(slot)), feed_(context.foxglove) {}

  [[nodiscard]] bool wants(Channel channel) const override { return at(channel).id.has_value(); }
  void wake(std::chrono::steady_clock::time_point now) override {
    check_stall(now);
    write();
  }

 private:
  struct Subscription {
    std::optional<std::uint32_t> id;  // the client's
    std::uint64_t seen = 0;           // version of the newest message that was sent
  };

  [[nodiscard]] const Subscription& at(Channel channel) const {
    return subscriptions_[static_cast<std::size_t>(channel)];
  }
  Subscription& at(Channel channel) { return subscriptions_[static_cast<std::size_t>(channel)]; }

  void on_open() override {
    answer({{}, text(foxglove::server_info_text(feed_.session_id())), false});
    answer({{}, text(foxglove::advertise_text()), false});
    answer({{}, text(feed_.services().advertise_text()), false});
    feed_.join(std::static_pointer_cast<FoxgloveSession>(shared_from_this()));
  }
  void on_end() override {
    subscriptions_ = {};
    answers_.clear();
  }

  void on_message(std::string_view message, bool is_text) override {
    auto parsed = is_text ? foxglove::parse_text(message) : foxglove::parse_binary(message);
    std::visit([this](auto& m) { handle(m); }, parsed);
  }

  void handle(const foxglove::Subscribe& message) {
    for (const auto& [id, channel] : message.items) {
      if (by_id(id))
        complain("subscription " + std::to_string(id) + " is in use");
      else if (wants(channel))
        complain(std::string(topic(channel)) + " is subscribed already");
      else
        at(channel) = {id, 0};
    }
  }
  void handle(const foxglove::Unsubscribe& message) {
    for (const std::uint32_t id : message.ids) {
      Subscription* subscription = by_id(id);
      if (subscription == nullptr)
        complain("there is no subscription " + std::to_string(id));
      else
        *subscription = {};
    }
  }
  void handle(const foxglove::ServiceCall& call) {
    ++context().api.counts().requests;
    const Reply reply = feed_.services().call(call);
    if (reply.status < 400) return answer({foxglove::service_response_head(call), reply.body, true});
    ++context().api.counts().errors;
    const auto error = nlohmann::json::parse(*reply.body);
    answer({{}, text(foxglove::service_failure_text(call, error["error"]["message"])), false});
  }
  void handle(const foxglove::BadMessage& message) { complain(message.message); }

  Subscription* by_id(std::uint32_t id) {
    for (Subscription& subscription : subscriptions_)
      if (subscription.id == id) return &subscription;
    return nullptr;
  }

  void complain(const std::string& message) {
    ++context().api.counts().errors;
    answer({{}, text(foxglove::status_message_text(foxglove::StatusLevel::Error, message)), false});
  }

  static SharedText text(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

  void answer(Outgoing message) {
    // One that is larger than the budget is sent all the same, when nothing else waits.
    if (!answers_.empty() && answers_bytes_ + message.size() > context().config.client_buffer_bytes)
      return give_up("slow reader: you ask faster than you read the answers");
    answers_bytes_ += message.size();
    answers_.push_back(std::move(message));
  }

  Outgoing next() override {
    if (!answers_.empty()) {
      Outgoing message = std::move(answers_.front());
      answers_.pop_front();
      answers_bytes_ -= message.size();
      return message;
    }
    if (feed_.time_ns() != time_ns_) {
      time_ns_ = feed_.time_ns();
      return {{}, text(foxglove::time_bytes(feed_.time_ns())), true};
    }
    // Channels take turns, so that on a slow link the fast one does not starve the others.
    for (std::size_t i = 0; i < kChannelCount; ++i) {
      const Channel channel = foxglove::kChannels[(turn_ + i) % kChannelCount];
      Outgoing message = news(channel);
      if (!message.text) continue;
      turn_ = (turn_ + i + 1) % kChannelCount;
      return message;
    }
    return {};
  }

  Outgoing news(Channel channel) {
    Subscription& subscription = at(channel);
    if (!subscription.id) return {};
    const foxglove::Newest* newest =
        channel == Channel::Log ? feed_.log_after(subscription.seen) : &feed_.newest(channel);
    if (newest == nullptr || !newest->text || newest->version == subscription.seen) return {};
    const SharedText text = channel == Channel::Scene ? feed_.scene_since(subscription.seen) : newest->text;
    if (subscription.seen != 0) context().api.counts().messages_skipped += newest->version - subscription.seen - 1;
    subscription.seen = newest->version;
    return {foxglove::message_head(*subscription.id, newest->time_ns), text, true};
  }

  foxglove::Feed& feed_;
  std::array<Subscription, kChannelCount> subscriptions_{};
  std::deque<Outgoing> answers_;
  std::size_t answers_bytes_ = 0;
  std::optional<std::uint64_t> time_ns_;  // the one that was sent last
  std::size_t turn_ = 0;
};

}  // namespace

void serve_foxglove(NetStream stream, http::request<http::string_body> request, const std::string& subprotocol,
                    WebContext& context, ConnectionSlot slot) {
  std::make_shared<FoxgloveSession>(std::move(stream), context, std::move(slot))
      ->accept(std::move(request), subprotocol);
}

}  // namespace kinemap
