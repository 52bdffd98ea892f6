// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/types.h>

#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap::cli {

/// A certificate that vouches for itself, and its key (P-256), both PEM.
struct SelfSigned {
  std::string certificate;
  std::string key;
};

/// For servers that are reached by any of `names` (host names and addresses); the first is what people are shown. It
/// holds from now on for so many days.
Result<SelfSigned> make_self_signed(const std::vector<std::string>& names, int days);

/// SHA-256 of a certificate as browsers and OpenSSL show it: "5F:0C:…", 32 bytes.
Result<std::string> fingerprint_of(const std::string& certificate_pem);
std::string fingerprint_of(const X509* certificate);
/// The same fingerprint with or without colons, in either case; empty when it is none.
std::string normal_fingerprint(const std::string& text);

/// Days until the certificate expires, negative once it has; an Error when it is none.
Result<int> days_left(const std::string& certificate_pem);

}  // namespace kinemap::cli
