// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace kinemap::cli {

/// What the shell is told.
enum ExitCode : int { kOk = 0, kFailed = 1, kUsage = 2 };

/// Each sub-command adds itself to the program; when it was the one asked for, it puts its work into `run`, to be done
/// after parsing.
using Run = std::function<int()>;

void add_sim(CLI::App& app, Run& run);
void add_replay(CLI::App& app, Run& run);
void add_build(CLI::App& app, Run& run);
void add_map(CLI::App& app, Run& run);
void add_objects(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_status(CLI::App& app, Run& run);
void add_doctor(CLI::App& app, Run& run);
void add_watch(CLI::App& app, Run& run);
void add_optimize(CLI::App& app, Run& run);
void add_sessions(CLI::App& app, Run& run);
void add_eval(CLI::App& app, Run& run);
void add_pair(CLI::App& app, Run& run);
void add_shell(CLI::App& app, Run& run);

/// Adds a sub-command whose options live in a shared `Options`; `work(options)` gives the exit code.
template <class Options, class Work>
CLI::App* add_command(CLI::App& app, Run& run, const std::string& name, const std::string& summary,
                      const std::string& examples, const std::shared_ptr<Options>& options, Work work) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->footer("\nExamples:\n" + examples);
  command->callback([&run, options, work] { run = [options, work] { return work(*options); }; });
  return command;
}

/// Prints "PROGRAM COMMAND: MESSAGE" to stderr and returns the code.
int fail(const std::string& command, const std::string& message, ExitCode code = kFailed);

/// Writes to stdout and notices a full disk or a closed pipe; the exit code for it.
int print(const std::string& command, const std::string& text);

}  // namespace kinemap::cli
