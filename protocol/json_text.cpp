// SPDX-License-Identifier: Apache-2.0
#include "protocol/json_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

std::string compact(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

bool is_flat(const Json& array) {
  return std::none_of(array.begin(), array.end(), [](const Json& item) { return item.is_structured(); });
}

void append_flat(const Json& array, std::string& text) {
  text += '[';
  for (std::size_t i = 0; i < array.size(); ++i) text += (i ? ", " : "") + compact(array[i]);
  text += ']';
}

void append(const Json& json, int depth, std::string& text) {
  if (!json.is_structured() || json.empty()) {
    text += compact(json);
    return;
  }
  if (json.is_array() && is_flat(json)) return append_flat(json, text);
  const std::string indent(2 * static_cast<std::size_t>(depth + 1), ' ');
  text += json.is_array() ? '[' : '{';
  bool first = true;
  for (const auto& [key, value] : json.items()) {
    text += (first ? "\n" : ",\n") + indent;
    if (json.is_object()) text += compact(Json(key)) + ": ";
    append(value, depth + 1, text);
    first = false;
  }
  text += '\n' + indent.substr(2) + (json.is_array() ? ']' : '}');
}

}  // namespace

std::string pretty_text(const Json& json) {
  std::string text;
  append(json, 0, text);
  text += '\n';
  return text;
}

std::string compact_text(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace kinemap
