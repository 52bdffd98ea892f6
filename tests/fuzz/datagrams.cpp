// SPDX-License-Identifier: Apache-2.0
// All that comes off the network: the input is a row of {u16 length, u8 sender, u8 wait in 10 ms, datagram}.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "protocol/assembler.hpp"
#include "protocol/wire/big_endian.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  kinemap::BigEndianReader in({reinterpret_cast<const std::byte*>(data), size});
  kinemap::Assembler assembler({});
  double last_s = 0.0;
  const auto sink = [&last_s](const kinemap::SuitFrame& f) {
    if (f.time_s < last_s) std::abort();
    last_s = f.time_s;
    for (const kinemap::Pose& p : f.segments) {
      if (!p.p.allFinite() || !p.q.coeffs().allFinite()) std::abort();
    }
  };
  double now_s = 0.0;
  while (in.remaining() > 4) {
    const std::size_t length = in.u16();
    const std::string sender = "10.0.0." + std::to_string(in.u8() % 4) + ":5000";
    now_s += 0.01 * in.u8();
    assembler.add(in.take(std::min(length, in.remaining())), now_s, sender, sink);
    if (assembler.stats().accounted() != assembler.stats().datagrams) std::abort();
  }
  assembler.flush(sink);
  if (assembler.stats().waiting != 0 || assembler.stats().accounted() != assembler.stats().datagrams) std::abort();
  return 0;
}
