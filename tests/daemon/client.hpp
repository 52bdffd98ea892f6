// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinemap::test {

struct HttpReply {
  int status = 0;  ///< 0: no answer
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
  [[nodiscard]] std::string header(std::string_view name) const;
  [[nodiscard]] nlohmann::json json() const;
};

/// Sends the bytes to the port of this machine as they are and reads until the server closes.
std::string raw_exchange(std::uint16_t port, std::string_view bytes);

/// One keep-alive connection, as a browser has it.
class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port);
  ~HttpClient();
  HttpReply request(const std::string& method, const std::string& target,
                    const std::vector<std::pair<std::string, std::string>>& headers = {}, const std::string& body = {});
  HttpReply get(const std::string& target) { return request("GET", target); }

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A WebSocket client of the stream. Reading gives up after a minute, so that a failure ends.
class StreamClient {
 public:
  /// `receive_buffer` 0 leaves the system's. Throws when the upgrade is refused (`HttpClient` sees why).
  explicit StreamClient(std::uint16_t port, int receive_buffer = 0);
  ~StreamClient();
  void send(const std::string& text, bool binary = false);
  /// False once the connection has ended.
  bool try_send(const std::string& text);
  /// The next message; an object with "closed" and its code when the server has ended the connection.
  nlohmann::json receive();
  /// Reads until a message has all members of `wanted` (or the connection ends).
  nlohmann::json receive(const nlohmann::json& wanted);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

void send_udp(std::uint16_t port, std::span<const std::byte> bytes);

/// A UDP sender that keeps its port, as MVN does.
class UdpSender {
 public:
  explicit UdpSender(std::uint16_t port);
  ~UdpSender();
  void send(std::span<const std::byte> bytes);

 private:
  int socket_;
};

}  // namespace kinemap::test
