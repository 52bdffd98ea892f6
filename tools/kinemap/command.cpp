// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/command.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace kinemap::cli {

int fail(const std::string& command, const std::string& message, ExitCode code) {
  std::fprintf(stderr, "%s %s: %s\n", program_invocation_short_name, command.c_str(), message.c_str());
  return code;
}

int print(const std::string& command, const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return kOk;
  return fail(command, std::string("standard output: ") + std::strerror(errno));
}

}  // namespace kinemap::cli
