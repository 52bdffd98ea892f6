// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "tools/sim/session.hpp"

namespace kinemap::sim {

inline std::unique_ptr<Session> session_of(const SimOptions& options) {
  auto session = Session::create(options);
  EXPECT_TRUE(session) << (session ? "" : session.error());
  return session ? std::move(*session) : nullptr;
}

inline SimOptions seeded(std::uint64_t seed, double rate_hz = 60.0) {
  SimOptions options;
  options.seed = seed;
  options.rate_hz = rate_hz;
  return options;
}

/// Runs a session to its end, or to `until_s`.
inline void run(Session& session, const std::function<void(const Sample&)>& each, double until_s = 1e9) {
  Sample sample;
  while (session.next(sample) && sample.time_s <= until_s) each(sample);
}

inline const Interval* interval_at(const Session& session, double time_s, const std::string& label) {
  for (const auto& i : session.script().score.intervals) {
    if (i.label.rfind(label, 0) == 0 && time_s >= i.begin_s && time_s <= i.end_s) return &i;
  }
  return nullptr;
}

inline double level_gap(const Sample& sample) {
  return (sample.reported[kPelvis].p - sample.truth[kPelvis].p).head<2>().norm();
}

}  // namespace kinemap::sim
