// SPDX-License-Identifier: Apache-2.0
#include "daemon/security.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "daemon/network.hpp"

namespace kinemap {
namespace {

namespace ssl = net::ssl;

constexpr int kDaysLeft = 30;  // of the certificate, at which the log begins to say so

/// A file that the configuration names, or else the credential of that name.
struct Source {
  std::string path;  ///< empty: there is none
  bool vouched = false;
};

Source source_of(const std::string& configured, const char* credential) {
  if (!configured.empty()) return {configured, false};
  const char* const folder = std::getenv("CREDENTIALS_DIRECTORY");  // systemd's LoadCredential=
  if (folder == nullptr) return {};
  const std::string path = std::string(folder) + "/" + credential;
  return std::filesystem::exists(path) ? Source{path, true} : Source{};
}

Result<Tokens> load_tokens(const Source& source) {
  if (source.path.empty()) return Tokens{};
  const auto text = read_secret(source.path, source.vouched);
  if (!text) return Error{text.error()};
  return Tokens::parse(*text, source.path);
}

/// What OpenSSL has to say of the last thing that failed.
std::string tls_error() {
  char text[256];
  ERR_error_string_n(ERR_get_error(), text, sizeof text);
  ERR_clear_error();
  return text;
}

void warn_of_expiry(const ssl::context& context, const std::string& path) {
  const X509* const certificate = SSL_CTX_get0_certificate(const_cast<ssl::context&>(context).native_handle());
  int days = 0, seconds = 0;
  if (ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate)) != 1 || days >= kDaysLeft) return;
  if (days < 0 || seconds < 0)
    spdlog::warn("api: the certificate {} has expired; `kinemap pair --renew` makes another", path);
  else
    spdlog::warn("api: the certificate {} expires in {} days; `kinemap pair --renew` makes another", path, days);
}

/// TLS 1.2 with forward secrecy and authenticated encryption, or 1.3.
Result<std::shared_ptr<ssl::context>> load_tls(const Source& certificate, const Source& key) {
  if (certificate.path.empty() && key.path.empty()) return std::shared_ptr<ssl::context>();
  if (certificate.path.empty() || key.path.empty())
    return Error{std::string(certificate.path.empty() ? "api.certificate" : "api.key") +
                 " is missing: TLS wants a certificate and its key; `kinemap pair` makes both"};
  const auto secret = read_secret(key.path, key.vouched);
  if (!secret) return Error{secret.error()};
  auto context = std::make_shared<ssl::context>(ssl::context::tls_server);
  SSL_CTX* const native = context->native_handle();
  SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_cipher_list(native, "ECDHE+AESGCM:ECDHE+CHACHA20");
  ERR_clear_error();
  if (SSL_CTX_use_certificate_chain_file(native, certificate.path.c_str()) != 1)
    return Error{certificate.path + ": cannot be used as a certificate (PEM): " + tls_error()};
  ErrorCode error;
  context->use_private_key(net::buffer(*secret), ssl::context::pem, error);
  if (error) return Error{key.path + ": cannot be used as the key of " + certificate.path + ": " + error.message()};
  warn_of_expiry(*context, certificate.path);
  return context;
}

/// Why nobody else may reach a server so configured; empty when they may.
std::string missing(const Config::Api& config, bool loopback_only, bool tokens, bool tls) {
  if (config.auth == "none") return {};
  const std::string what = !tokens && !tls ? "a token and a TLS certificate"
                           : !tokens       ? "a token"
                                           : "a TLS certificate";
  if (loopback_only)
    return config.auth == "always" && !tokens ? "api.auth \"always\" wants a token: set api.tokens" : "";
  if (tokens && tls) return {};
  return "api.address " + config.address + " lets other machines in, which wants " + what +
         " first: `kinemap pair` makes them (or set api.tokens, api.certificate and api.key); api.address 127.0.0.1 "
         "keeps "
         "others out; \"api\": {\"auth\": \"none\"} opens the map to everybody who reaches port " +
         std::to_string(config.port);
}

}  // namespace

Result<Security> load_security(const Config::Api& config) {
  const auto address = parse_address(config.address);
  const bool loopback_only = address && is_loopback(*address);
  const Source token_file = source_of(config.tokens, "kinemap.tokens");
  const Source certificate = source_of(config.certificate, "kinemap.crt"), key = source_of(config.key, "kinemap.key");
  auto tokens = load_tokens(token_file);
  if (!tokens) return Error{tokens.error()};
  auto tls = load_tls(certificate, key);
  if (!tls) return Error{tls.error()};
  if (auto lack = missing(config, loopback_only, !tokens->empty(), *tls != nullptr); !lack.empty()) return Error{lack};
  return Security{WebPolicy(config, *std::move(tokens), loopback_only, *tls != nullptr), *std::move(tls),
                  token_file.vouched || certificate.vouched || key.vouched};
}

}  // namespace kinemap
