// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace kinemap {

/// The one-to-one assignment of rows to columns with the most pairs and, among those, the least total cost (Hungarian
/// method). `cost` is finite and ≥ 0 where a pair is allowed, infinite where it is not. For each row its column, or
/// nullopt.
std::vector<std::optional<std::size_t>> assign(const Eigen::MatrixXd& cost);

}  // namespace kinemap
