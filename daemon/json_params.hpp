// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "daemon/url.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap {

/// The members of a JSON object as parameters, each as it would stand in a URL: numbers and strings as they are, a list
/// with commas. The Error says which member is none of these.
Result<Params> params_from_json(const nlohmann::ordered_json& object);

}  // namespace kinemap
