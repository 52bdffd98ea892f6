// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/map.hpp"

namespace kinemap {

/// The objects as a table for spreadsheets (RFC 4180: comma, CR LF, quotes where needed), one line each by id, with
/// units in the names of the columns. Empty means unknown; several functions or rooms stand in one cell, separated by
/// "; ".
std::string objects_csv(const MapSnapshot& map);

}  // namespace kinemap
