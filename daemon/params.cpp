// SPDX-License-Identifier: Apache-2.0
#include "daemon/params.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>

namespace kinemap {
namespace {

template <class T>
std::optional<T> parse(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

std::optional<double> parse_finite(std::string_view text) {
  const auto value = parse<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// What the client sent, short enough to be sent back.
std::string shortened(const std::string& text) {
  constexpr std::size_t kShown = 40;
  return text.size() > kShown ? text.substr(0, kShown) + "…" : text;
}

}  // namespace

std::optional<ApiError> check_params(const Params& params, const std::vector<ParamSpec>& specs) {
  std::string names;
  for (const ParamSpec& spec : specs) names += (names.empty() ? "" : ", ") + std::string(spec.name);
  std::set<std::string> seen;
  for (const auto& [name, value] : params) {
    const std::string shown = shortened(name);
    if (std::none_of(specs.begin(), specs.end(), [&name = name](const ParamSpec& spec) { return name == spec.name; }))
      return ApiError{
          .code = "bad_parameter",
          .message = "unknown parameter \"" + shown + "\"; there are" + (names.empty() ? " none here" : ": " + names),
          .parameter = shown,
          .given = shortened(value),
          .allowed = names};
    if (!seen.insert(name).second)
      return ApiError{.code = "bad_parameter",
                      .message = "parameter " + name + " stands twice",
                      .parameter = name,
                      .given = shortened(value),
                      .allowed = "once"};
  }
  return std::nullopt;
}

void ParamReader::fail(const std::string& name, const std::string& given, const std::string& allowed) {
  if (error_) return;
  error_ = ApiError{.code = "bad_parameter",
                    .message = name + " must be " + allowed + ", not \"" + shortened(given) + "\"",
                    .parameter = name,
                    .given = shortened(given),
                    .allowed = allowed};
}

std::optional<std::string> ParamReader::text(const char* name) {
  if (error_) return std::nullopt;
  for (const auto& [key, value] : params_)
    if (key == name) return value;
  return std::nullopt;
}

std::optional<double> ParamReader::number(const char* name, double min, double max) {
  const auto raw = text(name);
  if (!raw) return std::nullopt;
  const auto value = parse_finite(*raw);
  if (value && *value >= min && *value <= max) return value;
  char range[64];
  std::snprintf(range, sizeof range, "a number from %g to %g", min, max);
  fail(name, *raw, range);
  return std::nullopt;
}

std::optional<std::size_t> ParamReader::count(const char* name, std::size_t min, std::size_t max) {
  const auto raw = text(name);
  if (!raw) return std::nullopt;
  const auto value = parse<std::size_t>(*raw);
  if (value && *value >= min && *value <= max) return value;
  fail(name, *raw, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  return std::nullopt;
}

std::optional<ParamReader::Point> ParamReader::point(const char* name) {
  const auto raw = text(name);
  if (!raw) return std::nullopt;
  const auto parts = parts_of(*raw);
  Point point;
  point.has_z = parts.size() == 3;
  bool good = parts.size() == 2 || parts.size() == 3;
  for (std::size_t i = 0; good && i < parts.size(); ++i) {
    const auto value = parse_finite(parts[i]);
    good = value.has_value();
    point.p[static_cast<Eigen::Index>(i)] = value.value_or(0.0);
  }
  if (good) return point;
  fail(name, *raw, "two or three numbers with commas, metres in the map frame, such as 1.5,-2");
  return std::nullopt;
}

std::vector<std::string> ParamReader::list(const char* name) {
  const auto raw = text(name);
  return raw ? parts_of(*raw) : std::vector<std::string>();
}

}  // namespace kinemap
