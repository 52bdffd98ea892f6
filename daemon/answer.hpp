// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>

namespace kinemap {

/// What went wrong for the client, as in {"error": {"code": …, "message": …}}.
struct ApiError {
  unsigned status = 400;       ///< the HTTP status that says the same
  std::string code = {};       ///< for programs: "bad_parameter", "not_found", …
  std::string message = {};    ///< for people: what is allowed instead
  std::string parameter = {};  ///< of a bad parameter: its name, …
  std::string given = {};      ///< … what the client sent (shortened), …
  std::string allowed = {};    ///< … and what it may send
  std::string nearest = {};    ///< of an unknown path: the nearest that there is
};

/// {"error": {"code": …, "message": …, …}}; what is empty is left out.
std::string error_text(const ApiError& error);

/// JSON text, or why there is none.
using Answer = std::variant<std::string, ApiError>;

/// Text, or bytes, that several connections may be sending at the same time.
using SharedText = std::shared_ptr<const std::string>;

/// What a client gets, over HTTP or over the stream.
struct Reply {
  unsigned status = 200;
  std::string content_type = "application/json";
  SharedText body = {};
  std::string download = {};  ///< the file's name where it is to be saved; empty: to be shown
  bool immutable = false;     ///< never changes below this path (files named by their content): caches keep it
  std::string allow = {};     ///< with 405: the methods there are
  /// When set, there is no body yet: this makes the reply. It takes long, and may be called on any thread.
  std::function<Reply()> later = {};
};

/// The reply itself, made here when it has to be.
inline Reply made(Reply reply) { return reply.later ? reply.later() : std::move(reply); }

Reply reply_of(Answer answer);
Reply error_reply(const ApiError& error);

}  // namespace kinemap
