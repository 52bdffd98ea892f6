// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/doctor.hpp"
#include "tools/kinemap/pairing.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

using Json = nlohmann::ordered_json;
using Verdict = Finding::Verdict;

struct Options {
  DaemonOptions daemon;
  std::string config;
  double listen_s = 1.0;
  bool json = false;
};

const char* to_string(Verdict verdict) {
  return verdict == Verdict::Ok ? "ok" : verdict == Verdict::Note ? "note" : "problem";
}

/// The configuration in force, or, when it is wrong, the defaults: the other checks still tell something.
Config read_config(const std::string& path, Findings& findings) {
  if (path.empty()) {
    findings.push_back({Verdict::Ok, "config", "no file; everything has its default", ""});
    return {};
  }
  auto config = config_from_file(path);
  if (config)
    findings.push_back({Verdict::Ok, "config", path + " is right", ""});
  else
    findings.push_back({Verdict::Problem, "config", config.error(), "mend it; kinemapd does not start with it"});
  return config ? *config : Config{};
}

/// The file that was named, or else the service's; empty when there is none.
std::string config_path(const Options& options) {
  std::error_code ignored;
  if (!options.config.empty()) return options.config;
  return std::filesystem::exists(kServiceConfig, ignored) ? kServiceConfig : "";
}

/// The daemon that was named, or the one that the configuration makes, with what that one wants to be shown.
Result<DaemonAddress> daemon_address(const Options& options, const Config& config, const Access& access) {
  auto daemon = daemon_of(options.daemon);
  if (!daemon || !options.daemon.url.empty() || std::getenv("KINEMAP_URL") != nullptr) return daemon;
  const bool any = config.api.address == "0.0.0.0" || config.api.address == "::";
  daemon->endpoint = {any ? "127.0.0.1" : config.api.address, config.api.port};
  daemon->tls = access.tls;
  if (daemon->token.empty()) daemon->token = access.token;
  if (daemon->fingerprint.empty()) daemon->fingerprint = access.fingerprint;
  return daemon;
}

std::string findings_text(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += format("%-8s %-9s %s\n", to_string(finding.verdict), finding.subject.c_str(), finding.text.c_str());
    if (!finding.advice.empty()) text += format("%19s→ %s\n", "", finding.advice.c_str());
  }
  return text;
}

std::string findings_json(const Findings& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"verdict", to_string(finding.verdict)}, {"subject", finding.subject}, {"text", finding.text}});
    if (!finding.advice.empty()) list.back()["advice"] = finding.advice;
  }
  return pretty_text({{"findings", std::move(list)}});
}

int doctor(const Options& options) {
  Findings findings;
  const std::string path = config_path(options);
  const Config config = read_config(path, findings);
  const Access access = check_access(config, path);
  const auto daemon = daemon_address(options, config, access);
  if (!daemon) return fail("doctor", daemon.error(), kUsage);
  findings.push_back(access.finding);
  findings.push_back(check_service());
  Json status;
  findings.push_back(check_daemon(config, *daemon, status));
  for (auto& finding : check_suit(config, status, options.listen_s)) findings.push_back(std::move(finding));
  findings.push_back(check_firewall(config));
  findings.push_back(check_receive_buffer(config));
  findings.push_back(check_clock());
  findings.push_back(check_disk(config));
  const int printed = print("doctor", options.json ? findings_json(findings) : findings_text(findings));
  const auto is_problem = [](const Finding& finding) { return finding.verdict == Verdict::Problem; };
  return std::any_of(findings.begin(), findings.end(), is_problem) ? kFailed : printed;
}

}  // namespace

void add_doctor(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "doctor", "What keeps Kinemap from mapping on this machine, and what to do about it",
      "  kinemap doctor\n"
      "  kinemap doctor --config my.json --listen 10\n"
      "\nChecks configuration, access, service, daemon, suit, firewall, receive buffer, clock and disk. Where "
      "no kinemapd runs,\nit listens to the suit's port itself: as root beside everything else, else so "
      "that kinemapd cannot\nstart meanwhile. Exit code 1 when there is a problem; notes are none.\n",
      options, doctor);
  add_daemon_options(*command, options->daemon);
  command
      ->add_option("--config", options->config,
                   std::string("Configuration file; without it ") + kServiceConfig + " where it exists")
      ->type_name("FILE");
  command->add_option("--listen", options->listen_s, "Where no kinemapd runs: wait so long for the suit, s")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print the findings as JSON");
}

}  // namespace kinemap::cli
