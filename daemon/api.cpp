// SPDX-License-Identifier: Apache-2.0
#include "daemon/api.hpp"

#include <chrono>
#include <cstdio>
#include <random>
#include <utility>

#include "daemon/export_routes.hpp"
#include "daemon/metrics.hpp"
#include "daemon/openapi.hpp"
#include "daemon/page.hpp"
#include "daemon/queries.hpp"

namespace kinemap {
namespace {

constexpr std::chrono::milliseconds kLookPeriod{40};
constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

/// Tells this run of the daemon from any other.
std::string random_name() {
  std::random_device random;
  char text[17];
  std::snprintf(text, sizeof text, "%08x%08x", random(), random());
  return text;
}

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Api::Api(Sources sources, const Config::Suit& suit, std::uint16_t suit_port)
    : sources_(std::move(sources)), suit_(suit), suit_port_(suit_port), started_s_(now_s()), history_(random_name()) {
  add_page_routes(routes_);
  add_routes();
  add_export_routes(routes_, sources_);
}

void Api::add_routes() {
  const auto add = [this](const char* path, const char* summary, std::vector<ParamSpec> params, const char* schema,
                          std::function<Reply(const Call&)> answer) {
    routes_.add(
        {.path = path, .summary = summary, .params = std::move(params), .schema = schema, .answer = std::move(answer)});
  };
  add("/healthz", "Whether the daemon gets what it needs; 200 while it lives.", {}, "health",
      [this](const Call&) { return reply_of(health_text(status())); });
  add("/api/v1/map", "The whole map, or what changed since a revision.", map_params(), "map",
      [this](const Call& call) { return query_map(history(), call.params); });
  add("/api/v1/objects", "Objects by type, function and place.", object_params(), "objects",
      [this](const Call& call) { return reply_of(query_objects(*sources_.map(), call.params)); });
  add("/api/v1/objects/{id}", "One object.", {}, "object",
      [this](const Call& call) { return reply_of(query_object(*sources_.map(), call.id)); });
  add("/api/v1/rooms", "Every room, with the objects in it.", {}, "rooms",
      [this](const Call&) { return reply_of(query_rooms(*sources_.map())); });
  add("/api/v1/rooms/{id}", "One room.", {}, "room_with_objects",
      [this](const Call& call) { return reply_of(query_room(*sources_.map(), call.id)); });
  add("/api/v1/trajectory",
      "The optimised key poses of the pelvis; of the way of long ago those that the others lie between.",
      trajectory_params(), "trajectory",
      [this](const Call& call) { return reply_of(query_trajectory(*sources_.map(), call.params)); });
  add("/api/v1/pose", "Where the wearer is now.", {}, "pose_now",
      [this](const Call&) { return reply_of(query_pose(*sources_.map(), sources_.body(), now_s())); });
  add("/api/v1/body", "The 23 segments of the wearer's body now.", {}, "body",
      [this](const Call&) { return reply_of(query_body(*sources_.map(), sources_.body(), now_s())); });
  add("/api/v1/events", "What happened lately, the oldest first.", event_params(), "events",
      [this](const Call& call) { return reply_of(query_events(events_, call.params)); });
  add("/api/v1/status", "What was received, detected, mapped and dropped.", {}, "status",
      [this](const Call&) { return reply_of(status_text()); });
  routes_.add({.path = "/metrics",
               .summary = "The same and more as numbers, for Prometheus.",
               .content_type = kMetricsType,
               .answer = [this](const Call&) {
                 return Reply{.content_type = kMetricsType,
                              .body = std::make_shared<const std::string>(metrics_text(status()))};
               }});
  add("/api/v1/openapi.json", "This API as OpenAPI 3.1.", {}, "openapi", [this](const Call&) {
    if (!openapi_) openapi_ = std::make_shared<const std::string>(openapi_text(routes_, KINEMAP_VERSION));
    return Reply{.body = openapi_};
  });
  add("/api/v1/stream", "The WebSocket: revisions, poses and events as they come.", {}, "error", [](const Call&) {
    return error_reply({426, "upgrade_required", "/api/v1/stream speaks WebSocket"});
  });
}

MapHistory& Api::history() {
  history_.update(sources_.map());
  return history_;
}

void Api::look(std::chrono::steady_clock::time_point now) {
  if (now < look_due_) return;
  look_due_ = now + kLookPeriod;
  while (const auto notice = sources_.take_notice()) events_.add(*notice);
  events_.look(
      {sources_.map(), sources_.body().time_s, sources_.pipeline().tracker.tracing, is_receiving(sources_.suit())});
}

Status Api::status() {
  return {now_s() - started_s_, suit_,          suit_port_,      sources_.suit(),
          sources_.pipeline(),  sources_.map(), sources_.body(), counts_};
}

std::string Api::status_text() { return kinemap::status_text(status()); }

Reply Api::query(std::string_view path, const Params& params) {
  Reply reply = routes_.answer("/api/v1/" + std::string(path), params);
  if (reply.status < 400 && reply.content_type != "application/json")
    return error_reply({400, "not_json", "/api/v1/" + std::string(path) + " is a file; GET it over HTTP"});
  return made(std::move(reply));
}

Reply Api::begin(const HttpRequest& request) {
  ++counts_.requests;
  return get(request);
}

HttpAnswer Api::finish(Reply reply, const HttpRequest& request) {
  if (reply.status >= 400) ++counts_.errors;
  return http_answer(std::move(reply), request, gzip_);
}

HttpAnswer Api::refuse(const ApiError& error) {
  ++counts_.errors;
  return http_answer(error_reply(error), {}, gzip_);
}

Reply Api::get(const HttpRequest& request) {
  const auto target = parse_target(request.target);
  if (!target)
    return error_reply({400, "bad_target", "the request's target is not a path with well-formed %XX escapes"});
  if (!routes_.find(target->path)) return error_reply(routes_.unknown(target->path));
  if (request.method != "GET" && request.method != "HEAD") {
    Reply reply = error_reply({405, "method_not_allowed", "only GET and HEAD: the map is for reading"});
    reply.allow = "GET, HEAD";
    return reply;
  }
  return routes_.answer(target->path, target->params);
}

}  // namespace kinemap
