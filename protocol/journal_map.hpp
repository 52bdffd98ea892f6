// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/mapper/mapper.hpp"
#include "protocol/journal.hpp"

namespace kinemap::journal {

/// Tells the mapper what the entry says; marks and the like say nothing. True when a new snapshot was published.
bool tell(Mapper& mapper, const Entry& entry);

}  // namespace kinemap::journal
