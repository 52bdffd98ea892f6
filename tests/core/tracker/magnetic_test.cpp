// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/magnetic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/core/tracker/support.hpp"

namespace kinemap::test {
namespace {

constexpr double kRate = 60.0;
constexpr MagneticField kHere{1.27, -0.9};  // neither 1 nor in the northern hemisphere

using FieldAt = std::function<std::optional<MagneticField>(double t, double x)>;

/// Walks straight on at 1 m/s and stands still from `stop_m` on; the answers of all frames.
std::vector<std::optional<bool>> judge(double duration_s, const FieldAt& field, double stop_m = 1e9) {
  MagneticFold fold{{}};
  std::vector<std::optional<bool>> answers;
  for (int i = 0; i < duration_s * kRate; ++i) {
    SuitFrame frame;
    frame.time_s = i / kRate;
    frame[Segment::Pelvis].p = {std::min(frame.time_s, stop_m), 0.0, 0.95};
    frame.field_pelvis = field(frame.time_s, frame[Segment::Pelvis].p.x());
    answers.push_back(fold.step(frame));
  }
  return answers;
}

std::optional<bool> at(const std::vector<std::optional<bool>>& answers, double time_s) {
  return answers.at(static_cast<std::size_t>(time_s * kRate));
}

int changes(const std::vector<std::optional<bool>>& answers) {
  int n = 0;
  for (std::size_t i = 1; i < answers.size(); ++i) n += answers[i] != answers[i - 1];
  return n;
}

bool between(double x, double low, double high) { return x > low && x < high; }

TEST(Magnetic, TheUsualFieldIsLearntWhereverOnEarth) {
  const auto answers = judge(15.0, [](double, double) { return kHere; });
  EXPECT_EQ(at(answers, 4.0), std::nullopt) << "not known yet";
  EXPECT_EQ(at(answers, 5.5), false);
  EXPECT_EQ(changes(answers), 1);
}

TEST(Magnetic, MetalChangesStrengthOrDip) {
  for (const MagneticField bent : {MagneticField{1.27 * 1.2, -0.9}, MagneticField{1.27 * 0.8, -0.9},
                                   MagneticField{1.27, -0.75}, MagneticField{1.27, -1.05}}) {
    const auto answers = judge(15.0, [&](double, double x) { return between(x, 8.0, 10.0) ? bent : kHere; });
    EXPECT_EQ(at(answers, 7.9), false);
    EXPECT_EQ(at(answers, 9.0), true);
    EXPECT_EQ(at(answers, 11.0), false);
    EXPECT_EQ(changes(answers), 3);
  }
}

TEST(Magnetic, MetalWhereTheRecordingBeginsIsNotTakenForUsual) {
  const auto answers = judge(20.0, [](double, double x) {
    return x < 2.0 || between(x, 10.0, 12.0) ? MagneticField{1.6, -0.6} : kHere;
  });
  EXPECT_EQ(at(answers, 6.0), false);
  EXPECT_EQ(at(answers, 11.0), true);
}

TEST(Magnetic, StandingAtMetalForLongDoesNotMakeItUsual) {
  const auto answers = judge(
      900.0,
      [](double, double x) {
        return x > 9.9 ? MagneticField{1.27, -0.7} : kHere;
      },
      10.0);
  EXPECT_EQ(at(answers, 899.0), true);
}

TEST(Magnetic, AnotherBuildingBecomesUsualAfterALongWalk) {
  const auto answers = judge(120.0, [](double, double x) { return x > 30.0 ? MagneticField{1.5, -0.9} : kHere; });
  EXPECT_EQ(at(answers, 32.0), true);
  EXPECT_EQ(at(answers, 90.0), false);
}

TEST(Magnetic, NeitherSpikesNorAFieldAtTheLimitFlicker) {
  const auto spikes = judge(20.0, [](double t, double) {
    return static_cast<int>(t * kRate) % 30 == 0 ? MagneticField{2.2, -0.3} : kHere;
  });
  EXPECT_EQ(changes(spikes), 1);
  const auto limit = judge(
      60.0,
      [](double t, double x) {
        return MagneticField{1.27, x < 20.0 ? -0.9 : -0.9 + (x < 22.0 ? 0.13 : 0.09 + 0.015 * std::sin(3.0 * t))};
      },
      25.0);
  EXPECT_EQ(at(limit, 59.0), true);
  EXPECT_EQ(changes(limit), 2);
}

TEST(Magnetic, LostSamplesAreBridgedSilenceIsNot) {
  const auto lossy = judge(15.0, [](double t, double) {
    return static_cast<int>(t * kRate) % 3 == 0 ? std::nullopt : std::optional(kHere);
  });
  EXPECT_EQ(changes(lossy), 1);
  const auto silent = judge(15.0, [](double, double x) { return x > 8.0 ? std::nullopt : std::optional(kHere); });
  EXPECT_EQ(at(silent, 8.5), false);
  EXPECT_EQ(at(silent, 9.5), std::nullopt);
}

TEST(Magnetic, AKeyPoseTellsOfAllTheTimeSinceTheOneBefore) {
  const Puppet puppet;
  const auto frames_with = [&](const FieldAt& field) {
    auto frames = perform(puppet, {{10.0, [](double t) { return walking(t, 1.037); }}, {25.0, [](double) {
                                                                                          Figure f = standing();
                                                                                          f.hips.x() += 10.37;
                                                                                          return f;
                                                                                        }}});
    for (auto& frame : frames) frame.field_pelvis = field(frame.time_s, frame[Segment::Pelvis].p.x());
    return frames;
  };
  for (const KeyPose& key : track(frames_with([](double, double) { return std::nullopt; })).key_poses)
    EXPECT_EQ(key.field_disturbed, std::nullopt);

  const auto disturbed = frames_with([](double t, double) {
    return between(t, 14.0, 16.0) ? MagneticField{1.27, -0.6} : kHere;  // while nobody moves
  });
  const auto key_poses = track(disturbed).key_poses;
  EXPECT_EQ(key_poses.front().field_disturbed, std::nullopt);
  int told = 0;
  for (std::size_t i = 1; i < key_poses.size(); ++i) {
    if (key_poses[i].time_s < 7.0) continue;
    const bool overlaps = key_poses[i].time_s > 14.0 && key_poses[i - 1].time_s < 16.0;
    EXPECT_EQ(key_poses[i].field_disturbed, overlaps) << key_poses[i].time_s;
    told += overlaps;
  }
  EXPECT_GE(told, 1);
}

TEST(Magnetic, AfterARestartTheUsualFieldIsLearntAnew) {
  const Puppet puppet;
  auto frames = perform(puppet, {{20.0, [](double t) { return walking(t, 1.037); }}});
  for (auto& frame : frames) frame.field_pelvis = frame.time_s < 10.0 ? kHere : MagneticField{0.8, 1.1};
  for (auto& frame : frames)
    if (frame.time_s >= 10.0) {
      frame.discontinuity = true;
      break;
    }
  for (const KeyPose& key : track(frames).key_poses) EXPECT_FALSE(key.field_disturbed.value_or(false)) << key.time_s;
}

}  // namespace
}  // namespace kinemap::test
