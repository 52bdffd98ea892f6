// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/pcap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/protocol/body_stream.hpp"
#include "tests/protocol/capture_maker.hpp"

namespace kinemap {
namespace {

using namespace testing_support;
using testing::HasSubstr;

struct Read {
  std::vector<UdpPacket> packets;
  PcapStats stats;
  std::string error;
};

Read read_all(const std::string& path) {
  Read out;
  auto reader = PcapReader::open(path);
  if (!reader) return {{}, {}, reader.error()};
  for (;;) {
    auto packet = reader->next();
    if (!packet) {
      out.error = packet.error();
      break;
    }
    if (!*packet) break;
    out.packets.push_back(std::move(**packet));
  }
  EXPECT_FALSE((*reader->next()).has_value()) << "nothing comes after the end";
  out.stats = reader->stats();
  return out;
}

class Pcap : public testing::Test {
 protected:
  Read read(const std::vector<std::byte>& bytes) {
    file_.write(bytes);
    return read_all(file_.path());
  }
  Read read(const CaptureFormat& format, const std::vector<Packet>& packets) { return read(capture(format, packets)); }

  TemporaryFile file_{std::string("pcap_test_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                      ".pcap"};
  const Packet hello_ = packet_of("hello, this is a payload of some length");
};

TEST_F(Pcap, BothByteOrdersAndBothClocks) {
  for (const bool little : {false, true}) {
    for (const bool nano : {false, true}) {
      const Read r = read({little, nano, 1}, {ethernet(ipv4(udp(hello_))), ethernet(ipv4(udp(hello_, 6000)))});
      ASSERT_EQ(r.packets.size(), 2U) << r.error;
      EXPECT_EQ(r.packets[0].payload, hello_);
      EXPECT_EQ(r.packets[0].source, "192.0.2.1:5000");
      EXPECT_EQ(r.packets[0].destination_port, 9763);
      EXPECT_NEAR(r.packets[0].time_s, 1000.25, 1e-9);
      EXPECT_NEAR(r.packets[1].time_s, 1000.251, 1e-9);
      EXPECT_EQ(r.packets[1].source, "192.0.2.1:6000");
      EXPECT_EQ(r.stats.udp, 2U);
    }
  }
}

TEST_F(Pcap, EveryLinkType) {
  const Packet v4 = ipv4(udp(hello_));
  const Packet v6 = ipv6(udp(hello_));
  const Packet sll_head(14, std::byte{0});
  const Packet family_be{std::byte{0}, std::byte{0}, std::byte{0}, std::byte{2}};
  const Packet family_le{std::byte{2}, std::byte{0}, std::byte{0}, std::byte{0}};
  const Packet family6_le{std::byte{30}, std::byte{0}, std::byte{0}, std::byte{0}};
  const Packet type4{std::byte{0x08}, std::byte{0x00}};
  const Packet type6{std::byte{0x86}, std::byte{0xdd}};
  const std::vector<std::pair<std::uint32_t, Packet>> cases{
      {1, ethernet(v4)},
      {1, ethernet(v6, 0x86dd)},
      {1, ethernet(v4, 0x0800, 1)},
      {1, ethernet(v6, 0x86dd, 2)},
      {101, v4},
      {101, v6},
      {12, v4},
      {14, v6},
      {228, v4},
      {229, v6},
      {113, sll_head + type4 + v4},
      {113, sll_head + type6 + v6},
      {276, type4 + Packet(18, std::byte{0}) + v4},
      {276, type6 + Packet(18, std::byte{0}) + v6},
      {0, family_be + v4},
      {0, family_le + v4},
      {0, family6_le + v6},
      {108, family_be + v4},
  };
  for (const auto& [link, packet] : cases) {
    const Read r = read({true, false, link}, {packet});
    ASSERT_EQ(r.packets.size(), 1U) << "link type " << link << ' ' << r.error;
    EXPECT_EQ(r.packets[0].payload, hello_);
    EXPECT_THAT(r.packets[0].source, testing::AnyOf("192.0.2.1:5000", "[2001:db8::1]:5000"));
  }
}

TEST_F(Pcap, UnknownLinkTypesAreNamed) {
  const Read r = read({true, false, 105}, {});
  EXPECT_THAT(r.error, HasSubstr("byte 20: link type 105"));
}

TEST_F(Pcap, PaddingOptionsAndExtensionHeaders) {
  const Packet padded = ethernet(ipv4(udp(hello_))) + Packet(10, std::byte{0xee});
  const Packet options = ethernet(ipv4(udp(hello_), 0, 7, 17, 8));
  const Packet extended = ethernet(ipv6(extension(60, extension(43, extension(17, udp(hello_), 2)))), 0x86dd);
  Packet hop = ethernet(ipv6(extension(17, udp(hello_)), 0), 0x86dd);
  Packet next60 = ethernet(ipv6(extension(17, udp(hello_)), 60), 0x86dd);
  Packet first = extended;
  first[14 + 6] = std::byte{0};  // the chain begins with hop-by-hop options
  const Read r = read({}, {padded, options, hop, next60, first});
  ASSERT_EQ(r.packets.size(), 5U);
  for (const auto& p : r.packets) EXPECT_EQ(p.payload, hello_);
}

TEST_F(Pcap, OtherProtocolsAreCounted) {
  const Read r = read({}, {ethernet(ipv4(udp(hello_), 0, 7, 6)), ethernet(hello_, 0x0806),
                           ethernet(ipv6(hello_, 58), 0x86dd), ethernet(ipv4(udp(hello_)))});
  EXPECT_EQ(r.packets.size(), 1U);
  EXPECT_EQ(r.stats.not_udp, 3U);
  EXPECT_EQ(r.stats.records, 4U);
}

TEST_F(Pcap, WrongLengthsInsideAreCounted) {
  Packet long_ip = ethernet(ipv4(udp(hello_)));
  long_ip[14 + 3] = std::byte{0xff};
  Packet long_udp = ethernet(ipv4(udp(hello_)));
  long_udp[14 + 20 + 5] = std::byte{0xff};
  Packet short_udp = ethernet(ipv4(udp(hello_)));
  short_udp[14 + 20 + 5] = std::byte{7};
  Packet small_header = ethernet(ipv4(udp(hello_)));
  small_header[14] = std::byte{0x44};
  const Read r = read({}, {long_ip, long_udp, short_udp, small_header});
  EXPECT_TRUE(r.packets.empty());
  EXPECT_EQ(r.stats.truncated, 4U);
}

TEST_F(Pcap, PacketsCutAtEveryLengthAreCounted) {
  const std::vector<std::pair<std::uint32_t, Packet>> kinds{{1, ethernet(ipv4(udp(hello_)), 0x0800, 2)},
                                                            {101, ipv6(extension(17, udp(hello_)), 0)},
                                                            {0, Packet{std::byte{2}, {}, {}, {}} + ipv4(udp(hello_))}};
  for (const auto& [link, whole] : kinds) {
    std::vector<Packet> cut;
    for (std::size_t n = 0; n < whole.size(); ++n)
      cut.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
    const Read r = read({true, false, link}, cut);
    EXPECT_TRUE(r.packets.empty());
    EXPECT_EQ(r.stats.truncated, whole.size());
    EXPECT_EQ(r.stats.records, whole.size());
  }
}

TEST_F(Pcap, FilesCutAtEveryLengthTellWhere) {
  const auto whole = capture({}, {ethernet(ipv4(udp(hello_))), ethernet(ipv4(udp(hello_)))});
  const std::size_t first_end = 24 + (whole.size() - 24) / 2;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const Read r = read(std::vector<std::byte>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)));
    EXPECT_EQ(r.packets.size(), n >= first_end ? 1U : 0U);
    if (n == 24 || n == first_end) {
      EXPECT_EQ(r.error, "") << "ends between packets";
    } else {
      EXPECT_THAT(r.error, HasSubstr(file_.path())) << n;
    }
    if (n > first_end) {
      EXPECT_THAT(r.error, HasSubstr("byte " + std::to_string(first_end))) << n;
    }
  }
}

TEST_F(Pcap, DamagedRecordLength) {
  auto bytes = capture({false, false, 1}, {ethernet(ipv4(udp(hello_))), ethernet(ipv4(udp(hello_)))});
  const std::size_t second = 24 + (bytes.size() - 24) / 2;
  bytes[second + 8] = std::byte{0x7f};
  const Read r = read(bytes);
  EXPECT_EQ(r.packets.size(), 1U);
  EXPECT_THAT(r.error, HasSubstr("at most 262144"));
}

TEST_F(Pcap, WhatIsNoCapture) {
  EXPECT_THAT(read(packet_of("this is some text, longer than a header")).error, HasSubstr("no pcap magic"));
  EXPECT_THAT(read({}).error, HasSubstr("is empty"));
  EXPECT_THAT(read(Packet{std::byte{0x0a}, std::byte{0x0d}, std::byte{0x0d}, std::byte{0x0a}} + Packet(30)).error,
              HasSubstr("editcap"));
  EXPECT_THAT(read_all("/nowhere/at/all.pcap").error, HasSubstr("No such file"));
  EXPECT_THAT(read_all(KINEMAP_BINARY_DIR).error, HasSubstr("directory"));
}

/// A datagram of `size` payload bytes cut to IPv4 fragments of 1480 bytes, last one first when `reversed`.
std::vector<Packet> fragments4(const Packet& payload, std::uint16_t id) {
  const Packet body = udp(payload);
  std::vector<Packet> out;
  for (std::size_t at = 0; at < body.size(); at += 1480) {
    const std::size_t end = std::min(at + 1480, body.size());
    const auto flags = static_cast<std::uint16_t>(at / 8 | (end < body.size() ? 0x2000U : 0U));
    out.push_back(ethernet(ipv4(
        {body.begin() + static_cast<std::ptrdiff_t>(at), body.begin() + static_cast<std::ptrdiff_t>(end)}, flags, id)));
  }
  return out;
}

std::vector<Packet> fragments6(const Packet& payload, std::uint32_t id) {
  const Packet body = extension(17, udp(payload));  // the first fragment carries an extension header of its own
  std::vector<Packet> out;
  for (std::size_t at = 0; at < body.size(); at += 1232) {
    const std::size_t end = std::min(at + 1232, body.size());
    const Packet part(body.begin() + static_cast<std::ptrdiff_t>(at), body.begin() + static_cast<std::ptrdiff_t>(end));
    out.push_back(
        ethernet(ipv6(fragment6(60, static_cast<std::uint16_t>(at), end < body.size(), id, part), 44), 0x86dd));
  }
  return out;
}

Packet counting(std::size_t n) {
  Packet out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::byte>(i * 7 + i / 256);
  return out;
}

TEST_F(Pcap, FragmentsInAnyOrderWithRepeats) {
  const Packet payload = counting(5000);
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Packet> packets = fragments4(payload, 1);
    for (const auto& p : fragments4(payload, 2)) packets.push_back(p);
    for (const auto& p : fragments6(payload, 3)) packets.push_back(p);
    const std::size_t count = packets.size();
    if (round > 0) std::shuffle(packets.begin(), packets.end(), random);
    if (round > 10) packets.insert(packets.begin() + 1, packets.front());
    const Read r = read({}, packets);
    ASSERT_EQ(r.packets.size(), 3U) << round;
    for (const auto& p : r.packets) EXPECT_EQ(p.payload, payload);
    EXPECT_EQ(r.stats.fragments, packets.size());
    EXPECT_EQ(r.stats.fragments_unfinished, 0U);
    EXPECT_EQ(count, 12U + (fragments6(payload, 3).size() - 4));
  }
}

TEST_F(Pcap, AtomicFragmentsAreWhole) {
  const Read r = read({}, {ethernet(ipv6(fragment6(17, 0, false, 1, udp(hello_)), 44), 0x86dd)});
  ASSERT_EQ(r.packets.size(), 1U);
  EXPECT_EQ(r.stats.fragments, 0U);
}

TEST_F(Pcap, MissingAndOverlappingFragmentsAreCounted) {
  auto missing = fragments4(counting(5000), 1);
  missing.erase(missing.begin() + 1);
  Read r = read({}, missing);
  EXPECT_TRUE(r.packets.empty());
  EXPECT_EQ(r.stats.fragments_unfinished, 1U);

  auto overlapping = fragments4(counting(5000), 1);
  overlapping.insert(overlapping.begin() + 1, ethernet(ipv4(counting(16), 0x2000 | 1, 1)));
  r = read({}, overlapping);
  EXPECT_TRUE(r.packets.empty());
  EXPECT_EQ(r.stats.fragments_unfinished, 1U);

  std::vector<Packet> beyond{ethernet(ipv4(counting(64), 0x1fff, 1)), ethernet(ipv4(counting(64), 0x2000, 1))};
  r = read({}, beyond);
  EXPECT_TRUE(r.packets.empty());
  EXPECT_EQ(r.stats.fragments_unfinished, 1U);
}

TEST_F(Pcap, AFloodOfFragmentsIsBounded) {
  std::vector<Packet> packets;
  for (std::uint16_t id = 0; id < 1000; ++id) packets.push_back(fragments4(counting(3000), id)[0]);
  for (const auto& p : fragments4(counting(3000), 2000)) packets.push_back(p);
  const Read r = read({}, packets);
  EXPECT_EQ(r.packets.size(), 1U);
  EXPECT_EQ(r.stats.fragments_unfinished, 1000U);
}

TEST_F(Pcap, RandomDamageNeitherCrashesNorLoops) {
  std::mt19937 random(4);
  std::vector<Packet> packets = fragments4(counting(4000), 1);
  packets.push_back(ethernet(ipv6(extension(17, udp(hello_)), 0), 0x86dd, 1));
  const auto whole = capture({}, packets);
  for (int round = 0; round < 500; ++round) {
    auto bytes = whole;
    for (int k = 0; k < 1 + round % 5; ++k) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    const Read r = read(bytes);
    EXPECT_LE(r.stats.udp + r.stats.not_udp + r.stats.truncated, r.stats.records);
    EXPECT_EQ(r.packets.size(), r.stats.udp);
  }
}

TEST_F(Pcap, WriterIsReadBack) {
  auto writer = PcapWriter::create(file_.path(), 9763);
  ASSERT_TRUE(writer);
  std::vector<Packet> payloads;
  for (std::size_t n : {0U, 1U, 760U, 2040U, 65507U}) payloads.push_back(counting(n));
  for (std::size_t i = 0; i < payloads.size(); ++i)
    EXPECT_TRUE(writer->write(10.0 + 0.001 * static_cast<double>(i), payloads[i]));
  EXPECT_FALSE(writer->close());
  const Read r = read_all(file_.path());
  EXPECT_EQ(r.error, "");
  ASSERT_EQ(r.packets.size(), payloads.size());
  for (std::size_t i = 0; i < payloads.size(); ++i) {
    EXPECT_EQ(r.packets[i].payload, payloads[i]);
    EXPECT_NEAR(r.packets[i].time_s, 10.0 + 0.001 * static_cast<double>(i), 1e-6);
    EXPECT_EQ(r.packets[i].source, "127.0.0.1:50000");
    EXPECT_EQ(r.packets[i].destination_port, 9763);
  }
}

TEST_F(Pcap, WriterRefusesWhatCannotBeWritten) {
  EXPECT_FALSE(PcapWriter::create("/nowhere/at/all.pcap", 1));
  auto writer = PcapWriter::create(file_.path(), 9763);
  ASSERT_TRUE(writer);
  EXPECT_FALSE(writer->write(0.0, counting(65508)));
  const auto error = writer->close();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("65507"));
}

TEST_F(Pcap, FullDiskIsTold) {
  if (!exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  auto writer = PcapWriter::create("/dev/full", 9763);
  ASSERT_TRUE(writer);
  bool ok = true;
  for (int i = 0; i < 100 && ok; ++i) ok = writer->write(0.0, counting(60000));
  const auto error = writer->close();
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("No space left"));
}

TEST_F(Pcap, PacketsOfARecordingKeepTheirSenders) {
  std::string bytes = pcap_file_header();
  for (const char* sender : {"192.168.1.7:49152", "[2001:db8::7]:49153", "somebody"})
    bytes += pcap_packet(1.5, sender, 9763, hello_);
  EXPECT_EQ(pcap_packet(1.5, "1.2.3.4:5", 9763, std::vector<std::byte>(65508)), "") << "more than UDP can carry";
  const auto span = std::as_bytes(std::span(bytes));
  const Read r = read({span.begin(), span.end()});
  ASSERT_EQ(r.packets.size(), 3U) << r.error;
  EXPECT_EQ(r.packets[0].source, "192.168.1.7:49152");
  EXPECT_EQ(r.packets[1].source, "[2001:db8::7]:49153");
  EXPECT_EQ(r.packets[2].source, "127.0.0.1:0");
  for (const auto& packet : r.packets) {
    EXPECT_EQ(packet.payload, hello_);
    EXPECT_EQ(packet.destination_port, 9763);
  }
}

TEST(PcapReal, EveryRecordingIsReadToItsEnd) {
  const std::string data = std::string(KINEMAP_SHARED_DATA) + "/";
  if (!exists(data + "cmu_walk_2.pcap")) GTEST_SKIP() << "no recordings in " << data;
  const std::vector<std::pair<std::string, std::size_t>> files{{"cmu_walk_2", 598},
                                                               {"cmu_walk_3", 494},
                                                               {"cmu_washwindow_1", 2753},
                                                               {"cmu_directtraffic_4", 3702},
                                                               {"cmu_jump_1", 2085}};
  for (const auto& [name, count] : files) {
    const Read r = read_all(data + name + ".pcap");
    EXPECT_EQ(r.error, "");
    EXPECT_EQ(r.packets.size(), count) << name;
    EXPECT_EQ(r.stats.records, count);
    for (const auto& p : r.packets) ASSERT_EQ(p.payload.size(), 760U);
    EXPECT_NEAR(r.packets.back().time_s - r.packets.front().time_s, static_cast<double>(count - 1) / 120.0, 2e-6)
        << name;
  }
}

}  // namespace
}  // namespace kinemap
