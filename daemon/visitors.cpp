// SPDX-License-Identifier: Apache-2.0
#include "daemon/visitors.hpp"

#include <algorithm>

namespace kinemap {
namespace {

constexpr double kBurstS = 2.0;

/// IPv4 as it is, IPv6 without the half that the host chooses.
AddressBytes name_of(AddressBytes address) {
  static const Network v4 = *Network::parse("0.0.0.0/0");
  if (!v4.contains(address)) std::fill(address.begin() + 8, address.end(), std::uint8_t{0});
  return address;
}

}  // namespace

void Visitors::refill(Visitor& visitor, Clock::time_point now) const {
  const double passed_s = std::chrono::duration<double>(now - visitor.counted).count();
  visitor.requests = std::min(visitor.requests + passed_s * requests_per_s_, kBurstS * requests_per_s_);
  visitor.counted = now;
}

std::shared_ptr<Visitor> Visitors::of(const AddressBytes& address, Clock::time_point now) {
  if (known_.size() >= forget_at_) forget(now);
  auto& visitor = known_[name_of(address)];
  if (!visitor) visitor = std::make_shared<Visitor>(Visitor{is_loopback(address), 0, kBurstS * requests_per_s_, now});
  return visitor;
}

Visitors::Clock::duration Visitors::ask(Visitor& visitor, Clock::time_point now) const {
  refill(visitor, now);
  if (visitor.requests >= 1.0) {
    visitor.requests -= 1.0;
    return Clock::duration::zero();
  }
  return std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>((1.0 - visitor.requests) / requests_per_s_));
}

/// Those that are as if they had never been here.
void Visitors::forget(Clock::time_point now) {
  std::erase_if(known_, [&](const auto& entry) {
    Visitor& visitor = *entry.second;
    refill(visitor, now);
    return visitor.connections == 0 && visitor.requests >= kBurstS * requests_per_s_;
  });
  forget_at_ = std::max<std::size_t>(64, 2 * known_.size());
}

}  // namespace kinemap
