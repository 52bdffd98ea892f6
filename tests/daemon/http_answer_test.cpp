// SPDX-License-Identifier: Apache-2.0
#include "daemon/http_answer.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

namespace kinemap {
namespace {

std::string unpacked(const std::string& packed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  std::string out(10'000'000, '\0'), in = packed;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

std::string header(const HttpAnswer& answer, std::string_view name) {
  for (const auto& [key, value] : answer.headers)
    if (key == name) return value;
  return "";
}

HttpAnswer packed(const std::string& body, const std::string& type = "application/json") {
  GzipCache cache;
  return http_answer({.content_type = type, .body = std::make_shared<const std::string>(body)},
                     {.method = "GET", .target = "/", .accept_encoding = "gzip"}, cache);
}

TEST(HttpAnswer, WhatIsPackedCanBeUnpacked) {
  std::mt19937 random(1);
  for (const std::size_t size : {1024UL, 5000UL, 20000UL, 3'000'000UL}) {
    std::string text(size, ' ');
    for (char& c : text) c = static_cast<char>(random() % 256);
    for (const std::string& body : {text, std::string(size, 'x')}) {
      const auto answer = packed(body);
      EXPECT_EQ(header(answer, "Content-Encoding"), "gzip");
      EXPECT_EQ(unpacked(*answer.body), body);
    }
  }
}

TEST(HttpAnswer, LittleAnswersAndPicturesAreSentAsTheyAre) {
  EXPECT_EQ(header(packed(std::string(1000, 'x')), "Content-Encoding"), "");
  EXPECT_EQ(header(packed(std::string(100000, 'x'), "font/woff2"), "Content-Encoding"), "");
  EXPECT_EQ(header(packed(std::string(100000, 'x'), "image/svg+xml"), "Content-Encoding"), "gzip");
}

TEST(HttpAnswer, LargeOnesArePackedOnce) {
  GzipCache cache;
  const std::string text(100000, 'x');
  const auto first = cache.gzip(text, 1);
  EXPECT_EQ(cache.gzip(text, 1), first);
  for (std::uint64_t hash = 2; hash < 20; ++hash) cache.gzip(text, hash);
  EXPECT_NE(cache.gzip(text, 1), first) << "only the latest are kept";
}

TEST(AcceptsGzip, AsRfc9110Says) {
  for (const char* yes : {"gzip", "GZIP", "br, gzip", "gzip;q=0.5", "br;q=1.0 , gzip ; q=0.1", "x-gzip"})
    EXPECT_TRUE(accepts_gzip(yes)) << yes;
  for (const char* no : {"", "br", "identity", "gzip;q=0", "gzip;q=0.0", "gzipped", "*;q=0"})
    EXPECT_FALSE(accepts_gzip(no)) << no;
}

TEST(NamesTag, AsRfc9110Says) {
  for (const char* yes : {"\"a\"", "W/\"a\"", "\"b\", \"a\"", "*"}) EXPECT_TRUE(names_tag(yes, "\"a\"")) << yes;
  for (const char* no : {"", "a", "\"b\"", "\"aa\"", ","}) EXPECT_FALSE(names_tag(no, "\"a\"")) << no;
}

}  // namespace
}  // namespace kinemap
