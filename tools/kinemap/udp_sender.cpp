// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/udp_sender.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <thread>

#include "tools/kinemap/stop_signal.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {

namespace asio = boost::asio;
using asio::ip::udp;
using Clock = std::chrono::steady_clock;

class PacedSender::Impl {
 public:
  explicit Impl(double speed) : socket_(io_), speed_(speed) {}

  std::optional<Error> open(const Endpoint& to) {
    to_ = to;
    boost::system::error_code code;
    udp::resolver resolver(io_);
    const auto addresses = resolver.resolve(to.host, std::to_string(to.port), code);
    if (!code) socket_.connect(*addresses.begin(), code);  // connected, so that the system tells of refusals
    if (code) return Error{to.text() + ": " + code.message()};
    return std::nullopt;
  }

  bool send(double time_s, std::span<const std::byte> datagram) {
    if (!first_s_) {
      first_s_ = time_s;
      begin_ = Clock::now();
    }
    stream_s = std::max(stream_s, time_s - *first_s_);
    if (speed_ > 0.0)
      sleep_until(begin_ + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>((time_s - *first_s_) / speed_)));
    if (stop_requested()) return false;
    return send_now(datagram);
  }

  std::uint64_t sent = 0, bytes = 0, refused = 0;
  double stream_s = 0.0;
  std::optional<Error> error;

 private:
  bool send_now(std::span<const std::byte> datagram) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      boost::system::error_code code;
      socket_.send(asio::buffer(datagram.data(), datagram.size()), 0, code);
      if (!code) {
        ++sent;
        bytes += datagram.size();
        return true;
      }
      // A refusal belongs to an earlier datagram; this one has not been sent yet.
      if (code == asio::error::connection_refused) {
        ++refused;
      } else if (code == asio::error::no_buffer_space || code == asio::error::try_again) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      } else {
        error = Error{to_.text() + ": " + code.message()};
        return false;
      }
    }
    error = Error{to_.text() + ": the system does not take the datagrams"};
    return false;
  }

  asio::io_context io_;
  udp::socket socket_;
  Endpoint to_;
  double speed_;
  std::optional<double> first_s_;
  Clock::time_point begin_;
};

Result<PacedSender> PacedSender::create(const Endpoint& to, double speed) {
  auto impl = std::make_unique<Impl>(speed);
  if (auto error = impl->open(to)) return *error;
  return PacedSender(std::move(impl));
}

PacedSender::PacedSender(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PacedSender::~PacedSender() = default;
PacedSender::PacedSender(PacedSender&&) noexcept = default;
PacedSender& PacedSender::operator=(PacedSender&&) noexcept = default;

bool PacedSender::send(double time_s, std::span<const std::byte> datagram) { return impl_->send(time_s, datagram); }
std::uint64_t PacedSender::sent() const { return impl_->sent; }
std::uint64_t PacedSender::bytes() const { return impl_->bytes; }
std::uint64_t PacedSender::refused() const { return impl_->refused; }
double PacedSender::stream_s() const { return impl_->stream_s; }
const std::optional<Error>& PacedSender::error() const { return impl_->error; }

std::string sending_report(const PacedSender& sender, const Endpoint& to) {
  std::string text = "sent " + grouped(sender.sent()) + " datagrams, " + grouped(sender.bytes()) + " bytes, " +
                     format("%.1f s of stream to ", sender.stream_s()) + to.text() + '\n';
  if (sender.refused())
    text += "nobody listened on " + to.text() + " for " + grouped(sender.refused()) +
            " of them: start kinemapd, or check suit.port\n";
  return text;
}

}  // namespace kinemap::cli
