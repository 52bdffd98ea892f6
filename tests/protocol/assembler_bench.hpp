// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "protocol/assembler.hpp"
#include "tests/protocol/body_stream.hpp"

namespace kinemap::testing_support {

/// One datagram on its way: what arrives when, from whom.
struct Arrival {
  mxtp::Bytes bytes;
  double time_s = 0.0;
  std::string sender = "10.0.0.1:5000";
};

/// An Assembler, the frames it handed on, and the rules that hold after every single datagram.
class Bench {
 public:
  explicit Bench(const AssemblerConfig& config = {}) : assembler(config) {}

  void add(const Arrival& a) {
    assembler.add(a.bytes, a.time_s, a.sender, [this](const SuitFrame& f) { take(f); });
    EXPECT_EQ(assembler.stats().accounted(), assembler.stats().datagrams) << "a datagram is in no counter, or in two";
  }
  void add(const std::vector<Arrival>& all) {
    for (const Arrival& a : all) add(a);
  }
  void flush() {
    assembler.flush([this](const SuitFrame& f) { take(f); });
    EXPECT_EQ(assembler.stats().accounted(), assembler.stats().datagrams);
    EXPECT_EQ(assembler.stats().waiting, 0U);
    EXPECT_EQ(assembler.stats().frames, frames.size());
  }

  Assembler assembler;
  std::vector<SuitFrame> frames;

  [[nodiscard]] const AssemblerStats& stats() const { return assembler.stats(); }

 private:
  void take(const SuitFrame& f) {
    if (!frames.empty()) {
      EXPECT_GE(f.time_s, frames.back().time_s) << "time runs back";
      EXPECT_GT(f.index, frames.back().index) << "indices must grow";
    } else {
      EXPECT_EQ(f.time_s, 0.0);
    }
    for (const Pose& p : f.segments) {
      EXPECT_TRUE(p.p.allFinite());
      EXPECT_NEAR(p.q.norm(), 1.0, 1e-12);
    }
    frames.push_back(f);
  }
};

/// Samples `begin` … `end` − 1 of one wearer over a network without faults.
inline std::vector<Arrival> walk(std::uint64_t begin, std::uint64_t end, double rate_hz = 120.0,
                                 std::uint32_t first = 0, std::uint32_t first_ms = 0, std::size_t max_datagram = 2040) {
  std::vector<Arrival> out;
  for (std::uint64_t k = begin; k < end; ++k) {
    for (auto& bytes : mxtp::encode_poses(header_of(k, rate_hz, first, first_ms), body_items(k), max_datagram)) {
      out.push_back({std::move(bytes), 100.0 + static_cast<double>(k) / rate_hz});
    }
  }
  return out;
}

}  // namespace kinemap::testing_support
