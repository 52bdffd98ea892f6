// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "daemon/config.hpp"
#include "daemon/network.hpp"
#include "protocol/json_text.hpp"
#include "tools/kinemap/certificate.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/endpoint.hpp"
#include "tools/kinemap/pairing.hpp"
#include "tools/kinemap/qr_text.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  std::string config;
  std::string address = "0.0.0.0";
  std::string host;
  bool admin = false;
  bool renew = false;
  bool off = false;
  bool json = false;
};

/// The service's for root, else one of the user's own.
std::filesystem::path default_config() {
  if (::geteuid() == 0) return kServiceConfig;
  const char* const folder = std::getenv("XDG_CONFIG_HOME");
  const char* const home = std::getenv("HOME");
  if (folder != nullptr && *folder == '/') return std::filesystem::path(folder) / "kinemap" / "config.json";
  return std::filesystem::path(home != nullptr ? home : "/") / ".config" / "kinemap" / "config.json";
}

std::string to_take_effect(const Pairing& pairing) {
  return pairing.is_service() ? "sudo systemctl restart kinemapd" : "kinemapd --config " + pairing.config().string();
}

int switch_off(const Pairing& pairing) {
  const auto closed = pairing.close();
  if (!closed) return fail("pair", closed.error());
  if (!*closed) return print("pair", "Remote access is off already: there is no " + pairing.drop_in().string() + "\n");
  return print("pair", "Remote access is switched off. To take effect:\n\n    " + to_take_effect(pairing) + "\n");
}

/// Everything that a person, a browser or another `kinemap` needs.
std::string instructions(const Pairing& pairing, const std::string& url, const std::string& token,
                         const std::string& fingerprint) {
  const std::string link = url + "/#token=" + token;
  return "Remote access is switched on. To take effect:\n\n    " + to_take_effect(pairing) +
         "\n\nOn a phone or laptop, open\n\n    " + link + "\n\n" + qr_text(link, ::isatty(STDOUT_FILENO) == 1) +
         "\nThe browser warns once, since the certificate vouches for itself; its SHA-256 fingerprint must be\n\n    " +
         fingerprint + "\n\nFor `kinemap` on another machine:\n\n    export KINEMAP_URL=" + url +
         "\n    export KINEMAP_TOKEN=" + token + "\n    export KINEMAP_FINGERPRINT=" + fingerprint +
         "\n\nWho has the token can read the map. `kinemap pair` shows it again, `--renew` makes another, `--off` "
         "keeps "
         "others out.\n";
}

int pair(const Options& options) {
  const Pairing pairing(options.config.empty() ? default_config() : std::filesystem::absolute(options.config));
  if (options.off) return switch_off(pairing);
  const auto address = parse_address(options.address);
  if (!address || is_loopback(*address))
    return fail("pair",
                "--address: expected one of this machine's addresses that others reach, or 0.0.0.0 or ::", kUsage);

  auto names = own_addresses();
  const std::string host = !options.host.empty() ? options.host : names.empty() ? own_name() : names.front();
  names.insert(names.begin(), {own_name(), own_name() + ".local", "localhost", "127.0.0.1"});
  if (!options.host.empty()) names.insert(names.begin(), options.host);
  const auto keys = pairing.make(names, options.renew);
  if (!keys) return fail("pair", keys.error());
  const auto fingerprint = fingerprint_of(keys->certificate);
  if (!fingerprint) return fail("pair", pairing.certificate().string() + ": " + fingerprint.error());
  const auto drop_in = pairing.open(options.address);
  if (!drop_in) return fail("pair", drop_in.error());
  const auto config = config_from_file(pairing.config());
  if (!config) return fail("pair", config.error());

  const std::string url = "https://" + Endpoint{host, config->api.port}.text();
  const std::string& token = options.admin ? keys->admin_token : keys->read_token;
  if (!options.json) return print("pair", instructions(pairing, url, token, *fingerprint));
  return print("pair", pretty_text({{"url", url},
                                    {"token", token},
                                    {"fingerprint", *fingerprint},
                                    {"config", pairing.config().string()},
                                    {"drop_in", drop_in->string()}}));
}

}  // namespace

void add_pair(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "pair",
                  "Let a phone or another machine ask the daemon: makes a token and a certificate, shows a QR code",
                  "  sudo kinemap pair && sudo systemctl restart kinemapd\n"
                  "  kinemap pair --config ~/kinemap/config.json --host wearable.local\n",
                  options, pair);
  command
      ->add_option(
          "--config", options->config,
          "The daemon's configuration; conf.d/remote.json beside it is written. Without it that of the service "
          "(for root), or else ~/.config/kinemap/config.json")
      ->type_name("FILE");
  command->add_option("--address", options->address, "Address to listen on; 0.0.0.0 is every IPv4 interface")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_option("--host", options->host, "Name or address in the URL; without it the first of this machine's")
      ->type_name("HOST");
  command->add_flag("--admin", options->admin, "Show the token that may also change something");
  command->add_flag("--renew", options->renew, "Make tokens and certificate anew: those who had the old ones are out");
  command->add_flag("--off", options->off, "Switch remote access off; tokens and certificate stay");
  command->add_flag("--json", options->json, "Print url, token and fingerprint as JSON");
}

}  // namespace kinemap::cli
