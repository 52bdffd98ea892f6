// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/pairing.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <openssl/rand.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "daemon/network.hpp"
#include "daemon/tokens.hpp"
#include "protocol/text_format.hpp"
#include "tools/kinemap/certificate.hpp"

namespace kinemap::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kDays = 825;  // what Apple's systems accept at most
constexpr int kRenewDays = 30;
// All that is written says who made it: purging the package removes that, and nothing else. PEM allows text before it.
constexpr const char* kKeyMadeBy = "kinemapd's key; made by `kinemap pair`.\n";
constexpr const char* kCertificateMadeBy = "kinemapd's certificate; made by `kinemap pair`.\n";

/// Makes the folder where there is none; only its owner may look into a new one that is to hold secrets.
std::optional<Error> make_folder(const fs::path& folder, mode_t mode) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return std::nullopt;
  if (folder.has_parent_path() && folder != folder.parent_path())
    if (auto problem = make_folder(folder.parent_path(), 0755)) return problem;
  if (::mkdir(folder.c_str(), mode) == 0) return std::nullopt;
  return Error{folder.string() + ": cannot be made: " + std::strerror(errno)};
}

/// The whole text or nothing: others see the old file until the new one is on the disk.
std::optional<Error> write_file(const fs::path& path, const std::string& text, mode_t mode) {
  const std::string draft = path.string() + ".new";
  ::unlink(draft.c_str());
  const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  const bool written = file >= 0 && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       ::fchmod(file, mode) == 0 && ::fsync(file) == 0;
  const std::string why = std::strerror(errno);
  if (file >= 0) ::close(file);
  if (written && ::rename(draft.c_str(), path.c_str()) == 0) return std::nullopt;
  ::unlink(draft.c_str());
  return Error{path.string() + ": cannot be written: " + why};
}

/// 192 random bits, as letters that need no escape in a URL.
Result<std::string> random_token() {
  std::array<unsigned char, 24> bytes{};
  if (RAND_bytes(bytes.data(), bytes.size()) != 1) return Error{"the system has no random numbers"};
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string token;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned bits = bytes[i] << 16U | bytes[i + 1] << 8U | bytes[i + 2];
    for (const unsigned shift : {18U, 12U, 6U, 0U}) token += kLetters[bits >> shift & 63U];
  }
  return token;
}

}  // namespace

std::string token_in(const std::string& text, const std::string& scope) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string first, token;
    if (words >> first >> token && first == scope) return token;
  }
  return {};
}

Pairing::Pairing(fs::path config)
    : config_(std::move(config)), secrets_(is_service() ? fs::path(kServiceCredentials) : config_.parent_path()) {}

Result<Pairing::Keys> Pairing::tokens_of(bool renew) const {
  Keys keys;
  std::string text = "# Who may ask kinemapd; made by `kinemap pair`.\n";
  if (fs::exists(tokens()) && !renew) {
    const auto old = read_secret(tokens(), false);
    if (!old) return Error{old.error()};
    if (const auto parsed = Tokens::parse(*old, tokens()); !parsed) return Error{parsed.error()};
    text = *old;
    keys.read_token = token_in(text, "read");
    keys.admin_token = token_in(text, "admin");
  }
  bool made = false;
  for (const auto& [scope, token] : {std::pair{"read", &keys.read_token}, std::pair{"admin", &keys.admin_token}}) {
    if (!token->empty()) continue;
    auto fresh = random_token();
    if (!fresh) return Error{fresh.error()};
    *token = *std::move(fresh);
    if (!text.ends_with('\n')) text += '\n';
    text += std::string(scope) + " " + *token + "\n";
    made = true;
  }
  if (made)
    if (auto error = write_file(tokens(), text, 0600)) return std::move(*error);
  return keys;
}

Result<std::string> Pairing::certificate_of(const std::vector<std::string>& names, bool renew) const {
  if (fs::exists(certificate()) && fs::exists(key()) && !renew) {
    auto old = read_secret(certificate(), /*vouched=*/true);  // no secret, but a text of the same kind
    if (!old) return old;
    const auto days = days_left(*old);
    if (!days) return Error{certificate().string() + ": " + days.error()};
    if (*days >= kRenewDays) return old;
  }
  auto made = make_self_signed(names, kDays);
  if (!made) return Error{made.error()};
  if (auto error = write_file(key(), kKeyMadeBy + made->key, 0600)) return std::move(*error);
  if (auto error = write_file(certificate(), kCertificateMadeBy + made->certificate, 0600)) return std::move(*error);
  return made->certificate;
}

Result<Pairing::Keys> Pairing::make(const std::vector<std::string>& names, bool renew) const {
  if (auto error = make_folder(secrets_, 0700)) return std::move(*error);
  auto keys = tokens_of(renew);
  if (!keys) return keys;
  auto made = certificate_of(names, renew);
  if (!made) return Error{made.error()};
  keys->certificate = *std::move(made);
  return keys;
}

Result<fs::path> Pairing::open(const std::string& address) const {
  nlohmann::ordered_json api = {{"address", address}};
  if (!is_service()) {
    api["tokens"] = tokens();
    api["certificate"] = certificate();
    api["key"] = key();
  }
  const std::string text = "// Lets other machines in; made by `kinemap pair`, taken away by `kinemap pair --off`.\n" +
                           nlohmann::ordered_json{{"api", std::move(api)}}.dump(2) + "\n";
  if (auto error = make_folder(drop_in().parent_path(), 0755)) return std::move(*error);
  if (!fs::exists(config_))
    if (auto error = write_file(config_, "{}\n", 0644)) return std::move(*error);
  if (auto error = write_file(drop_in(), text, 0644)) return std::move(*error);
  return drop_in();
}

Result<bool> Pairing::close() const {
  std::error_code error;
  const bool removed = fs::remove(drop_in(), error);
  if (error) return Error{drop_in().string() + ": cannot be removed: " + error.message()};
  return removed;
}

std::vector<std::string> own_addresses() {
  static const Network v6_link_local = *Network::parse("fe80::/10"), v4_link_local = *Network::parse("169.254.0.0/16");
  std::vector<std::string> v4, v6;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return {};
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr) continue;
    const int family = one->ifa_addr->sa_family;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (family == AF_INET)
      ::inet_ntop(family, &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr, text.data(), text.size());
    else if (family == AF_INET6)
      ::inet_ntop(family, &reinterpret_cast<const sockaddr_in6*>(one->ifa_addr)->sin6_addr, text.data(), text.size());
    const auto address = parse_address(text.data());
    if (!address || is_loopback(*address) || v6_link_local.contains(*address) || v4_link_local.contains(*address))
      continue;
    (family == AF_INET ? v4 : v6).emplace_back(text.data());
  }
  ::freeifaddrs(list);
  v4.insert(v4.end(), v6.begin(), v6.end());
  return v4;
}

std::string own_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

}  // namespace kinemap::cli
