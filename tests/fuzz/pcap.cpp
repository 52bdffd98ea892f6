// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/pcap.hpp"

#include "tests/fuzz/memory_file.hpp"
#include "tests/fuzz/recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const kinemap::fuzz::MemoryFile file(data, size);
  if (auto reader = kinemap::PcapReader::open(file.path())) {
    for (auto packet = reader->next(); packet && *packet; packet = reader->next())
      if ((*packet)->payload.size() > size) std::abort();  // no byte that is not in the file
    if (reader->stats().udp > reader->stats().records) std::abort();
  }
  kinemap::fuzz::read_frames(file.path());
  return 0;
}
