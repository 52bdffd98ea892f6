// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/sim/options.hpp"
#include "tools/sim/random.hpp"

namespace kinemap::sim {

std::optional<Scene> scene_from(const std::string& name);
const char* to_string(Scene scene);
std::vector<std::string> scene_names();  ///< all of them

/// The scene of a session: the one asked for, or one drawn that agrees with the other options (mostly none).
Scene drawn_scene(const SimOptions& options);

/// The options with what the scene says of rooms and shells.
SimOptions with_shell_of(Scene scene, const SimOptions& options, Random& random);

/// What in the options contradicts the scene; nullopt when nothing does.
std::optional<std::string> check_scene(const SimOptions& options);

}  // namespace kinemap::sim
