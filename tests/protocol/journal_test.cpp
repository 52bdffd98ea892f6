// SPDX-License-Identifier: Apache-2.0
#include "protocol/journal.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "protocol/journal_entries.hpp"

namespace kinemap::journal {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Pose some_pose(double x) {
  return {{x, -2.25, 1.0 / 3.0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3 + x, Eigen::Vector3d(1, 2, 3).normalized()))};
}

KeyPose key_pose(KeyPoseId id) {
  KeyPose k;
  k.id = id;
  k.time_s = 0.1 * id;
  k.T_odom_pelvis = some_pose(0.2 * id);
  k.path_m = 0.21;
  k.turn_rad = 0.7;
  if (id % 2 == 0) k.p_pelvis_stance = Eigen::Vector3d(0.1, 0.2, -0.95);
  if (id % 4 == 1) k.slip = Slip{-0.01, {0.002, -1.0 / 3.0}, 0.75, 0.003};
  if (id % 3 == 0) k.field_disturbed = id % 2 == 0;
  return k;
}

Trace trace(KeyPoseId first, std::size_t contacts) {
  Trace t{1.5, 9.25, 1.78, {}};
  for (std::size_t i = 0; i < contacts; ++i)
    t.contacts.push_back({1.5 + 0.1 * static_cast<double>(i), first + static_cast<KeyPoseId>(i / 4),
                          some_pose(0.01 * static_cast<double>(i))});
  return t;
}

/// A short session, an entry of every kind in it.
std::vector<Entry> session() {
  std::vector<Entry> entries{SessionStart{"20261122T103303Z", 1795343583000, "0.1.0", kVersion},
                             WearerInfo{"Ada \xC3\x9F", Eigen::Vector3d(0, -0.18, 0), std::nullopt, 1.71}};
  for (KeyPoseId id = 0; id < 12; ++id) {
    entries.push_back(key_pose(id));
    if (id % 5 == 0) entries.push_back(StreamMark{0.1 * id, 4294967290U + id, 1795343583000 + id, {}, {}, {}, {}});
  }
  entries.push_back(trace(2, 30));
  entries.push_back(StreamMark{32.0, 7, 1795343584000, 86399999U, some_pose(1), 0.125, 0.0625});
  entries.push_back(Pivot{20, 26, {0.01, -0.17, 0}, Eigen::Vector3d(1e-4, 2e-4, 1.0 / 3.0).asDiagonal(), 1.75});
  entries.push_back(Sitting{30, 34, 11, some_pose(3), 0.44, 0.01});
  entries.push_back(Announced{33.5, 12, 3, 1});
  entries.push_back(StreamSilence{});
  entries.push_back(
      UnfinishedTrace{1.5, 2.25, true, {HipState{true, true, 1.75}, HipState{}}, 1.78, trace(2, 5).contacts});
  entries.push_back(
      UnfinishedSitting{30, 31.5, 1.25, 0.75, true, false, {0.5, 0, 0}, {{30.5, 11, some_pose(3), 0.44}}});
  return entries;
}

std::vector<std::string> encoded(const std::vector<Entry>& entries) {
  std::vector<std::string> list;
  for (const auto& entry : entries) list.push_back(encode(entry));
  return list;
}

TEST(Journal, AnEntryThatSaysToBeHugeOrIsDeepIsNone) {
  EXPECT_FALSE(decode("\xbb\xbf\xc7\x0a\x3d\x02\xd1\x07\x18"));         // an object of 13·10¹⁸ members
  EXPECT_FALSE(decode(std::string(3000000, static_cast<char>(0x81))));  // lists of one list each
}

TEST(Journal, GivesBackEveryBitOfEveryEntry) {
  const auto entries = session();
  const auto contents = read(file_of(entries), "j");
  ASSERT_TRUE(contents);
  EXPECT_TRUE(contents->damage.empty());
  EXPECT_EQ(contents->torn_bytes, 0U);
  EXPECT_EQ(contents->sound_bytes, file_of(entries).size());
  EXPECT_TRUE(encoded(contents->entries) == encoded(entries));
  const auto& k = std::get<KeyPose>(contents->entries[2]);
  EXPECT_EQ(k.T_odom_pelvis.p, key_pose(0).T_odom_pelvis.p);
  EXPECT_EQ(k.T_odom_pelvis.q.coeffs(), key_pose(0).T_odom_pelvis.q.coeffs());
}

TEST(Journal, CutAtAnyByteGivesAllThatWasWrittenBefore) {
  const auto entries = session();
  const auto bytes = file_of(entries);
  std::vector<std::size_t> ends{header().size()};
  for (const auto& entry : entries) ends.push_back(ends.back() + record(entry).size());
  for (std::size_t length = header().size(); length <= bytes.size(); ++length) {
    const auto contents = read(std::string_view(bytes).substr(0, length), "j");
    ASSERT_TRUE(contents);
    const auto whole = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), length) - ends.begin()) - 1;
    ASSERT_EQ(contents->entries.size(), whole) << "cut at " << length;
    ASSERT_EQ(contents->sound_bytes, ends[whole]);
    ASSERT_EQ(contents->torn_bytes, length - ends[whole]);
    ASSERT_TRUE(contents->damage.empty());
  }
}

TEST(Journal, AFlippedBitCostsOneEntryAndIsReported) {
  const auto entries = session();
  const auto bytes = file_of(entries);
  for (std::size_t at = header().size(); at < bytes.size(); ++at) {
    auto broken = bytes;
    broken[at] = static_cast<char>(broken[at] ^ 1 << at % 8);
    const auto contents = read(broken, "j");
    ASSERT_TRUE(contents);
    ASSERT_EQ(contents->entries.size(), entries.size() - 1) << "byte " << at;
    ASSERT_EQ(contents->damage.size() + (contents->torn_bytes > 0 ? 1 : 0), 1U) << "byte " << at;
  }
}

TEST(Journal, AFlippedBitInTheFirstLineCostsNothingElse) {
  const auto bytes = file_of(session());
  for (std::size_t bit = 0; bit < 8 * header().size(); ++bit) {
    auto broken = bytes;
    broken[bit / 8] = static_cast<char>(broken[bit / 8] ^ 1 << bit % 8);
    const auto contents = read(broken, "j");
    ASSERT_TRUE(contents) << contents.error();
    ASSERT_EQ(contents->entries.size(), session().size()) << "bit " << bit;
  }
}

TEST(Journal, OfANewerVersionOrOfSomethingElseIsRefused) {
  const auto next = std::to_string(kVersion + 1);
  const auto line = "kinemap-journal " + next + "\n";
  EXPECT_THAT(read(line, "a/journal").error(), HasSubstr("a/journal: a journal of format " + next));
  const auto newer = line + record(SessionStart{"x", 0, "9.0", kVersion + 1}) + record(key_pose(0));
  EXPECT_THAT(read(newer, "a/journal").error(), HasSubstr("this one reads up to format " + std::to_string(kVersion)));
  EXPECT_THAT(read("?" + newer, "a/journal").error(), HasSubstr("format " + next));
  for (const char* text : {"", "kinemap-journal", "kinemap-journal \n", "kinemap-journal -1\n", "PK\x03\x04", "{}"})
    EXPECT_THAT(read(text, "x").error(), HasSubstr("no journal of Kinemap")) << text;
}

TEST(Journal, ARecordWithAGoodChecksumAndNonsenseInItIsDamage) {
  auto bad = key_pose(0);
  bad.T_odom_pelvis.p.x() = std::numeric_limits<double>::quiet_NaN();
  auto twisted = key_pose(0);
  twisted.T_odom_pelvis.q.coeffs() *= 2.0;
  const auto contents = read(header() + record(bad) + record(twisted) + record(key_pose(0)), "j");
  ASSERT_TRUE(contents);
  EXPECT_THAT(contents->entries, SizeIs(1));
  EXPECT_THAT(contents->damage, SizeIs(1)) << "what lies side by side is one place";
  for (const std::string payload : {"", "\xA0", "\xFF", "\xA1\x64type\x01", "\xA1\x64type\x64mark"})
    EXPECT_FALSE(decode(payload)) << ::testing::PrintToString(payload);
}

TEST(Journal, SuchARecordAtTheEndIsDamageTooAndNotTorn) {
  auto bad = key_pose(1);
  bad.T_odom_pelvis.p.x() = std::numeric_limits<double>::quiet_NaN();
  const auto whole = header() + record(key_pose(0)) + record(bad);
  for (const std::size_t torn : {0U, 5U}) {
    const auto contents = read(whole + record(key_pose(2)).substr(0, torn), "j");
    ASSERT_TRUE(contents);
    EXPECT_THAT(contents->entries, SizeIs(1));
    ASSERT_THAT(contents->damage, SizeIs(1));
    EXPECT_EQ(contents->damage[0].bytes, record(bad).size());
    EXPECT_EQ(contents->sound_bytes, whole.size());
    EXPECT_EQ(contents->torn_bytes, torn);
  }
}

/// Whatever versions come: each format that was ever written opens, and is the same session in the current one.
TEST(Journal, FilesOfEveryFormatOpen) {
  for (std::uint32_t version = 1; version <= kVersion; ++version) {
    const auto name = "journal-v" + std::to_string(version) + ".kjr";
    std::ostringstream bytes;
    bytes << std::ifstream(KINEMAP_SOURCE_DIR "/tests/data/" + name, std::ios::binary).rdbuf();
    const auto contents = read(bytes.str(), name);
    ASSERT_TRUE(contents) << contents.error();
    EXPECT_EQ(contents->version, version);
    EXPECT_TRUE(contents->damage.empty());
    EXPECT_EQ(contents->torn_bytes, 0U);
    std::map<std::size_t, int> kinds;
    for (const auto& entry : contents->entries) ++kinds[entry.index()];
    EXPECT_EQ(kinds[Entry(KeyPose{}).index()], 121) << name;
    EXPECT_EQ(kinds[Entry(Trace{}).index()], 1) << name;
    EXPECT_EQ(kinds[Entry(Sitting{}).index()], 2) << name;
    const auto migrated = read(file_of(contents->entries), name);
    ASSERT_TRUE(migrated) << migrated.error();
    EXPECT_EQ(migrated->version, kVersion);
    EXPECT_EQ(migrated->entries.size(), contents->entries.size());
  }
}

TEST(Journal, PiecesOfWhatIsFinishedAreNotRead) {
  const UnfinishedTrace drawing{1.5, 2.25, true, {}, {}, trace(0, 4).contacts};
  const UnfinishedSitting sitting{1.5, 2.25, 0.5, 0.5, true, true, {0, 0, 0}, {{2.0, 0, some_pose(0), 0.4}}};
  const Sitting seat{1.5, 4.0, 0, some_pose(0), 0.4, 0.01};
  const auto count = [](const std::vector<Entry>& entries) { return read(file_of(entries), "j")->entries.size(); };
  EXPECT_EQ(count({key_pose(0), drawing, sitting, drawing}), 4U);
  EXPECT_EQ(count({key_pose(0), drawing, sitting, key_pose(1), drawing, trace(0, 8)}), 4U);
  EXPECT_EQ(count({key_pose(0), drawing, sitting, trace(0, 8), drawing, seat}), 4U);
  EXPECT_EQ(count({key_pose(0), drawing, Pivot{1.5, 4.0, {0, 0, 0}, Eigen::Matrix3d::Identity(), {}}, sitting, seat}), 3U);
}

TEST(JournalMend, ChangesNothingWhereNothingIsMissing) {
  auto entries = session();
  const auto report = mend(entries);
  EXPECT_EQ(report.key_poses_missing, 0U);
  EXPECT_EQ(report.entries_left_out, 0U);
  EXPECT_TRUE(encoded(entries) == encoded(session()));
}

TEST(JournalMend, BreaksTheOdometryWhereKeyPosesAreMissing) {
  std::vector<Entry> entries{key_pose(0), key_pose(1), key_pose(4), key_pose(5), trace(1, 16), trace(2, 4)};
  entries.push_back(Sitting{1, 2, 3, some_pose(0), 0.4, 0.01});
  entries.push_back(Sitting{1, 2, 5, some_pose(0), 0.4, 0.01});
  const auto report = mend(entries);
  EXPECT_EQ(report.key_poses_missing, 2U);
  EXPECT_EQ(report.entries_left_out, 2U);
  ASSERT_THAT(entries, SizeIs(6));
  EXPECT_FALSE(std::get<KeyPose>(entries[1]).discontinuity);
  EXPECT_EQ(std::get<KeyPose>(entries[2]).id, 2U);
  EXPECT_TRUE(std::get<KeyPose>(entries[2]).discontinuity);
  EXPECT_EQ(std::get<KeyPose>(entries[3]).id, 3U);
  EXPECT_FALSE(std::get<KeyPose>(entries[3]).discontinuity);
  const auto& contacts = std::get<Trace>(entries[4]).contacts;  // of key poses 1 and 4; 2 and 3 are lost
  ASSERT_THAT(contacts, SizeIs(8));
  EXPECT_EQ(contacts.front().key_pose, 1U);
  EXPECT_EQ(contacts.back().key_pose, 2U);
  EXPECT_EQ(std::get<Sitting>(entries[5]).key_pose, 3U);
}

TEST(JournalMend, WhatIsUnfinishedKeepsWhatItCan) {
  std::vector<Entry> entries{key_pose(0), key_pose(3), UnfinishedTrace{0, 1, true, {}, {}, trace(2, 8).contacts}};
  entries.push_back(UnfinishedSitting{
      0, 1, 1, 1, true, true, {0.5, 0, 0}, {{0.5, 1, some_pose(0), 0.4}, {0.6, 3, some_pose(0), 0.4}}});
  mend(entries);
  const auto& contacts = std::get<UnfinishedTrace>(entries[2]).contacts;  // of key poses 2 and 3
  ASSERT_THAT(contacts, SizeIs(4));
  EXPECT_EQ(contacts.front().key_pose, 1U);
  const auto& samples = std::get<UnfinishedSitting>(entries[3]).samples;
  ASSERT_THAT(samples, SizeIs(1));
  EXPECT_EQ(samples.front().key_pose, 1U);
}

}  // namespace
}  // namespace kinemap::journal
