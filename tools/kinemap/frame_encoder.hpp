// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/body.hpp"
#include "protocol/wire/mxtp.hpp"
#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// A frame as MXTP type 02 datagrams of character 0.
std::vector<mxtp::Bytes> encode_frame(const SuitFrame& frame);

/// True when the file begins like XML (an .mvnx), false for anything else.
Result<bool> is_xml_file(const std::string& path);

}  // namespace kinemap::cli
