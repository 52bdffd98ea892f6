// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/web.hpp"

namespace kinemap {

using WebRequest = http::request<http::string_body>;

/// The paths at which WebSockets are spoken.
inline constexpr std::string_view kStreamPath = "/api/v1/stream", kFoxglovePath = "/";

inline std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }
std::string_view path_of(const WebRequest& request);

/// Why a request that has come over this connection is not answered, before its path is looked at: how often its
/// address asks, then who asks, whether there is a place for that one, and whether there is such a WebSocket. Each
/// reason is counted.
std::optional<ApiError> refusal(const WebRequest& request, Guest& guest, bool encrypted, WebContext& context);

}  // namespace kinemap
