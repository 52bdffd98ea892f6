// SPDX-License-Identifier: Apache-2.0
// Lines: method, target, If-None-Match, Accept-Encoding.
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "tests/fuzz/world.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::array<std::string_view, 4> lines;
  for (auto& line : lines) {
    line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
  }
  const auto answer = kinemap::fuzz::api().http({lines[0], lines[1], lines[2], lines[3]});
  if (!answer.body || answer.status < 200 || answer.status >= 600) std::abort();
  bool packed = false, json = false;
  for (const auto& [name, value] : answer.headers) {
    if (name.find_first_of("\r\n") != std::string::npos || value.find_first_of("\r\n") != std::string::npos)
      std::abort();
    packed |= name == "Content-Encoding";
    json |= name == "Content-Type" && value == "application/json";
  }
  if (answer.status >= 400 && (!json || packed)) std::abort();  // why, in words
  if (json && !packed && answer.status != 304 && !nlohmann::json::accept(*answer.body)) std::abort();
  return 0;
}
