// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/queries.hpp"
#include "daemon/status.hpp"

namespace kinemap {

/// Where the server's answers come from. All are called on the server's thread and return at once.
struct Sources {
  std::function<std::shared_ptr<const MapSnapshot>()> map;  ///< never null
  std::function<LivePose()> pose;
  std::function<ReceiverState()> suit;
  std::function<PipelineStats()> pipeline;
  std::function<std::optional<Notice>()> take_notice;
};

/// Text that several connections may be sending at the same time.
using SharedText = std::shared_ptr<const std::string>;

struct Reply {
  unsigned status = 200;
  const char* content_type = "application/json";
  SharedText body;
  const char* allow = nullptr;  ///< with 405: the methods there are
};

/// All answers of the server, without its sockets: which path gives what. The server's thread only.
class Api {
 public:
  Api(Sources sources, const Config::Suit& suit, std::uint16_t suit_port);

  /// One HTTP request; HEAD is answered as GET (who sends it leaves out the body).
  Reply http(std::string_view method, std::string_view target);
  /// The same questions below /api/v1 by path ("objects", "objects/7", "pose", …).
  Answer query(std::string_view path, const Params& params);

  /// The map's JSON, made once per revision for everyone who asks.
  SharedText map_text();
  std::string status_text();
  [[nodiscard]] const Sources& sources() const { return sources_; }
  ApiCounts& counts() { return counts_; }

 private:
  Status status();
  Reply reply(Answer answer);

  Sources sources_;
  Config::Suit suit_;
  std::uint16_t suit_port_;
  double started_s_;
  ApiCounts counts_;
  std::shared_ptr<const MapSnapshot> map_of_text_;  // what map_text_ says
  SharedText map_text_;
};

Reply error_reply(const ApiError& error);

}  // namespace kinemap
