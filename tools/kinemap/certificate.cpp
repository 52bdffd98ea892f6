// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/certificate.hpp"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <array>
#include <cctype>
#include <memory>

#include "daemon/network.hpp"
#include "protocol/text_format.hpp"

namespace kinemap::cli {
namespace {

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* thing) const {
    Free(thing);
  }
};
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Memory = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;

Error failed(const char* what) {
  std::array<char, 256> why{};
  ERR_error_string_n(ERR_get_error(), why.data(), why.size());
  return Error{std::string(what) + ": " + why.data()};
}

std::string text_of(BIO* memory) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory, &data);
  return {data, static_cast<std::size_t>(size)};
}

bool extend(X509* certificate, int nid, const std::string& value) {
  const Extension extension(X509V3_EXT_conf_nid(nullptr, nullptr, nid, value.c_str()));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

bool set_identity(X509* certificate, EVP_PKEY* key, const std::string& name, int days) {
  std::array<unsigned char, 16> serial{};
  if (RAND_bytes(serial.data(), serial.size()) != 1) return false;
  serial[0] &= 0x7f;  // positive
  const std::unique_ptr<BIGNUM, Freed<BN_free>> number(BN_bin2bn(serial.data(), serial.size(), nullptr));
  X509_NAME* const subject = X509_get_subject_name(certificate);
  const auto add = [&](const char* field, const std::string& text) {
    return X509_NAME_add_entry_by_txt(subject, field, MBSTRING_UTF8,
                                      reinterpret_cast<const unsigned char*>(text.data()),
                                      static_cast<int>(text.size()), -1, 0) == 1;
  };
  constexpr long kDayS = 86400;
  return X509_set_version(certificate, X509_VERSION_3) == 1 &&
         BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr && add("O", "Kinemap") &&
         add("CN", name.substr(0, 64)) && X509_set_issuer_name(certificate, subject) == 1 &&
         X509_gmtime_adj(X509_getm_notBefore(certificate), -kDayS / 24) != nullptr &&  // clocks differ
         X509_gmtime_adj(X509_getm_notAfter(certificate), days * kDayS) != nullptr &&
         X509_set_pubkey(certificate, key) == 1;
}

Certificate read_certificate(const std::string& pem) {
  const Memory memory(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  return Certificate(PEM_read_bio_X509(memory.get(), nullptr, nullptr, nullptr));
}

}  // namespace

Result<SelfSigned> make_self_signed(const std::vector<std::string>& names, int days) {
  const Key key(EVP_EC_gen("P-256"));
  const Certificate certificate(X509_new());
  std::string alternatives;
  for (const auto& name : names) {
    if (!alternatives.empty()) alternatives += ',';
    alternatives += parse_address(name) ? "IP:" : "DNS:";
    alternatives += name;
  }
  if (!key || !certificate || !set_identity(certificate.get(), key.get(), names.front(), days) ||
      !extend(certificate.get(), NID_basic_constraints, "critical,CA:FALSE") ||
      !extend(certificate.get(), NID_key_usage, "critical,digitalSignature") ||
      !extend(certificate.get(), NID_ext_key_usage, "serverAuth") ||
      !extend(certificate.get(), NID_subject_alt_name, alternatives) ||
      X509_sign(certificate.get(), key.get(), EVP_sha256()) == 0)
    return failed("no certificate could be made");
  const Memory certificate_pem(BIO_new(BIO_s_mem())), key_pem(BIO_new(BIO_s_mem()));
  if (PEM_write_bio_X509(certificate_pem.get(), certificate.get()) != 1 ||
      PEM_write_bio_PKCS8PrivateKey(key_pem.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return failed("no certificate could be written");
  return SelfSigned{text_of(certificate_pem.get()), text_of(key_pem.get())};
}

std::string fingerprint_of(const X509* certificate) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (X509_digest(certificate, EVP_sha256(), digest.data(), &size) != 1) return {};
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += format(i == 0 ? "%02X" : ":%02X", static_cast<unsigned>(digest[i]));
  return text;
}

Result<std::string> fingerprint_of(const std::string& certificate_pem) {
  const Certificate certificate = read_certificate(certificate_pem);
  if (!certificate) return failed("this is no certificate (PEM)");
  return fingerprint_of(certificate.get());
}

std::string normal_fingerprint(const std::string& text) {
  std::string digits;
  for (const char c : text) {
    if (c == ':') continue;
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) return {};
    digits += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  if (digits.size() != 64) return {};
  std::string normal;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    if (i > 0) normal += ':';
    normal.append(digits, i, 2);
  }
  return normal;
}

Result<int> days_left(const std::string& certificate_pem) {
  const Certificate certificate = read_certificate(certificate_pem);
  int days = 0, seconds = 0;
  if (!certificate || ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate.get())) != 1)
    return failed("this is no certificate (PEM)");
  return seconds < 0 ? days - 1 : days;
}

}  // namespace kinemap::cli
