// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "protocol/assembler.hpp"

namespace kinemap {

/// One counter of AssemblerStats, as it is shown.
struct StreamCounter {
  enum class Kind : std::uint8_t {
    Traffic,    ///< what came and what became of it
    Dropped,    ///< datagrams that are in no frame
    LostFrame,  ///< frames that there should have been
    Incident,   ///< what befell the stream
  };
  const char* name;
  std::uint64_t AssemblerStats::*value;
  Kind kind;
};

/// All of them but the decoder's faults, in the order of the status page; /metrics walks the same list.
inline constexpr std::array kStreamCounters = [] {
  using S = AssemblerStats;
  using K = StreamCounter::Kind;
  return std::to_array<StreamCounter>({
      {"used", &S::used, K::Traffic},
      {"waiting", &S::waiting, K::Traffic},
      {"skipped_types", &S::skipped_types, K::Dropped},
      {"meta", &S::meta, K::Traffic},
      {"duplicates", &S::duplicates, K::Dropped},
      {"late", &S::late, K::Dropped},
      {"incomplete_datagrams", &S::incomplete_datagrams, K::Dropped},
      {"malformed", &S::malformed, K::Dropped},
      {"other_character", &S::other_character, K::Dropped},
      {"other_sender", &S::other_sender, K::Dropped},
      {"not_a_person", &S::not_a_person, K::Dropped},
      {"refused_pinned", &S::refused_pinned, K::Dropped},
      {"refused_bones", &S::refused_bones, K::Dropped},
      {"frames", &S::frames, K::Traffic},
      {"incomplete", &S::incomplete, K::LostFrame},
      {"lost_samples", &S::lost_samples, K::LostFrame},
      {"restarts", &S::restarts, K::Incident},
      {"clock_jumps", &S::clock_jumps, K::Incident},
      {"jumps", &S::jumps, K::Incident},
      {"odd_bones", &S::odd_bones, K::Incident},
  });
}();
// Beside these: datagrams, bytes and the faults. A counter that is not listed would be one that nobody sees.
static_assert(kStreamCounters.size() + 2 + mxtp::kFaultCount == sizeof(AssemblerStats) / sizeof(std::uint64_t));

}  // namespace kinemap
