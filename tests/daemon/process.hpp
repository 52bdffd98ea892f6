// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace kinemap::test {

/// A child process whose output (stdout and stderr together) is read; killed by destruction if it still runs.
class Process {
 public:
  Process(const std::string& program, const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Reads output until it holds `text`; false when the output ends before (or nothing comes for a minute).
  bool wait_for_output(const std::string& text);
  void signal(int number) const;
  /// Reads the output to its end and returns the exit code, 128 + n after a signal.
  int wait();
  [[nodiscard]] const std::string& output() const { return output_; }

 private:
  bool read_more();

  pid_t pid_ = -1;
  int pipe_ = -1;
  std::string output_;
};

/// kinemapd on ports that the system chose.
class RunningDaemon {
 public:
  explicit RunningDaemon(std::vector<std::string> arguments = {});

  Process process;
  std::uint16_t suit_port = 0, api_port = 0;
  bool ready = false;
};

}  // namespace kinemap::test
