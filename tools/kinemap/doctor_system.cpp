// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "protocol/text_format.hpp"
#include "tools/kinemap/doctor.hpp"
#include "tools/kinemap/pairing.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

constexpr std::time_t kSurelyPast = 1735689600;  // 2025-01-01: a clock before it was never set
const fs::path kServiceState = "/var/lib/kinemap";

/// What a command prints; empty when it cannot be run.
std::string output_of(const char* command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command, "r"), ::pclose);
  std::string text;
  char buffer[4096];
  for (std::size_t n; pipe && (n = std::fread(buffer, 1, sizeof buffer, pipe.get())) > 0;) text.append(buffer, n);
  return text;
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// "KEY=VALUE" lines.
std::map<std::string, std::string> properties(const std::string& text) {
  std::map<std::string, std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (const auto equals = line.find('='); equals != std::string::npos)
      out[line.substr(0, equals)] = line.substr(equals + 1);
  return out;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

Finding firewall(const std::string& which, const std::string& command) {
  return {Verdict::Note, "firewall", which + " is on; the suit, and clients from elsewhere, must be let in", command};
}

/// The nearest folder that there is: what a new one would be made in.
fs::path existing(const fs::path& wanted) {
  std::error_code ignored;
  fs::path path = fs::absolute(wanted, ignored);
  while (!is_there(path) && path.has_relative_path()) path = path.parent_path();
  return path;
}

/// A credential that is newer than the service, which goes by the one that was there at its start. Only root sees them.
std::optional<fs::path> credential_since(double started_s) {
  for (const char* name : {"kinemap.tokens", "kinemap.crt", "kinemap.key"}) {
    const fs::path path = fs::path(kServiceCredentials) / name;
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0 && static_cast<double>(info.st_mtim.tv_sec) > started_s) return path;
  }
  return std::nullopt;
}

}  // namespace

Finding check_service() {
  if (!is_there("/run/systemd/system")) return {Verdict::Ok, "service", "systemd does not run here", ""};
  auto unit =
      properties(output_of("systemctl show kinemapd.service -p LoadState -p ActiveState -p UnitFileState -p NRestarts "
                           "-p Result -p ExecMainStartTimestamp --timestamp=unix 2>/dev/null"));
  if (unit["LoadState"] != "loaded")
    return {Verdict::Note, "service", "kinemapd.service is not installed",
            "install the Debian package, or run kinemapd by hand"};
  if (unit["ActiveState"] == "failed")
    return {Verdict::Problem, "service", "kinemapd.service has failed (" + unit["Result"] + ")",
            "journalctl -u kinemapd -n 30 says why; then sudo systemctl restart kinemapd"};
  if (unit["ActiveState"] != "active")
    return {Verdict::Note, "service", "kinemapd.service is " + unit["ActiveState"], "sudo systemctl start kinemapd"};
  const std::string started = unit["ExecMainStartTimestamp"];  // "@1700000000"
  if (const auto newer = started.size() > 1 ? credential_since(std::atof(started.c_str() + 1)) : std::nullopt)
    return {Verdict::Problem, "service",
            newer->string() +
                " is newer than the service, which goes by the one before: tokens that were taken back "
                "are still good",
            "sudo systemctl restart kinemapd; the session goes on"};
  if (unit["UnitFileState"] != "enabled")
    return {Verdict::Note, "service", "kinemapd.service runs, but will not after the next boot",
            "sudo systemctl enable kinemapd"};
  if (unit["NRestarts"] != "0")
    return {Verdict::Note, "service", "kinemapd.service runs, but was started again " + unit["NRestarts"] + " times",
            "journalctl -u kinemapd -p warning says why"};
  return {Verdict::Ok, "service", "kinemapd.service runs and is started at boot", ""};
}

Finding check_firewall(const Config& config) {
  const std::string suit = std::to_string(config.suit.port) + "/" + config.suit.transport;
  if (text_of("/etc/ufw/ufw.conf").find("ENABLED=yes") != std::string::npos)
    return firewall("ufw", "sudo ufw allow " + suit);
  if (is_there("/run/firewalld"))
    return firewall("firewalld", "sudo firewall-cmd --permanent --add-port=" + suit + " && sudo firewall-cmd --reload");
  const std::string rules = output_of("nft list ruleset 2>/dev/null");
  const bool drops = rules.find("policy drop") != std::string::npos || rules.find("reject") != std::string::npos;
  if (drops && rules.find("hook input") != std::string::npos)
    return firewall("nftables", "sudo nft list ruleset; add: " + config.suit.transport + " dport " +
                                    std::to_string(config.suit.port) + " accept");
  if (text_of("/proc/net/ip_tables_names").find("filter") != std::string::npos)
    return firewall("iptables", "sudo iptables -L INPUT -n; add: -p " + config.suit.transport + " --dport " +
                                    std::to_string(config.suit.port) + " -j ACCEPT");
  return {Verdict::Ok, "firewall", ::geteuid() == 0 ? "none seen" : "none seen (root sees more)", ""};
}

Finding check_receive_buffer(const Config& config) {
  int granted = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> granted;
  if (granted == 0 || granted >= config.suit.receive_buffer_bytes)
    return {Verdict::Ok, "buffer", "the kernel grants the receive buffer that is asked for", ""};
  return {Verdict::Note, "buffer",
          format("the kernel grants a receive buffer of %d bytes instead of %d: bursts may be lost", granted,
                 config.suit.receive_buffer_bytes),
          format("echo net.core.rmem_max=%d | sudo tee /etc/sysctl.d/60-kinemap.conf && sudo sysctl --system",
                 config.suit.receive_buffer_bytes)};
}

Finding check_clock() {
  if (std::time(nullptr) < kSurelyPast)
    return {Verdict::Problem, "clock", "the clock was never set", "sudo timedatectl set-time '2026-01-31 12:00:00'"};
  timex state{};
  if (::adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0)
    return {Verdict::Ok, "clock", "synchronised", ""};
  return {Verdict::Note, "clock", "not synchronised: sessions are named by it, and clients compare with theirs",
          "sudo timedatectl set-ntp true, or install chrony"};
}

Finding check_disk(const Config& config) {
  const bool by_systemd = config.journal.directory.empty();
  if (by_systemd && !is_there(kServiceState))
    return {Verdict::Note, "disk", "sessions are kept by the service only: journal.directory is not set",
            "set it where kinemapd runs by hand"};
  const fs::path directory = by_systemd ? kServiceState : fs::path(config.journal.directory);
  std::error_code error;
  const fs::path there = by_systemd ? "/var/lib" : existing(directory);
  const auto space = fs::space(there, error);
  if (error) return {Verdict::Problem, "disk", directory.string() + ": " + error.message(), "is it mounted?"};
  const double free_mb = static_cast<double>(space.available) / 1048576.0;
  const std::string text = format("%.1f GiB free for the sessions in %s", free_mb / 1024.0, directory.c_str());
  if (free_mb < config.journal.min_free_mb)
    return {Verdict::Problem, "disk",
            text + format(": less than journal.min_free_mb (%.0f MiB)", config.journal.min_free_mb),
            "make room; until then the map is in memory only"};
  // The service's user is nobody's; systemd sees to its folder.
  if (!by_systemd && ::access(there.c_str(), W_OK | X_OK) != 0)
    return {Verdict::Problem, "disk", there.string() + " may not be written by this user",
            "sudo chown the folder to who runs kinemapd, or set another journal.directory"};
  return {Verdict::Ok, "disk", text, ""};
}

}  // namespace kinemap::cli
