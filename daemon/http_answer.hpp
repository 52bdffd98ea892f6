// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/answer.hpp"

namespace kinemap {

/// What of an HTTP request an answer depends on.
struct HttpRequest {
  std::string_view method;
  std::string_view target;
  std::string_view if_none_match = {};
  std::string_view accept_encoding = {};
};

struct HttpAnswer {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  SharedText body;  ///< never null; empty with 304
};

/// Compresses answers, and remembers the large ones by their content: the map goes to many clients.
class GzipCache {
 public:
  /// `hash` is the text's; null when it could not be compressed.
  SharedText gzip(const std::string& text, std::uint64_t hash);

 private:
  struct Entry {
    std::uint64_t hash;
    std::size_t size;
    SharedText packed;
  };
  std::deque<Entry> entries_;
};

/// The answer as HTTP has it (RFC 9110): a strong ETag made of the content, 304 for who has it already, gzip for who
/// takes it, and what caches may do.
HttpAnswer http_answer(Reply reply, const HttpRequest& request, GzipCache& gzip);

/// Whether "gzip, br;q=0.5" and the like allow gzip.
bool accepts_gzip(std::string_view accept_encoding);
/// Whether "\"a\", W/\"b\"" or "*" names the tag, quotes and all.
bool names_tag(std::string_view if_none_match, std::string_view etag);

}  // namespace kinemap
