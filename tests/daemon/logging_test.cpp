// SPDX-License-Identifier: Apache-2.0
#include "daemon/logging.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinemap {
namespace {

TEST(LogLimit, TenAMinuteOfAKindAndThenHowManyWereLeftOut) {
  LogLimit limit;
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(limit.take("suit: receiving from 10.0.0." + std::to_string(i), i), 0U) << "numbers make no other kind";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(limit.take("suit: receiving from 10.0.0.9", 11.0 + i), std::nullopt);
  EXPECT_EQ(limit.take("suit: receiving from 10.0.0.9", 59.9), std::nullopt);
  EXPECT_EQ(limit.take("suit: receiving from 10.0.0.9", 60.0), 6U);
  EXPECT_EQ(limit.take("suit: receiving from 10.0.0.9", 60.1), 0U);
}

TEST(LogLimit, OtherKindsAreNotHeldUp) {
  LogLimit limit;
  for (int i = 0; i < 20; ++i) (void)limit.take("suit: receiving from a", 0.0);
  EXPECT_EQ(limit.take("suit: worn by Ada", 0.0), 0U);
  EXPECT_EQ(limit.take("ending", 0.0), 0U);
  EXPECT_EQ(limit.take("", 0.0), 0U);
}

TEST(LogLimit, ManyKindsAtOnceCountAsOne) {
  LogLimit limit;
  const auto name = [](int i) { return std::string(1 + i % 20, static_cast<char>('a' + i / 20)); };
  int passed = 0;
  for (int i = 0; i < 400; ++i) passed += limit.take(name(i), 1.0).has_value();
  EXPECT_EQ(passed, 256 + 10);  // the one for all the others has its ten
  // When their minute is over they make room.
  EXPECT_EQ(limit.take("another", 100.0), 0U);
}

}  // namespace
}  // namespace kinemap
