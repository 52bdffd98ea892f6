// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/daemon_address.hpp"

#include <cstdlib>

namespace kinemap::cli {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::string DaemonAddress::text() const { return "http://" + endpoint.text() + path; }

Result<DaemonAddress> parse_daemon_address(const std::string& url) {
  std::string rest = url;
  if (const auto end = url.find("://"); end != std::string::npos) {
    const std::string scheme = url.substr(0, end);
    if (scheme == "https")
      return Error{url +
                   ": https is not supported yet; go through a tunnel: ssh -L 8765:127.0.0.1:8765 HOST, then --url "
                   "http://127.0.0.1:8765"};
    if (scheme != "http") return Error{url + ": expected http://HOST:PORT, got " + scheme + "://"};
    rest = url.substr(end + 3);
  }
  DaemonAddress address;
  const auto slash = std::min(rest.find('/'), rest.size());
  address.path = rest.substr(slash);
  while (address.path.ends_with('/')) address.path.pop_back();
  if (address.path.find_first_of("?# \t\r\n") != std::string::npos)
    return Error{url + ": expected http://HOST:PORT, without a query"};
  auto endpoint = parse_endpoint(rest.substr(0, slash), "127.0.0.1", kApiPort);
  if (!endpoint) return Error{endpoint.error()};
  address.endpoint = *std::move(endpoint);
  return address;
}

CLI::Option* add_daemon_options(CLI::App& command, DaemonOptions& options) {
  return command
      .add_option("--url,--host", options.url,
                  "API of kinemapd; without it KINEMAP_URL, or else http://127.0.0.1:8765. KINEMAP_TOKEN goes with it")
      ->type_name("URL");
}

Result<DaemonAddress> daemon_of(const DaemonOptions& options) {
  const std::string from_environment = options.url.empty() ? environment("KINEMAP_URL") : "";
  auto address = parse_daemon_address(options.url.empty() ? from_environment : options.url);
  if (!address) return Error{(from_environment.empty() ? "--url: " : "KINEMAP_URL: ") + address.error()};
  address->token = environment("KINEMAP_TOKEN");
  if (address->token.find_first_of(" \t\r\n") != std::string::npos)
    return Error{"KINEMAP_TOKEN: expected one word without blanks or line ends"};
  return address;
}

}  // namespace kinemap::cli
