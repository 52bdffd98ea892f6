// SPDX-License-Identifier: Apache-2.0
#include "daemon/start.hpp"

namespace kinemap {

StartError bind_error(const Binding& binding, std::error_code reason) {
  const std::string port = std::to_string(binding.port);
  const std::string change =
      std::string("choose another with ") + binding.key + " in the configuration or " + binding.option + " PORT";
  if (reason == std::errc::address_in_use)
    return {ExitCode::PortTaken,
            std::string(binding.protocol) + " port " + port + " on " + binding.address +
                " is taken: another program holds it, perhaps a kinemapd that already runs (`ss -" +
                (std::string(binding.protocol) == "UDP" ? "lunp" : "ltnp") + " 'sport = :" + port +
                "'` names it). End that one, or " + change + "."};
  if (reason == std::errc::permission_denied)
    return {ExitCode::Failure, std::string(binding.protocol) + " port " + port +
                                   " may not be used by this user (ports below 1024 need the capability); " + change +
                                   "."};
  const std::string key(binding.key);
  return {ExitCode::Failure, std::string(binding.protocol) + " port " + port + " on " + binding.address +
                                 " cannot be opened: " + reason.message() + ". Is " + key.substr(0, key.find('.')) +
                                 ".address one of this machine's addresses?"};
}

}  // namespace kinemap
