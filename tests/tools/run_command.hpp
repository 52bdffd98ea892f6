// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinemap {

/// How a program ended and what it wrote.
struct Ran {
  int code = -1;  ///< exit code; 128 + n after signal n
  std::string out, err;
};

/// Runs a program with the arguments as they are (no shell between), standard input empty, and waits for it.
/// `out_path`: where its standard output goes instead of into `out`.
Ran run_command(const std::vector<std::string>& command, const std::string& out_path = {});

/// A program in the background; killed when the object goes.
class Background {
 public:
  Background(const std::vector<std::string>& command, const std::string& out_path);
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  [[nodiscard]] bool running();
  /// Sends the signal and waits for the end; the exit code.
  int stop(int signal);

 private:
  int pid_ = -1;
};

}  // namespace kinemap
