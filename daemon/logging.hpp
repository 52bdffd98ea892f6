// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace kinemap {

/// Keeps a log readable when the same thing happens again and again: of messages that begin alike (their first three
/// words, whatever numbers are in them) ten a minute get through. Not thread-safe.
class LogLimit {
 public:
  static constexpr std::uint64_t kMessages = 10;
  static constexpr double kPeriodS = 60.0;

  /// Nullopt: the message is left out. Else it is written, and so many like it were left out before it.
  std::optional<std::uint64_t> take(std::string_view message, double now_s);

 private:
  struct Kind {
    double until_s = 0.0;
    std::uint64_t passed = 0;
    std::uint64_t left_out = 0;
  };
  Kind& kind_of(std::string_view message, double now_s);
  std::map<std::string, Kind> kinds_;
};

/// The program's log: to systemd's journal with its fields (PRIORITY, SYSLOG_IDENTIFIER, TID) where standard error is
/// connected to it, else to standard error; limited as above.
void set_up_logging();

}  // namespace kinemap
