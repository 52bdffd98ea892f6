// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/resolve.hpp"

#include <gtest/gtest.h>

#include "core/mapper/mapper.hpp"
#include "tests/core/landmarks/contours.hpp"
#include "tests/core/mapper/wearer.hpp"

namespace kinemap {
namespace {

using test::Wearer;

const std::vector<Eigen::Vector3d> kTable = test::level_rectangle({2.0, 1.0, 0.74}, 0.0, 1.4, 0.8);
const Eigen::Vector2d kStand(2.0, -4.0);

std::shared_ptr<const MapSnapshot> map_of(const Wearer& wearer) {
  MapperConfig config;
  config.hand.tip_m = 0.18;
  Mapper mapper(config);
  for (const auto& event : wearer.events) mapper.add(event);
  mapper.finish();
  return mapper.snapshot();
}

TEST(TraceResolver, OneEdgeOfATableIsKeptAsUnresolved) {
  Wearer wearer;
  wearer.walk_to(1.3, 0.0);
  wearer.trace({kTable[0], kTable[1]}, kStand);
  const auto map = map_of(wearer);
  EXPECT_TRUE(map->objects.empty());
  ASSERT_EQ(map->unresolved.size(), 1u);
  EXPECT_NE(map->unresolved[0].reason.find("edge"), std::string::npos) << map->unresolved[0].reason;
}

TEST(TraceResolver, TwoEdgesInTwoGesturesAreOneTable) {
  Wearer wearer;
  wearer.walk_to(1.3, 0.0);
  wearer.trace({kTable[0], kTable[1]}, kStand);
  wearer.trace({kTable[1], kTable[2]}, kStand);
  const auto map = map_of(wearer);
  ASSERT_EQ(map->objects.size(), 1u);
  EXPECT_EQ(map->objects[0].type, ObjectType::Table);
  EXPECT_NEAR((*map->objects[0].size)[0], 1.4, 0.03);
  EXPECT_NEAR((*map->objects[0].size)[1], 0.8, 0.03);
  EXPECT_TRUE(map->unresolved.empty()) << map->unresolved[0].reason;
}

// The hand comes to the edge from the wearer and goes back: two short sides that nobody drew.
const Eigen::Vector3d kWay(0.0, -0.28, 0.0);
const std::vector<Eigen::Vector3d> kDesk = test::level_rectangle({2.0, 1.0, 0.74}, 0.0, 1.0, 0.8);

TEST(TraceResolver, OneEdgeAndTheWayOfTheHandIsNoTable) {
  Wearer wearer;
  wearer.walk_to(1.3, 0.0);
  wearer.trace({kDesk[3] + kWay, kDesk[3], kDesk[2], kDesk[2] + kWay}, kStand);
  const auto map = map_of(wearer);
  EXPECT_TRUE(map->objects.empty());
  ASSERT_EQ(map->unresolved.size(), 1u);
  EXPECT_NE(map->unresolved[0].reason.find("edge"), std::string::npos) << map->unresolved[0].reason;
}

TEST(TraceResolver, TwoEdgesWithTheWayOfTheHandBetweenThemAreOneTable) {
  Wearer wearer;
  wearer.walk_to(1.3, 0.0);
  wearer.trace({kDesk[3] + kWay, kDesk[3], kDesk[2], kDesk[2] + kWay}, kStand);
  wearer.trace({kDesk[2], kDesk[1]}, kStand);
  const auto map = map_of(wearer);
  ASSERT_EQ(map->objects.size(), 1u);
  EXPECT_EQ(map->objects[0].type, ObjectType::Table);
  EXPECT_NEAR((*map->objects[0].size)[0], 1.0, 0.03);
  EXPECT_NEAR((*map->objects[0].size)[1], 0.8, 0.03);
}

TEST(TraceResolver, TwoEdgesBetweenWhichTheHandWasLoweredAreOneTable) {
  const Eigen::Vector3d lowered(0.15, -0.05, -0.15);
  Wearer wearer;
  wearer.walk_to(1.3, 0.0);
  wearer.trace({kTable[0], kTable[1], kTable[1] + lowered}, kStand);
  wearer.trace({kTable[1] + lowered, kTable[1], kTable[2], kTable[2] + lowered}, kStand);
  const auto map = map_of(wearer);
  ASSERT_EQ(map->objects.size(), 1u);
  EXPECT_EQ(map->objects[0].type, ObjectType::Table);
  EXPECT_NEAR((*map->objects[0].size)[0], 1.4, 0.06);
  EXPECT_NEAR((*map->objects[0].size)[1], 0.8, 0.06);
}

TEST(TraceResolver, AScreenInterruptedHalfWay) {
  const auto c = test::upright_rectangle({2.0, 2.0, 1.4}, -1.5707963, 0.9, 0.5);
  Wearer wearer;
  wearer.walk_to(2.0, 1.2);
  wearer.trace({c[0], c[1], c[2]}, kStand);
  wearer.trace({c[2], c[3], c[0]}, kStand);
  const auto map = map_of(wearer);
  ASSERT_EQ(map->objects.size(), 1u);
  EXPECT_EQ(map->objects[0].type, ObjectType::Screen);
  EXPECT_NEAR((*map->objects[0].size)[0], 0.9, 0.03);
  EXPECT_NEAR((*map->objects[0].size)[1], 0.5, 0.03);
}

TEST(TraceResolver, WhatIsFarAwayOrLateIsNotJoined) {
  Wearer far;
  far.walk_to(1.3, 0.0);
  far.trace({kTable[0], kTable[1]}, kStand);
  const Eigen::Vector3d away(3.0, 0.0, 0.0);
  far.walk_to(5.7, 1.0);
  far.trace({kTable[1] + away, kTable[2] + away}, {10.0, 1.0});
  EXPECT_EQ(map_of(far)->unresolved.size(), 2u);

  Wearer late;
  late.walk_to(1.3, 0.0);
  late.trace({kTable[0], kTable[1]}, kStand);
  for (int i = 0; i < 40; ++i) {  // 80 s to and fro
    late.walk_to(1.3, -1.0);
    late.walk_to(1.3, 0.0);
  }
  late.trace({kTable[1], kTable[2]}, kStand);
  EXPECT_EQ(map_of(late)->unresolved.size(), 2u);
}

}  // namespace
}  // namespace kinemap
