// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/journal.hpp"

/// Entries of the journal as CBOR (RFC 8949); protocol/README.md names the keys.
namespace kinemap::journal {

std::string encode(const Entry& entry);
/// nullopt when the bytes are no entry: wrong type of a key, a number that is not finite, a quaternion that is no
/// rotation.
std::optional<Entry> decode(std::string_view payload);

}  // namespace kinemap::journal
