// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>

namespace kinemap::test {
namespace {

constexpr int kSilenceMs = 60000;

std::vector<std::string> with_free_ports(std::vector<std::string> arguments) {
  for (const char* text : {"--port", "0", "--suit-port", "0"}) arguments.emplace_back(text);
  return arguments;
}

std::uint16_t number_after(const std::string& text, const std::string& marker) {
  const auto at = text.find(marker);
  return at == std::string::npos ? std::uint16_t{0}
                                 : static_cast<std::uint16_t>(std::atoi(text.c_str() + at + marker.size()));
}

}  // namespace

Process::Process(const std::string& program, const std::vector<std::string>& arguments) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  pipe_ = ends[0];
}

Process::~Process() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  ::close(pipe_);
}

bool Process::read_more() {
  pollfd waiting{pipe_, POLLIN, 0};
  if (::poll(&waiting, 1, kSilenceMs) <= 0) return false;
  std::array<char, 4096> buffer;
  const auto size = ::read(pipe_, buffer.data(), buffer.size());
  if (size <= 0) return false;
  output_.append(buffer.data(), static_cast<std::size_t>(size));
  return true;
}

bool Process::wait_for_output(const std::string& text) {
  while (output_.find(text) == std::string::npos)
    if (!read_more()) return false;
  return true;
}

void Process::signal(int number) const { ::kill(pid_, number); }

int Process::wait() {
  while (read_more()) {
  }
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

RunningDaemon::RunningDaemon(std::vector<std::string> arguments)
    : process(KINEMAPD, with_free_ports(std::move(arguments))) {
  ready = process.wait_for_output("ready: ") && process.wait_for_output("/\n");
  // "ready: suit on udp ADDRESS port PORT, map at http://ADDRESS:PORT/"
  const auto said = process.output().substr(std::min(process.output().find("ready: "), process.output().size()));
  suit_port = number_after(said, " port ");
  const auto map = said.find("map at ");
  if (map != std::string::npos) api_port = number_after(said.substr(said.find("://", map) + 3), ":");
}

}  // namespace kinemap::test
