// SPDX-License-Identifier: Apache-2.0
#include "daemon/answer.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/json_text.hpp"

namespace kinemap {

std::string error_text(const ApiError& error) {
  using Json = nlohmann::ordered_json;
  Json json = {{"code", error.code}, {"message", error.message}};
  const std::pair<const char*, const std::string*> details[] = {{"parameter", &error.parameter},
                                                                {"given", &error.given},
                                                                {"allowed", &error.allowed},
                                                                {"nearest", &error.nearest}};
  for (const auto& [name, text] : details)
    if (!text->empty()) json[name] = *text;
  // What the client sent may hold anything: bytes that are no UTF-8 are replaced.
  return compact_text({{"error", std::move(json)}});
}

Reply error_reply(const ApiError& error) {
  return {.status = error.status, .body = std::make_shared<const std::string>(error_text(error))};
}

Reply reply_of(Answer answer) {
  if (const auto* error = std::get_if<ApiError>(&answer)) return error_reply(*error);
  return {.body = std::make_shared<const std::string>(std::get<std::string>(std::move(answer)))};
}

}  // namespace kinemap
