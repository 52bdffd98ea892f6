// SPDX-License-Identifier: Apache-2.0
#include "daemon/openapi.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/json_text.hpp"
#include "protocol/schemas.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::ordered_json;

const std::string kComponents = "#/components/schemas/";

/// The same schema with its references turned to where the schemas are in the OpenAPI document.
Json relocated(const Json& schema) {
  if (schema.is_array()) {
    Json out = Json::array();
    for (const Json& item : schema) out.push_back(relocated(item));
    return out;
  }
  if (!schema.is_object()) return schema;
  Json out = Json::object();
  for (const auto& [key, value] : schema.items()) {
    if (key == "$schema" || key == "$id" || key == "$defs") continue;
    if (key != "$ref") {
      out[key] = relocated(value);
      continue;
    }
    const auto target = value.get<std::string>();
    const auto definition = target.find("#/$defs/");
    out[key] = kComponents + (definition == std::string::npos ? "whole_map" : target.substr(definition + 8));
  }
  return out;
}

Json schemas() {
  const Json map = Json::parse(map_schema_text()), api = Json::parse(api_schema_text());
  Json out = {{"whole_map", relocated(map)}};
  for (const Json* document : {&api, &map})
    for (const auto& [name, schema] : document->at("$defs").items()) out[name] = relocated(schema);
  return out;
}

Json content(const std::string& type, const Json& schema) { return {{type, {{"schema", schema}}}}; }
Json reference(const std::string& name) { return {{"$ref", kComponents + name}}; }

Json parameters(const Route& route) {
  Json out = Json::array();
  if (const auto open = route.path.find('{'); open != std::string::npos)
    out.push_back({{"name", route.path.substr(open + 1, route.path.find('}') - open - 1)},
                   {"in", "path"},
                   {"required", true},
                   {"schema", {{"type", "string"}}}});
  for (const ParamSpec& param : route.params)
    out.push_back(
        {{"name", param.name}, {"in", "query"}, {"description", param.meaning}, {"schema", Json::parse(param.schema)}});
  return out;
}

Json responses(const Route& route) {
  const Json error = content("application/json", reference("error"));
  Json out;
  if (route.schema == "error")  // what is not for HTTP
    out["426"] = {{"description", "It speaks WebSocket: stream_request and stream_message."}, {"content", error}};
  else if (!route.schema.empty())
    out["200"] = {{"description", route.summary}, {"content", content("application/json", reference(route.schema))}};
  else
    out["200"] = {{"description", route.summary}, {"content", content(route.content_type, Json::object())}};
  out["304"] = {{"description", "If-None-Match has the answer's ETag."}};
  const auto refused = [&](const char* status, const char* why) {
    out[status] = {{"description", why}, {"content", error}};
  };
  if (!route.open) refused("401", "A token is wanted, and none or an unknown one was shown.");
  refused("403", "The Host or the Origin is not one that this server answers to, or the token allows less than this.");
  refused("429", "Too many requests from this address; Retry-After says for how many seconds.");
  refused("default", "Why there is no answer.");
  return out;
}

/// How a token is shown; programs of the daemon's own machine mostly need none (api.auth).
Json security_schemes() {
  return {
      {"token", {{"type", "http"}, {"scheme", "bearer"}, {"description", "Scope read, or admin for what changes."}}},
      {"stream_token",
       {{"type", "apiKey"},
        {"in", "query"},
        {"name", "token"},
        {"description", "The same for WebSockets, of which browsers let a page set no header."}}}};
}

}  // namespace

std::string openapi_text(const Routes& routes, const std::string& version) {
  Json paths = Json::object();
  for (const Route& route : routes.all()) {
    Json get = {{"summary", route.summary}, {"responses", responses(route)}};
    if (Json list = parameters(route); !list.empty()) get["parameters"] = std::move(list);
    if (route.open) get["security"] = Json::array();
    paths[route.path] = {{"get", std::move(get)}};
  }
  return compact_text({{"openapi", "3.1.0"},
                       {"info",
                        {{"title", "Kinemap"},
                         {"version", version},
                         {"description", "A live map of a building, from the motion of who walks through it."},
                         {"license", {{"name", "Apache-2.0"}, {"identifier", "Apache-2.0"}}}}},
                       {"paths", std::move(paths)},
                       {"security", Json::array({{{"token", Json::array()}}, {{"stream_token", Json::array()}}})},
                       {"components", {{"schemas", schemas()}, {"securitySchemes", security_schemes()}}}});
}

}  // namespace kinemap
