// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <boost/beast/websocket.hpp>
#include <chrono>

#include "daemon/stream_protocol.hpp"
#include "daemon/web.hpp"

namespace kinemap {
namespace {

namespace websocket = beast::websocket;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestMessage = 256 * 1024;
constexpr std::size_t kSlowestBytesPerS = 64 * 1024;

class StreamSession : public Subscriber, public std::enable_shared_from_this<StreamSession> {
 public:
  StreamSession(beast::tcp_stream stream, WebContext& context, ConnectionSlot slot)
      : stream_(std::move(stream)), context_(context), slot_(std::move(slot)), outbox_(context.client_buffer_bytes) {}

  void accept(http::request<http::string_body> request) {
    auto timeouts = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeouts.idle_timeout = std::chrono::seconds(30);
    timeouts.keep_alive_pings = true;
    stream_.set_option(timeouts);
    stream_.set_option(websocket::permessage_deflate{});  // off
    stream_.set_option(websocket::stream_base::decorator(
        [](websocket::response_type& response) { response.set(http::field::server, "kinemapd"); }));
    stream_.read_message_max(kLongestMessage);
    request_ = std::move(request);
    stream_.async_accept(request_, [self = shared_from_this()](ErrorCode error) {
      if (error) return;
      ++self->context_.api.counts().streams;
      self->context_.hub.join(self);
      self->read();
    });
  }

  [[nodiscard]] bool wants(Topic topic) const override { return wants_[static_cast<std::size_t>(topic)]; }

  void offer(const News& news, Clock::time_point now) override {
    if (left_) return;
    if (writing_ && now > write_deadline_) return give_up();
    for (std::size_t i = 0; i < kTopicCount; ++i) {
      const auto& text = news.newest[i];
      if (!wants_[i] || !text || text == seen_[i]) continue;
      if (add_news(static_cast<Topic>(i), text)) seen_[i] = text;
    }
    if (wants(Topic::Events))
      for (const auto& text : news.events)
        if (!add_news(Topic::Events, text)) ++context_.api.counts().messages_skipped;
    write();
  }

 private:
  bool add_news(Topic topic, const SharedText& text) {
    const auto [added, skipped] = outbox_.add_news(topic, text);
    context_.api.counts().messages_skipped += skipped;
    return added;
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error) return self->leave();
      self->take_message();
      if (!self->left_) self->read();
    });
  }

  void take_message() {
    const auto data = buffer_.data();
    auto message =
        stream_.got_text()
            ? parse_client_message({static_cast<const char*>(data.data()), data.size()})
            : ClientMessage(BadMessage{"", {400, "bad_message", "messages are JSON in text frames, not binary"}});
    buffer_.consume(buffer_.size());
    std::visit([this](auto& m) { handle(m); }, message);
    write();
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
    ++context_.api.counts().requests;
    const Answer result = context_.api.query(query.path, query.params);
    if (const auto* error = std::get_if<ApiError>(&result)) return handle(BadMessage{query.id, *error});
    answer(result_text(query.id, std::get<std::string>(result)));
  }
  void handle(const BadMessage& message) {
    ++context_.api.counts().errors;
    answer(stream_error_text(message.id, message.error));
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

  void write() {
    if (writing_ || left_) return;
    auto text = outbox_.next();
    if (!text) return;
    writing_ = true;
    write_deadline_ = Clock::now() + context_.stall + std::chrono::seconds(text->size() / kSlowestBytesPerS);
    stream_.text(true);
    stream_.async_write(net::buffer(*text), [self = shared_from_this(), text](ErrorCode error, std::size_t) {
      self->writing_ = false;
      if (error) return self->leave();
      self->write();
    });
  }

  /// The client is too slow. A closing handshake would wait behind what it does not read, so the connection is just
  /// ended.
  void give_up() {
    if (left_) return;
    ++context_.api.counts().slow_clients_closed;
    ErrorCode ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
    leave();
  }

  void leave() {
    if (std::exchange(left_, true)) return;
    --context_.api.counts().streams;
    wants_ = {};
  }

  websocket::stream<beast::tcp_stream> stream_;
  WebContext& context_;
  ConnectionSlot slot_;
  http::request<http::string_body> request_;
  beast::flat_buffer buffer_;
  Outbox outbox_;
  std::array<bool, kTopicCount> wants_{};
  std::array<SharedText, kTopicCount> seen_;
  bool writing_ = false;
  bool left_ = false;
  Clock::time_point write_deadline_;
};

}  // namespace

void serve_stream(beast::tcp_stream stream, http::request<http::string_body> request, WebContext& context,
                  ConnectionSlot slot) {
  std::make_shared<StreamSession>(std::move(stream), context, std::move(slot))->accept(std::move(request));
}

}  // namespace kinemap
