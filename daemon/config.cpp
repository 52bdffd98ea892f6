// SPDX-License-Identifier: Apache-2.0
#include "daemon/config.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "daemon/config_fields.hpp"
#include "daemon/config_reader.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

/// Visitor: a config as JSON, in the order of the list.
class Writer {
 public:
  template <class T>
  void section(const char* key, T& value) {
    Writer inner;
    fields(inner, value);
    json_[key] = std::move(inner.json_);
  }
  template <class T>
  void number(const char* key, const T& value, const Range&) {
    json_[key] = value;
  }
  void flag(const char* key, bool value) { json_[key] = value; }
  void choice(const char* key, const std::string& value, std::initializer_list<const char*>) { json_[key] = value; }
  void address(const char* key, const std::string& value) { json_[key] = value; }
  void path(const char* key, const std::string& value) { json_[key] = value; }
  void list(const char* key, const std::vector<std::string>& value, const ListOf&) { json_[key] = value; }

  void at_most(const char*, double, const char*, double) {}

  Json json_ = Json::object();
};

/// Visitor: what the documentation has to say of each key.
class Lister {
 public:
  explicit Lister(std::vector<ConfigKey>& keys, std::string prefix = {}) : keys_(keys), prefix_(std::move(prefix)) {}

  template <class T>
  void section(const char* key, T& value) {
    Lister inner(keys_, prefix_ + key + ".");
    fields(inner, value);
  }
  template <class T>
  void number(const char* key, const T& value, const Range& range) {
    keys_.push_back({prefix_ + key, range.unit, Json(value).dump(), describe(range)});
  }
  void flag(const char* key, bool value) {
    keys_.push_back({prefix_ + key, "", value ? "true" : "false", "true or false"});
  }
  void choice(const char* key, const std::string& value, std::initializer_list<const char*> allowed) {
    keys_.push_back({prefix_ + key, "", Json(value).dump(), describe(allowed)});
  }
  void address(const char* key, const std::string& value) {
    keys_.push_back({prefix_ + key, "", Json(value).dump(), kAddressAllowed});
  }
  void path(const char* key, const std::string& value) {
    keys_.push_back({prefix_ + key, "", Json(value).dump(), kPathAllowed});
  }
  void list(const char* key, const std::vector<std::string>& value, const ListOf& of) {
    keys_.push_back({prefix_ + key, "", Json(value).dump(), of.allowed});
  }
  void at_most(const char*, double, const char*, double) {}

 private:
  std::vector<ConfigKey>& keys_;
  std::string prefix_;
};

/// Parses JSON with comments; a key that stands twice in one object is refused, since which of the two counts is
/// anybody's guess.
Result<Json> parse(const std::string& text) {
  std::vector<std::set<std::string>> seen;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) seen.emplace_back();
    if (event == Json::parse_event_t::object_end) seen.pop_back();
    if (event == Json::parse_event_t::key && !seen.back().insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  try {
    Json json = Json::parse(text, watch, /*allow_exceptions=*/true, /*ignore_comments=*/true);
    if (!twice.empty()) return Error{"key \"" + twice + "\" stands twice in one object"};
    return json;
  } catch (const Json::exception& e) {
    // "[json.exception.parse_error.101] parse error at line 3, column 7: …": the part for people begins after the
    // bracket.
    const std::string what = e.what();
    const auto bracket = what.find("] ");
    return Error{bracket == std::string::npos ? what : what.substr(bracket + 2)};
  }
}

/// Takes the keys that the text has into `config`.
std::optional<Error> lay_over(Config& config, const std::string& text, const std::string& path) {
  auto json = parse(text);
  if (!json) return Error{path + ": " + json.error()};
  ConfigReader reader(*json, "");
  reader.read(config);
  if (reader.error()) return Error{path + ": " + *reader.error()};
  return std::nullopt;
}

/// The paths below `prefix` at which two configurations, which have the same keys, differ.
void add_differences(const Json& a, const Json& b, const std::string& prefix, std::vector<std::string>& keys) {
  for (const auto& [key, value] : a.items()) {
    if (value.is_object())
      add_differences(value, b.at(key), prefix + key + ".", keys);
    else if (value != b.at(key))
      keys.push_back(prefix + key);
  }
}

}  // namespace

Result<Config> config_from_text(const std::string& text, const std::string& path) {
  Config config;
  if (auto error = lay_over(config, text, path)) return std::move(*error);
  return config;
}

Result<Config> config_from_file(const std::string& path) {
  std::vector<std::filesystem::path> files{path};
  std::error_code none;  // there need not be a conf.d
  for (const auto& entry : std::filesystem::directory_iterator(files[0].parent_path() / "conf.d", none))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin() + 1, files.end());
  Config config;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (in) text << in.rdbuf();
    if (!in || in.bad()) return Error{file.string() + ": cannot be read as a configuration file"};
    if (auto error = lay_over(config, text.str(), file.string())) return std::move(*error);
  }
  return config;
}

nlohmann::ordered_json to_json(const Config& config) {
  Config copy = config;  // the list takes references that a reader may write through
  Writer writer;
  fields(writer, copy);
  return writer.json_;
}

std::vector<ConfigKey> config_keys() {
  std::vector<ConfigKey> keys;
  Config defaults;
  Lister lister(keys);
  fields(lister, defaults);
  return keys;
}

std::vector<std::string> changed_keys(const Config& a, const Config& b) {
  std::vector<std::string> keys;
  add_differences(to_json(a), to_json(b), "", keys);
  return keys;
}

}  // namespace kinemap
