// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "daemon/checkpoints.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/resume.hpp"
#include "daemon/session_store.hpp"
#include "protocol/assembler.hpp"
#include "protocol/journal_map.hpp"
#include "tests/core/mapper/wearer.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using test::eventually;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class JournalTest : public testing::Test {
 protected:
  JournalTest() : dir_(fs::temp_directory_path() / ("kinemap-journal-" + std::to_string(::getpid()))) {
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  ~JournalTest() override { fs::remove_all(dir_); }

  static std::string text(const fs::path& path) {
    std::ostringstream out;
    out << std::ifstream(path, std::ios::binary).rdbuf();
    return out.str();
  }
  static std::vector<journal::Entry> entries(const fs::path& path) {
    const auto contents = journal::read(text(path), path.string());
    EXPECT_TRUE(contents) << contents.error();
    EXPECT_TRUE(contents->damage.empty());
    return contents->entries;
  }
  static std::unique_ptr<SessionJournal> open(const fs::path& dir) {
    auto opened = SessionJournal::open(dir, unlimited());
    EXPECT_TRUE(opened) << opened.error();
    return *std::move(opened);
  }
  static Config::Journal unlimited() {
    Config::Journal config;
    config.min_free_mb = 0;
    return config;
  }

  const fs::path dir_;
};

KeyPose key_pose(KeyPoseId id) {
  KeyPose k;
  k.id = id;
  k.time_s = 0.1 * id;
  return k;
}

TEST_F(JournalTest, AFileGoesOnAfterWhatIsSound) {
  const auto path = dir_ / "a" / "journal.kjr";
  { JournalFile(path, 0, {}).append(key_pose(0)); }
  const auto sound = fs::file_size(path);
  { std::ofstream(path, std::ios::app) << "torn"; }
  JournalFile file(path, sound, {});
  file.append(key_pose(1));
  EXPECT_THAT(entries(path), SizeIs(2));
  EXPECT_EQ(file.stats().bytes, fs::file_size(path));
  EXPECT_TRUE(file.stats().healthy);
}

TEST_F(JournalTest, AFullDiskLosesNothingOnceThereIsRoom) {
  const auto path = dir_ / "journal.kjr";
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  JournalFile file(path, 0, {});
  file.append(key_pose(0));
  const rlimit full{fs::file_size(path) + 20, before.rlim_max};  // in the middle of the next record
  setrlimit(RLIMIT_FSIZE, &full);
  for (KeyPoseId id = 1; id < 50; ++id) file.append(key_pose(id));
  EXPECT_FALSE(file.stats().healthy);
  EXPECT_GT(file.stats().waiting_bytes, 0U);
  EXPECT_THAT(entries(path), SizeIs(1)) << "the record that was cut short is no damage";
  file.retry();
  EXPECT_FALSE(file.stats().healthy);
  setrlimit(RLIMIT_FSIZE, &before);
  file.retry();
  EXPECT_TRUE(file.stats().healthy);
  EXPECT_EQ(file.stats().waiting_bytes, 0U);
  EXPECT_EQ(file.stats().lost_entries, 0U);
  EXPECT_THAT(entries(path), SizeIs(50));
}

TEST_F(JournalTest, WhatTheDiskHasNotConfirmedIsCounted) {
  JournalFile::Limits limits;
  limits.sync_every = std::chrono::hours(1);
  JournalFile file(dir_ / "journal.kjr", 0, limits);
  file.append(key_pose(0));  // the first sync is due at once
  EXPECT_EQ(file.stats().unsafe_entries, 0U);
  EXPECT_LT(file.stats().unsafe_since_s, 0.0);
  file.append(key_pose(1));
  const double since_s = file.stats().unsafe_since_s;
  EXPECT_GT(since_s, 0.0);
  file.append(key_pose(2));
  EXPECT_EQ(file.stats().unsafe_entries, 2U);
  EXPECT_EQ(file.stats().unsafe_since_s, since_s);
  file.append(journal::StreamSilence{});  // must be safe before it is announced
  EXPECT_EQ(file.stats().unsafe_entries, 0U);
  EXPECT_LT(file.stats().unsafe_since_s, 0.0);
}

TEST_F(JournalTest, KeyPosesAreSyncedWhenTheirTimeHasComeThoughNothingFollows) {
  JournalFile::Limits limits;
  limits.sync_every = std::chrono::milliseconds(20);
  JournalFile file(dir_ / "journal.kjr", 0, limits);
  file.append(key_pose(0));
  file.append(key_pose(1));
  EXPECT_TRUE(test::eventually([&] {
    file.retry();
    return file.stats().unsafe_entries == 0;
  }));
}

TEST_F(JournalTest, TooLittleFreeSpaceCountsAsFull) {
  JournalFile::Limits limits;
  limits.min_free_bytes = UINT64_MAX;
  limits.max_waiting_bytes = 1000;
  JournalFile file(dir_ / "journal.kjr", 0, limits);
  for (KeyPoseId id = 0; id < 50; ++id) file.append(key_pose(id));
  EXPECT_FALSE(file.stats().healthy);
  EXPECT_EQ(file.stats().unsafe_entries, 50U);
  EXPECT_GT(file.stats().lost_entries, 0U);
  EXPECT_EQ(file.stats().entries, 50U);
  EXPECT_LT(file.stats().waiting_bytes, 1500U);
}

TEST_F(JournalTest, OnlyOneDaemonKeepsItsSessionsHere) {
  const auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  EXPECT_THAT(SessionStore::open(dir_).error(), HasSubstr("another kinemapd"));
}

TEST_F(JournalTest, ADirectoryThatCannotBeIsAnErrorThatNamesTheKey) {
  { std::ofstream(dir_ / "file") << "x"; }
  EXPECT_THAT(SessionStore::open(dir_ / "file" / "sessions").error(), HasSubstr("journal.directory"));
}

TEST_F(JournalTest, ADamagedJournalGoesToQuarantineAndItsRestIsUsed) {
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  const auto path = store->files().journal_of("20260101T000000Z");
  {
    JournalFile file(path, 0, {});
    for (KeyPoseId id = 0; id < 20; ++id) file.append(key_pose(id));
  }
  auto bytes = text(path);
  bytes[bytes.size() / 2] ^= 1;
  { std::ofstream(path, std::ios::binary) << bytes; }
  const auto session = store->last();
  ASSERT_TRUE(session);
  EXPECT_THAT(session->entries, SizeIs(19));
  EXPECT_EQ(text(dir_ / "quarantine" / "20260101T000000Z.kjr"), bytes);
  EXPECT_EQ(session->bytes, fs::file_size(path));
  const auto healed = entries(path);
  ASSERT_THAT(healed, SizeIs(19));
  EXPECT_EQ(std::get<KeyPose>(healed.back()).id, 18U);
}

TEST_F(JournalTest, AJournalOfANewerVersionIsLeftAlone) {
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  const auto path = store->files().journal_of("20260101T000000Z");
  fs::create_directories(path.parent_path());
  { std::ofstream(path) << "kinemap-journal 9\nwhatever"; }
  EXPECT_FALSE(store->last());
  EXPECT_EQ(text(path), "kinemap-journal 9\nwhatever");
}

TEST_F(JournalTest, OneOfAnOlderFormatIsWrittenAnewAndGoesOn) {
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  const auto path = store->files().journal_of("20261122T135207Z");
  fs::create_directories(path.parent_path());
  fs::copy_file(KINEMAP_SOURCE_DIR "/tests/data/journal-v1.kjr", path);
  const auto before = entries(path);
  const auto session = store->last();
  ASSERT_TRUE(session);
  EXPECT_EQ(session->entries.size(), before.size());
  EXPECT_EQ(session->bytes, fs::file_size(path));
  EXPECT_EQ(read_journal(path)->contents.version, journal::kVersion);
  EXPECT_EQ(entries(path).size(), before.size());
  EXPECT_FALSE(fs::exists(dir_ / "quarantine")) << "old is not damaged";
}

TEST_F(JournalTest, TheSessionUnderWayIsFoundAgainBeforeNewerOnes) {
  for (const char* id : {"20260101T000000Z", "20260102T000000Z"})
    JournalFile(SessionFiles(dir_).journal_of(id), 0, {}).append(key_pose(0));
  {
    auto store = SessionStore::open(dir_);
    ASSERT_TRUE(store);
    EXPECT_EQ(store->last()->id, "20260102T000000Z");
    store->begin("20260101T000000Z");
  }
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  EXPECT_EQ(store->last()->id, "20260101T000000Z");
}

TEST_F(JournalTest, TheOldestSessionsGoFirstAndTheCurrentOneNever) {
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  for (const char* id : {"20260101T000000Z", "20260102T000000Z", "20260103T000000Z"}) {
    fs::create_directories(store->files().journal_of(id).parent_path());
    std::ofstream(store->files().journal_of(id)) << std::string(600 * 1024, 'x');
  }
  const std::int64_t now = store->files().sessions().front().changed_s;
  Config::Journal config;
  EXPECT_TRUE(store->retain(config, "20260103T000000Z", now).empty());
  config.keep_mb = 1.2;
  EXPECT_THAT(store->retain(config, "20260103T000000Z", now), ElementsAre("20260101T000000Z"));
  config.keep_days = 1;
  EXPECT_THAT(store->retain(config, "20260103T000000Z", now + 2 * 86400), ElementsAre("20260102T000000Z"));
  config.keep_mb = 0;
  EXPECT_TRUE(store->retain(config, "20260103T000000Z", now + 2 * 86400).empty());
}

TEST_F(JournalTest, TwoSessionsOfOneSecondHaveTwoNames) {
  auto store = SessionStore::open(dir_);
  ASSERT_TRUE(store);
  EXPECT_EQ(store->new_id(1795343583000), "20261122T103303Z");
  fs::create_directories(store->files().journal_of("20261122T103303Z").parent_path());
  EXPECT_EQ(store->new_id(1795343583999), "20261122T103303Zb");
}

struct Resume : testing::Test {
  ResumePoint point;
  SuitFrame frame;
  Resume() {
    point.tracker.key_poses = {key_pose(40)};
    point.mark = {10.0, 5000, 1'000'000, {}, {}, {}, {}};
    point.rate_hz = 100.0;
    frame.counter = 5500;
  }
};

TEST_F(Resume, TheCounterTellsHowLongItTook) { EXPECT_EQ(time_since(point, frame, 1'005'000), 5.0); }
TEST_F(Resume, AWallClockThatIsBehindIsNotBelieved) { EXPECT_EQ(time_since(point, frame, 1'000), 5.0); }
TEST_F(Resume, TheCounterMayTurnOver) {
  point.mark.index = 4294967200U;
  frame.counter = 4;
  EXPECT_EQ(time_since(point, frame, 1'001'000), 1.0);
}
TEST_F(Resume, ACounterThatBeganAnewIsAnotherStream) {
  frame.counter = 10;
  EXPECT_EQ(time_since(point, frame, 1'005'000), std::nullopt);
}
TEST_F(Resume, ACounterThatCountedLessThanTheClockIsAnotherStream) {
  frame.counter = 5000 + 6000;
  EXPECT_EQ(time_since(point, frame, 1'000'000 + 3'600'000), std::nullopt);
}
TEST_F(Resume, ACounterThatGoesOnRightThereIsTheSameStreamHoweverLongItHeld) {
  frame.counter = 5000 + 50;
  EXPECT_EQ(time_since(point, frame, 1'000'000 + 3'600'000), 3600.0) << "without a time code, the wall's clock counts";
  point.mark.time_code_ms = 40'000'000;
  frame.time_code_ms = 40'000'500;
  EXPECT_EQ(time_since(point, frame, 1'000'000 + 3'600'000), 0.5) << "a recording that was held";
  frame.time_code_ms = 43'600'000;
  EXPECT_EQ(time_since(point, frame, 1'000'000 + 3'600'000), 3600.0) << "a suit that was held";
}
TEST_F(Resume, ARestartedSuitCountsFromZeroWhateverTheClocksSay) {
  point.mark.time_code_ms = 40'000'000;
  frame.time_code_ms = 40'005'000;
  frame.counter = 0;
  EXPECT_EQ(time_since(point, frame, 1'005'000), std::nullopt);
}
TEST_F(Resume, NobodyWalksThatFar) {
  frame[Segment::Pelvis].p.x() = 30.0;
  EXPECT_EQ(time_since(point, frame, 1'005'000), std::nullopt);
}
TEST(ResumePointOf, NeedsTwoMarksAndAKeyPose) {
  const journal::StreamMark first{1.0, 100, 0, {}, {}, {}, {}}, second{2.0, 220, 1000, {}, Pose{}, 0.1, 0.2};
  EXPECT_FALSE(resume_point({}));
  EXPECT_FALSE(resume_point({key_pose(0), first}));
  const auto point = resume_point({key_pose(0), first, key_pose(1), second});
  ASSERT_TRUE(point);
  EXPECT_EQ(point->tracker.key_poses.back().id, 1U);
  EXPECT_EQ(point->rate_hz, 120.0);
  EXPECT_EQ(point->tracker.since_key_pose->path_m, 0.1);
  EXPECT_EQ(point->seen_s(), 2.0);
}

/// Entries and two marks, with which they make a resume point.
Interrupted interrupted(std::vector<journal::Entry> entries) {
  entries.push_back(journal::StreamMark{0.1, 100, 0, {}, {}, {}, {}});
  entries.push_back(journal::StreamMark{0.2, 112, 0, {}, {}, {}, {}});
  return resume_point(entries)->tracker;
}
TEST(ResumePointOf, PutsTogetherTheUnfinishedGestureAndWhatItRefersTo) {
  const auto piece = [](double begin_s, double seen_s, KeyPoseId key_pose) {
    return UnfinishedTrace{begin_s, seen_s, true, {}, {}, {{seen_s, key_pose, Pose{}}}};
  };
  std::vector<journal::Entry> entries;
  for (KeyPoseId id = 0; id < 1000; ++id) {
    entries.push_back(key_pose(id));
    if (id == 100) entries.push_back(piece(10.0, 10.0, id));  // came to nothing
    if (id >= 900) entries.push_back(piece(90.0, 0.1 * id, id));
  }
  const auto tracker = interrupted(entries);
  ASSERT_TRUE(tracker.trace);
  EXPECT_EQ(tracker.trace->begin_s, 90.0);
  EXPECT_EQ(tracker.trace->seen_s, 0.1 * 999);
  ASSERT_THAT(tracker.trace->contacts, SizeIs(100));
  EXPECT_EQ(tracker.find(900)->id, 900U);
  EXPECT_EQ(tracker.find(999)->id, 999U);
  EXPECT_EQ(tracker.find(1000), nullptr);
  EXPECT_LT(tracker.key_poses.size(), 400U) << "what nothing refers to is forgotten";
}
TEST(ResumePointOf, AGestureThatHasEndedIsNotUnfinished) {
  const UnfinishedTrace drawing{0.0, 0.1, true, {}, {}, {{0.1, 0, Pose{}}}};
  const UnfinishedSitting sitting{0.0, 0.1, 0.1, 0.1, true, true, {0.5, 0, 0}, {{0.1, 0, Pose{}, 0.4}}};
  EXPECT_TRUE(interrupted({key_pose(0), drawing, sitting}).trace);
  EXPECT_TRUE(interrupted({key_pose(0), drawing, sitting}).sitting);
  EXPECT_FALSE(interrupted({key_pose(0), drawing, Trace{}}).trace);
  EXPECT_FALSE(interrupted({key_pose(0), drawing, Pivot{}}).trace);
  EXPECT_FALSE(interrupted({key_pose(0), sitting, Sitting{}}).sitting);
  EXPECT_FALSE(interrupted({key_pose(0), sitting, journal::StreamSilence{}}).sitting);
  KeyPose broken = key_pose(1);
  broken.discontinuity = true;
  EXPECT_FALSE(interrupted({key_pose(0), drawing, broken}).trace);
  EXPECT_FALSE(interrupted({key_pose(0), drawing, key_pose(200)}).trace) << "its end was not worth an entry";
}

std::vector<SuitFrame> glider_frames(std::uint32_t begin, std::uint32_t end) {
  std::vector<SuitFrame> frames;
  Assembler assembler{AssemblerConfig{}};
  const auto keep = [&](const SuitFrame& f) { frames.push_back(f); };
  for (std::uint32_t i = begin; i < end; ++i) assembler.add(test::glider_datagram(i), i / 120.0, "test:1", keep);
  assembler.flush(keep);
  return frames;
}

/// A session in which somebody sits down for ten minutes, here and there; as it is on the disk.
std::vector<journal::Entry> sitting_about() {
  test::Wearer wearer;
  for (int k = 0; k < 55; ++k) wearer.sit(2.0 * (k % 3), 1.5 * (k % 2), 0.5 * (k % 3));
  std::vector<journal::Entry> entries{journal::SessionStart{"20261122T103303Z", 0, "test", journal::kVersion}};
  for (const Event& event : wearer.events) entries.push_back(journal::entry_of(event));
  entries.insert(entries.begin() + 100, journal::Announced{12.0, 3, 1, 0});
  return entries;
}

class CheckpointTest : public JournalTest {
 protected:
  CheckpointTest() {
    fs::create_directories(file_.parent_path());
    told(mapper_, entries_);
  }
  /// As the solver tells a mapper.
  void told(Mapper& mapper, const std::vector<journal::Entry>& entries) {
    for (const auto& entry : entries) {
      checkpoints_.add(entry);
      journal::tell(mapper, entry);
      checkpoints_.keep(entry, mapper);
    }
  }
  std::optional<Checkpoints::Restored> restore(const std::vector<journal::Entry>& entries,
                                               const MapperConfig& config = {}) {
    return Checkpoints(journal_.get(), config).restore(entries);
  }

  std::unique_ptr<SessionJournal> journal_ = open(dir_);
  const fs::path file_ = journal_->checkpoint_of("20261122T103303Z");
  std::vector<journal::Entry> entries_ = sitting_about();
  Checkpoints checkpoints_{journal_.get(), {}};
  Mapper mapper_{{}};
};

TEST_F(CheckpointTest, TheSessionGoesOnFromIt) {
  auto restored = restore(entries_);
  ASSERT_TRUE(restored);
  EXPECT_GT(restored->entries, entries_.size() / 3);
  ASSERT_LT(restored->entries, entries_.size());
  for (std::size_t k = restored->entries; k < entries_.size(); ++k) journal::tell(restored->mapper, entries_[k]);
  const auto map = restored->mapper.snapshot(), undisturbed = mapper_.snapshot();
  ASSERT_THAT(map->objects, SizeIs(undisturbed->objects.size()));
  for (std::size_t k = 0; k < map->objects.size(); ++k)
    EXPECT_EQ(map->objects[k].pose.p, undisturbed->objects[k].pose.p);
  EXPECT_EQ(map->trajectory.size(), undisturbed->trajectory.size());
}

TEST_F(CheckpointTest, CountsOnlyForTheJournalThatItIsOf) {
  auto without_note = entries_;
  std::erase_if(without_note, [](const auto& e) { return std::holds_alternative<journal::Announced>(e); });
  EXPECT_TRUE(restore(without_note)) << "nothing is mapped from what was announced";
  auto changed = entries_;
  std::get<KeyPose>(changed[50]).path_m += 0.001;
  EXPECT_FALSE(restore(changed));
  auto shorter = entries_;
  shorter.erase(shorter.begin() + 50);
  EXPECT_FALSE(restore(shorter));
  shorter.resize(60);
  EXPECT_FALSE(restore(shorter));
  MapperConfig other;
  other.hand.tip_m = 0.15;
  EXPECT_FALSE(restore(entries_, other));
}

TEST_F(CheckpointTest, ADamagedOneIsNone) {
  const std::string bytes = text(file_);
  ASSERT_GT(bytes.size(), 1000U);
  for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 50) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::ofstream(file_, std::ios::binary) << damaged;
    EXPECT_FALSE(restore(entries_)) << at;
    std::ofstream(file_, std::ios::binary) << bytes.substr(0, at);
    EXPECT_FALSE(restore(entries_)) << at;
  }
}

TEST_F(CheckpointTest, GoesWithTheNextSession) {
  ASSERT_TRUE(fs::exists(file_));
  checkpoints_.add(journal::SessionStart{"20261122T120000Z", 0, "test", journal::kVersion});
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(CheckpointTest, NoneOnADiskThatIsFull) {
  Config::Journal config = unlimited();
  config.min_free_mb = 1e12;
  fs::create_directories(dir_ / "full");
  auto opened = SessionJournal::open(dir_ / "full", config);
  ASSERT_TRUE(opened) << opened.error();
  const fs::path file = (*opened)->checkpoint_of("20261122T103303Z");
  fs::create_directories(file.parent_path());
  Checkpoints checkpoints(opened->get(), {});
  Mapper mapper{{}};
  for (const auto& entry : entries_) {
    checkpoints.add(entry);
    journal::tell(mapper, entry);
    checkpoints.keep(entry, mapper);
  }
  EXPECT_TRUE(fs::is_empty(file.parent_path()));
}

class PipelineJournal : public JournalTest {
 protected:
  /// Runs a daemon's life: these frames, then its end. The last map.
  std::shared_ptr<const MapSnapshot> live(std::uint32_t begin, std::uint32_t end) {
    const std::size_t before = entries_written();
    Pipeline pipeline{TrackerConfig{}, MapperConfig{}, {}, open(dir_)};
    for (const auto& frame : glider_frames(begin, end)) pipeline.offer(frame);
    pipeline.offer_silence();
    EXPECT_TRUE(eventually([&] {
      const auto stats = pipeline.stats();
      // Before the solver has had the first entry the journal need not be there.
      return stats.tracker.frames == end - begin && stats.solver.messages > 0 &&
             has_ended(stats, entries_written() - before);
    }));
    return pipeline.map();
  }

 private:
  /// Of all sessions.
  [[nodiscard]] std::size_t entries_written() const {
    const SessionFiles files(dir_);
    std::size_t count = 0;
    for (const auto& session : files.sessions()) count += entries(files.journal_of(session.id)).size();
    return count;
  }
  /// All is written, silence last, and mapped.
  bool has_ended(const PipelineStats& stats, std::size_t written_in_this_life) const {
    if (written_in_this_life != stats.solver.messages) return false;
    const SessionFiles files(dir_);
    const auto written = entries(files.journal_of(files.sessions().back().id));
    return std::holds_alternative<journal::StreamSilence>(written.back());
  }
};

TEST_F(PipelineJournal, ARestartGoesOnWithTheSameSession) {
  const auto first = live(0, 600);
  const auto second = live(720, 960);  // a second is missing
  ASSERT_GT(second->trajectory.size(), first->trajectory.size());
  for (std::size_t i = 0; i < first->trajectory.size(); ++i)
    EXPECT_EQ(first->trajectory[i].T_odom_pelvis.p, second->trajectory[i].T_odom_pelvis.p);
  // The glider makes 1 m/s: time and place went on together, over the gap too.
  const auto& last = second->trajectory.back();
  EXPECT_NEAR(last.time_s, 959 / 120.0, 0.02);
  EXPECT_NEAR((last.T_odom_pelvis.p - second->trajectory.front().T_odom_pelvis.p).norm(), last.time_s, 0.05);
  EXPECT_GT(second->revision, first->revision);
  auto store = SessionStore::open(dir_);
  EXPECT_THAT(store->files().sessions(), SizeIs(1));
}

TEST_F(PipelineJournal, AnotherStreamBeginsAnotherSession) {
  const auto first = live(5000, 5600);
  const auto second = live(0, 240);
  EXPECT_LT(second->trajectory.size(), first->trajectory.size());
  EXPECT_GT(second->revision, first->revision);
  EXPECT_LT(second->trajectory.front().time_s, 0.1);
  auto store = SessionStore::open(dir_);
  EXPECT_THAT(store->files().sessions(), SizeIs(2));
}

TEST_F(PipelineJournal, TheMapIsBackBeforeTheSuitIs) {
  const auto first = live(0, 600);
  const Pipeline pipeline{TrackerConfig{}, MapperConfig{}, {}, open(dir_)};
  EXPECT_TRUE(eventually([&] { return pipeline.map()->trajectory.size() == first->trajectory.size(); }));
  EXPECT_EQ(pipeline.map()->revision, first->revision);
}

}  // namespace
}  // namespace kinemap
