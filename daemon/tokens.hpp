// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap {

/// What the bearer of a token may do; each may also do what those before it may.
enum class Scope { Nothing, Read, Admin };

using TokenHash = std::array<unsigned char, 32>;  ///< SHA-256
TokenHash hash_of(std::string_view token);

/// The tokens that the daemon accepts. It keeps their hashes only.
class Tokens {
 public:
  /// Lines of "read TOKEN" or "admin TOKEN"; empty ones and those that begin with # are left out. A token has 20 to 200
  /// letters, digits and -._~+/=. Errors name the line, never what stands there. `path` is for the messages only.
  static Result<Tokens> parse(const std::string& text, const std::string& path);

  [[nodiscard]] bool empty() const { return tokens_.empty(); }
  /// Takes as long for a token that is nearly right as for any other.
  [[nodiscard]] Scope scope_of(const TokenHash& token) const;

 private:
  struct Token {
    TokenHash hash;
    Scope scope;
  };
  std::vector<Token> tokens_;
};

/// The text of a file that only its owner may read; an Error when others may. `vouched`: whoever put it there has seen
/// to that (systemd's credentials).
Result<std::string> read_secret(const std::string& path, bool vouched);

}  // namespace kinemap
