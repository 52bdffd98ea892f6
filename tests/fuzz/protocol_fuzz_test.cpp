// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "protocol/wire/big_endian.hpp"
#include "tests/protocol/body_stream.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace kinemap {
namespace {

using namespace testing_support;

/// A stream with every decoded type, in the fuzzer's input format.
std::vector<std::byte> corpus() {
  BigEndianWriter w;
  const auto put = [&w](const mxtp::Bytes& bytes, std::uint8_t wait) {
    w.u16(static_cast<std::uint16_t>(bytes.size()));
    w.u8(0);
    w.u8(wait);
    w.bytes(bytes);
  };
  const mxtp::Scale scale{{{"Head", {0, 0, 1.6F}}}, {{11, 1, "pRightTopOfHand", 0, {0, -0.18F, 0}}}};
  for (std::uint64_t k = 0; k < 60; ++k) {
    const auto h = header_of(k, 100.0, 0xffffffe0U, 86'399'900);
    for (const auto& part : mxtp::encode_poses(h, body_items(k), k % 2 ? 2040 : 300)) put(part, k % 2 == 0 ? 0 : 2);
    if (k % 5 == 0) put(mxtp::encode_center_of_mass(h, {{0, 0, 1}}), 0);
    if (k % 7 == 0) put(mxtp::encode_poses_euler(h, body_items(k))[0], 0);
    if (k == 10) put(mxtp::encode_meta(h, {{{"name", "Anna"}}}), 0);
    if (k == 11) put(mxtp::encode_time_code(h, {"12:34:56.789"}), 0);
    if (k == 12) {
      for (const auto& part : mxtp::encode_scale(h, scale, 60)) put(part, 0);
    }
  }
  return w.release();
}

TEST(Fuzz, SeededMutationsOfAStream) {
  const auto whole = corpus();
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    auto bytes = whole;
    for (unsigned n = 0; n < seed; ++n) {
      bytes[random() % bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
    }
    if (seed % 4 == 3) bytes.resize(random() % bytes.size());
    EXPECT_EQ(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
  }
}

}  // namespace
}  // namespace kinemap
