// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "daemon/config_fields.hpp"

namespace kinemap {

inline constexpr const char* kAddressAllowed = "an IPv4 or IPv6 address";
inline constexpr const char* kPathAllowed = "an absolute path, or \"\"";
std::string describe(const Range& range);
std::string describe(std::initializer_list<const char*> allowed);

/// Visitor over one JSON object: takes the keys that are there, leaves the defaults of those that are not, and stops at
/// the first thing that is wrong.
class ConfigReader {
 public:
  using Json = nlohmann::ordered_json;
  /// `path` is the object's key path, "" for the root.
  ConfigReader(const Json& json, std::string path) : json_(json), path_(std::move(path)) {}

  /// Reads all fields of `target`, then refuses the keys that are left over.
  template <class T>
  void read(T& target) {
    if (!json_.is_object())
      return fail(path_.empty() ? "the file" : path_, "must be an object { … }, not " + shown(json_));
    fields(*this, target);
    if (!error_) refuse_unknown();
  }

  template <class T>
  void section(const char* key, T& target) {
    const Json* value = find(key);
    if (value == nullptr) return;
    ConfigReader inner(*value, path_of(key));
    inner.read(target);
    error_ = inner.error_;
  }

  template <class T>
  void number(const char* key, T& target, const Range& range) {
    const Json* value = find(key);
    if (value == nullptr) return;
    if constexpr (std::is_floating_point_v<T>) {
      if (!value->is_number())
        return fail(path_of(key), "must be a number, " + describe(range) + ", not " + shown(*value));
    } else {
      if (!value->is_number_integer())
        return fail(path_of(key), "must be a whole number, " + describe(range) + ", not " + shown(*value));
    }
    const double number = value->template get<double>();
    if (!(number >= range.min && number <= range.max))
      return fail(path_of(key), shown(*value) + " is out of range: allowed are " + describe(range));
    target = value->template get<T>();
  }

  void flag(const char* key, bool& target);
  void choice(const char* key, std::string& target, std::initializer_list<const char*> allowed);
  void address(const char* key, std::string& target);
  void path(const char* key, std::string& target);
  void list(const char* key, std::vector<std::string>& target, const ListOf& of);
  void at_most(const char* key, double value, const char* bound_key, double bound);

  [[nodiscard]] const std::optional<std::string>& error() const { return error_; }

 private:
  const Json* find(const char* key);
  [[nodiscard]] std::string path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  static std::string shown(const Json& value);
  void fail(const std::string& path, const std::string& message);
  void refuse_unknown();

  const Json& json_;
  std::string path_;
  std::vector<std::string> known_;
  std::optional<std::string> error_;
};

}  // namespace kinemap
