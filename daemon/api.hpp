// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "daemon/answer.hpp"
#include "daemon/http_answer.hpp"
#include "daemon/live_events.hpp"
#include "daemon/map_history.hpp"
#include "daemon/routes.hpp"
#include "daemon/sources.hpp"
#include "daemon/status.hpp"

namespace kinemap {

/// All answers of the server, without its sockets. The server's thread only.
class Api {
 public:
  Api(Sources sources, const Config::Suit& suit, std::uint16_t suit_port);
  Api(const Api&) = delete;  // the routes refer to it
  Api& operator=(const Api&) = delete;

  /// One HTTP request; HEAD is answered as GET (who sends it leaves out the body). In two steps, between which `made`
  /// may be called on another thread when the reply says that it takes long.
  Reply begin(const HttpRequest& request);
  HttpAnswer finish(Reply reply, const HttpRequest& request);
  HttpAnswer http(const HttpRequest& request) { return finish(made(begin(request)), request); }
  /// The answer to a request that is refused before its path is looked at.
  HttpAnswer refuse(const ApiError& error);
  /// The same questions by path, below /api/v1/ ("objects", "objects/7", "pose", …).
  Reply query(std::string_view path, const Params& params);

  /// Takes note of what has changed; to be called often.
  void look(std::chrono::steady_clock::time_point now);
  /// Knows the newest map.
  MapHistory& history();
  [[nodiscard]] const LiveEvents& events() const { return events_; }
  std::string status_text();
  [[nodiscard]] const Sources& sources() const { return sources_; }
  [[nodiscard]] const Routes& routes() const { return routes_; }
  ApiCounts& counts() { return counts_; }

 private:
  void add_routes();
  Reply get(const HttpRequest& request);
  Status status();

  Sources sources_;
  Config::Suit suit_;
  std::uint16_t suit_port_;
  double started_s_;
  ApiCounts counts_;
  Routes routes_;
  MapHistory history_;
  LiveEvents events_;
  GzipCache gzip_;
  SharedText openapi_;  // once somebody asked
  std::chrono::steady_clock::time_point look_due_{};
};

}  // namespace kinemap
