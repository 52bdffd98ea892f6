// SPDX-License-Identifier: Apache-2.0
// world.sdf read by libsdformat, which Gazebo reads it with.
#include <gtest/gtest.h>

#include <sdf/sdf.hh>

namespace {

sdf::Root load(const std::string& folder) {
  sdf::Root root;
  for (const sdf::Error& error : root.Load(KINEMAP_BINARY_DIR "/exports/" + folder + "/world.sdf"))
    ADD_FAILURE() << error.Message();
  return root;
}

/// A box of a model's collision in the world: its middle and its size.
std::pair<ignition::math::Vector3d, ignition::math::Vector3d> box(const sdf::Model& model, std::uint64_t index) {
  const sdf::Collision& collision = *model.LinkByIndex(0)->CollisionByIndex(index);
  const auto pose = model.RawPose() * collision.RawPose();
  return {pose.Pos(), collision.Geom()->BoxShape()->Size()};
}

void expect_near(const ignition::math::Vector3d& a, const ignition::math::Vector3d& b) {
  EXPECT_LT(a.Distance(b), 1e-3) << a << " " << b;
}

TEST(SdfReader, EveryObjectIsAStaticModel) {
  const sdf::Root root = load("sample");
  ASSERT_EQ(root.WorldCount(), 1U);
  const sdf::World& world = *root.WorldByIndex(0);
  EXPECT_EQ(world.ModelCount(), 1U + 4U + 2U) << "ground, objects, inferred walls";
  for (std::uint64_t i = 0; i < world.ModelCount(); ++i) {
    const sdf::Model& model = *world.ModelByIndex(i);
    EXPECT_TRUE(model.Static()) << model.Name();
    EXPECT_EQ(model.LinkByIndex(0)->CollisionCount(), model.LinkByIndex(0)->VisualCount()) << model.Name();
  }
  for (const char* name : {"ground", "wall_1", "table_2", "screen_5", "chair_7", "inferred_wall_1", "inferred_wall_2"})
    EXPECT_NE(world.ModelByName(name), nullptr) << name;
  EXPECT_EQ(world.LightCount(), 1U);
}

TEST(SdfReader, ThingsAreWhereTheyAre) {
  const sdf::Root root = load("sample");
  const sdf::World& world = *root.WorldByIndex(0);
  const sdf::Model& table = *world.ModelByName("table_2");
  EXPECT_EQ(table.LinkByIndex(0)->CollisionCount(), 5U) << "top and four legs";
  expect_near(box(table, 0).first, {2.0, 1.0, 0.725});
  expect_near(box(table, 0).second, {1.6, 0.8, 0.03});
  expect_near(box(table, 1).second, {0.05, 0.05, 0.71});
  const sdf::Model& screen = *world.ModelByName("screen_5");
  expect_near(box(screen, 0).first, {0.035, 1.5, 1.4});
  expect_near(box(screen, 0).second, {0.03, 1.0, 0.6});
  EXPECT_EQ(world.ModelByName("chair_7")->LinkByIndex(0)->CollisionCount(), 6U) << "seat, legs, back";
}

TEST(SdfReader, WallsAreOpenAtTheirDoorways) {
  const sdf::Root root = load("sample");
  const sdf::Model& wall = *root.WorldByIndex(0)->ModelByName("wall_1");
  ASSERT_EQ(wall.LinkByIndex(0)->CollisionCount(), 2U);
  expect_near(box(wall, 0).first, {4.05, 0.4, 1.25});  // 0 to 0.8 m along it, behind its face
  expect_near(box(wall, 0).second, {0.8, 0.1, 2.5});
  expect_near(box(wall, 1).first, {4.05, 2.3, 1.25});
  expect_near(box(wall, 1).second, {1.4, 0.1, 2.5});
}

TEST(SdfReader, AnEmptyMapIsTheGround) {
  const sdf::Root root = load("empty");
  ASSERT_EQ(root.WorldCount(), 1U);
  EXPECT_EQ(root.WorldByIndex(0)->ModelCount(), 1U);
}

}  // namespace
