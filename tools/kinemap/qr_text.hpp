// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kinemap::cli {

/// A QR code for terminals, two rows of it in each line of text; empty when the text is too long for one. `colour`:
/// black on white by escape sequences, whatever the terminal's colours are; without, its background must be light.
std::string qr_text(const std::string& text, bool colour);

}  // namespace kinemap::cli
