// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <array>
#include <boost/asio/generic/raw_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <variant>

#include "protocol/text_format.hpp"
#include "protocol/wire/mxtp.hpp"
#include "tools/kinemap/client.hpp"
#include "tools/kinemap/doctor.hpp"

namespace kinemap::cli {
namespace {

namespace asio = boost::asio;
using Json = nlohmann::ordered_json;
using Verdict = Finding::Verdict;
using ErrorCode = boost::system::error_code;

/// Why a server could not open this port now; no error when it could.
template <class Protocol>
ErrorCode bind_error(const std::string& address, std::uint16_t port) {
  asio::io_context io;
  ErrorCode error;
  const auto ip = asio::ip::make_address(address, error);
  if (error) return error;
  const typename Protocol::endpoint endpoint(ip, port);
  typename Protocol::socket socket(io);
  socket.open(endpoint.protocol(), error);
  // As servers do: a port in TIME_WAIT is free.
  if constexpr (std::is_same_v<Protocol, asio::ip::tcp>)
    if (!error) socket.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) socket.bind(endpoint, error);
  return error;
}

/// "192.168.1.7, 10.0.0.3": where MVN can send to.
std::string own_addresses() {
  std::string text;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return text;
  for (const ifaddrs* i = list; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET || (i->ifa_flags & IFF_LOOPBACK) != 0) continue;
    std::array<char, INET_ADDRSTRLEN> name{};
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr, name.data(), name.size());
    text += (text.empty() ? "" : ", ") + std::string(name.data());
  }
  ::freeifaddrs(list);
  return text;
}

std::string streamer_advice(const Config& config) {
  std::string to = config.suit.address;
  if (to == "0.0.0.0" || to == "::") to = own_addresses();
  return "in MVN: Options > Preferences > Network Streamer: add " + (to.empty() ? "this machine's address" : to) +
         format(", port %d, protocol Quaternion, and switch it on; without a suit: kinemap sim --udp 127.0.0.1:%d",
                config.suit.port, config.suit.port);
}

Finding suit_by_daemon(const Config& config, const Json& suit) {
  if (suit.contains("refusal"))
    return {Verdict::Problem, "suit", suit["refusal"].get<std::string>(), "change it in MVN as it says"};
  if (suit.value("receiving", false))
    return {Verdict::Ok, "suit",
            format("%.0f frames a second from %s", suit.value("rate_hz", 0.0), suit.value("sender", "?").c_str()), ""};
  if (suit.contains("silence_s"))
    return {Verdict::Problem, "suit", format("silent for %.0f s", suit["silence_s"].get<double>()),
            "is MVN still streaming, and the network there? " + streamer_advice(config)};
  return {Verdict::Problem, "suit", "nothing has come since kinemapd was started", streamer_advice(config)};
}

/// What the machine or the network lost, by the daemon's counters; nullopt: nothing.
std::optional<Finding> losses_by_daemon(const Json& status) {
  const auto count = [&status](const char* pointer) {
    return status.value(Json::json_pointer(pointer), std::uint64_t{0});
  };
  const auto kernel = count("/suit/socket/kernel_drops"), ring = count("/rings/frames/dropped");
  const auto samples = count("/suit/stream/lost_samples"), frames = count("/suit/stream/frames");
  if (kernel + ring > 0)
    return Finding{Verdict::Problem, "losses",
                   format("this machine was too slow for %llu datagrams and %llu frames",
                          static_cast<unsigned long long>(kernel), static_cast<unsigned long long>(ring)),
                   "see what else runs on it, and the receive buffer below"};
  if (samples * 50 > frames)
    return Finding{Verdict::Note, "losses",
                   format("%.1f %% of the suit's samples were lost on the way",
                          100.0 * static_cast<double>(samples) / static_cast<double>(frames + samples)),
                   "a better network: 5 GHz, a cable, fewer walls to the access point"};
  return std::nullopt;
}

/// Whether the map keeps up with what is done; nullopt: it does.
std::optional<Finding> mapping_by_daemon(const Json& status) {
  constexpr double kLongS = 120.0;
  const double at_entry_s = status.value(Json::json_pointer("/map/solver/at_entry_s"), 0.0);
  if (at_entry_s < kLongS) return std::nullopt;
  return Finding{
      Verdict::Note, "mapping",
      format("the solver has been at one gesture for %.0f s; the map waits for it, nothing is lost", at_entry_s),
      "what else runs on this machine? Should it never end: the session's journal (kinemap sessions export) "
      "shows why"};
}

constexpr std::size_t kUdpHeader = 8;

/// What was sent to this UDP port, of an IPv4 packet as a raw socket has it, with its header.
std::optional<std::span<const std::byte>> payload_of(std::span<const std::byte> packet, std::uint16_t port) {
  if (packet.empty()) return std::nullopt;
  const std::size_t begin = 4 * (std::to_integer<std::size_t>(packet[0]) & 15U);
  if (packet.size() < begin + kUdpHeader) return std::nullopt;
  const auto to = std::to_integer<unsigned>(packet[begin + 2]) << 8U | std::to_integer<unsigned>(packet[begin + 3]);
  if (to != port) return std::nullopt;
  return packet.subspan(begin + kUdpHeader);
}

/// The first datagram that comes to the socket within the time; of a raw one, the first for this port.
template <class Socket>
std::optional<std::vector<std::byte>> first_datagram(asio::io_context& io, Socket& socket,
                                                     std::optional<std::uint16_t> raw_port, double listen_s) {
  std::vector<std::byte> buffer(65536), found;
  bool heard = false;
  asio::steady_timer timer(io, std::chrono::milliseconds(static_cast<int>(1000.0 * listen_s)));
  timer.async_wait([&](ErrorCode) { socket.cancel(); });
  std::function<void()> receive = [&] {
    socket.async_receive(asio::buffer(buffer.data(), buffer.size()), [&](ErrorCode error, std::size_t size) {
      if (error) return;
      const std::span<const std::byte> packet(buffer.data(), size);
      const auto payload = raw_port ? payload_of(packet, *raw_port) : std::optional(packet);
      if (!payload) return receive();
      heard = true;
      found.assign(payload->begin(), payload->end());
      timer.cancel();
    });
  };
  receive();
  io.run();
  return heard ? std::optional(std::move(found)) : std::nullopt;
}

/// A raw socket, which only root may open, hears the suit while its port stays free for kinemapd.
std::optional<std::vector<std::byte>> first_datagram(const Config& config, double listen_s) {
  asio::io_context io;
  ErrorCode error;
  const asio::ip::udp::endpoint at(asio::ip::make_address(config.suit.address, error), config.suit.port);
  if (at.address().is_v4()) {  // to the IPv6 port come IPv4 datagrams too, which a raw IPv6 socket does not hear
    asio::generic::raw_protocol::socket beside(io);
    beside.open(asio::generic::raw_protocol(AF_INET, IPPROTO_UDP), error);
    if (!error) beside.bind(asio::generic::raw_protocol::endpoint(at.data(), at.size(), IPPROTO_UDP), error);
    if (!error) return first_datagram(io, beside, at.port(), listen_s);
  }
  asio::ip::udp::socket socket(io);
  socket.open(at.protocol(), error);
  if (!error) socket.bind(at, error);
  if (error) return std::nullopt;
  std::fprintf(stderr, "kinemap doctor: holds UDP port %d for %g s; kinemapd cannot start meanwhile (root need not)\n",
               config.suit.port, listen_s);
  return first_datagram(io, socket, std::nullopt, listen_s);
}

Finding suit_by_listening(const Config& config, double listen_s) {
  if (const ErrorCode error = bind_error<asio::ip::udp>(config.suit.address, config.suit.port))
    return {Verdict::Problem, "suit",
            format("UDP port %d on %s cannot be opened: %s", config.suit.port, config.suit.address.c_str(),
                   error.message().c_str()),
            format("end what holds it (sudo ss -lunp 'sport = :%d'; a kinemapd that could not be asked?), or choose "
                   "another suit.port",
                   config.suit.port)};
  const auto datagram = first_datagram(config, listen_s);
  if (!datagram)
    return {Verdict::Problem, "suit", format("nothing came to UDP port %d within %g s", config.suit.port, listen_s),
            streamer_advice(config)};
  if (const auto decoded = mxtp::decode(*datagram); const auto* fault = std::get_if<mxtp::Fault>(&decoded))
    return {Verdict::Problem, "suit",
            format("what comes to UDP port %d is not MVN's stream (%s)", config.suit.port, mxtp::to_string(*fault)),
            "another program sends there; choose another suit.port, or end it"};
  return {Verdict::Ok, "suit", format("MVN's stream comes to UDP port %d", config.suit.port), ""};
}

}  // namespace

Finding check_daemon(const Config& config, const DaemonAddress& daemon, Json& status) {
  const auto body = http_get(daemon, "/api/v1/status");
  if (body) status = Json::parse(*body, nullptr, false);
  if (status.is_object() && status.contains("suit"))
    return {Verdict::Ok, "daemon",
            format("kinemapd %s answers at %s", status.value("version", "?").c_str(), daemon.text().c_str()), ""};
  status = nullptr;
  if (body)
    return {Verdict::Problem, "daemon", daemon.text() + " answers, but is no kinemapd", "choose another api.port"};
  const auto& host = daemon.endpoint.host;
  if (host != "127.0.0.1" && host != "::1" && host != "localhost" && host != config.api.address)
    return {Verdict::Problem, "daemon", body.error(), ""};  // another machine's ports are not ours to try
  const ErrorCode error = bind_error<asio::ip::tcp>(config.api.address, config.api.port);
  if (!error)
    return {Verdict::Problem, "daemon", "no kinemapd runs on " + daemon.text() + "; its port is free",
            "sudo systemctl start kinemapd, or kinemapd --config FILE"};
  return {Verdict::Problem, "daemon", body.error(),
          error == asio::error::address_in_use
              ? format("another program may hold the port: sudo ss -ltnp 'sport = :%d'", config.api.port)
              : "api.address: " + error.message()};
}

Findings check_suit(const Config& config, const Json& status, double listen_s) {
  if (status.is_object()) {
    Findings findings{suit_by_daemon(config, status["suit"])};
    if (auto losses = losses_by_daemon(status)) findings.push_back(std::move(*losses));
    if (auto mapping = mapping_by_daemon(status)) findings.push_back(std::move(*mapping));
    return findings;
  }
  if (config.suit.transport == "udp") return {suit_by_listening(config, listen_s)};
  const ErrorCode error = bind_error<asio::ip::tcp>(config.suit.address, config.suit.port);
  if (!error)
    return {{Verdict::Note, "suit",
             format("TCP port %d is free; MVN connects to it when kinemapd runs", config.suit.port),
             streamer_advice(config)}};
  return {{Verdict::Problem, "suit",
           format("TCP port %d cannot be opened: %s", config.suit.port, error.message().c_str()),
           "choose another suit.port"}};
}

}  // namespace kinemap::cli
