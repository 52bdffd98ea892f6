// SPDX-License-Identifier: Apache-2.0
#include "daemon/config_reader.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "daemon/network.hpp"

namespace kinemap {

bool is_address_or_network(const std::string& text) { return Network::parse(text).has_value(); }

bool is_host_name(const std::string& text) {
  const auto is = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_'; };
  return !text.empty() && std::all_of(text.begin(), text.end(), is);
}

/// A scheme, a host, perhaps a port; no path, since browsers send none.
bool is_origin(const std::string& text) {
  const auto host = text.find("://");
  if (host == std::string::npos || host == 0 || text.size() == host + 3) return false;
  return text.find_first_of("/?# \t", host + 3) == std::string::npos;
}

std::string describe(const Range& range) {
  char text[96];
  const bool plain =
      std::string(range.unit) == "1" || std::string(range.unit) == "id" || std::string(range.unit) == "port";
  std::snprintf(text, sizeof text, "%.10g to %.10g%s%s", range.min, range.max, plain ? "" : " ",
                plain ? "" : range.unit);
  return text;
}

std::string describe(std::initializer_list<const char*> allowed) {
  std::string text;
  for (const char* item : allowed) text += (text.empty() ? "\"" : ", \"") + std::string(item) + "\"";
  return text;
}

const ConfigReader::Json* ConfigReader::find(const char* key) {
  known_.emplace_back(key);
  if (error_) return nullptr;
  const auto it = json_.find(key);
  return it == json_.end() ? nullptr : &*it;
}

void ConfigReader::flag(const char* key, bool& target) {
  const Json* value = find(key);
  if (value == nullptr) return;
  if (!value->is_boolean()) return fail(path_of(key), "must be true or false, not " + shown(*value));
  target = value->get<bool>();
}

void ConfigReader::choice(const char* key, std::string& target, std::initializer_list<const char*> allowed) {
  const Json* value = find(key);
  if (value == nullptr) return;
  const auto is = [&](const char* item) { return value->is_string() && value->get_ref<const std::string&>() == item; };
  if (std::none_of(allowed.begin(), allowed.end(), is))
    return fail(path_of(key), "must be one of " + describe(allowed) + ", not " + shown(*value));
  target = value->get<std::string>();
}

void ConfigReader::address(const char* key, std::string& target) {
  const Json* value = find(key);
  if (value == nullptr) return;
  const std::string text = value->is_string() ? value->get<std::string>() : std::string();
  in6_addr ignored{};
  if (inet_pton(AF_INET, text.c_str(), &ignored) != 1 && inet_pton(AF_INET6, text.c_str(), &ignored) != 1)
    return fail(path_of(key), std::string("must be ") + kAddressAllowed + " in quotes, not " + shown(*value));
  target = text;
}

void ConfigReader::path(const char* key, std::string& target) {
  const Json* value = find(key);
  if (value == nullptr) return;
  const std::string text = value->is_string() ? value->get<std::string>() : "?";
  if (!text.empty() && !text.starts_with('/'))
    return fail(path_of(key), std::string("must be ") + kPathAllowed + ", not " + shown(*value));
  target = text;
}

void ConfigReader::list(const char* key, std::vector<std::string>& target, const ListOf& of) {
  const Json* value = find(key);
  if (value == nullptr) return;
  if (!value->is_array()) return fail(path_of(key), std::string("must be ") + of.allowed + ", not " + shown(*value));
  std::vector<std::string> items;
  for (const Json& item : *value) {
    if (!item.is_string() || !of.matches(item.get_ref<const std::string&>()))
      return fail(path_of(key), shown(item) + " is wrong there; it must be " + of.allowed);
    items.push_back(item.get<std::string>());
  }
  target = std::move(items);
}

void ConfigReader::at_most(const char* key, double value, const char* bound_key, double bound) {
  if (value <= bound) return;
  fail(path_of(key),
       Json(value).dump() + " is more than " + bound_key + " (" + Json(bound).dump() + "), which it may not be");
}

std::string ConfigReader::shown(const Json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list";
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 60) + "…";
  return text;
}

void ConfigReader::fail(const std::string& path, const std::string& message) {
  if (!error_) error_ = path + ": " + message;
}

void ConfigReader::refuse_unknown() {
  for (const auto& [key, value] : json_.items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::string allowed;
    for (const auto& name : known_) allowed += (allowed.empty() ? "" : ", ") + name;
    return fail(path_of(key), "unknown key; allowed here: " + allowed);
  }
}

}  // namespace kinemap
