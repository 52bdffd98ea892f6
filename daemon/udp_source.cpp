// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <cstring>

#include "daemon/suit_sockets.hpp"

namespace kinemap {
namespace {

constexpr int kBatch =
    256;  // datagrams between two looks at the event loop, so that a flood cannot keep it from ending

void note_kernel_drops(const msghdr& message, ReceiverCounts& counts) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(const_cast<msghdr*>(&message), c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t drops = 0;
    std::memcpy(&drops, CMSG_DATA(c), sizeof drops);
    counts.kernel_drops = drops;  // of this socket since it was opened
  }
}

}  // namespace

void set_receive_buffer(net::ip::udp::socket& socket, int bytes) {
  ErrorCode error;
  socket.set_option(net::socket_base::receive_buffer_size(bytes), error);
  net::socket_base::receive_buffer_size granted;
  socket.get_option(granted, error);
  // Linux reports twice what it grants, for its own bookkeeping.
  if (granted.value() / 2 < bytes)
    spdlog::info("suit: the kernel grants a receive buffer of {} bytes instead of {} (sysctl net.core.rmem_max)",
                 granted.value() / 2, bytes);
}

UdpSource::UdpSource(net::ip::udp::socket socket, Intake& intake, std::vector<Network> allowed)
    : socket_(std::move(socket)), intake_(intake), buffer_(65536), allowed_(std::move(allowed)) {
  const int on = 1;
  ::setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  socket_.non_blocking(true);
}

void UdpSource::start() {
  socket_.async_wait(net::ip::udp::socket::wait_read, [this](ErrorCode error) {
    if (error) return;  // closed
    read_all();
    start();
  });
}

void UdpSource::read_all() {
  for (int i = 0; i < kBatch && read_one(); ++i) {
  }
  intake_.publish();
}

bool UdpSource::read_one() {
  sockaddr_storage sender{};
  iovec part{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<std::byte, 64> control;
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket_.native_handle(), &message, MSG_DONTWAIT);
  if (size < 0) return false;
  note_kernel_drops(message, intake_.counts());
  note_sender(sender, message.msg_namelen);
  if (!last_allowed_) {
    ++intake_.counts().not_allowed;
    return true;
  }
  if ((message.msg_flags & MSG_TRUNC) != 0) {
    ++intake_.counts().truncated;
    return true;
  }
  intake_.take(std::span(buffer_).first(static_cast<std::size_t>(size)), last_name_);
  return true;
}

void UdpSource::note_sender(const sockaddr_storage& sender, std::size_t length) {
  if (std::memcmp(&sender, &last_sender_, sizeof sender) == 0 && !last_name_.empty()) return;
  last_sender_ = sender;
  net::ip::udp::endpoint endpoint;
  std::memcpy(endpoint.data(), &sender, std::min(length, endpoint.capacity()));
  const std::string address = endpoint.address().to_string();
  last_allowed_ = allows(allowed_, parse_address(address).value_or(AddressBytes{}));
  last_name_ = (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" + std::to_string(endpoint.port());
}

}  // namespace kinemap
