// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>

#include "daemon/network.hpp"
#include "daemon/tokens.hpp"
#include "protocol/text_format.hpp"
#include "tools/kinemap/certificate.hpp"
#include "tools/kinemap/doctor.hpp"
#include "tools/kinemap/pairing.hpp"

namespace kinemap::cli {
namespace {

using Verdict = Finding::Verdict;

constexpr int kFewDays = 30;

/// A file of the daemon's, if it has one.
struct Secret {
  std::string path, text;
  bool there = false;
  bool hidden = false;  ///< this user may not read it
  std::string error;    ///< why the daemon does not take it
};

/// The one that the configuration names, or else the service's credential.
Secret secret_of(const std::string& named, const Pairing& pairing, const std::filesystem::path& credential,
                 bool vouched) {
  Secret secret;
  secret.path = !named.empty() ? named : pairing.is_service() ? credential.string() : "";
  if (secret.path.empty()) return secret;
  const bool readable = ::access(secret.path.c_str(), R_OK) == 0;
  if (!readable && errno == ENOENT && named.empty()) return secret;
  secret.there = true;
  secret.hidden = !readable && errno == EACCES;
  if (secret.hidden) return secret;
  auto text = read_secret(secret.path, vouched);
  if (text)
    secret.text = *std::move(text);
  else
    secret.error = text.error();
  return secret;
}

Finding unusable(const std::string& error) {
  return {Verdict::Problem, "access", error, "kinemapd does not start with it; `kinemap pair --renew` makes it anew"};
}

/// What is wrong with what the daemon guards itself with; nullopt: nothing.
std::optional<Finding> fault_of(const Config::Api& api, const Secret& tokens, const Secret& certificate, bool open) {
  for (const Secret* secret : {&tokens, &certificate}) {
    if (!secret->error.empty()) return unusable(secret->error);
    if (secret->hidden)
      return Finding{Verdict::Note, "access", secret->path + " may not be read by this user, and so not be checked",
                     "sudo kinemap doctor; to ask the daemon, set KINEMAP_TOKEN and KINEMAP_FINGERPRINT"};
  }
  if (tokens.there)
    if (const auto parsed = Tokens::parse(tokens.text, tokens.path); !parsed) return unusable(parsed.error());
  if ((open && (!tokens.there || !certificate.there)) || (api.auth == "always" && !tokens.there))
    return Finding{
        Verdict::Problem, "access",
        (open ? "api.address " + api.address + " lets other machines in, which wants a token and a certificate"
              : std::string("api.auth \"always\" wants a token")),
        "kinemap pair makes them; kinemapd does not start without"};
  if (!certificate.there) return std::nullopt;
  const auto days = days_left(certificate.text);
  if (!days) return unusable(certificate.path + ": " + days.error());
  if (*days >= kFewDays) return std::nullopt;
  return Finding{*days < 0 ? Verdict::Problem : Verdict::Note, "access",
                 certificate.path + (*days < 0 ? " has expired" : format(" expires in %d days", *days)),
                 "kinemap pair --renew, then open its new link on the other machines"};
}

}  // namespace

Access check_access(const Config& config, const std::string& config_path) {
  const Config::Api& api = config.api;
  const Pairing pairing(config_path);
  const auto address = parse_address(api.address);
  const bool open = !(address && is_loopback(*address)), any = api.address == "0.0.0.0" || api.address == "::";
  const Secret tokens = secret_of(api.tokens, pairing, pairing.tokens(), false);
  const Secret certificate = secret_of(api.certificate, pairing, pairing.certificate(), true);
  Access access;
  // A daemon that trusts this machine answers it in the clear.
  if (api.auth != "remote" || (open && !any)) {
    access.tls = certificate.there;
    if (auto fingerprint = fingerprint_of(certificate.text)) access.fingerprint = normal_fingerprint(*fingerprint);
    for (const char* scope : {"admin", "read"})
      if (auto token = token_in(tokens.text, scope); !token.empty()) access.token = std::move(token);
  }
  if (api.auth == "none")
    access.finding = {open ? Verdict::Note : Verdict::Ok, "access",
                      open ? format("api.auth is none: everybody who reaches port %d can read the map", api.port)
                           : std::string("this machine only, without a token"),
                      open ? "where that is not meant: kinemap pair, and take api.auth out" : ""};
  else if (auto fault = fault_of(api, tokens, certificate, open))
    access.finding = *std::move(fault);
  else
    access.finding = {Verdict::Ok, "access",
                      open ? "other machines are let in with token and TLS" : std::string("this machine only"), ""};
  return access;
}

}  // namespace kinemap::cli
