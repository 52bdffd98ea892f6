// SPDX-License-Identifier: Apache-2.0
#include "protocol/assembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "protocol/wire/segment_names.hpp"
#include "tests/protocol/assembler_bench.hpp"

namespace kinemap {
namespace {

using namespace testing_support;
using testing::HasSubstr;

/// Every frame is the body of its sample, at the time of its counter.
void expect_true_frames(const Bench& bench, double rate_hz, std::uint64_t first_index = 0, double tolerance_s = 1e-9) {
  ASSERT_FALSE(bench.frames.empty());
  const std::uint64_t i0 = bench.frames.front().index;
  for (const SuitFrame& f : bench.frames) {
    ASSERT_NEAR(f.time_s, static_cast<double>(f.index - i0) / rate_hz, tolerance_s) << f.index;
    const auto truth = body_items(f.index - first_index);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      for (int k = 0; k < 3; ++k) ASSERT_EQ(f.segments[i].p[k], truth[i].position[static_cast<std::size_t>(k)]);
    }
  }
}

TEST(Assembler, PlainStreamAtEveryRate) {
  for (const double rate : {60.0, 80.0, 100.0, 120.0, 240.0}) {
    Bench bench;
    bench.add(walk(0, 600, rate));
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 600U);
    EXPECT_EQ(bench.assembler.rate_hz(), rate);
    EXPECT_EQ(bench.stats().used, 600U);
    EXPECT_EQ(bench.stats().lost_samples, 0U);
    EXPECT_EQ(bench.stats().odd_bones, 0U);
    EXPECT_FALSE(bench.frames.front().discontinuity);
    expect_true_frames(bench, rate);
  }
}

TEST(Assembler, RatesThatMvnDoesNotOfferAreMeasured) {
  for (const double rate : {67.3, 90.0, 133.0, 200.0}) {
    Bench bench;
    bench.add(walk(0, 3000, rate));
    bench.flush();
    EXPECT_NEAR(bench.assembler.rate_hz(), rate, 0.0005 * rate);
    expect_true_frames(bench, rate, 0, 0.006);
  }
}

TEST(Assembler, FramesComeOutAtOnceOnceTheStreamRuns) {
  Bench bench;
  const auto all = walk(0, 200);
  for (std::size_t k = 0; k < all.size(); ++k) {
    bench.add(all[k]);
    if (k > 30) {
      EXPECT_EQ(bench.frames.size(), k + 1);
    }
  }
}

TEST(Assembler, HalfOfTheSamplesLost) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    for (const double rate : {60.0, 120.0, 240.0}) {
      auto all = walk(0, 2000, rate);
      std::erase_if(all, [&](const Arrival&) { return random() % 2 == 0; });
      Bench bench;
      bench.add(all);
      bench.flush();
      EXPECT_EQ(bench.frames.size(), all.size());
      EXPECT_EQ(bench.assembler.rate_hz(), rate);
      EXPECT_EQ(bench.stats().lost_samples + bench.frames.size(),
                bench.frames.back().index - bench.frames.front().index + 1);
      for (const SuitFrame& f : bench.frames) EXPECT_FALSE(f.discontinuity);
      expect_true_frames(bench, rate);
    }
  }
}

TEST(Assembler, ReorderedWithinTheWindowNothingIsLost) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> delay(0.0, 0.045);
    auto all = walk(0, 500, 120.0, 0, 0, 300);  // three datagrams a sample
    for (Arrival& a : all) a.time_s += delay(random);
    std::stable_sort(all.begin(), all.end(), [](const Arrival& a, const Arrival& b) { return a.time_s < b.time_s; });
    Bench bench;
    bench.add(all);
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 500U) << seed;
    EXPECT_EQ(bench.stats().incomplete + bench.stats().late, 0U);
    expect_true_frames(bench, 120.0);
  }
}

TEST(Assembler, TooLateIsCounted) {
  auto all = walk(0, 200);
  const Arrival held = all[100];
  all.erase(all.begin() + 100);
  all.insert(all.begin() + 150, held);
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 199U);
  EXPECT_EQ(bench.stats().late, 1U);
  EXPECT_EQ(bench.stats().lost_samples, 1U);
}

TEST(Assembler, DuplicatesOfAllKinds) {
  const auto all = walk(0, 200, 120.0, 0, 0, 300);
  std::vector<Arrival> doubled;
  for (std::size_t i = 0; i < all.size(); ++i) {
    doubled.push_back(all[i]);
    doubled.push_back(all[i]);                    // at once
    if (i >= 20) doubled.push_back(all[i - 20]);  // after its sample was handed on
  }
  Bench bench;
  bench.add(doubled);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 200U);
  EXPECT_EQ(bench.stats().duplicates, doubled.size() - all.size());
  EXPECT_EQ(bench.stats().used, all.size());
}

TEST(Assembler, SamplesSplitOverDatagramsOfAnySize) {
  for (const std::size_t size : {56U, 100U, 200U, 400U, 759U}) {
    Bench bench;
    bench.add(walk(0, 100, 120.0, 0, 0, size));
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 100U) << size;
    expect_true_frames(bench, 120.0);
  }
}

TEST(Assembler, ALostPartMakesTheSampleIncomplete) {
  auto all = walk(0, 100, 120.0, 0, 0, 300);
  const std::size_t parts = all.size() / 100;
  ASSERT_EQ(parts, 3U);
  all.erase(all.begin() + 3 * 50 + 1);
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 99U);
  EXPECT_EQ(bench.stats().incomplete, 1U);
  EXPECT_EQ(bench.stats().incomplete_datagrams, 2U);
  EXPECT_EQ(bench.stats().lost_samples, 1U);
}

TEST(Assembler, PropsAndFingersFollowTheBody) {
  std::vector<Arrival> all;
  for (std::uint64_t k = 0; k < 100; ++k) {
    auto items = body_items(k);
    for (int i = 0; i < 42; ++i) {  // 2 props whose ids repeat the body's, 20 + 20 fingers
      mxtp::SegmentItem extra = items[static_cast<std::size_t>(i % 23)];
      extra.id = i < 2 ? i + 1 : 22 + i;
      extra.position = {9, 9, 9};
      items.push_back(extra);
    }
    auto h = header_of(k);
    h.props = 2;
    h.finger_segments = 40;
    for (auto& bytes : mxtp::encode_poses(h, items)) all.push_back({bytes, 100.0 + static_cast<double>(k) / 120.0});
  }
  ASSERT_EQ(all.size(), 200U);
  ASSERT_EQ(all[0].bytes.size(), 2040U);
  std::swap(all[20], all[21]);
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 100U);
  EXPECT_EQ(bench.stats().used, 200U);
  expect_true_frames(bench, 120.0);
}

TEST(Assembler, SendersBefore2019LeaveTheCountsZero) {
  Bench bench;
  for (auto a : walk(0, 100)) {
    a.bytes[17] = std::byte{0};
    a.bytes[22] = a.bytes[23] = std::byte{0};
    bench.add(a);
  }
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 100U);
}

TEST(Assembler, CounterWrapsWithoutAGap) {
  Bench bench;
  bench.add(walk(0, 400, 120.0, 0xffffff00U));
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 400U);
  EXPECT_EQ(bench.stats().restarts + bench.stats().lost_samples, 0U);
  EXPECT_EQ(bench.frames.front().index, 0xffffff00U);
  EXPECT_EQ(bench.frames.back().index, 0xffffff00ULL + 399);
  expect_true_frames(bench, 120.0, 0xffffff00U);
}

TEST(Assembler, MidnightIsNoJump) {
  for (const double rate : {60.0, 240.0}) {
    Bench bench;
    bench.add(walk(0, 1000, rate, 0, 86'400'000 - 2'000));
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 1000U);
    EXPECT_EQ(bench.stats().clock_jumps, 0U);
    expect_true_frames(bench, rate);
  }
}

TEST(Assembler, MidnightAmongTheFirstSamples) {
  Bench bench;
  bench.add(walk(0, 1000, 120.0, 0, 86'400'000 - 50));
  bench.flush();
  EXPECT_EQ(bench.stats().clock_jumps, 0U);
  expect_true_frames(bench, 120.0);
}

TEST(Assembler, ATimeCodeThatJumpsAloneIsNotBelieved) {
  auto all = walk(0, 300);
  const auto later = walk(300, 600, 120.0, 0, 5'000'000);
  all.insert(all.end(), later.begin(), later.end());
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.stats().clock_jumps, 1U);
  for (const auto& f : bench.frames) EXPECT_FALSE(f.discontinuity) << "the body moves on: only the clock was set";
  expect_true_frames(bench, 120.0);
}

TEST(Assembler, ATimeCodeJumpWithALeapOfTheBodyIsADiscontinuity) {
  Bench bench;
  bench.add(walk(0, 300));
  for (std::uint64_t k = 300; k < 600; ++k) {
    bench.add({mxtp::encode_poses(header_of(k, 120.0, 0, 5'000'000), body_items(k, {4, 0, 0}))[0],
               100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  ASSERT_EQ(bench.frames.size(), 600U);
  for (const auto& f : bench.frames) EXPECT_EQ(f.discontinuity, f.index == 300);
}

TEST(Assembler, AResetOfTheOriginIsADiscontinuityAndCounted) {
  for (const std::uint64_t lost : {0U, 30U}) {
    Bench bench;
    bench.add(walk(0, 300));
    for (std::uint64_t k = 300 + lost; k < 600; ++k) {
      bench.add(
          {mxtp::encode_poses(header_of(k), body_items(k, {-12, 3, 0}))[0], 100.0 + static_cast<double>(k) / 120.0});
    }
    bench.flush();
    ASSERT_EQ(bench.frames.size(), 600U - lost);
    for (const auto& f : bench.frames) EXPECT_EQ(f.discontinuity, f.index == 300 + lost);
    EXPECT_EQ(bench.stats().jumps, 1U);
    EXPECT_EQ(bench.stats().restarts, 0U);
  }
}

TEST(Assembler, ASenderThatPausesWithItsCounterIsSilentForSoLong) {
  Bench bench;
  bench.add(walk(0, 300));
  for (std::uint64_t k = 300; k < 600; ++k) {  // the wearer walked 5 m meanwhile
    bench.add({mxtp::encode_poses(header_of(k, 120.0, 0, 20'000), body_items(k, {4, 3, 0}))[0],
               120.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  ASSERT_EQ(bench.frames.size(), 600U);
  for (const auto& f : bench.frames) EXPECT_FALSE(f.discontinuity) << "20 s are enough to walk 5 m";
  EXPECT_NEAR(bench.frames[300].time_s - bench.frames[299].time_s, 20.0, 0.05);
}

TEST(Assembler, ATimeCodeThatStandsStill) {
  Bench bench;
  for (auto a : walk(0, 600)) {
    for (std::size_t i = 12; i < 16; ++i) a.bytes[i] = std::byte{0};
    bench.add(a);
  }
  bench.flush();
  EXPECT_EQ(bench.assembler.rate_hz(), 120.0) << "from the arrivals";
  expect_true_frames(bench, 120.0);
}

TEST(Assembler, RateChangesInMidStream) {
  auto all = walk(0, 600, 60.0);
  const double end = all.back().time_s;
  for (std::uint64_t k = 600; k < 4000; ++k) {
    auto h = header_of(k - 600, 240.0, 600, 10'004);
    all.push_back({mxtp::encode_poses(h, body_items(k))[0], end + static_cast<double>(k - 599) / 240.0});
  }
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 4000U);
  EXPECT_EQ(bench.assembler.rate_hz(), 240.0);
  const double true_end = 10.004 + 3399.0 / 240.0;
  EXPECT_NEAR(bench.frames.back().time_s, true_end, 0.01);
}

TEST(Assembler, RestartAfterSilence) {
  for (const std::uint32_t new_first : {0U, 500U}) {
    auto all = walk(0, 1000, 120.0, 1000);
    for (auto a : walk(0, 300, 120.0, new_first)) {
      a.time_s += 20.0;
      all.push_back(a);
    }
    Bench bench;
    bench.add(all);
    bench.flush();
    ASSERT_EQ(bench.frames.size(), 1300U);
    EXPECT_EQ(bench.stats().restarts, 1U);
    for (std::size_t i = 0; i < bench.frames.size(); ++i) EXPECT_EQ(bench.frames[i].discontinuity, i == 1000);
    EXPECT_NEAR(bench.frames[1000].time_s, 20.0, 0.01);
    EXPECT_NEAR(bench.frames[1299].time_s - bench.frames[1000].time_s, 299.0 / 120.0, 1e-6);
  }
}

TEST(Assembler, AJumpBackWithoutSilenceIsLateUntilTheSilenceHasPassed) {
  auto all = walk(0, 1000, 120.0, 1000);
  const double end = all.back().time_s;
  for (auto a : walk(0, 300, 120.0, 0)) {
    a.time_s += end - 100.0 + 1.0 / 120.0;
    all.push_back(a);
  }
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.stats().restarts, 1U);
  EXPECT_NEAR(static_cast<double>(bench.stats().late), 0.75 * 120, 2);
  EXPECT_EQ(bench.frames.size() + bench.stats().late, 1300U);
}

TEST(Assembler, ASingleWildCounterDoesNotStopTheStream) {
  for (const std::uint32_t wild : {0U, 5'000U, 0x7fffffffU, 0x80000000U, 0xffffffffU}) {
    auto all = walk(0, 1000, 120.0, 100'000);
    Arrival odd = all[500];
    for (int i = 0; i < 4; ++i)
      odd.bytes[static_cast<std::size_t>(6 + i)] = static_cast<std::byte>((100'000 + wild) >> (24 - 8 * i));
    odd.time_s += 1e-4;
    all.insert(all.begin() + 501, odd);
    Bench bench;
    bench.add(all);
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 1000U) << wild;
    EXPECT_EQ(bench.stats().restarts, 0U);
  }
}

TEST(Assembler, ALongLossOfTheNetworkIsAGapNotARestart) {
  auto all = walk(0, 1000);
  const auto later = walk(9000, 9500);
  all.insert(all.end(), later.begin(), later.end());
  Bench bench;
  bench.add(all);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 1500U);
  EXPECT_EQ(bench.stats().restarts, 0U);
  EXPECT_EQ(bench.stats().lost_samples, 8000U);
  expect_true_frames(bench, 120.0);
}

std::vector<Arrival> with_character(std::vector<Arrival> all, std::uint8_t character,
                                    const std::string& sender = "10.0.0.1:5000") {
  for (Arrival& a : all) {
    a.bytes[16] = static_cast<std::byte>(character);
    a.sender = sender;
  }
  return all;
}

std::vector<Arrival> merged(const std::vector<std::vector<Arrival>>& streams) {
  std::vector<Arrival> out;
  for (const auto& s : streams) out.insert(out.end(), s.begin(), s.end());
  std::stable_sort(out.begin(), out.end(), [](const Arrival& a, const Arrival& b) { return a.time_s < b.time_s; });
  return out;
}

/// A tracked object: a character of one item, though the header says 23 as MVN's does.
std::vector<Arrival> object(std::uint64_t count, std::uint8_t character) {
  std::vector<Arrival> out;
  for (std::uint64_t k = 0; k < count; ++k) {
    const auto item = body_items(k)[0];
    out.push_back({mxtp::encode_poses(header_of(k), std::span(&item, 1))[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  return with_character(out, character);
}

TEST(Assembler, ObjectsAreNoPersonsAndTheFirstPersonIsMapped) {
  Bench bench;
  bench.add(merged({object(300, 0), with_character(walk(0, 300), 1), with_character(walk(0, 300), 2)}));
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 300U);
  EXPECT_EQ(bench.stats().not_a_person, 300U);
  EXPECT_EQ(bench.stats().other_character, 300U);
  EXPECT_FALSE(bench.assembler.refusal());
}

TEST(Assembler, TheCharacterCanBeChosen) {
  AssemblerConfig config;
  config.character = 2;
  Bench bench(config);
  bench.add(merged({object(300, 0), with_character(walk(0, 300), 1), with_character(walk(0, 200), 2)}));
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 200U);
  EXPECT_EQ(bench.stats().not_a_person, 300U);
  EXPECT_EQ(bench.stats().other_character, 300U);
}

TEST(Assembler, OnlyObjectsAreRefusedWithAReason) {
  Bench bench;
  bench.add(object(300, 0));
  ASSERT_TRUE(bench.assembler.refusal());
  EXPECT_THAT(*bench.assembler.refusal(), HasSubstr("whole-body"));
  auto person = with_character(walk(0, 200), 1);
  for (auto& a : person) a.time_s += 10;
  bench.add(person);
  EXPECT_FALSE(bench.assembler.refusal());
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 200U);
}

TEST(Assembler, OnlyOtherTypesAreRefusedWithAReason) {
  Bench bench;
  for (auto a : walk(0, 200)) {
    a.bytes[4] = std::byte{'2'};
    a.bytes[5] = std::byte{'0'};
    bench.add(a);
  }
  EXPECT_EQ(bench.stats().skipped_types, 200U);
  ASSERT_TRUE(bench.assembler.refusal());
  EXPECT_THAT(*bench.assembler.refusal(), HasSubstr("type 02"));
}

TEST(Assembler, OneSenderPerCharacter) {
  Bench bench;
  bench.add(merged({with_character(walk(0, 400), 0, "10.0.0.1:5000"),
                    with_character(walk(0, 400, 120.0, 7000), 0, "10.0.0.2:5000")}));
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 400U);
  EXPECT_EQ(bench.stats().other_sender, 400U);
  EXPECT_EQ(bench.stats().restarts, 0U);
}

TEST(Assembler, TheSameMachineMayComeBackFromAnotherPort) {
  auto second = with_character(walk(0, 400, 120.0, 5), 0, "10.0.0.1:5999");
  for (auto& a : second) a.time_s += 4.5;
  Bench bench;
  bench.add(with_character(walk(0, 400), 0, "10.0.0.1:5000"));
  bench.add(second);
  bench.flush();
  ASSERT_EQ(bench.frames.size(), 800U);
  EXPECT_EQ(bench.stats().restarts, 1U);
  for (std::size_t i = 0; i < 800; ++i) EXPECT_EQ(bench.frames[i].discontinuity, i == 400) << i;
}

TEST(Assembler, AnotherMachineOrWearerTakesOverOnlyAfterALongSilence) {
  for (const bool other_machine : {false, true}) {
    auto second =
        with_character(walk(0, 4800), other_machine ? 0 : 1, other_machine ? "10.0.0.2:5000" : "10.0.0.1:5000");
    Bench bench;
    bench.add(merged({walk(0, 400), second}));
    bench.flush();
    EXPECT_EQ(bench.stats().restarts, 1U);
    EXPECT_NEAR(static_cast<double>(bench.frames.size()), 400 + 800, 1);  // from 33.3 s to 40 s
  }
}

TEST(Assembler, Type01ServesWhereThereIsNo02) {
  Bench bench;
  for (std::uint64_t k = 0; k < 300; ++k) {
    bench.add({mxtp::encode_poses_euler(header_of(k), body_items(k))[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  ASSERT_EQ(bench.frames.size(), 300U);
  for (const SuitFrame& f : bench.frames) {
    const auto truth = body_items(f.index);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      const auto& q = truth[i].orientation;
      EXPECT_LT(f.segments[i].q.angularDistance(Eigen::Quaterniond(q[0], q[1], q[2], q[3])), 1e-3);
      EXPECT_NEAR(f.segments[i].p.x(), truth[i].position[0], 1e-5);
    }
  }
}

TEST(Assembler, Type01IsSkippedBeside02) {
  for (const bool first_01 : {true, false}) {
    Bench bench;
    for (std::uint64_t k = 0; k < 300; ++k) {
      const double t = 100.0 + static_cast<double>(k) / 120.0;
      const Arrival a{mxtp::encode_poses_euler(header_of(k), body_items(k))[0], t};
      const Arrival b{mxtp::encode_poses(header_of(k), body_items(k))[0], t};
      bench.add(first_01 ? a : b);
      bench.add(first_01 ? b : a);
    }
    bench.flush();
    EXPECT_EQ(bench.frames.size(), 300U);
    EXPECT_EQ(bench.stats().skipped_types, 300U);
    expect_true_frames(bench, 120.0);
  }
}

TEST(Assembler, TheCentreOfMassGoesWithItsSample) {
  for (const bool com_first : {true, false}) {
    Bench bench;
    for (std::uint64_t k = 0; k < 300; ++k) {
      const double t = 100.0 + static_cast<double>(k) / 120.0;
      const Arrival com{mxtp::encode_center_of_mass(header_of(k), {{static_cast<float>(k), 0, 1}}), t};
      const Arrival pose{mxtp::encode_poses(header_of(k), body_items(k))[0], t};
      bench.add(com_first ? com : pose);
      bench.add(com_first ? pose : com);
    }
    bench.flush();
    ASSERT_EQ(bench.frames.size(), 300U);
    EXPECT_EQ(bench.stats().meta, 300U);
    std::size_t with = 0;
    for (const SuitFrame& f : bench.frames) {
      if (!f.center_of_mass) continue;
      ++with;
      EXPECT_EQ(f.center_of_mass->x(), static_cast<double>(f.index));
    }
    EXPECT_GE(with, 299U);
  }
}

/// A field of `norm` that dips by `dip`, as a tracker on that segment has it that is mounted askew and believes in a
/// heading that is off.
mxtp::TrackerItem tracker(Segment segment, double norm, double dip) {
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond mount = Eigen::Quaterniond(0.3, -0.2, 0.5, 0.8).normalized();
  const Eigen::Vector3d field = mount.conjugate() * (norm * Eigen::Vector3d(0, std::cos(dip), -std::sin(dip)));
  const Eigen::Quaternionf q = (heading * mount).cast<float>();
  mxtp::TrackerItem item;
  item.id = static_cast<std::int32_t>(segment) + 1;
  item.orientation = {q.w(), q.x(), q.y(), q.z()};
  for (std::size_t k = 0; k < 3; ++k) item.magnetic_field[k] = static_cast<float>(field[static_cast<long>(k)]);
  return item;
}

TEST(Assembler, TheMagneticFieldGoesWithItsSample) {
  for (const bool field_first : {true, false}) {
    Bench bench;
    const auto norm = [](std::uint64_t k) { return 0.5 + 0.002 * static_cast<double>(k); };
    for (std::uint64_t k = 0; k < 300; ++k) {
      const double t = 100.0 + static_cast<double>(k) / 120.0;
      const std::vector items{tracker(Segment::Head, 9.0, 0.0), tracker(Segment::Pelvis, norm(k), 1.1),
                              tracker(Segment::RightForearm, 0.8, -0.4)};
      std::vector<Arrival> sample{{mxtp::encode_poses(header_of(k), body_items(k))[0], t}};
      for (auto& part : mxtp::encode_trackers(header_of(k), items, 100))  // each in its own datagram
        sample.insert(field_first ? sample.begin() : sample.end(), {part, t});
      bench.add(sample);
    }
    bench.flush();
    ASSERT_EQ(bench.frames.size(), 300U);
    EXPECT_EQ(bench.stats().meta, 900U);
    std::size_t with = 0;
    for (const SuitFrame& f : bench.frames) {
      if (!f.field_pelvis) continue;
      ++with;
      EXPECT_NEAR(f.field_pelvis->norm, norm(f.index), 1e-6);
      EXPECT_NEAR(f.field_pelvis->dip, 1.1, 1e-6);
      if (field_first) {
        ASSERT_TRUE(f.field_right_forearm);
        EXPECT_NEAR(f.field_right_forearm->dip, -0.4, 1e-6);
      }
    }
    EXPECT_GE(with, 299U);
  }
}

TEST(Assembler, WithoutTrackersThereIsNoField) {
  Bench bench;
  bench.add(walk(0, 60));
  bench.flush();
  for (const SuitFrame& f : bench.frames) EXPECT_FALSE(f.field_pelvis || f.field_right_forearm);
}

TEST(Assembler, QuaternionSignsAreAligned) {
  Bench bench;
  std::mt19937 random(5);
  for (std::uint64_t k = 0; k < 300; ++k) {
    auto items = body_items(k);
    for (auto& item : items) {
      if (random() % 2) {
        for (float& v : item.orientation) v = -v;
      }
    }
    bench.add({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  ASSERT_EQ(bench.frames.size(), 300U);
  for (std::size_t n = 1; n < bench.frames.size(); ++n) {
    for (std::size_t i = 0; i < kSegmentCount; ++i)
      EXPECT_GT(bench.frames[n].segments[i].q.dot(bench.frames[n - 1].segments[i].q), 0.99);
  }
}

TEST(Assembler, BonesOfAnotherLengthAreCounted) {
  Bench bench;
  for (std::uint64_t k = 0; k < 300; ++k) {
    auto items = body_items(k);
    if (k == 100) items[10].position[2] += 0.03F;  // a wrist 3 cm off … the forearm is a little longer
    if (k == 100) items[9].position[0] += 0.12F;
    if (k == 200) items[0].position[0] += 3.0F;  // a pelvis metres off: damage
    bench.add({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  EXPECT_EQ(bench.stats().odd_bones, 2U);
  EXPECT_EQ(bench.stats().refused_bones, 1U);
  EXPECT_EQ(bench.frames.size(), 299U);
}

TEST(Assembler, ABodyMeasuredAnewIsAdopted) {
  Bench bench;
  for (std::uint64_t k = 0; k < 600; ++k) {
    auto items = body_items(k);
    if (k >= 300) {
      for (auto& item : items) item.position[2] *= 1.3F;
    }
    bench.add({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  EXPECT_NEAR(static_cast<double>(bench.stats().refused_bones), 60, 2);
  EXPECT_EQ(bench.frames.size() + bench.stats().refused_bones, 600U);
  EXPECT_EQ(std::count_if(bench.frames.begin(), bench.frames.end(), [](const auto& f) { return f.discontinuity; }), 1);
}

/// An Upper Body stream: the pelvis at the origin.
mxtp::Bytes pinned(std::uint64_t k) {
  auto items = body_items(k);
  const auto pelvis = items[0].position;
  for (auto& item : items) {
    for (std::size_t i = 0; i < 3; ++i) item.position[i] -= pelvis[i];
  }
  return mxtp::encode_poses(header_of(k), items)[0];
}

TEST(Assembler, APinnedPelvisIsRefusedUntilTheStreamIsWell) {
  Bench bench;
  const auto at = [](std::uint64_t k) { return 100.0 + static_cast<double>(k) / 120.0; };
  for (std::uint64_t k = 0; k < 300; ++k) bench.add({pinned(k), at(k)});
  ASSERT_TRUE(bench.assembler.refusal());
  EXPECT_THAT(*bench.assembler.refusal(), HasSubstr("Single Level"));
  EXPECT_TRUE(bench.frames.empty());
  for (const auto& a : walk(300, 600)) bench.add(a);
  EXPECT_FALSE(bench.assembler.refusal());
  for (std::uint64_t k = 600; k < 700; ++k) bench.add({pinned(k), at(k)});
  EXPECT_TRUE(bench.assembler.refusal());
  for (const auto& a : walk(700, 900)) bench.add(a);
  bench.flush();
  EXPECT_FALSE(bench.assembler.refusal());
  EXPECT_EQ(bench.stats().refused_pinned, 400U);
  ASSERT_EQ(bench.frames.size(), 500U);
  for (std::size_t i = 0; i < 500; ++i) EXPECT_EQ(bench.frames[i].discontinuity, i == 300);
}

TEST(Assembler, WalkingThroughTheOriginADownstairsIsNotPinned) {
  Bench bench;
  for (std::uint64_t k = 0; k < 400; ++k) {
    auto items = body_items(0);
    for (auto& item : items) {
      item.position[0] += -1.0F + 0.01F * (static_cast<float>(k) - 200.0F);
      item.position[2] -= 0.93F;
    }
    bench.add({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 400U);
  EXPECT_EQ(bench.stats().refused_pinned, 0U);
}

mxtp::Scale scale_with_points() {
  mxtp::Scale scale;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto& p = t_pose()[i];
    scale.segments.push_back(
        {kSegmentNames[i], {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())}});
  }
  for (std::uint16_t i = 0; i < 60; ++i) scale.points.push_back({1, i, "pSomething" + std::to_string(i), 0, {0, 0, 0}});
  scale.points.push_back({7, 1, "pTopOfHead", 0, {0, 0, 0.17F}});
  scale.points.push_back({11, 1, "pRightTopOfHand", 0, {0.01F, -0.185F, 0}});
  scale.points.push_back({11, 2, "pRightPinky", 0, {-0.03F, -0.08F, 0}});
  scale.points.push_back({11, 3, "pRightBallHand", 0, {0.03F, -0.10F, -0.02F}});
  return scale;
}

TEST(Assembler, WearerFromMetaAndScaleInAnyOrder) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::vector<Arrival> about;
    for (auto& part : mxtp::encode_scale({}, scale_with_points(), 1000)) about.push_back({std::move(part), 100.0});
    about.push_back({mxtp::encode_meta({}, {{{"name", "Anna"}}}), 100.0});
    if (seed > 0) std::shuffle(about.begin(), about.end(), random);
    Bench bench;
    if (seed % 2 == 0) bench.add(about);
    bench.add(walk(0, 100));
    if (seed % 2 == 1) bench.add(about);
    const WearerInfo& w = bench.assembler.wearer();
    EXPECT_GT(bench.assembler.wearer_revision(), 0U);
    EXPECT_EQ(w.name, "Anna");
    ASSERT_TRUE(w.p_hand_fingertip && w.p_hand_palm && w.stature_m) << seed;
    EXPECT_LT((*w.p_hand_fingertip - Eigen::Vector3d(0.01, -0.185, 0)).norm(), 1e-6);
    EXPECT_LT((*w.p_hand_palm - Eigen::Vector3d(0, -0.09, -0.01)).norm(), 1e-6);
    EXPECT_NEAR(*w.stature_m, 1.75, 1e-6);
    const auto revision = bench.assembler.wearer_revision();
    bench.add(about);
    EXPECT_EQ(bench.assembler.wearer_revision(), revision) << "nothing new";
  }
}

TEST(Assembler, WhatLiesOutsideABodyIsUnknown) {
  auto scale = scale_with_points();
  scale.points[61].position = {0, 0.18F, 0};  // a right hand that points to the left
  scale.points[62].position = {0, -0.5F, 0};
  scale.segments[6].origin[2] = 0.2F;
  Bench bench;
  bench.add(walk(0, 100));
  for (auto& part : mxtp::encode_scale({}, scale)) bench.add({part, 101.0});
  EXPECT_FALSE(bench.assembler.wearer().p_hand_fingertip);
  EXPECT_FALSE(bench.assembler.wearer().p_hand_palm);
  EXPECT_FALSE(bench.assembler.wearer().stature_m);
}

TEST(Assembler, AScaleMessageThatMakesNoSenseIsAFault) {
  auto parts = mxtp::encode_scale({}, scale_with_points(), 1000);
  ASSERT_GT(parts.size(), 2U);
  parts[1][24 + 100] = parts[1][24 + 101] = std::byte{0xff};
  for (std::size_t i = 24; i < 400; ++i) parts[1][i] = std::byte{0xff};
  Bench bench;
  for (auto& p : parts) bench.add({p, 100.0});
  std::uint64_t faults = 0;
  for (const auto n : bench.stats().faults) faults += n;
  EXPECT_EQ(faults, 1U);
  EXPECT_EQ(bench.stats().meta, parts.size() - 1);
}

TEST(Assembler, TheRealSampleAndItsWearer) {
  const std::string data = std::string(KINEMAP_SHARED_DATA) + "/";
  if (!exists(data + "mxtp02.bin")) GTEST_SKIP() << "no recordings in " << data;
  for (const char* pose : {"mxtp01.bin", "mxtp02.bin"}) {
    Bench bench;
    bench.add({read_bytes(data + "mxtp12.bin"), 1.0});
    bench.add({read_bytes(data + "mxtp13.bin"), 1.0});
    bench.add({read_bytes(data + pose), 1.0});
    bench.flush();
    ASSERT_EQ(bench.frames.size(), 1U);
    EXPECT_EQ(bench.frames[0].index, 0x1a19U);
    EXPECT_NEAR(bench.frames[0][Segment::Pelvis].p.z(), 1.0484, 1e-4);
    EXPECT_EQ(bench.assembler.wearer().name, "Factory");
    EXPECT_FALSE(bench.assembler.wearer().p_hand_fingertip) << "the part with the points is not in the recording";
    ASSERT_TRUE(bench.assembler.wearer().stature_m);
    EXPECT_NEAR(*bench.assembler.wearer().stature_m, 1.97, 0.01);
  }
}

TEST(Assembler, FloodsAreBoundedAndCounted) {
  Bench bench;
  std::mt19937 random(6);
  const auto good = walk(0, 400);
  for (std::size_t k = 0; k < good.size(); ++k) {
    bench.add(good[k]);
    for (int n = 0; n < 20; ++n) {
      auto h = header_of(k);
      h.character = static_cast<std::uint8_t>(random());
      h.sample_counter = static_cast<std::uint32_t>(random());
      auto bytes = mxtp::encode_poses(h, body_items(k), 200)[random() % 4];
      bench.add({std::move(bytes), good[k].time_s,
                 "10.1." + std::to_string(random() % 250) + ".9:" + std::to_string(random() % 60000)});
      bench.add(
          {mxtp::encode_meta(h, {{{"name", "x"}}}), good[k].time_s, "10.2.0.1:" + std::to_string(random() % 60000)});
    }
  }
  EXPECT_LT(bench.stats().waiting, 3000U);
  bench.flush();
  EXPECT_EQ(bench.frames.size(), 400U);
  expect_true_frames(bench, 120.0);
}

TEST(Assembler, OneSenderFloodingItsOwnCountersIsBounded) {
  Bench bench;
  std::mt19937 random(7);
  for (int k = 0; k < 20000; ++k) {
    auto h = header_of(static_cast<std::uint64_t>(random() % 4000));
    bench.add({mxtp::encode_poses(h, body_items(0), 200)[random() % 4], 100.0});
  }
  EXPECT_LT(bench.stats().waiting, 1000U);
  bench.flush();
}

/// Whatever comes in: each datagram in one counter, time never back, finite poses (asserted by the bench after each
/// datagram).
TEST(Assembler, MutationsNeverBreakTheRules) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    auto all = merged({walk(0, 150, 120.0, 0xfffffff0U, 86'399'800, seed % 3 ? 2040 : 300),
                       with_character(walk(0, 60), 3), object(60, 4)});
    for (auto& part : mxtp::encode_scale({}, scale_with_points(), 700))
      all.insert(all.begin() + static_cast<long>(random() % all.size()), {part, 100.5});
    for (int k = 0; k < 30; ++k) {
      all.insert(all.begin() + static_cast<long>(random() % all.size()),
                 {mxtp::encode_center_of_mass(header_of(random() % 200), {{0, 0, 1}}), 100.2});
      all.insert(
          all.begin() + static_cast<long>(random() % all.size()),
          {mxtp::encode_trackers(header_of(random() % 200), std::array{tracker(Segment::Pelvis, 1, 1)})[0], 100.2});
    }
    for (Arrival& a : all) {
      switch (random() % 8) {
        case 0:
          for (auto n = 1 + random() % 4; n > 0; --n)
            a.bytes[random() % a.bytes.size()] ^= static_cast<std::byte>(1U << random() % 8);
          break;
        case 1:
          for (auto n = 1 + random() % 3; n > 0; --n) a.bytes[random() % 24] = static_cast<std::byte>(random());
          break;
        case 2:
          a.bytes.resize(random() % (a.bytes.size() + 1));
          break;
        case 3:
          std::swap(a, all[random() % all.size()]);
          break;
        case 4:
          a = all[random() % all.size()];
          break;
        case 5:
          a.time_s += 0.1 * static_cast<double>(random() % 100);
          break;
        default:
          break;
      }
      if (random() % 50 == 0) a.time_s = std::numeric_limits<double>::quiet_NaN();
    }
    Bench bench;
    bench.add(all);
    bench.flush();
  }
}

}  // namespace
}  // namespace kinemap
