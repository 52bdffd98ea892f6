// SPDX-License-Identifier: Apache-2.0
#include "protocol/tum.hpp"

#include <gtest/gtest.h>

#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

TEST(Tum, RoundTrip) {
  const MapSnapshot map = sample_map();
  const auto poses = tum_from_text(optimised_tum(map));
  ASSERT_TRUE(poses) << poses.error();
  ASSERT_EQ(poses->size(), map.trajectory.size());
  for (std::size_t i = 0; i < poses->size(); ++i) {
    EXPECT_NEAR((*poses)[i].time_s, map.trajectory[i].time_s, 1e-6);
    EXPECT_LT(((*poses)[i].pose.p - map.trajectory[i].T_map_pelvis.p).norm(), 2e-6);
    EXPECT_LT((*poses)[i].pose.q.angularDistance(map.trajectory[i].T_map_pelvis.q), 1e-7);
  }
  EXPECT_NE(optimised_tum(map), odometry_tum(map));
}

TEST(Tum, OrderOfColumns) {
  const TimedPose pose{1.5, {{1, 2, 3}, Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5)}};
  const std::string text = tum_text({&pose, 1});
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "1.500000 1.000000 2.000000 3.000000 -0.500000000 0.500000000 -0.500000000 0.500000000\n");
}

TEST(Tum, SkipsCommentsAndBlankLines) {
  const auto poses = tum_from_text("# comment\r\n\r\n  # another\n1 2 3 4\t0 0 0 1  \r\n");
  ASSERT_TRUE(poses) << poses.error();
  EXPECT_EQ(poses->size(), 1U);
}

TEST(Tum, ErrorsNameTheLine) {
  EXPECT_EQ(tum_from_text("\n1 2 3 4 0 0 0\n").error(), "line 2: expected 8 numbers: t x y z qx qy qz qw");
  EXPECT_EQ(tum_from_text("1 2 3 4 0 0 0 1 9").error(), "line 1: expected 8 numbers: t x y z qx qy qz qw");
  EXPECT_EQ(tum_from_text("1 2 3 x 0 0 0 1").error(), "line 1: expected 8 numbers: t x y z qx qy qz qw");
  EXPECT_EQ(tum_from_text("1 2 3 nan 0 0 0 1").error(), "line 1: expected 8 numbers: t x y z qx qy qz qw");
  EXPECT_EQ(tum_from_text("1 2 3 4 0 0 0 2").error(), "line 1: the quaternion is not a unit quaternion");
}

}  // namespace
}  // namespace kinemap
