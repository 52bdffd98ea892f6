// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/server_clients.hpp"

#include "daemon/asio.hpp"
// after Asio
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "protocol/text_format.hpp"

namespace kinemap::bench {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Clock = std::chrono::steady_clock;

double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

/// What stands behind `key` in the text, without reading all of it.
std::string_view behind(std::string_view text, std::string_view key) {
  const auto at = text.find(key);
  return at == std::string_view::npos ? std::string_view() : text.substr(at + key.size());
}

class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(net::io_context& io, const ClientsPlan& plan, ClientsReport& report)
      : plan_(plan), report_(report), stream_(io) {}

  /// Who never reads has a small window and wants bodies too, so that the kernel's buffers are soon full.
  bool connect(bool sleeper) {
    ErrorCode error;
    auto& socket = stream_.next_layer();
    socket.open(net::ip::tcp::v4(), error);
    if (sleeper) socket.set_option(net::socket_base::receive_buffer_size(4096), error);
    socket.connect({net::ip::address_v4::loopback(), plan_.port}, error);
    if (!error) stream_.handshake("localhost:" + std::to_string(plan_.port), "/api/v1/stream", error);
    if (error) return false;
    stream_.read_message_max(0);
    stream_.write(net::buffer(format(R"({"op":"subscribe","topics":["map","pose"],"rate_hz":%g})", plan_.rate_hz)),
                  error);
    if (sleeper) stream_.write(net::buffer(std::string_view(R"({"op":"subscribe","topics":["body"]})")), error);
    return !error;
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error) {
        ++self->report_.lost;
        return;
      }
      const double arrived_s = now_s();
      const auto data = self->buffer_.data();
      self->note({static_cast<const char*>(data.data()), data.size()}, arrived_s);
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

 private:
  void note(std::string_view message, double arrived_s) {
    const auto topic = behind(message, R"("topic":")"), time = behind(message, R"("time":)");
    double time_s = 0.0;
    if (topic.empty() || std::from_chars(time.data(), time.data() + time.size(), time_s).ec != std::errc{}) return;
    const std::string name(topic.substr(0, topic.find('"')));
    // The first map is as old as it is.
    if (name == "map" && !seen_map_) {
      seen_map_ = true;
      return;
    }
    report_.delivery_ms[name].push_back((arrived_s - plan_.epoch_s - time_s) * 1e3);
  }

  const ClientsPlan& plan_;
  ClientsReport& report_;
  websocket::stream<net::ip::tcp::socket> stream_;
  beast::flat_buffer buffer_;
  bool seen_map_ = false;
};

}  // namespace

ClientsReport run_clients(const ClientsPlan& plan) {
  ClientsReport report;
  net::io_context io;
  std::vector<std::shared_ptr<Client>> clients;
  for (int i = 0; i < plan.readers + plan.sleepers; ++i) {
    const bool sleeper = i < plan.sleepers;
    auto client = std::make_shared<Client>(io, plan, report);
    if (!client->connect(sleeper)) continue;
    ++report.connected;
    if (!sleeper) client->read();
    clients.push_back(std::move(client));
  }
  io.run_for(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(plan.seconds)));
  return report;
}

Result<ClientsReport> run_clients_apart(const ClientsPlan& plan) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  // Clients are on other machines: what they compute is not to be taken from the daemon.
  const std::string command = format(
      "nice -n 10 '%s' server-clients --port %u --readers %d --sleepers %d --rate %.17g --seconds %.17g --epoch %.17g",
      program.c_str(), plan.port, plan.readers, plan.sleepers, plan.rate_hz, plan.seconds, plan.epoch_s);
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return Error{"cannot start " + command};
  std::string text;
  char part[65536];
  while (const std::size_t n = std::fread(part, 1, sizeof part, pipe)) text.append(part, n);
  const int code = ::pclose(pipe);
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (code != 0 || !json.is_object()) return Error{command + " failed"};
  return ClientsReport{json.at("delivery_ms").get<std::map<std::string, std::vector<double>>>(),
                       json.at("connected").get<int>(), json.at("lost").get<int>()};
}

}  // namespace kinemap::bench
