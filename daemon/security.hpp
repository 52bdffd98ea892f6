// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "daemon/asio.hpp"
// after Asio with its <utility>
#include <boost/asio/ssl/context.hpp>

#include "daemon/web_policy.hpp"

namespace kinemap {

/// How a server guards itself: what the files say that the configuration names.
struct Security {
  WebPolicy policy;
  std::shared_ptr<net::ssl::context> tls;  ///< null: in the clear
  /// Some of it is the service's credentials: systemd hands them over when the service starts, so reading them again
  /// brings what was there then.
  bool from_credentials = false;
};

/// Reads tokens, certificate and key. An Error says which file is wrong, or what an address that others can reach wants
/// first.
Result<Security> load_security(const Config::Api& config);

}  // namespace kinemap
