// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/run_command.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace kinemap {
namespace {

std::string slurp(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

int exit_code(int status) { return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status); }

int start(const std::vector<std::string>& command, const std::string& out, const std::string& err) {
  const int pid = ::fork();
  if (pid != 0) return pid;
  const int in_file = ::open("/dev/null", O_RDONLY);
  const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err_file = err == out ? out_file : ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(in_file, 0);
  ::dup2(out_file, 1);
  ::dup2(err_file, 2);
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

Ran run_command(const std::vector<std::string>& command, const std::string& out_path) {
  const std::string base =
      (std::filesystem::temp_directory_path() / ("kinemap-run-" + std::to_string(::getpid()))).string();
  const std::string out = out_path.empty() ? base + ".out" : out_path, err = base + ".err";
  const int pid = start(command, out, err);
  int status = 0;
  ::waitpid(pid, &status, 0);
  Ran ran{exit_code(status), out_path.empty() ? slurp(out) : "", slurp(err)};
  std::filesystem::remove(base + ".out");
  std::filesystem::remove(err);
  return ran;
}

Background::Background(const std::vector<std::string>& command, const std::string& out_path)
    : pid_(start(command, out_path, out_path)) {}

Background::~Background() {
  if (pid_ > 0) stop(SIGKILL);
}

bool Background::running() { return pid_ > 0 && ::kill(pid_, 0) == 0 && ::waitpid(pid_, nullptr, WNOHANG) == 0; }

int Background::stop(int signal) {
  int status = 0;
  ::kill(pid_, signal);
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return exit_code(status);
}

}  // namespace kinemap
