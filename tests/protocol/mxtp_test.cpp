// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/mxtp.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "protocol/wire/axes.hpp"
#include "protocol/wire/big_endian.hpp"
#include "protocol/wire/utf8.hpp"
#include "tests/protocol/body_stream.hpp"

namespace kinemap::mxtp {
namespace {

using testing_support::body_items;
using testing_support::exists;
using testing_support::read_bytes;

const std::string kData = std::string(KINEMAP_SHARED_DATA) + "/";

Fault fault_of(std::span<const std::byte> bytes) {
  const auto result = decode(bytes);
  EXPECT_TRUE(std::holds_alternative<Fault>(result)) << "was accepted";
  return std::holds_alternative<Fault>(result) ? std::get<Fault>(result) : Fault::BadMagic;
}

template <class T>
T payload_of(std::span<const std::byte> bytes) {
  const auto result = decode(bytes);
  if (const auto* fault = std::get_if<Fault>(&result)) {
    ADD_FAILURE() << "refused: " << to_string(*fault);
    return {};
  }
  const auto* payload = std::get_if<T>(&std::get<Datagram>(result).payload);
  EXPECT_NE(payload, nullptr);
  return payload ? *payload : T{};
}

TrackerItem tracker(std::int32_t id) {
  return {id, {0.5F, -0.5F, 0.5F, 0.5F}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0.3F, 0, -0.9F}};
}

/// One datagram of each type that is decoded, and one of a type that is skipped.
std::vector<Bytes> one_of_each() {
  Header h;
  h.sample_counter = 77;
  h.time_code_ms = 1234;
  Scale scale{{{"Pelvis", {0, 0, 1}}, {"RightHand", {0, -0.7F, 1.4F}}}, {{11, 3, "RightTopOfHand", 0, {0, -0.18F, 0}}}};
  Bytes skipped = encode_center_of_mass(h, {{0, 0, 1}});
  skipped[4] = std::byte{'2'};
  skipped[5] = std::byte{'1'};
  return {encode_poses(h, body_items(3))[0],
          encode_poses_euler(h, body_items(3))[0],
          encode_meta(h, {{{"name", "Anna"}, {"color", "ff0000"}}}),
          encode_scale(h, scale)[0],
          encode_center_of_mass(h, {{1, 2, 3}}),
          encode_time_code(h, {"12:34:56.789"}),
          skipped,
          encode_trackers(h, std::array{tracker(1), tracker(10)})[0]};
}

void put_u8(Bytes& b, std::size_t at, unsigned v) { b[at] = static_cast<std::byte>(v); }
void put_u16(Bytes& b, std::size_t at, unsigned v) {
  put_u8(b, at, v >> 8U & 0xffU);
  put_u8(b, at + 1, v & 0xffU);
}
void put_f32(Bytes& b, std::size_t at, float v) {
  const auto u = std::bit_cast<std::uint32_t>(v);
  put_u16(b, at, u >> 16U);
  put_u16(b, at + 2, u & 0xffffU);
}

TEST(MxtpHeader, EveryFieldSurvives) {
  Header h;
  h.sample_counter = 0xfedcba98;
  h.time_code_ms = 0x89abcdef;
  h.character = 200;
  h.body_segments = 23;
  h.props = 3;
  h.finger_segments = 40;
  const auto bytes = encode_poses(h, body_items(0))[0];
  ASSERT_EQ(bytes.size(), 760U);
  const auto result = decode(bytes);
  const Header& got = std::get<Datagram>(result).header;
  EXPECT_EQ(got.type, 2);
  EXPECT_EQ(got.sample_counter, h.sample_counter);
  EXPECT_EQ(got.time_code_ms, h.time_code_ms);
  EXPECT_EQ(got.character, 200);
  EXPECT_EQ(got.props, 3);
  EXPECT_EQ(got.finger_segments, 40);
  EXPECT_EQ(got.items, 23);
  EXPECT_EQ(got.datagram_index, 0);
  EXPECT_TRUE(got.last_datagram);
  EXPECT_EQ(got.payload_size, 736);
}

TEST(MxtpRoundTrip, RandomPosesAreTheSameBits) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int round = 0; round < 200; ++round) {
    auto items = body_items(static_cast<std::uint64_t>(round));
    for (auto& item : items) {
      for (float& v : item.position) v = 50.0F * normal(random);
      float norm = 0;
      for (float& v : item.orientation) v = normal(random), norm += v * v;
      for (float& v : item.orientation) v /= std::sqrt(norm);
    }
    const auto got = payload_of<PoseItems>(encode_poses({}, items)[0]);
    ASSERT_EQ(got.items.size(), items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      EXPECT_EQ(got.items[i].id, items[i].id);
      EXPECT_EQ(got.items[i].position, items[i].position);
      EXPECT_EQ(got.items[i].orientation, items[i].orientation);
    }
  }
}

TEST(MxtpRoundTrip, EulerKeepsRotationAndPosition) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 500; ++round) {
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    SegmentItem item;
    item.id = 1;
    item.position = {1.5F, -2.25F, 0.125F};
    item.orientation = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                        static_cast<float>(q.z())};
    const auto got = payload_of<PoseItems>(encode_poses_euler({}, std::span(&item, 1))[0]).items.at(0);
    const Eigen::Quaterniond back(got.orientation[0], got.orientation[1], got.orientation[2], got.orientation[3]);
    // Close to ±90° about y the float angles lose half their digits.
    EXPECT_LT(back.angularDistance(q), 2e-3) << round;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(got.position[k], item.position[k], 1e-6);
  }
}

TEST(MxtpRoundTrip, MetaScaleComAndTimeCode) {
  const auto all = one_of_each();
  EXPECT_THAT(payload_of<MetaData>(all[2]).tags,
              testing::ElementsAre(testing::Pair("name", "Anna"), testing::Pair("color", "ff0000")));
  EXPECT_THAT(payload_of<CenterOfMass>(all[4]).position, testing::ElementsAre(1, 2, 3));
  EXPECT_EQ(payload_of<TimeCode>(all[5]).text, "12:34:56.789");
  const auto scale = decode_scale(payload_of<ScaleFragment>(all[3]).bytes);
  ASSERT_TRUE(std::holds_alternative<Scale>(scale));
  const auto& s = std::get<Scale>(scale);
  ASSERT_EQ(s.segments.size(), 2U);
  EXPECT_EQ(s.segments[1].name, "RightHand");
  EXPECT_EQ(s.segments[1].origin, (std::array<float, 3>{0, -0.7F, 1.4F}));
  ASSERT_EQ(s.points.size(), 1U);
  EXPECT_EQ(s.points[0].segment, 11);
  EXPECT_EQ(s.points[0].point, 3);
  EXPECT_EQ(s.points[0].name, "RightTopOfHand");
  payload_of<Skipped>(all[6]);
}

TEST(MxtpRoundTrip, TimeCodeIsTakenBareAsWell) {
  Bytes bytes = one_of_each()[5];
  bytes.erase(bytes.begin() + 24, bytes.begin() + 28);
  put_u16(bytes, 22, 12);
  EXPECT_EQ(payload_of<TimeCode>(bytes).text, "12:34:56.789");
}

TEST(MxtpSplit, SixtyThreeItemsFillOneDatagramOf2040Bytes) {
  std::vector<SegmentItem> items(64, body_items(0)[0]);
  Header h;
  h.finger_segments = 40;
  h.props = 1;
  const auto parts = encode_poses(h, items);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].size(), 2040U);
  EXPECT_EQ(parts[1].size(), 24U + 32U);
  EXPECT_EQ(std::to_integer<int>(parts[0][10]), 0x00);
  EXPECT_EQ(std::to_integer<int>(parts[1][10]), 0x81);
  EXPECT_EQ(std::to_integer<int>(parts[0][11]), 63);
}

TEST(MxtpSplit, ScaleMessageIsJoinedFromAnyPartSize) {
  Scale scale;
  for (int i = 0; i < 23; ++i)
    scale.segments.push_back({"Segment" + std::to_string(i), {0, 0, 0.1F * static_cast<float>(i)}});
  for (int i = 0; i < 70; ++i)
    scale.points.push_back({11, static_cast<std::uint16_t>(i), "point" + std::to_string(i), 1, {0, -0.1F, 0}});
  for (const std::size_t size : {25U, 40U, 100U, 1000U, 2040U}) {
    const auto parts = encode_scale({}, scale, size);
    if (parts.size() > 128) continue;
    Bytes joined;
    for (const auto& part : parts) {
      EXPECT_LE(part.size(), size);
      const auto bytes = payload_of<ScaleFragment>(part).bytes;
      joined.insert(joined.end(), bytes.begin(), bytes.end());
    }
    const auto got = decode_scale(joined);
    ASSERT_TRUE(std::holds_alternative<Scale>(got)) << size;
    EXPECT_EQ(std::get<Scale>(got).points.size(), 70U);
    EXPECT_EQ(std::get<Scale>(got).points[69].name, "point69");
  }
}

TEST(MxtpFaults, EveryTruncationIsRefused) {
  for (const Bytes& bytes : one_of_each()) {
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      const Fault fault = fault_of(std::span(bytes).first(n));
      EXPECT_EQ(fault, n < 24 ? Fault::TooShort : Fault::BadLength)
          << "type " << static_cast<char>(bytes[5]) << " cut to " << n;
    }
  }
}

TEST(MxtpFaults, EveryTruncationOfOldSendersIsRefusedToo) {
  for (Bytes bytes : one_of_each()) {
    put_u16(bytes, 22, 0);
    const bool open_ended = bytes[4] == std::byte{'2'} && bytes[5] == std::byte{'1'};  // skipped: any length
    const bool fragment = bytes[4] == std::byte{'1'} && bytes[5] == std::byte{'3'};    // joined first
    EXPECT_TRUE(std::holds_alternative<Datagram>(decode(bytes)));
    const bool tracker = bytes[4] == std::byte{'2'} && bytes[5] == std::byte{'3'};
    for (std::size_t n = 0; n < bytes.size() && !(open_ended && n >= 24) && !(fragment && n > 24); ++n) {
      if (tracker && n == kHeaderSize + 2 * 44U) continue;  // as long as two items of the published size: skipped
      fault_of(std::span(bytes).first(n));
    }
  }
}

TEST(MxtpFaults, TrailingBytes) {
  for (Bytes bytes : one_of_each()) {
    bytes.push_back(std::byte{0});
    EXPECT_EQ(fault_of(bytes), Fault::BadLength);
  }
  Bytes old = one_of_each()[0];
  put_u16(old, 22, 0);
  old.push_back(std::byte{0});
  EXPECT_EQ(fault_of(old), Fault::BadLength);
}

TEST(MxtpFaults, Magic) {
  for (std::size_t i = 0; i < 6; ++i) {
    Bytes bytes = one_of_each()[0];
    bytes[i] = std::byte{'?'};
    EXPECT_EQ(fault_of(bytes), Fault::BadMagic) << i;
  }
}

TEST(MxtpFaults, EveryTypeNumberIsKnownOrRefused) {
  const std::vector<int> known{1, 2, 3, 4, 5, 10, 11, 12, 13, 20, 21, 22, 23, 24, 25};
  for (int type = 0; type < 100; ++type) {
    Bytes bytes = one_of_each()[0];
    put_u8(bytes, 4, static_cast<unsigned>('0' + type / 10));
    put_u8(bytes, 5, static_cast<unsigned>('0' + type % 10));
    const auto result = decode(bytes);
    const auto* fault = std::get_if<Fault>(&result);
    const bool refused = fault && *fault == Fault::UnknownType;
    EXPECT_EQ(refused, std::find(known.begin(), known.end(), type) == known.end()) << type;
  }
}

TEST(MxtpFaults, ItemCount) {
  Bytes bytes = one_of_each()[0];
  put_u8(bytes, 11, 22);
  EXPECT_EQ(fault_of(bytes), Fault::BadLength);
  put_u8(bytes, 11, 24);
  EXPECT_EQ(fault_of(bytes), Fault::TooShort);
  put_u8(bytes, 11, 23);
  put_u8(bytes, 17, 22);
  EXPECT_EQ(fault_of(bytes), Fault::BadItemCount) << "more items than the header's segments";
  put_u8(bytes, 17, 0);
  EXPECT_TRUE(std::holds_alternative<Datagram>(decode(bytes))) << "senders before 2019 leave the counts 0";
  Bytes none = encode_poses({}, {})[0];
  EXPECT_EQ(fault_of(none), Fault::BadItemCount);
}

TEST(MxtpFaults, EveryFloatMustBeFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    for (std::size_t i = 0; i < 7; ++i) {
      Bytes bytes = one_of_each()[0];
      put_f32(bytes, 24 + 32 * 22 + 4 + 4 * i, bad);
      EXPECT_EQ(fault_of(bytes), Fault::NotFinite);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      Bytes bytes = one_of_each()[1];
      put_f32(bytes, 24 + 28 * 22 + 4 + 4 * i, bad);
      EXPECT_EQ(fault_of(bytes), Fault::NotFinite);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      Bytes bytes = one_of_each()[4];
      put_f32(bytes, 24 + 4 * i, bad);
      EXPECT_EQ(fault_of(bytes), Fault::NotFinite);
    }
  }
}

TEST(MxtpFaults, QuaternionNorm) {
  const auto with_norm = [](float norm) {
    auto items = body_items(0);
    items[7].orientation = {norm, 0, 0, 0};
    return encode_poses({}, items)[0];
  };
  EXPECT_EQ(fault_of(with_norm(1.02F)), Fault::NotUnit);
  EXPECT_EQ(fault_of(with_norm(0.98F)), Fault::NotUnit);
  EXPECT_EQ(fault_of(with_norm(0.0F)), Fault::NotUnit);
  EXPECT_EQ(fault_of(with_norm(3e38F)), Fault::NotUnit);
  EXPECT_EQ(payload_of<PoseItems>(with_norm(1.005F)).items.size(), 23U);
}

TEST(MxtpRoundTrip, Trackers) {
  const Bytes bytes = one_of_each()[7];
  ASSERT_EQ(bytes.size(), kHeaderSize + 2 * 68U);
  const auto items = payload_of<TrackerItems>(bytes).items;
  ASSERT_EQ(items.size(), 2U);
  const TrackerItem& got = items[1];
  const TrackerItem want = tracker(10);
  EXPECT_EQ(got.id, 10);
  EXPECT_EQ(got.orientation, want.orientation);
  EXPECT_EQ(got.free_acceleration, want.free_acceleration);
  EXPECT_EQ(got.acceleration, want.acceleration);
  EXPECT_EQ(got.angular_velocity, want.angular_velocity);
  EXPECT_EQ(got.magnetic_field, want.magnetic_field);
  std::vector<TrackerItem> all(17, tracker(3));
  EXPECT_EQ(encode_trackers({}, all).size(), 1U);
  EXPECT_EQ(encode_trackers({}, all, 700).size(), 2U);
}

/// The published item is shorter; nothing is known of it that could be used.
TEST(MxtpRoundTrip, TrackersOfThePublishedSizeAreSkipped) {
  Bytes bytes = encode_trackers({}, std::array{tracker(1)})[0];
  bytes.resize(kHeaderSize + 44);
  put_u16(bytes, 22, 44);
  payload_of<Skipped>(bytes);
}

TEST(MxtpFaults, Trackers) {
  Bytes bytes = encode_trackers({}, std::array{tracker(1)})[0];
  put_f32(bytes, kHeaderSize + 4, 0.9F);
  EXPECT_EQ(fault_of(bytes), Fault::NotUnit);
  for (const std::size_t at : {20U, 32U, 44U, 56U}) {
    Bytes nan = encode_trackers({}, std::array{tracker(1)})[0];
    put_f32(nan, kHeaderSize + at, std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(fault_of(nan), Fault::NotFinite);
  }
  EXPECT_EQ(fault_of(encode_trackers({}, std::array{tracker(-1)})[0]), Fault::OutOfRange);
}

TEST(MxtpFaults, Range) {
  auto items = body_items(0);
  items[22].position[2] = 100'001.0F;
  EXPECT_EQ(fault_of(encode_poses({}, items)[0]), Fault::OutOfRange);
  items[22].position[2] = -1.0F;
  items[22].id = -1;
  EXPECT_EQ(fault_of(encode_poses({}, items)[0]), Fault::OutOfRange);
  items[22].id = 256;
  EXPECT_EQ(fault_of(encode_poses({}, items)[0]), Fault::OutOfRange);
  EXPECT_EQ(fault_of(encode_center_of_mass({}, {{0, 2e5F, 0}})), Fault::OutOfRange);
  Bytes euler = one_of_each()[1];
  put_f32(euler, 24 + 16, 721.0F);
  EXPECT_EQ(fault_of(euler), Fault::OutOfRange);
}

TEST(MxtpFaults, Text) {
  EXPECT_EQ(fault_of(encode_meta({}, {{{"name", "\xc3\x28"}}})), Fault::BadText);
  Bytes meta = one_of_each()[2];
  put_u8(meta, 27, std::to_integer<unsigned>(meta[27]) + 1);
  EXPECT_EQ(fault_of(meta), Fault::BadText) << "longer than the datagram";
  put_u8(meta, 24, 0x80);
  EXPECT_EQ(fault_of(meta), Fault::BadText) << "negative";
  EXPECT_EQ(fault_of(encode_time_code({}, {"12:34:56,789"})), Fault::BadText);
  EXPECT_EQ(fault_of(encode_time_code({}, {"1:34:56.7890"})), Fault::BadText);
  EXPECT_EQ(fault_of(encode_time_code({}, {"12:34:56.7890"})), Fault::BadLength);
}

TEST(MxtpMeta, UnknownTagsAndOddLinesDoNoHarm) {
  const auto meta = payload_of<MetaData>(encode_meta({}, {{{"name", "a:b:c"}, {"x", ""}}}));
  EXPECT_THAT(meta.tags, testing::ElementsAre(testing::Pair("name", "a:b:c"), testing::Pair("x", "")));
  BigEndianWriter text;
  const std::string lines = "no colon\r\nname:Bo\r\n\n:";
  text.i32(static_cast<std::int32_t>(lines.size()));
  text.text(lines);
  Bytes bytes = encode_meta({}, {});
  bytes.resize(24);
  bytes.insert(bytes.end(), text.view().begin(), text.view().end());
  put_u16(bytes, 22, static_cast<unsigned>(text.size()));
  EXPECT_THAT(payload_of<MetaData>(bytes).tags,
              testing::ElementsAre(testing::Pair("name", "Bo"), testing::Pair("", "")));
}

TEST(MxtpScale, EveryTruncationIsRefused) {
  const auto bytes = payload_of<ScaleFragment>(one_of_each()[3]).bytes;
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    EXPECT_TRUE(std::holds_alternative<Fault>(decode_scale(std::span(bytes).first(n)))) << n;
  }
  EXPECT_TRUE(std::holds_alternative<Scale>(decode_scale(bytes)));
}

TEST(MxtpScale, FaultsAreTold) {
  const auto fault = [](auto&& write) {
    BigEndianWriter w;
    write(w);
    const auto result = decode_scale(w.view());
    return std::get<Fault>(result);
  };
  EXPECT_EQ(fault([](auto& w) { w.i32(-1); }), Fault::BadItemCount);
  EXPECT_EQ(fault([](auto& w) { w.i32(1 << 20); }), Fault::BadItemCount);
  EXPECT_EQ(fault([](auto& w) {
              w.i32(1);
              w.i32(-5);
            }),
            Fault::BadText);
  EXPECT_EQ(fault([](auto& w) {
              w.i32(1);
              w.i32(1 << 20);
            }),
            Fault::BadText);
  EXPECT_EQ(fault([](auto& w) {
              w.i32(1);
              w.i32(2);
              w.text("\xff\xff");
              for (int i = 0; i < 3; ++i) w.f32(0);
              w.i32(0);
            }),
            Fault::BadText);
  EXPECT_EQ(fault([](auto& w) {
              w.i32(1);
              w.i32(1);
              w.text("a");
              w.f32(NAN);
              w.f32(0);
              w.f32(0);
              w.i32(0);
            }),
            Fault::NotFinite);
  EXPECT_EQ(fault([](auto& w) {
              w.i32(1);
              w.i32(1);
              w.text("a");
              w.f32(11);
              w.f32(0);
              w.f32(0);
              w.i32(0);
            }),
            Fault::OutOfRange);
}

TEST(MxtpScale, LaterPartsMayBeBlocksOfTheirOwn) {
  BigEndianWriter head;
  head.i32(1);
  head.i32(4);
  head.text("Head");
  for (const float f : {0.0F, 0.0F, 1.6F}) head.f32(f);
  head.i32(0);
  const auto with = [&](bool empty_segments) {
    BigEndianWriter w = head;
    if (empty_segments) w.i32(0);
    w.i32(1);
    w.u16(11);
    w.u16(1);
    w.i32(1);
    w.text("p");
    w.u32(0);
    for (int i = 0; i < 3; ++i) w.f32(0.5F);
    return decode_scale(w.view());
  };
  for (const bool empty_segments : {false, true}) {
    const auto result = with(empty_segments);
    ASSERT_TRUE(std::holds_alternative<Scale>(result)) << empty_segments;
    EXPECT_EQ(std::get<Scale>(result).segments.size(), 1U);
    EXPECT_EQ(std::get<Scale>(result).points.size(), 1U);
  }
}

TEST(Utf8, WellFormedOrNot) {
  for (const char* good :
       {"", "abc", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xed\x9f\xbf", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(good)) << good;
  }
  for (const char* bad : {"\x80", "\xc0\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                          "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xe2\x82", "a\xff", "\xc3", "\xf0\x9f\x98"}) {
    EXPECT_FALSE(is_utf8(bad)) << bad;
  }
}

TEST(MxtpReal, PosesOfTypes01And02AreTheSameSample) {
  if (!exists(kData + "mxtp01.bin")) GTEST_SKIP() << "no recordings in " << kData;
  const auto a = decode(read_bytes(kData + "mxtp01.bin"));
  const auto b = decode(read_bytes(kData + "mxtp02.bin"));
  const auto& ha = std::get<Datagram>(a).header;
  EXPECT_EQ(ha.sample_counter, 0x1a19U);
  EXPECT_EQ(ha.time_code_ms, 0x6cbdU);
  EXPECT_EQ(ha.items, 23);
  EXPECT_EQ(ha.body_segments, 23);
  EXPECT_EQ(std::get<Datagram>(b).header.sample_counter, ha.sample_counter);
  const auto& pa = std::get<PoseItems>(std::get<Datagram>(a).payload).items;
  const auto& pb = std::get<PoseItems>(std::get<Datagram>(b).payload).items;
  ASSERT_EQ(pa.size(), 23U);
  ASSERT_EQ(pb.size(), 23U);
  for (std::size_t i = 0; i < 23; ++i) {
    EXPECT_EQ(pa[i].id, static_cast<int>(i + 1));
    EXPECT_EQ(pb[i].id, static_cast<int>(i + 1));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(pa[i].position[k], pb[i].position[k], 1e-6);
    const auto q = [](const SegmentItem& s) {
      return Eigen::Quaterniond(s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]).normalized();
    };
    EXPECT_LT(q(pa[i]).angularDistance(q(pb[i])), 1e-3) << "segment " << i + 1;  // 0.03° at most
  }
}

TEST(MxtpReal, MetaAndScale) {
  if (!exists(kData + "mxtp12.bin")) GTEST_SKIP() << "no recordings in " << kData;
  EXPECT_THAT(payload_of<MetaData>(read_bytes(kData + "mxtp12.bin")).tags,
              testing::ElementsAre(testing::Pair("color", "e96417"), testing::Pair("count", "1"),
                                   testing::Pair("name", "Factory"), testing::Pair("timeOffset", "-3600000")));
  const auto bytes = read_bytes(kData + "mxtp13.bin");
  const auto datagram = decode(bytes);
  EXPECT_FALSE(std::get<Datagram>(datagram).header.last_datagram) << "the first part of several";
  const auto scale = decode_scale(payload_of<ScaleFragment>(bytes).bytes);
  ASSERT_TRUE(std::holds_alternative<Scale>(scale));
  const auto& s = std::get<Scale>(scale);
  ASSERT_EQ(s.segments.size(), 23U);
  EXPECT_TRUE(s.points.empty());
  EXPECT_EQ(s.segments[6].name, "Head");
  EXPECT_NEAR(s.segments[6].origin[2], 1.7869, 1e-3);
  EXPECT_EQ(s.segments[10].name, "RightHand");
  EXPECT_NEAR(s.segments[10].origin[1], -0.8244, 1e-3);
}

TEST(MxtpReal, EncodersGiveTheRealBytes) {
  if (!exists(kData + "mxtp02.bin")) GTEST_SKIP() << "no recordings in " << kData;
  const auto bytes = read_bytes(kData + "mxtp02.bin");
  const auto datagram = decode(bytes);
  const auto& d = std::get<Datagram>(datagram);
  EXPECT_EQ(encode_poses(d.header, std::get<PoseItems>(d.payload).items)[0], bytes);
  const auto meta_bytes = read_bytes(kData + "mxtp12.bin");
  const auto meta = decode(meta_bytes);
  EXPECT_EQ(encode_meta(std::get<Datagram>(meta).header, std::get<MetaData>(std::get<Datagram>(meta).payload)),
            meta_bytes);
}

}  // namespace
}  // namespace kinemap::mxtp
