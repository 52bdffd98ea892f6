// SPDX-License-Identifier: Apache-2.0
#include "daemon/http_answer.hpp"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <functional>

namespace kinemap {
namespace {

constexpr std::size_t kWorthPacking = 1024;   // bytes: below, one packet carries it anyway
constexpr std::size_t kWorthKeeping = 16384;  // bytes: below, packing costs less than looking for it
constexpr std::size_t kKept = 8;              // packed answers: the map, the files of the page
constexpr int kLevel = 4;                     // JSON shrinks to a tenth at level 9 too, but three times as slowly

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Calls `take` with each part between commas until it returns true; whether it did.
template <class Take>
bool any_part(std::string_view list, const Take& take) {
  while (!list.empty()) {
    const auto comma = list.find(',');
    if (take(trimmed(list.substr(0, comma)))) return true;
    list = comma == std::string_view::npos ? std::string_view() : list.substr(comma + 1);
  }
  return false;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// Pictures, fonts and recordings are packed already.
bool shrinks(std::string_view content_type) {
  if (content_type.starts_with("text/") || content_type.starts_with("model/")) return true;
  for (const char* part : {"json", "javascript", "xml"})
    if (content_type.find(part) != std::string_view::npos) return true;
  return false;
}

SharedText packed(const std::string& text) {
  z_stream stream{};
  constexpr int kGzipWindow = 15 + 16;  // 16: with gzip's header
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK) return nullptr;
  std::string out(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));  // zlib's C interface; it only reads
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int result = deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return result == Z_STREAM_END ? std::make_shared<const std::string>(std::move(out)) : nullptr;
}

std::string tag_of(std::uint64_t hash, std::size_t size, bool gzip) {
  char tag[64];
  std::snprintf(tag, sizeof tag, "\"%016llx-%zx%s\"", static_cast<unsigned long long>(hash), size, gzip ? "-gz" : "");
  return tag;
}

}  // namespace

SharedText GzipCache::gzip(const std::string& text, std::uint64_t hash) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.hash == hash && entry.size == text.size(); });
  if (found != entries_.end()) return found->packed;
  SharedText result = packed(text);
  if (result && text.size() >= kWorthKeeping) {
    entries_.push_front({hash, text.size(), result});
    if (entries_.size() > kKept) entries_.pop_back();
  }
  return result;
}

bool accepts_gzip(std::string_view accept_encoding) {
  return any_part(accept_encoding, [](std::string_view part) {
    const auto semicolon = part.find(';');
    const std::string name = lower(trimmed(part.substr(0, semicolon)));
    if (name != "gzip" && name != "x-gzip") return false;
    if (semicolon == std::string_view::npos) return true;
    const auto weight = trimmed(part.substr(semicolon + 1));
    double q = 1.0;
    if (weight.starts_with("q=")) std::from_chars(weight.data() + 2, weight.data() + weight.size(), q);
    return q > 0.0;
  });
}

bool names_tag(std::string_view if_none_match, std::string_view etag) {
  return any_part(if_none_match, [&](std::string_view part) {
    if (part.starts_with("W/")) part.remove_prefix(2);
    return part == "*" || part == etag;
  });
}

HttpAnswer http_answer(Reply reply, const HttpRequest& request, GzipCache& gzip) {
  HttpAnswer answer{reply.status, {{"Content-Type", reply.content_type}}, std::move(reply.body)};
  if (!reply.allow.empty()) answer.headers.emplace_back("Allow", reply.allow);
  if (reply.status == 401) answer.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"kinemap\"");
  if (reply.status == 429 || reply.status == 503) answer.headers.emplace_back("Retry-After", "1");
  if (reply.status != 200) {
    answer.headers.emplace_back("Cache-Control", "no-store");
    return answer;
  }
  if (!reply.download.empty())
    answer.headers.emplace_back("Content-Disposition", "attachment; filename=\"" + reply.download + "\"");
  answer.headers.emplace_back("Cache-Control", reply.immutable ? "public, max-age=31536000, immutable" : "no-cache");
  answer.headers.emplace_back("Vary", "Accept-Encoding");

  const std::uint64_t hash = std::hash<std::string>{}(*answer.body);
  const std::size_t size = answer.body->size();
  const bool pack = size >= kWorthPacking && shrinks(reply.content_type) && accepts_gzip(request.accept_encoding);
  const std::string tag = tag_of(hash, size, pack);
  answer.headers.emplace_back("ETag", tag);
  if (names_tag(request.if_none_match, tag)) {
    answer.status = 304;
    answer.body = std::make_shared<const std::string>();
    return answer;
  }
  if (!pack) return answer;
  if (auto text = gzip.gzip(*answer.body, hash)) {
    answer.body = std::move(text);
    answer.headers.emplace_back("Content-Encoding", "gzip");
  }
  return answer;
}

}  // namespace kinemap
