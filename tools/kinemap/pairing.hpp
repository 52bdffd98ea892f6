// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// Where the service has its configuration and where systemd looks for its credentials.
inline constexpr const char* kServiceConfig = "/etc/kinemap/config.json";
inline constexpr const char* kServiceCredentials = "/etc/credstore";

/// What opens a daemon to others: files that only their owner may read, and one that switches it on.
class Pairing {
 public:
  /// For the daemon with this configuration; the service's secrets are systemd credentials, others lie beside the file.
  explicit Pairing(std::filesystem::path config);

  struct Keys {
    std::string read_token, admin_token;
    std::string certificate;  ///< PEM
  };
  /// Makes what is missing, or all of it anew; the certificate is for `names` and made anew a month before it expires.
  Result<Keys> make(const std::vector<std::string>& names, bool renew) const;
  /// Writes the file that lets others in at `address`.
  [[nodiscard]] Result<std::filesystem::path> open(const std::string& address) const;
  /// Takes it away; whether there was one.
  [[nodiscard]] Result<bool> close() const;

  [[nodiscard]] bool is_service() const { return config_ == kServiceConfig; }
  [[nodiscard]] const std::filesystem::path& config() const { return config_; }
  [[nodiscard]] std::filesystem::path tokens() const { return secrets_ / "kinemap.tokens"; }
  [[nodiscard]] std::filesystem::path certificate() const { return secrets_ / "kinemap.crt"; }
  [[nodiscard]] std::filesystem::path key() const { return secrets_ / "kinemap.key"; }
  [[nodiscard]] std::filesystem::path drop_in() const { return config_.parent_path() / "conf.d" / "remote.json"; }

 private:
  Result<Keys> tokens_of(bool renew) const;
  Result<std::string> certificate_of(const std::vector<std::string>& names, bool renew) const;

  std::filesystem::path config_, secrets_;
};

/// The first token of that scope in a file of tokens that is right; empty when there is none.
std::string token_in(const std::string& text, const std::string& scope);

/// This machine's addresses but loopback and link-local ones, IPv4 first, and its name.
std::vector<std::string> own_addresses();
std::string own_name();

}  // namespace kinemap::cli
