// SPDX-License-Identifier: Apache-2.0
#include "daemon/admission.hpp"

#include <boost/beast/websocket/rfc6455.hpp>
#include <string>

#include "daemon/foxglove_protocol.hpp"
#include "daemon/url.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kTargetLimit = 2048;

std::optional<ApiError> refusal_by_rate(Visitor& visitor, WebContext& context) {
  if (!context.limited(visitor) ||
      context.visitors.ask(visitor, Visitors::Clock::now()) == Visitors::Clock::duration::zero())
    return std::nullopt;
  ++context.api.counts().throttled;
  return ApiError{429, "too_many_requests",
                  "more than api.max_requests_per_s come from your address; the stream pushes what is new"};
}

/// Who came when all places were taken gets the one of somebody who has less claim. The live page itself is given to
/// everybody, or those who hold places could keep it from them.
std::optional<ApiError> refusal_by_places(Guest& guest, WebContext& context) {
  if (!guest.surplus || (guest.visit.open && guest.scope == Scope::Nothing)) return std::nullopt;
  auto& counts = context.api.counts();
  const Visitor& visitor = *guest.visitor;
  const auto& config = context.config;
  if (context.crowded(visitor, visitor.connections) && !context.guests.make_room(guest, true)) {
    ++counts.refused;
    return ApiError{503, "too_many_of_you",
                    "api.max_clients_per_address (" + std::to_string(config.max_clients_per_address) +
                        ") connections from your address are open"};
  }
  if (context.crowded(counts.connections) && !context.guests.make_room(guest)) {
    ++counts.refused;
    return ApiError{503, "too_many_clients",
                    "api.max_clients (" + std::to_string(config.max_clients) + ") connections are open"};
  }
  guest.surplus = false;
  return std::nullopt;
}

WebVisit visit_of(const WebRequest& request, const Visitor& visitor, bool encrypted, const Routes& routes) {
  WebVisit visit;
  visit.local = visitor.local;
  visit.tls = encrypted;
  visit.upgrade = beast::websocket::is_upgrade(request);
  visit.viewer = visit.upgrade && path_of(request) == kFoxglovePath;
  visit.changes = request.method() != http::verb::get && request.method() != http::verb::head;
  visit.host = view(request[http::field::host]);
  visit.origin = view(request[http::field::origin]);
  std::string token(bearer_token(view(request[http::field::authorization])));
  const auto target = parse_target(view(request.target()));
  const auto found = target ? routes.find(target->path) : std::nullopt;
  visit.open = found && found->route->open;
  if (target) {
    for (const auto& [name, value] : target->params) {
      if (name != "token") continue;
      visit.token_in_query = true;
      token = value;
    }
  }
  if (!token.empty()) visit.token = hash_of(token);
  return visit;
}

std::optional<ApiError> refusal_by_policy(const WebVisit& visit, WebContext& context) {
  auto problem = context.security.policy.refusal(visit);
  if (!problem) return problem;
  auto& counts = context.api.counts();
  ++(problem->code.starts_with("token_") ? counts.unauthorized : counts.forbidden);
  return problem;
}

std::optional<ApiError> upgrade_refusal(const WebRequest& request) {
  const auto path = path_of(request);
  if (path != kStreamPath && path != kFoxglovePath)
    return ApiError{.status = 404,
                    .code = "not_found",
                    .message = "the WebSocket is at /api/v1/stream, the one for Foxglove's viewers at /",
                    .nearest = std::string(kStreamPath)};
  if (path == kFoxglovePath && !foxglove::choose_subprotocol(view(request[http::field::sec_websocket_protocol])))
    return ApiError{400, "bad_subprotocol",
                    "at / the WebSocket subprotocol is foxglove.sdk.v1 or foxglove.websocket.v1; Kinemap's own stream "
                    "is at /api/v1/stream"};
  return std::nullopt;
}

}  // namespace

std::string_view path_of(const WebRequest& request) {
  const auto target = view(request.target());
  return target.substr(0, target.find('?'));
}

std::optional<ApiError> refusal(const WebRequest& request, Guest& guest, bool encrypted, WebContext& context) {
  if (auto problem = refusal_by_rate(*guest.visitor, context)) return problem;
  if (request.target().size() > kTargetLimit)
    return ApiError{414, "target_too_long", "the request's target is longer than 2 KiB"};
  guest.visit = visit_of(request, *guest.visitor, encrypted, context.api.routes());
  guest.scope = context.security.policy.scope_of(guest.visit);
  if (auto problem = refusal_by_policy(guest.visit, context)) return problem;
  if (auto problem = refusal_by_places(guest, context)) return problem;
  return guest.visit.upgrade ? upgrade_refusal(request) : std::nullopt;
}

}  // namespace kinemap
