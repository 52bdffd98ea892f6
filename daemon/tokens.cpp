// SPDX-License-Identifier: Apache-2.0
#include "daemon/tokens.hpp"

#include <fcntl.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <sstream>

namespace kinemap {
namespace {

constexpr std::size_t kShortest = 20, kLongest = 200;
constexpr std::size_t kLargestFile = 1 << 20;

bool is_token(const std::string& text) {
  const auto is = [](unsigned char c) { return std::isalnum(c) != 0 || std::strchr("-._~+/=", c) != nullptr; };
  return text.size() >= kShortest && text.size() <= kLongest && std::all_of(text.begin(), text.end(), is);
}

}  // namespace

TokenHash hash_of(std::string_view token) {
  TokenHash hash;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), hash.data());
  return hash;
}

Result<Tokens> Tokens::parse(const std::string& text, const std::string& path) {
  Tokens tokens;
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream words(line);
    std::string scope, token, more;
    if (!(words >> scope) || scope.starts_with('#')) continue;
    if ((scope != "read" && scope != "admin") || !(words >> token) || words >> more || !is_token(token))
      return Error{path + ": line " + std::to_string(number) +
                   ": expected \"read TOKEN\" or \"admin TOKEN\", the token 20 to 200 letters, digits and -._~+/="};
    tokens.tokens_.push_back({hash_of(token), scope == "admin" ? Scope::Admin : Scope::Read});
  }
  if (tokens.empty())
    return Error{path + ": there is no token in it; `kinemap pair` makes one, or `echo read $(openssl rand -hex 32)`"};
  return tokens;
}

Scope Tokens::scope_of(const TokenHash& token) const {
  Scope scope = Scope::Nothing;
  for (const Token& known : tokens_)
    if (CRYPTO_memcmp(token.data(), known.hash.data(), token.size()) == 0) scope = std::max(scope, known.scope);
  return scope;
}

Result<std::string> read_secret(const std::string& path, bool vouched) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat info {};
  if (file < 0 || ::fstat(file, &info) != 0) {
    const std::string why = std::strerror(errno);
    if (file >= 0) ::close(file);
    return Error{path + ": cannot be read: " + why};
  }
  std::string text(kLargestFile, '\0');
  const ssize_t size = S_ISREG(info.st_mode) ? ::read(file, text.data(), text.size()) : -1;
  ::close(file);
  if (size < 0) return Error{path + ": cannot be read as a file"};
  if (!vouched && (info.st_mode & 077) != 0) {
    char mode[8];
    std::snprintf(mode, sizeof mode, "%04o", info.st_mode & 07777U);
    return Error{path + ": others may read or write it (mode " + mode + "); it holds a secret: chmod 600 " + path};
  }
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace kinemap
