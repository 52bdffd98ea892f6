// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pose.hpp"
#include "daemon/routes.hpp"

namespace kinemap {

/// An error when a parameter is not among `specs`, or stands twice.
std::optional<ApiError> check_params(const Params& params, const std::vector<ParamSpec>& specs);

/// Reads the parameters of one query; like a cursor with a sticky error: the first thing that is wrong stays, later
/// reads give nothing.
class ParamReader {
 public:
  explicit ParamReader(const Params& params) : params_(params) {}

  std::optional<std::string> text(const char* name);
  /// A finite number within [min, max].
  std::optional<double> number(const char* name, double min, double max);
  std::optional<std::size_t> count(const char* name, std::size_t min, std::size_t max);
  /// "x,y" or "x,y,z", all finite.
  struct Point {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    bool has_z = false;
  };
  std::optional<Point> point(const char* name);
  /// The parts between commas.
  std::vector<std::string> list(const char* name);

  /// `given` is what the client sent, `allowed` what it may send.
  void fail(const std::string& name, const std::string& given, const std::string& allowed);
  [[nodiscard]] const std::optional<ApiError>& error() const { return error_; }

 private:
  const Params& params_;
  std::optional<ApiError> error_;
};

}  // namespace kinemap
