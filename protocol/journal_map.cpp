// SPDX-License-Identifier: Apache-2.0
#include "protocol/journal_map.hpp"

namespace kinemap::journal {

bool tell(Mapper& mapper, const Entry& entry) {
  if (const auto event = event_of(entry)) return mapper.add(*event);
  if (const auto* wearer = std::get_if<WearerInfo>(&entry)) mapper.set_wearer(*wearer);
  if (!std::holds_alternative<StreamSilence>(entry)) return false;
  mapper.finish();
  return true;
}

}  // namespace kinemap::journal
