// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "protocol/wire/result.hpp"

namespace kinemap {

/// Brings a client's map up to date with what `/api/v1/map` or the stream sent: a whole map takes its place, a delta
/// (with `since`) changes it. An Error, and `map` as it was, when the delta is not on the revision of `map`: then the
/// whole map must be asked for. Throws nlohmann's exceptions when `message` is no such message.
std::optional<Error> apply_map_message(const nlohmann::ordered_json& message, nlohmann::ordered_json& map);

}  // namespace kinemap
