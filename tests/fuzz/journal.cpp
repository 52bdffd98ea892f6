// SPDX-License-Identifier: Apache-2.0
// A journal; or, when the first byte is 'E', one entry, which a CRC would keep mutations away from.
#include "protocol/journal.hpp"

#include <cstdlib>
#include <string_view>
#include <variant>

#include "protocol/journal_entries.hpp"

namespace {

using namespace kinemap;

void entry(std::string_view payload) {
  const auto entry = journal::decode(payload);
  if (!entry) return;
  const auto again = journal::decode(journal::encode(*entry));
  if (!again || again->index() != entry->index()) std::abort();
}

void whole(std::string_view bytes) {
  auto contents = journal::read(bytes, "fuzz");
  if (!contents) return;
  if (contents->sound_bytes + contents->torn_bytes != bytes.size()) std::abort();
  // What could be read makes a journal without damage.
  std::string again = journal::header();
  for (const auto& one : contents->entries) again += journal::record(one);
  const auto second = journal::read(again, "again");
  if (!second || second->entries.size() != contents->entries.size() || !second->damage.empty()) std::abort();
  journal::mend(contents->entries);
  KeyPoseId next = 0;
  for (const auto& one : contents->entries)
    if (const auto* pose = std::get_if<KeyPose>(&one); pose != nullptr && pose->id != next++) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with('E'))
    entry(bytes.substr(1));
  else
    whole(bytes);
  return 0;
}
