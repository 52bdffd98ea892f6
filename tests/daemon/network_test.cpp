// SPDX-License-Identifier: Apache-2.0
#include "daemon/network.hpp"

#include <gtest/gtest.h>

namespace kinemap {
namespace {

bool within(const char* network, const char* address) {
  return Network::parse(network).value().contains(parse_address(address).value());
}

TEST(Network, ContainsWhatBeginsWithItsBits) {
  EXPECT_TRUE(within("192.168.1.0/24", "192.168.1.255"));
  EXPECT_FALSE(within("192.168.1.0/24", "192.168.2.0"));
  EXPECT_TRUE(within("192.168.1.128/25", "192.168.1.129"));
  EXPECT_FALSE(within("192.168.1.128/25", "192.168.1.127"));
  EXPECT_TRUE(within("10.1.2.3", "10.1.2.3"));
  EXPECT_FALSE(within("10.1.2.3", "10.1.2.2"));
  EXPECT_TRUE(within("0.0.0.0/0", "8.8.8.8"));
  EXPECT_FALSE(within("0.0.0.0/0", "2001:db8::1"));
  EXPECT_TRUE(within("::/0", "2001:db8::1"));
  EXPECT_TRUE(within("fe80::/10", "febf::1"));
  EXPECT_FALSE(within("fe80::/10", "fec0::1"));
  // A socket of both families shows IPv4 like this.
  EXPECT_TRUE(within("192.168.1.0/24", "::ffff:192.168.1.7"));
}

TEST(Network, WhatIsNoneIsRefused) {
  for (const char* text :
       {"", "/", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x", "::/129", "10.0.0", "host"})
    EXPECT_FALSE(Network::parse(text)) << text;
}

TEST(Network, LoopbackIsKnown) {
  for (const char* text : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"})
    EXPECT_TRUE(is_loopback(parse_address(text).value())) << text;
  for (const char* text : {"128.0.0.1", "0.0.0.0", "::", "::2", "::127.0.0.1"})
    EXPECT_FALSE(is_loopback(parse_address(text).value())) << text;
}

TEST(Network, AnEmptyListAllowsEverybody) {
  const auto address = parse_address("10.0.0.1").value();
  EXPECT_TRUE(allows({}, address));
  EXPECT_TRUE(allows({*Network::parse("::1"), *Network::parse("10.0.0.0/8")}, address));
  EXPECT_FALSE(allows({*Network::parse("::1")}, address));
}

}  // namespace
}  // namespace kinemap
