// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "daemon/url.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// What a client sent as JSON; discarded (`is_discarded()`) when it is none, or nests deeper than anything that we
/// understand: copying a value takes as much stack as it is deep.
nlohmann::ordered_json parse_message(std::string_view text);

/// The members of a JSON object as parameters, each as it would stand in a URL: numbers and strings as they are, a list
/// with commas. The Error says which member is none of these.
Result<Params> params_from_json(const nlohmann::ordered_json& object);

}  // namespace kinemap
