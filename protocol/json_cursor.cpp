// SPDX-License-Identifier: Apache-2.0
#include "protocol/json_cursor.hpp"

#include <algorithm>

namespace kinemap {

using Json = nlohmann::ordered_json;

Result<Json> parse_json(const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    const auto* syntax = dynamic_cast<const Json::parse_error*>(&error);
    const std::size_t byte = syntax ? std::min(syntax->byte, text.size()) : 0;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(byte), '\n');
    return Error{"not JSON: line " + std::to_string(line) + ", byte " + std::to_string(byte)};
  }
}

void JsonCursor::fail(const std::string& path, const std::string& what) const {
  if (!*error_) *error_ = Error{(path.empty() ? "the file" : path) + ": " + what};
}

JsonCursor JsonCursor::at(const char* key) const {
  const std::string path = path_.empty() ? key : path_ + "." + key;
  if (has(key)) return {&(*json_)[key], path, *error_};
  if (json_) fail(path, "missing");
  return {nullptr, path, *error_};
}

std::vector<JsonCursor> JsonCursor::items(std::size_t expected) const {
  std::vector<JsonCursor> result;
  if (!json_) return result;
  if (!json_->is_array() || (expected && json_->size() != expected)) {
    fail(expected ? "expected an array of " + std::to_string(expected) : "expected an array");
    return result;
  }
  for (std::size_t i = 0; i < json_->size(); ++i)
    result.push_back({&(*json_)[i], path_ + "[" + std::to_string(i) + "]", *error_});
  return result;
}

double JsonCursor::number() const {
  if (json_ && json_->is_number() && std::isfinite(json_->get<double>())) return json_->get<double>();
  if (json_) fail("expected a number");
  return 0.0;
}

std::uint64_t JsonCursor::count(std::uint64_t limit) const {
  if (json_ && json_->is_number_unsigned() && json_->get<std::uint64_t>() <= limit) return json_->get<std::uint64_t>();
  if (json_) fail("expected a whole number from 0 to " + std::to_string(limit));
  return 0;
}

std::string JsonCursor::string() const {
  if (json_ && json_->is_string()) return json_->get<std::string>();
  if (json_) fail("expected a string");
  return {};
}

bool JsonCursor::boolean_or_false(const char* key) const {
  if (!has(key)) return false;
  const JsonCursor value = at(key);
  if (value.json_->is_boolean()) return value.json_->get<bool>();
  value.fail("expected true or false");
  return false;
}

}  // namespace kinemap
