// SPDX-License-Identifier: Apache-2.0
#include "daemon/json_params.hpp"

#include <nlohmann/json.hpp>
#include <optional>

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 16;

std::optional<std::string> param_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  if (!value.is_array() || value.empty()) return std::nullopt;
  std::string text;
  for (const auto& item : value) {
    const auto part = item.is_array() ? std::nullopt : param_text(item);
    if (!part) return std::nullopt;
    text += (text.empty() ? "" : ",") + *part;
  }
  return text;
}

}  // namespace

Json parse_message(std::string_view text) {
  bool deep = false;
  const auto within = [&deep](int depth, Json::parse_event_t, Json&) {
    deep |= depth > kDeepest;
    return depth <= kDeepest;
  };
  Json json = Json::parse(text, within, /*allow_exceptions=*/false);
  return deep ? Json(Json::value_t::discarded) : json;
}

Result<Params> params_from_json(const Json& object) {
  Params params;
  for (const auto& [key, value] : object.items()) {
    auto text = param_text(value);
    if (!text) return Error{"parameter " + key.substr(0, 40) + " must be a number, a string or a list of these"};
    params.emplace_back(key, std::move(*text));
  }
  return params;
}

}  // namespace kinemap
