// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "protocol/text_format.hpp"

namespace kinemap::cli {

/// Rows of cells in columns as wide as their widest cell; the first row is the heading. Columns named in `left` (by
/// index) are left-aligned, the others right-aligned. Width counts code points, so × and ° take one column.
std::string text_table(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left);

/// Code points in a UTF-8 text.
std::size_t display_width(const std::string& text);

/// 1234567 → "1,234,567".
std::string grouped(unsigned long long number);

}  // namespace kinemap::cli
