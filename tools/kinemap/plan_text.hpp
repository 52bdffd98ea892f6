// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "protocol/export/plan.hpp"

namespace kinemap::cli {

/// The plan in Braille dots, at most `columns` wide and `rows` high, with ids on the objects, a scale bar and a key.
/// `colour`: ANSI colours.
std::string plan_text(const Plan& plan, int columns, int rows, bool colour);

}  // namespace kinemap::cli
