// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace kinemap::cli {

using Clock = std::chrono::steady_clock;

int terminal_width(int descriptor, int otherwise) {
  winsize size{};
  if (::isatty(descriptor) && ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return otherwise;
}

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), shown_(::isatty(STDERR_FILENO) != 0), begin_(Clock::now()) {}

ProgressBar::~ProgressBar() {
  if (shown_ && drawn_ != Clock::time_point{}) std::fputs("\r\033[K", stderr);
}

void ProgressBar::update(double part, const std::string& note) {
  const auto now = Clock::now();
  if (!shown_ || now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  part = std::clamp(part, 0.0, 1.0);
  const int room = terminal_width(STDERR_FILENO, 80) - static_cast<int>(label_.size() + note.size()) - 18;
  const int width = std::clamp(room, 4, 40), filled = static_cast<int>(part * width);
  std::string bar;
  for (int i = 0; i < width; ++i) bar += i < filled ? "█" : "░";
  const double elapsed = std::chrono::duration<double>(now - begin_).count();
  const std::string left = part > 0.02 && elapsed > 1.0
                               ? std::to_string(static_cast<long>(elapsed * (1.0 - part) / part + 0.5)) + " s left"
                               : "";
  std::fprintf(stderr, "\r%s %s %3.0f %% %s%s%s\033[K", label_.c_str(), bar.c_str(), 100.0 * part, note.c_str(),
               note.empty() ? "" : " ", left.c_str());
  std::fflush(stderr);
}

}  // namespace kinemap::cli
