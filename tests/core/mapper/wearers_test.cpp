// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/wearers.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

WearerInfo named(const std::string& name, std::optional<double> fingertip_m = {}) {
  WearerInfo info;
  info.name = name;
  if (fingertip_m) info.p_hand_fingertip = Eigen::Vector3d(0.0, -*fingertip_m, 0.0);
  return info;
}

double expected_m(const Wearers& wearers, std::size_t k) { return -wearers.touch(k).prior().p_hand.y(); }

TEST(Wearers, AreToldApartByTheirBones) {
  Wearers wearers({});
  EXPECT_EQ(wearers.count(), 1u);
  wearers.meet(std::nullopt);
  wearers.meet(1.80);
  wearers.meet(1.805);
  wearers.meet(std::nullopt);
  EXPECT_EQ(wearers.count(), 1u) << "what is not known tells nobody apart";
  wearers.meet(1.62);
  EXPECT_EQ(wearers.current(), 1u);
  EXPECT_LT(expected_m(wearers, 1), expected_m(wearers, 0));
  wearers.meet(1.81);
  EXPECT_EQ(wearers.current(), 0u) << "comes back";
  EXPECT_EQ(wearers.count(), 2u);
}

TEST(Wearers, AreToldApartByTheirNames) {
  Wearers wearers({});
  wearers.meet(1.80);
  wearers.tell(named("Anna"));
  wearers.meet(1.80);
  EXPECT_EQ(wearers.count(), 1u) << "now it is known";
  wearers.tell(named("Berta"));
  wearers.meet(1.80);
  EXPECT_EQ(wearers.current(), 1u);
  wearers.tell(named(""));
  wearers.meet(1.80);
  EXPECT_EQ(wearers.current(), 1u);
  wearers.tell(named("Anna"));
  wearers.meet(1.80);
  EXPECT_EQ(wearers.current(), 0u);
  EXPECT_EQ(wearers.count(), 2u);
}

TEST(Wearers, WhatTheSuitSaidOfOneIsNotTakenForAnother) {
  Wearers wearers({});
  wearers.tell(named("Anna", 0.20));
  wearers.meet(1.80);
  const double of_first = expected_m(wearers, 0);
  wearers.meet(1.60);
  EXPECT_EQ(wearers.info(1).name, "");
  EXPECT_FALSE(wearers.info(1).p_hand_fingertip);
  wearers.tell(named("Berta", 0.16));
  wearers.meet(1.60);
  EXPECT_EQ(wearers.info(1).name, "Berta");
  EXPECT_NEAR(of_first - expected_m(wearers, 1), 0.04, 0.02);
  wearers.meet(1.80);
  EXPECT_EQ(expected_m(wearers, 0), of_first);
}

}  // namespace
}  // namespace kinemap
