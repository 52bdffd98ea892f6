// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace kinemap::cli {

/// A bar on stderr for work that takes a while; silent where stderr is no terminal. One for all commands.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();  ///< wipes the bar off the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `part` of the work is done (0–1); `note` is shown behind. Cheap: draws at most ten times a second.
  void update(double part, const std::string& note = {});

 private:
  std::string label_;
  bool shown_;
  std::chrono::steady_clock::time_point begin_, drawn_{};
};

/// Columns of the terminal behind the file descriptor; `otherwise` when it is none.
int terminal_width(int descriptor, int otherwise);

}  // namespace kinemap::cli
