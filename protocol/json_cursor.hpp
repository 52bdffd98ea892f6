// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap {

/// Parses a JSON text; the Error names line and byte.
Result<nlohmann::ordered_json> parse_json(const std::string& text);

/// Walks a JSON tree and knows the path of where it is. The first thing that is wrong is kept in the Error given at the
/// root, and makes later reads yield defaults: a reader needs no branch for errors and looks at the Error once, at its
/// end.
class JsonCursor {
 public:
  JsonCursor(const nlohmann::ordered_json& root, std::optional<Error>& error) : JsonCursor(&root, "", error) {}

  [[nodiscard]] bool has(const char* key) const { return json_ && json_->is_object() && json_->contains(key); }
  [[nodiscard]] JsonCursor at(const char* key) const;
  /// All items of an array; `expected` of them when given.
  [[nodiscard]] std::vector<JsonCursor> items(std::size_t expected = 0) const;

  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] std::uint64_t count(std::uint64_t limit = UINT64_MAX) const;
  [[nodiscard]] std::string string() const;
  [[nodiscard]] bool boolean_or_false(const char* key) const;
  template <int N>
  [[nodiscard]] Eigen::Matrix<double, N, 1> vector() const {
    Eigen::Matrix<double, N, 1> result = Eigen::Matrix<double, N, 1>::Zero();
    int i = 0;
    for (const JsonCursor& item : items(N)) result[i++] = item.number();
    return result;
  }

  /// Says what is wrong here.
  void fail(const std::string& what) const { fail(path_, what); }

 private:
  JsonCursor(const nlohmann::ordered_json* json, std::string path, std::optional<Error>& error)
      : json_(json), path_(std::move(path)), error_(&error) {}
  void fail(const std::string& path, const std::string& what) const;

  const nlohmann::ordered_json* json_;  ///< null after an error
  std::string path_;
  std::optional<Error>* error_;
};

}  // namespace kinemap
