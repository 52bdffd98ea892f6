// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/kinemap/command.hpp"

namespace kinemap::bench {

void add_accuracy(CLI::App& app, cli::Run& run);
void add_pipeline(CLI::App& app, cli::Run& run);
void add_server(CLI::App& app, cli::Run& run);
void add_tracker(CLI::App& app, cli::Run& run);

}  // namespace kinemap::bench
