// SPDX-License-Identifier: Apache-2.0
#include "daemon/foxglove_services.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "daemon/json_params.hpp"

namespace kinemap::foxglove {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kApiPrefix = "/api/v1/";
constexpr std::string_view kId = "{id}";

/// What a service of this route is called; nullopt for what is no JSON query.
std::optional<std::string> service_name(const Route& route) {
  const std::string_view path = route.path;
  if (!path.starts_with(kApiPrefix) || !route.content_type.empty() || route.schema == "error") return std::nullopt;
  std::string name = "/kinemap/" + std::string(path.substr(kApiPrefix.size()));
  if (const auto at = name.find('{'); at != std::string::npos) name.replace(at, kId.size(), "by_id");
  return name;
}

bool has_id(const Route& route) { return route.path.find(kId) != std::string::npos; }

Json request_schema(const Route& route, const std::string& name) {
  Json properties = Json::object();
  if (has_id(route)) properties["id"] = {{"type", "integer"}, {"minimum", 0}};
  for (const ParamSpec& param : route.params) {
    Json schema = Json::parse(param.schema);
    schema["description"] = param.meaning;
    properties[param.name] = std::move(schema);
  }
  Json schema = {{"title", name}, {"description", route.summary}, {"type", "object"}, {"properties", properties}};
  if (has_id(route)) schema["required"] = Json::array({"id"});
  return schema;
}

Json definition(const std::string& name, const Json& schema) {
  return {{"encoding", "json"}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", schema.dump()}};
}

Reply bad_request(const std::string& message) { return error_reply({.code = "bad_request", .message = message}); }

}  // namespace

Services::Services(Api& api) : api_(api) {
  for (const Route& route : api.routes().all())
    if (auto name = service_name(route)) services_.push_back({std::move(*name), &route});
}

std::string Services::advertise_text() const {
  Json list = Json::array();
  for (const auto& [name, route] : services_) {
    const std::string type = "kinemap." + route->schema;
    const Json response = {{"title", type}, {"type", "object"}, {"properties", Json::object()}};
    list.push_back({{"id", list.size() + 1},
                    {"name", name},
                    {"type", type},
                    {"request", definition(type + "_request", request_schema(*route, type + "_request"))},
                    {"response", definition(type, response)}});
  }
  return Json{{"op", "advertiseServices"}, {"services", std::move(list)}}.dump();
}

Reply Services::call(const ServiceCall& call) {
  if (call.service == 0 || call.service > services_.size())
    return bad_request("there is no service " + std::to_string(call.service) + "; \"advertiseServices\" has them");
  if (call.encoding != "json") return bad_request("requests are encoded as \"json\"");
  Json request = Json::object();
  if (!call.payload.empty()) request = parse_message(call.payload);
  if (!request.is_object()) return bad_request("a request is a JSON object of the query's parameters");

  const Route& route = *services_[call.service - 1].route;
  std::string path = route.path.substr(kApiPrefix.size());
  if (const auto at = path.find(kId); at != std::string::npos) {
    const Json id = request.value("id", Json());
    if (!id.is_number_unsigned()) return bad_request("the request needs \"id\", a whole number");
    path.replace(at, kId.size(), id.dump());
    request.erase("id");
  }
  const auto params = params_from_json(request);
  return params ? api_.query(path, *params) : bad_request(params.error());
}

}  // namespace kinemap::foxglove
