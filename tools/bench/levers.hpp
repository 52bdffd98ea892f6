// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "daemon/config.hpp"

namespace kinemap::bench {

/// Something that makes the estimate better, switched off.
struct Lever {
  const char* name;       ///< the state without it: "no right angles"
  const char* meaning;    ///< one sentence, without a full stop
  const char* overrides;  ///< JSON with the keys of the configuration that switch it off
};

/// All of them, in the order of the document. The one place to add one.
std::span<const Lever> levers();

/// One more, which counts only with a suit that does not hold standing feet in place.
const Lever& feet_not_heard();

/// `config` with the lever switched off. An Error when the override is no configuration.
Result<Config> without(const Config& config, const Lever& lever);

}  // namespace kinemap::bench
