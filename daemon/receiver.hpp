// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/body.hpp"
#include "daemon/config.hpp"
#include "daemon/start.hpp"
#include "protocol/assembler.hpp"

namespace kinemap {

/// Where the receiver puts what it got; all are called on its thread, must not wait, and return false when there is no
/// room. A frame is lost then; the others are offered again soon.
struct SuitSink {
  std::function<bool(const SuitFrame&)> on_frame;
  std::function<bool(const WearerInfo&)> on_wearer;
  std::function<bool()> on_silence;  ///< no frame has come for 3 s; once, until the next frame
  /// Every datagram as it came, before anything is made of it, with its sender; may be empty.
  std::function<void(std::span<const std::byte>, const std::string&)> on_datagram{};
};

/// Plain numbers, copied as one value between threads.
struct ReceiverCounts {
  AssemblerStats stream;
  double rate_hz = 0.0;                  ///< as the stream has it; 0 while unknown
  double last_frame_s = -1.0;            ///< arrival of the newest whole frame, on the receiver's clock; −1: none yet
  std::uint64_t kernel_drops = 0;        ///< datagrams that the kernel dropped since the socket's buffer was full
  std::uint64_t truncated = 0;           ///< datagrams longer than 64 KiB − 1
  std::uint64_t not_allowed = 0;         ///< datagrams, and connections, of senders that suit.allow does not name
  std::uint64_t tcp_accepted = 0;        ///< connections ever
  std::uint64_t tcp_refused = 0;         ///< connections beyond the limit
  std::uint64_t tcp_closed_garbage = 0;  ///< closed since the peer did not speak the protocol
  std::uint64_t tcp_skipped_bytes = 0;   ///< bytes between datagrams
  std::uint64_t tcp_open = 0;            ///< connections now
};

/// What changes seldom.
struct ReceiverNews {
  std::string sender;  ///< "address:port" of the newest frame; empty: none yet
  std::optional<std::string> refusal;
  WearerInfo wearer;
};

struct ReceiverState {
  ReceiverCounts counts;
  std::shared_ptr<const ReceiverNews> news;  ///< never null
  double now_s = 0.0;                        ///< the receiver's clock, to hold `last_frame_s` against
};

/// The suit's socket and the thread that reads it: UDP from any number of senders, or TCP, on which MVN is the client.
/// Bytes go through an Assembler to the sink. Receiving ends when it is destroyed.
class Receiver {
 public:
  /// Binds at once; port 0 lets the kernel choose (`port()` tells). `kept`: a UDP socket of a daemon before, or -1; it
  /// is taken over, with what came to it meanwhile, where it is bound as `suit` says, else closed.
  static Started<Receiver> open(const Config::Suit& suit, const AssemblerConfig& stream, SuitSink sink, int kept = -1);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// The UDP socket, for the next daemon; -1 with TCP, where each connection ends with us.
  [[nodiscard]] int udp_socket() const;
  /// Any thread.
  [[nodiscard]] ReceiverState state() const;

 private:
  class Impl;
  explicit Receiver(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
