// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/scene.hpp"

#include <array>
#include <utility>

namespace kinemap::sim {

namespace {

constexpr std::array<std::pair<Scene, const char*>, 11> kNames{{{Scene::Auto, "auto"},
                                                                {Scene::Plain, "plain"},
                                                                {Scene::TwinTables, "twin-tables"},
                                                                {Scene::ChairRow, "chair-row"},
                                                                {Scene::TwinScreens, "twin-screens"},
                                                                {Scene::FlushScreen, "flush-screen"},
                                                                {Scene::ThinWall, "thin-wall"},
                                                                {Scene::Hall, "hall"},
                                                                {Scene::LRoom, "l-room"},
                                                                {Scene::ObliqueWall, "oblique-wall"},
                                                                {Scene::Flat, "flat"}}};
constexpr double kDrawnChance = 0.35;

int rooms_of(Scene scene) { return scene == Scene::ThinWall || scene == Scene::Flat ? 2 : 1; }

/// Scenes that are a shape of the shell.
bool makes_shell(Scene scene) { return scene >= Scene::ThinWall; }

}  // namespace

std::optional<Scene> scene_from(const std::string& name) {
  for (const auto& [scene, known] : kNames)
    if (name == known) return scene;
  return std::nullopt;
}

const char* to_string(Scene scene) { return kNames[static_cast<std::size_t>(scene)].second; }

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [scene, name] : kNames) names.emplace_back(name);
  return names;
}

std::optional<std::string> check_scene(const SimOptions& o) {
  if (!makes_shell(o.scene)) return std::nullopt;
  const std::string name = to_string(o.scene);
  if (o.rooms && *o.rooms != rooms_of(o.scene))
    return "scene " + name + " has " + std::to_string(rooms_of(o.scene)) + " rooms: leave out the number of rooms";
  if (o.room_size || o.shell != Shell::Auto) return "scene " + name + " has its own shape: leave out shape and size";
  return std::nullopt;
}

Scene drawn_scene(const SimOptions& options) {
  if (options.scene != Scene::Auto) return options.scene;
  Random random(options.seed, 8);
  if (!random.chance(kDrawnChance)) return Scene::Plain;
  SimOptions with = options;
  with.scene = kNames[static_cast<std::size_t>(random.integer(2, static_cast<int>(kNames.size()) - 1))].first;
  return check_scene(with) ? Scene::Plain : with.scene;
}

SimOptions with_shell_of(Scene scene, const SimOptions& options, Random& random) {
  SimOptions o = options;
  if (!makes_shell(scene)) return o;
  o.rooms = rooms_of(scene);
  o.shell = scene == Scene::LRoom ? Shell::LShape : Shell::Rectangle;
  if (scene == Scene::Hall) o.room_size = {random.uniform(8.3, 9.0), random.uniform(3.0, 4.0)};
  if (scene == Scene::ObliqueWall) o.room_size = {random.uniform(3.2, 4.2), random.uniform(5.2, 6.5)};
  return o;
}

}  // namespace kinemap::sim
