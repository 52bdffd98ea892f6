// SPDX-License-Identifier: Apache-2.0
#include "daemon/api.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/page.hpp"
#include "protocol/map_json.hpp"

namespace kinemap {
namespace {

constexpr std::string_view kPrefix = "/api/v1/";

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

ApiError unknown_path(std::string_view path) {
  return {404, "not_found",
          "no " + std::string(path.substr(0, 80)) +
              "; there are /, /healthz and /api/v1/{map, objects, objects/ID, trajectory, "
              "pose, status, stream}"};
}

ApiError takes_no_params(const Params& params) {
  return {400, "bad_parameter", "unknown parameter " + params.front().first.substr(0, 40) + "; there are none here"};
}

}  // namespace

Reply error_reply(const ApiError& error) {
  return {error.status, "application/json", std::make_shared<const std::string>(error_text(error)), nullptr};
}

Api::Api(Sources sources, const Config::Suit& suit, std::uint16_t suit_port)
    : sources_(std::move(sources)), suit_(suit), suit_port_(suit_port), started_s_(now_s()) {}

SharedText Api::map_text() {
  auto map = sources_.map();
  if (map != map_of_text_) {
    map_text_ = std::make_shared<const std::string>(
        to_json(*map).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    map_of_text_ = std::move(map);
  }
  return map_text_;
}

Status Api::status() {
  return {now_s() - started_s_, suit_, suit_port_, sources_.suit(), sources_.pipeline(), sources_.map(), counts_};
}

std::string Api::status_text() { return kinemap::status_text(status()); }

Answer Api::query(std::string_view path, const Params& params) {
  constexpr std::string_view kObject = "objects/";
  const bool object = path.starts_with(kObject);
  if (path == "objects") return query_objects(*sources_.map(), params);
  if (path == "trajectory") return query_trajectory(*sources_.map(), params);
  if (!object && path != "map" && path != "pose" && path != "status") return unknown_path(path);
  if (!params.empty()) return takes_no_params(params);
  if (object) return query_object(*sources_.map(), path.substr(kObject.size()));
  if (path == "pose") return query_pose(*sources_.map(), sources_.pose());
  return path == "map" ? *map_text() : status_text();
}

Reply Api::reply(Answer answer) {
  if (const auto* error = std::get_if<ApiError>(&answer)) return error_reply(*error);
  return {200, "application/json", std::make_shared<const std::string>(std::get<std::string>(std::move(answer))),
          nullptr};
}

Reply Api::http(std::string_view method, std::string_view target) {
  ++counts_.requests;
  const auto parsed = parse_target(target);
  Reply answer;
  if (!parsed) {
    answer = error_reply({400, "bad_target", "the request's target is not a path with well-formed %XX escapes"});
  } else if (method != "GET" && method != "HEAD") {
    answer = error_reply({405, "method_not_allowed", "only GET and HEAD: the map is for reading"});
    answer.allow = "GET, HEAD";
  } else if (parsed->path == "/") {
    answer = {200, "text/html; charset=utf-8", status_page(), nullptr};
  } else if (parsed->path == "/healthz") {
    answer = reply(health_text(status()));
  } else if (parsed->path == "/api/v1/map" && parsed->params.empty()) {
    answer = {200, "application/json", map_text(), nullptr};
  } else if (parsed->path == "/api/v1/stream") {
    answer = error_reply({426, "upgrade_required", "/api/v1/stream speaks WebSocket"});
  } else if (std::string_view(parsed->path).starts_with(kPrefix)) {
    answer = reply(query(std::string_view(parsed->path).substr(kPrefix.size()), parsed->params));
  } else {
    answer = error_reply(unknown_path(parsed->path));
  }
  if (answer.status >= 400) ++counts_.errors;
  return answer;
}

}  // namespace kinemap
