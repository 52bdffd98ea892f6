// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/memory_file.hpp"
#include "tests/fuzz/recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const kinemap::fuzz::MemoryFile file(data, size);
  kinemap::fuzz::read_frames(file.path());
  return 0;
}
