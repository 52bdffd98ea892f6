// SPDX-License-Identifier: Apache-2.0
#include "daemon/params.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
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

/// What the client sent, short enough and plain enough to be sent back.
std::string quoted(const std::string& text) {
  std::string shown(1, '"');
  shown.append(text, 0, 40);
  shown += text.size() > 40 ? "…\"" : "\"";
  return shown;
}

}  // namespace

ParamReader::ParamReader(const Params& params, std::initializer_list<const char*> allowed) : params_(params) {
  std::set<std::string> seen;
  for (const auto& [name, value] : params) {
    if (std::none_of(allowed.begin(), allowed.end(), [&](const char* item) { return name == item; })) {
      std::string list;
      for (const char* item : allowed) list += (list.empty() ? "" : ", ") + std::string(item);
      fail("unknown parameter " + quoted(name) + "; " + (list.empty() ? "there are none here" : "there are: " + list));
    }
    if (!seen.insert(name).second) fail("parameter " + name + " stands twice");
  }
}

void ParamReader::fail(const std::string& message) {
  if (!error_) error_ = ApiError{400, "bad_parameter", message};
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
  char range[96];
  std::snprintf(range, sizeof range, " must be a number from %g to %g, not ", min, max);
  fail(name + std::string(range) + quoted(*raw));
  return std::nullopt;
}

std::optional<std::size_t> ParamReader::count(const char* name, std::size_t min, std::size_t max) {
  const auto raw = text(name);
  if (!raw) return std::nullopt;
  const auto value = parse<std::size_t>(*raw);
  if (value && *value >= min && *value <= max) return value;
  fail(std::string(name) + " must be a whole number from " + std::to_string(min) + " to " + std::to_string(max) +
       ", not " + quoted(*raw));
  return std::nullopt;
}

std::optional<Eigen::Vector2d> ParamReader::point(const char* name) {
  const auto raw = text(name);
  if (!raw) return std::nullopt;
  const auto comma = raw->find(',');
  if (comma != std::string::npos) {
    const auto x = parse_finite(std::string_view(*raw).substr(0, comma));
    const auto y = parse_finite(std::string_view(*raw).substr(comma + 1));
    if (x && y) return Eigen::Vector2d(*x, *y);
  }
  fail(std::string(name) + " must be two numbers with a comma, metres in the map frame, such as 1.5,-2; not " +
       quoted(*raw));
  return std::nullopt;
}

std::vector<std::string> ParamReader::list(const char* name) {
  std::vector<std::string> parts;
  const auto raw = text(name);
  if (!raw) return parts;
  for (std::size_t begin = 0; begin <= raw->size();) {
    const auto end = std::min(raw->find(',', begin), raw->size());
    parts.push_back(raw->substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace kinemap
