// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "daemon/queries.hpp"

namespace kinemap {

/// Reads the parameters of one query; like a cursor with a sticky error: the first thing that is wrong stays, later
/// reads give nothing.
class ParamReader {
 public:
  /// Parameters that are not in `allowed`, or stand twice, are an error.
  ParamReader(const Params& params, std::initializer_list<const char*> allowed);

  std::optional<std::string> text(const char* name);
  /// A finite number within [min, max].
  std::optional<double> number(const char* name, double min, double max);
  std::optional<std::size_t> count(const char* name, std::size_t min, std::size_t max);
  /// "x,y", both finite.
  std::optional<Eigen::Vector2d> point(const char* name);
  /// The parts between commas.
  std::vector<std::string> list(const char* name);

  void fail(const std::string& message);
  [[nodiscard]] const std::optional<ApiError>& error() const { return error_; }

 private:
  const Params& params_;
  std::optional<ApiError> error_;
};

}  // namespace kinemap
