// SPDX-License-Identifier: Apache-2.0
#include "daemon/watchdog.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

constexpr int kPatience = 3;

TEST(Watchdog, IsFedByTheDetectionLoop) {
  Watchdog watchdog(0, {}, kPatience);
  EXPECT_TRUE(watchdog.look(1, {}));
  EXPECT_TRUE(watchdog.look(2, {}));
  EXPECT_FALSE(watchdog.look(2, {})) << "held";
  EXPECT_TRUE(watchdog.look(3, {})) << "comes round again";
}

TEST(Watchdog, NoticesASolverThatHangsForGood) {
  std::uint64_t pulse = 0;
  Watchdog watchdog(pulse, {7, 500, true}, kPatience);
  for (int i = 1; i < kPatience; ++i) EXPECT_TRUE(watchdog.look(++pulse, {7, 500, true})) << i;
  for (int i = 0; i < 10; ++i)
    EXPECT_FALSE(watchdog.look(++pulse, {7, 500, true})) << "detection waits for room and beats";
  EXPECT_TRUE(watchdog.solver_is_stuck());
}

TEST(Watchdog, LetsASolverTakeItsTime) {
  std::uint64_t pulse = 0, steps = 0;
  Watchdog watchdog(pulse, {}, kPatience);
  for (int entry = 0; entry < 20; ++entry) {
    for (int i = 1; i < kPatience; ++i) EXPECT_TRUE(watchdog.look(++pulse, {steps, 0, true}));
    EXPECT_TRUE(watchdog.look(++pulse, {++steps, 0, true})) << "each takes nearly all the patience there is";
  }
}

TEST(Watchdog, LeavesASolverAloneThatComputes) {
  std::uint64_t pulse = 0, cpu_ns = 0;
  Watchdog watchdog(pulse, {}, kPatience);
  for (int i = 0; i < 100 * kPatience; ++i) EXPECT_TRUE(watchdog.look(++pulse, {7, ++cpu_ns, true}));
  for (int i = 1; i < kPatience; ++i) EXPECT_TRUE(watchdog.look(++pulse, {7, cpu_ns, true}));
  EXPECT_FALSE(watchdog.look(++pulse, {7, cpu_ns, true})) << "and then waits for ever";
}

TEST(Watchdog, ASolverWithoutWorkNeedNotMove) {
  std::uint64_t pulse = 0;
  Watchdog watchdog(pulse, {}, kPatience);
  for (int i = 0; i < 10 * kPatience; ++i) EXPECT_TRUE(watchdog.look(++pulse, {5, 0, false}));
  EXPECT_TRUE(watchdog.look(++pulse, {5, 0, true})) << "its patience begins with the work";
}

}  // namespace
}  // namespace kinemap
