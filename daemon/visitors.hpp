// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>

#include "daemon/network.hpp"

namespace kinemap {

/// What one address does.
struct Visitor {
  using Clock = std::chrono::steady_clock;
  bool local = false;           ///< this machine
  std::size_t connections = 0;  ///< open now
  double requests = 0.0;        ///< so many may come at once; grows with time, up to two seconds' worth
  Clock::time_point counted{};  ///< when that was so
};

/// All addresses that have connections or had requests lately. An IPv6 address stands for its /64, within which a host
/// chooses freely.
class Visitors {
 public:
  using Clock = Visitor::Clock;
  explicit Visitors(double requests_per_s) : requests_per_s_(requests_per_s) {}

  void set_rate(double requests_per_s) { requests_per_s_ = requests_per_s; }
  std::shared_ptr<Visitor> of(const AddressBytes& address, Clock::time_point now);
  /// Counts a request; how long it has to wait before it may be counted, zero when it was.
  Clock::duration ask(Visitor& visitor, Clock::time_point now) const;
  [[nodiscard]] std::size_t size() const { return known_.size(); }

 private:
  void refill(Visitor& visitor, Clock::time_point now) const;
  void forget(Clock::time_point now);

  double requests_per_s_;
  std::map<AddressBytes, std::shared_ptr<Visitor>> known_;
  std::size_t forget_at_ = 64;
};

}  // namespace kinemap
