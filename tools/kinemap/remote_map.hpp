// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/map.hpp"
#include "tools/kinemap/daemon_address.hpp"

namespace kinemap::cli {

/// The map of a running daemon, with its optimised trajectory (T_map_pelvis only).
Result<MapSnapshot> fetch_map(const DaemonAddress& daemon);

}  // namespace kinemap::cli
