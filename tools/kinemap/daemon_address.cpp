// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/daemon_address.hpp"

#include <cstdlib>

#include "daemon/network.hpp"
#include "tools/kinemap/certificate.hpp"

namespace kinemap::cli {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::string DaemonAddress::text() const { return (tls ? "https://" : "http://") + endpoint.text() + path; }

Result<DaemonAddress> parse_daemon_address(const std::string& url) {
  std::string rest = url;
  DaemonAddress address;
  if (const auto end = url.find("://"); end != std::string::npos) {
    const std::string scheme = url.substr(0, end);
    address.tls = scheme == "https";
    if (scheme != "http" && scheme != "https")
      return Error{url + ": expected http://HOST:PORT or https://HOST:PORT, got " + scheme + "://"};
    rest = url.substr(end + 3);
  }
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
  command
      .add_option("--token", options.token,
                  "Token to show; without it KINEMAP_TOKEN, which the list of processes does not give away")
      ->type_name("TOKEN");
  command
      .add_option("--fingerprint", options.fingerprint,
                  "With https: SHA-256 of the daemon's certificate, as `kinemap pair` prints it; without it "
                  "KINEMAP_FINGERPRINT")
      ->type_name("SHA256");
  command
      .add_option("--ca", options.ca,
                  "With https: certificates that vouch for the daemon's (PEM), instead of those the system trusts")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  return command
      .add_option("--url,--host", options.url,
                  "API of kinemapd, http or https; without it KINEMAP_URL, or else http://127.0.0.1:8765")
      ->type_name("URL");
}

Result<DaemonAddress> daemon_of(const DaemonOptions& options) {
  const std::string from_environment = options.url.empty() ? environment("KINEMAP_URL") : "";
  auto address = parse_daemon_address(options.url.empty() ? from_environment : options.url);
  if (!address) return Error{(from_environment.empty() ? "--url: " : "KINEMAP_URL: ") + address.error()};
  address->token = options.token.empty() ? environment("KINEMAP_TOKEN") : options.token;
  address->ca = options.ca;
  if (address->token.find_first_of(" \t\r\n") != std::string::npos)
    return Error{"KINEMAP_TOKEN: expected one word without blanks or line ends"};
  const auto host = parse_address(address->endpoint.host);
  if (!address->token.empty() && !address->tls && address->endpoint.host != "localhost" &&
      !(host && is_loopback(*host)))
    return Error{address->text() + ": a token is not sent in the clear; use https://" + address->endpoint.text()};
  const std::string pinned = options.fingerprint.empty() ? environment("KINEMAP_FINGERPRINT") : options.fingerprint;
  if (pinned.empty()) return address;
  address->fingerprint = normal_fingerprint(pinned);
  if (address->fingerprint.empty())
    return Error{"--fingerprint, KINEMAP_FINGERPRINT: expected a SHA-256 fingerprint, 64 hexadecimal digits"};
  return address;
}

}  // namespace kinemap::cli
