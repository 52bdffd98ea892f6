// SPDX-License-Identifier: Apache-2.0
#include "core/landmarks/sides.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kinemap {
namespace {

using graph::Edge;

constexpr std::array<double, 2> kSize{1.6, 0.8};
constexpr std::array<bool, 4> kAll{true, true, true, true};

/// The contacts of a hand that moves evenly along a polyline in the rectangle's axes.
std::vector<SideQuery> along(const std::vector<Eigen::Vector2d>& polyline) {
  std::vector<SideQuery> out;
  for (std::size_t k = 1; k < polyline.size(); ++k) {
    const Eigen::Vector2d leg = polyline[k] - polyline[k - 1];
    for (double s = 0.025; s < leg.norm(); s += 0.05)
      out.push_back({polyline[k - 1] + s * leg.normalized(), leg.normalized(), Edge::None});
  }
  return out;
}

TEST(ChooseSides, NothingForNoContacts) { EXPECT_TRUE(choose_sides({}, kSize, kAll, {}, false).empty()); }

TEST(ChooseSides, FollowsTheContour) {
  const auto contacts = along({{0.0, -0.4}, {0.8, -0.4}, {0.8, 0.4}, {-0.8, 0.4}, {-0.8, -0.4}, {0.1, -0.4}});
  const auto sides = choose_sides(contacts, kSize, kAll, {}, false);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    ASSERT_NE(sides[k], Edge::None) << k;
    EXPECT_NEAR(side_error(contacts[k].p, kSize, sides[k]), 0.0, 1e-12) << k;
  }
}

// Nobody knows where a side ends beyond which nothing was drawn: contacts there speak of it like all others.
TEST(ChooseSides, AnOpenSideGoesOn) {
  const std::array<bool, 4> drawn{false, true, true, false};  // +u and −v
  const auto contacts = along({{-1.2, -0.4}, {0.8, -0.4}, {0.8, 0.4}});
  const auto sides = choose_sides(contacts, kSize, drawn, {}, false);
  EXPECT_EQ(sides.front(), Edge::MinusV);
  EXPECT_FALSE(in_corner(contacts.front().p, kSize, drawn, Edge::MinusV, {}));
  EXPECT_TRUE(in_corner(contacts.front().p, kSize, kAll, Edge::MinusV, {}));
  EXPECT_TRUE(in_corner({0.79, -0.4}, kSize, drawn, Edge::MinusV, {}));
  EXPECT_NEAR(distance_from_side({-1.2, -0.3}, kSize, drawn, Edge::MinusV), 0.1, 1e-12);
  EXPECT_NEAR(distance_from_side({1.2, -0.1}, kSize, drawn, Edge::MinusV), 0.5, 1e-12);
}

// A screen a hand's breadth high: nearness alone would jump between the long sides.
TEST(ChooseSides, TheOrderOfSidesDecidesWhereNearnessDoesNot) {
  const std::array<double, 2> flat{0.8, 0.2};
  auto contacts = along({{-0.4, -0.1}, {0.4, -0.1}, {0.4, 0.1}, {-0.4, 0.1}});
  contacts[8].p.y() = 0.02;  // past the middle, still on the first side
  const auto sides = choose_sides(contacts, flat, kAll, {}, false);
  EXPECT_EQ(sides[8], Edge::MinusV);
}

TEST(ChooseSides, SidesThatWereNotDrawnAreNotChosen) {
  const auto contacts = along({{-0.8, -0.4}, {0.8, -0.4}});
  const auto sides = choose_sides(contacts, kSize, {true, true, false, true}, {}, false);
  EXPECT_EQ(std::count(sides.begin(), sides.end(), Edge::MinusV), 0);
}

TEST(ChooseSides, TheWayToTheContourIsOnNoSide) {
  const auto contacts = along({{0.0, 0.0}, {-0.8, 0.0}, {-0.8, 0.4}, {0.8, 0.4}});
  const auto sides = choose_sides(contacts, kSize, kAll, {}, false);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (std::abs(contacts[k].p.x()) < 0.4 && contacts[k].p.y() == 0.0) {
      EXPECT_EQ(sides[k], Edge::None) << k;
    }
}

TEST(TravelDirections, ZeroWhereTheHandDwells) {
  std::vector<Eigen::Vector2d> points(10, Eigen::Vector2d(1.0, 2.0));
  for (const auto& d : travel_directions(points, 0.05)) EXPECT_TRUE(d.isZero());
  points.clear();
  for (int i = 0; i < 10; ++i) points.emplace_back(0.02 * i, 0.0);
  for (const auto& d : travel_directions(points, 0.05)) EXPECT_NEAR(d.x(), 1.0, 1e-12);
}

}  // namespace
}  // namespace kinemap
