// SPDX-License-Identifier: Apache-2.0
#include "protocol/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "protocol/wire/mvnx_writer.hpp"
#include "protocol/wire/pcap.hpp"
#include "tests/protocol/assembler_bench.hpp"
#include "tests/protocol/capture_maker.hpp"
#include "tests/protocol/mvnx_maker.hpp"

namespace kinemap {
namespace {

using namespace testing_support;
using testing::HasSubstr;

class Recording : public testing::Test {
 protected:
  Result<RecordingSummary> read(const std::string& path, const AssemblerConfig& config = {}) {
    frames_.clear();
    wearers_.clear();
    progress_.clear();
    return read_recording(
        path, config,
        {[this](const SuitFrame& f) { frames_.push_back(f); }, [this](const WearerInfo& w) { wearers_.push_back(w); }},
        [this](double part) { progress_.push_back(part); });
  }
  Result<RecordingSummary> read_text(const std::string& text, const AssemblerConfig& config = {}) {
    file_.write(text);
    return read(file_.path(), config);
  }
  std::string error_of(const std::string& text) {
    const auto result = read_text(text);
    EXPECT_FALSE(result);
    return result ? "" : result.error();
  }

  // The name's ending must not matter: content tells.
  TemporaryFile file_{std::string("recording_test_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                      ".dat"};
  std::vector<SuitFrame> frames_;
  std::vector<WearerInfo> wearers_;
  std::vector<double> progress_;
};

void expect_bodies(const std::vector<SuitFrame>& frames, std::size_t count, double tolerance) {
  ASSERT_EQ(frames.size(), count);
  for (const SuitFrame& f : frames) {
    ASSERT_NEAR(f.time_s, static_cast<double>(f.index) / 120.0, 1e-9);
    const auto truth = body_items(f.index);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(f.segments[i].p[static_cast<int>(k)], truth[i].position[k], tolerance);
      const auto& q = truth[i].orientation;
      ASSERT_LT(f.segments[i].q.angularDistance(Eigen::Quaterniond(q[0], q[1], q[2], q[3])), 1e-5) << "segment " << i;
    }
  }
}

TEST_F(Recording, MvnxOfBothVersionsGivesTheSameFramesAndWearer) {
  for (const int version : {3, 4}) {
    for (const bool t_pose : {true, false}) {
      const auto result = read_text(mvnx({version, t_pose}, 300));
      ASSERT_TRUE(result) << result.error();
      EXPECT_EQ(result->format, "mvnx");
      EXPECT_EQ(result->rate_hz, 120.0);
      EXPECT_NEAR(result->duration_s, 299.0 / 120.0, 1e-9);
      EXPECT_TRUE(result->warnings.empty());
      EXPECT_EQ(result->stream.accounted(), result->stream.datagrams);
      expect_bodies(frames_, 300, 1e-6);
      EXPECT_EQ(frames_[0].center_of_mass, Eigen::Vector3d(0.5, 0.25, 1));
      EXPECT_EQ(result->wearer.name, "Anna");
      ASSERT_EQ(wearers_.size(), 1U);
      ASSERT_TRUE(wearers_[0].p_hand_fingertip);
      EXPECT_LT((*wearers_[0].p_hand_fingertip - Eigen::Vector3d(0.01, -0.18, 0)).norm(), 1e-6)
          << "version " << version;
      EXPECT_EQ(wearers_[0].stature_m.has_value(), t_pose);
      if (t_pose) {
        EXPECT_NEAR(*wearers_[0].stature_m, 1.75, 1e-6);
      }
      EXPECT_EQ(progress_.back(), 1.0);
    }
  }
}

TEST_F(Recording, TheTPoseFrameDecidesTheConventionOverTheVersion) {
  std::string text = mvnx({4, true}, 10);
  text.replace(text.find("version=\"4\""), 11, "version=\"3\"");
  ASSERT_TRUE(read_text(text));
  expect_bodies(frames_, 10, 1e-6);
}

TEST_F(Recording, MvnxWriterIsReadBack) {
  MvnxSubject subject;
  subject.name = "A<n&\"a";
  subject.frame_rate_hz = 240.0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const auto& p = t_pose()[i];
    subject.segments.push_back({kSegmentNames[i], {p.x(), p.y(), p.z()}, {}});
  }
  subject.segments[10].points.push_back({"pRightTopOfHand", {0, -0.19, 0.01}});
  auto writer = MvnxWriter::create(file_.path(), subject);
  ASSERT_TRUE(writer);
  for (std::uint64_t k = 0; k < 100; ++k) {
    std::vector<MvnxPose> poses;
    for (const auto& item : body_items(k)) {
      const auto& [x, y, z] = item.position;
      const auto& o = item.orientation;
      poses.push_back({{x, y, z}, {o[0], o[1], o[2], o[3]}});
    }
    EXPECT_TRUE(writer->write({7 + k, static_cast<double>(k) / 240.0, poses, std::array<double, 3>{1, 2, 3}}));
  }
  EXPECT_FALSE(writer->close());
  const auto result = read(file_.path());
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->wearer.name, subject.name);
  EXPECT_EQ(result->rate_hz, 240.0);
  ASSERT_EQ(frames_.size(), 100U);
  EXPECT_NEAR(frames_[99].time_s, 99.0 / 240.0, 1e-12);
  EXPECT_EQ(frames_[99].index, 106U);
  EXPECT_EQ(frames_[99].center_of_mass, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(frames_[99].segments[10].p.y(), body_items(99)[10].position[1], 1e-6);
  EXPECT_NEAR(*result->wearer.stature_m, 1.58 / 0.905, 1e-6);
  EXPECT_LT((*result->wearer.p_hand_fingertip - Eigen::Vector3d(0, -0.19, 0.01)).norm(), 1e-6);
}

TEST_F(Recording, MvnxWriterRefusesAFrameOfAnotherSize) {
  MvnxSubject subject;
  subject.segments.resize(23);
  auto writer = MvnxWriter::create(file_.path(), subject);
  ASSERT_TRUE(writer);
  const std::vector<MvnxPose> poses(22);
  EXPECT_FALSE(writer->write({0, 0.0, poses, {}}));
  EXPECT_THAT(writer->close()->message, HasSubstr("22 segments"));
  EXPECT_FALSE(MvnxWriter::create("/nowhere/at/all.mvnx", subject));
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST_F(Recording, MvnxErrorsNamePathAndLine) {
  const std::string good = mvnx({}, 3);
  const auto at_line = [&](int line) { return file_.path() + ":" + std::to_string(line) + ": "; };
  EXPECT_THAT(error_of(replaced(good, "<mvnx version=\"4\"", "<mvnx version=\"7\"")),
              HasSubstr(at_line(2) + "<mvnx version=\"7\">"));
  EXPECT_THAT(error_of(replaced(good, "<mvnx version=\"4\"", "<mvnx")), HasSubstr("version 3 or 4"));
  EXPECT_THAT(error_of("<svg><g/></svg>"), HasSubstr(at_line(1) + "the document is <svg>"));
  EXPECT_THAT(error_of(replaced(good, "frameRate=\"120\"", "frameRate=\"fast\"")),
              HasSubstr(at_line(4) + "frameRate=\"fast\""));
  EXPECT_THAT(error_of(replaced(good, "label=\"L3\"", "label=\"L4\"")),
              HasSubstr("segment 3 is \"L4\"; L3 is expected"));
  EXPECT_THAT(error_of(replaced(good, "</segments>", "</segmants>")), HasSubstr("mismatched tag"));
  EXPECT_THAT(error_of(replaced(good, "<position>", "<position>abc ")),
              HasSubstr("<position> has something that is no number"));
  EXPECT_THAT(error_of(replaced(good, "<pos_b>", "<pos_b>1 ")), HasSubstr("<pos_b> has 4 numbers, not 3"));
  std::string no_position = good;
  for (std::size_t at; (at = no_position.find("position>")) != std::string::npos;)
    no_position.replace(at, 9, "velocity>");
  EXPECT_THAT(error_of(no_position), HasSubstr("without <position>"));
  const std::size_t last = good.rfind("<position>");
  EXPECT_THAT(error_of(good.substr(0, last + 10) + "1 " + good.substr(last + 10)), HasSubstr("70 position"));
  EXPECT_THAT(error_of(replaced(good, "</frame>", "<frame/></frame>")), HasSubstr("<frame> within <frame>"));
}

TEST_F(Recording, MvnxOfFewSegmentsIsNoBody) {
  EXPECT_THAT(error_of("<mvnx version=\"4\"><subject frameRate=\"60\"><segments><segment "
                       "label=\"Pelvis\"/></segments><frames><frame/></frames>"
                       "</subject></mvnx>"),
              HasSubstr("1 segments; a whole body has 23"));
}

TEST_F(Recording, EntityBombsAndOtherXmlTricksAreRefused) {
  std::string bomb = "<?xml version=\"1.0\"?>\n<!DOCTYPE mvnx [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"";
    for (int i = 0; i < 10; ++i) bomb += std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += "\">";
  }
  bomb += "]>\n<mvnx version=\"4\">&j;</mvnx>";
  EXPECT_THAT(error_of(bomb), HasSubstr("<!DOCTYPE>"));
  EXPECT_THAT(error_of("<!DOCTYPE mvnx SYSTEM \"file:///etc/passwd\"><mvnx version=\"4\"/>"), HasSubstr("<!DOCTYPE>"));
  std::string deep = "<mvnx version=\"4\">";
  for (int i = 0; i < 1000; ++i) deep += "<a>";
  EXPECT_THAT(error_of(deep), HasSubstr("nested"));
  EXPECT_THAT(error_of("<mvnx version=\"4\"><subject label=\"" + std::string(20 << 20, 'x')), HasSubstr("4 MiB"));
  const std::string head = mvnx_head({});
  EXPECT_THAT(error_of(head + "<frame type=\"normal\"><position>" + std::string(1 << 20, '1')),
              HasSubstr("longer than"));
  std::string many = "<mvnx version=\"4\"><subject>";
  for (int i = 0; i < 300; ++i) many += "<segment/>";
  EXPECT_THAT(error_of(many), HasSubstr("255 segments"));
}

TEST_F(Recording, AMvnxCutShortAnywhereGivesWhatItHasOrAnError) {
  const std::string whole = mvnx({}, 6);
  std::mt19937 random(8);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = random() % (whole.size() - 1) + 1;
    const auto result = read_text(whole.substr(0, n));
    if (result) {
      EXPECT_FALSE(frames_.empty());
      // Only what follows the root element may be missing without a word.
      EXPECT_EQ(result->warnings.empty(), n >= whole.size() - 1) << n;
    } else {
      EXPECT_TRUE(frames_.empty()) << n << ' ' << result.error();
    }
  }
}

TEST_F(Recording, RandomDamageOfAMvnxNeverCrashes) {
  const std::string whole = mvnx({}, 3);
  std::mt19937 random(9);
  for (int round = 0; round < 300; ++round) {
    std::string text = whole;
    for (unsigned k = 0; k < 1U + random() % 4; ++k) text[random() % text.size()] = static_cast<char>(random());
    const auto result = read_text(text);
    if (result) {
      EXPECT_EQ(result->stream.accounted(), result->stream.datagrams);
    }
  }
}

TEST_F(Recording, MvnxFramesThatAreNoBodyAreCounted) {
  std::string text = mvnx({}, 20);
  const auto spoil = [&](const std::string& tag, const std::string& number, int nth) {
    std::size_t at = 0;
    for (int i = 0; i <= nth; ++i) at = text.find(tag, at + 1);
    at += tag.size();
    text.replace(at, text.find(' ', at) - at, number);
  };
  spoil("<orientation>", "5", 5);  // the first is the tpose frame's
  spoil("<position>", "nan", 7);
  spoil("<position>", "1e9", 9);
  const auto result = read_text(text);
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->stream.faults[static_cast<std::size_t>(mxtp::Fault::NotUnit)], 1U);
  EXPECT_EQ(result->stream.faults[static_cast<std::size_t>(mxtp::Fault::NotFinite)], 1U);
  EXPECT_EQ(result->stream.faults[static_cast<std::size_t>(mxtp::Fault::OutOfRange)], 1U);
  EXPECT_EQ(frames_.size(), 17U);
}

TEST_F(Recording, MvnxWithoutMotionOrWithoutTheSubject) {
  EXPECT_THAT(error_of(mvnx({}, 0)), HasSubstr("no frame of type normal"));
  AssemblerConfig config;
  config.character = 1;
  const auto result = read_text(mvnx({}, 3), config);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error(), HasSubstr("it has 1 subjects"));
}

// ---- pcap

void write_pcap(const std::string& path, const std::vector<Arrival>& all) {
  auto writer = PcapWriter::create(path, 9763);
  ASSERT_TRUE(writer);
  for (const Arrival& a : all) ASSERT_TRUE(writer->write(a.time_s, a.bytes));
  ASSERT_FALSE(writer->close());
}

TEST_F(Recording, PcapIsToldByItsContent) {
  auto all = walk(0, 300);
  all.insert(all.begin(), {mxtp::encode_meta({}, {{{"name", "Bo"}}}), 100.0});
  all.insert(all.begin() + 50, {packet_of("this is another protocol"), 100.3});
  write_pcap(file_.path(), all);
  const auto result = read(file_.path());
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->format, "pcap");
  EXPECT_EQ(result->rate_hz, 120.0);
  EXPECT_EQ(result->wearer.name, "Bo");
  EXPECT_EQ(wearers_.size(), 1U);
  EXPECT_EQ(result->stream.datagrams, 301U) << "what is no MXTP is none of our business";
  EXPECT_TRUE(result->warnings.empty());
  expect_bodies(frames_, 300, 0.0);
}

TEST_F(Recording, ATruncatedLastPacketIsAWarning) {
  write_pcap(file_.path(), walk(0, 100));
  auto bytes = read_bytes(file_.path());
  bytes.resize(bytes.size() - 5);
  file_.write(bytes);
  const auto result = read(file_.path());
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(frames_.size(), 99U);
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_THAT(result->warnings[0], HasSubstr("ends within a packet"));
}

TEST_F(Recording, NoWearerIsAnErrorThatSaysWhy) {
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("some text"), HasSubstr("no pcap magic"));
  EXPECT_THAT(read("/nowhere/at/all.pcap").error(), HasSubstr("/nowhere/at/all.pcap: cannot open: No such file"));
  EXPECT_THAT(read(KINEMAP_BINARY_DIR).error(), HasSubstr("directory"));

  write_pcap(file_.path(), {});
  EXPECT_THAT(read(file_.path()).error(), HasSubstr("0 packets, of which none carries MXTP"));
  write_pcap(file_.path(), {{packet_of("not MXTP at all"), 1.0}});
  EXPECT_THAT(read(file_.path()).error(), HasSubstr("1 packets, of which none carries MXTP"));

  std::vector<Arrival> objects;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const auto item = body_items(k)[0];
    objects.push_back(
        {mxtp::encode_poses(header_of(k), std::span(&item, 1))[0], 100.0 + 0.01 * static_cast<double>(k)});
  }
  write_pcap(file_.path(), objects);
  EXPECT_THAT(read(file_.path()).error(), HasSubstr("20 are of tracked objects"));

  std::vector<Arrival> pinned;
  for (std::uint64_t k = 0; k < 50; ++k) {
    auto items = body_items(k);
    const auto pelvis = items[0].position;
    for (auto& item : items) {
      for (std::size_t i = 0; i < 3; ++i) item.position[i] -= pelvis[i];
    }
    pinned.push_back({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  write_pcap(file_.path(), pinned);
  EXPECT_THAT(read(file_.path()).error(), HasSubstr("Single Level"));
}

TEST_F(Recording, PartlyPinnedIsAWarning) {
  auto all = walk(0, 100);
  for (std::uint64_t k = 100; k < 150; ++k) {
    auto items = body_items(k);
    const auto pelvis = items[0].position;
    for (auto& item : items) {
      for (std::size_t i = 0; i < 3; ++i) item.position[i] -= pelvis[i];
    }
    all.push_back({mxtp::encode_poses(header_of(k), items)[0], 100.0 + static_cast<double>(k) / 120.0});
  }
  write_pcap(file_.path(), all);
  const auto result = read(file_.path());
  ASSERT_TRUE(result);
  EXPECT_EQ(frames_.size(), 100U);
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_THAT(result->warnings[0], HasSubstr("refused"));
}

TEST(RecordingReal, EveryCaptureIsReadToItsEnd) {
  const std::string data = std::string(KINEMAP_SHARED_DATA) + "/";
  if (!exists(data + "cmu_walk_2.pcap")) GTEST_SKIP() << "no recordings in " << data;
  struct Expected {
    const char* name;
    std::size_t frames;
    double least_path_m;
    double most_path_m;
  };
  for (const auto& e :
       {Expected{"cmu_walk_2", 598, 4, 5}, Expected{"cmu_walk_3", 494, 4, 5}, Expected{"cmu_washwindow_1", 2753, 2, 4},
        Expected{"cmu_directtraffic_4", 3702, 4, 7}, Expected{"cmu_jump_1", 2085, 12, 20}}) {
    std::vector<SuitFrame> frames;
    const auto result =
        read_recording(data + e.name + ".pcap", {}, {[&](const SuitFrame& f) { frames.push_back(f); }, {}});
    ASSERT_TRUE(result) << result.error();
    EXPECT_EQ(result->rate_hz, 120.0);
    EXPECT_EQ(frames.size(), e.frames);
    EXPECT_EQ(result->stream.used, e.frames);
    EXPECT_EQ(result->stream.lost_samples, 0U);
    EXPECT_TRUE(result->warnings.empty());
    double path_m = 0.0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_NEAR(frames[i].time_s, static_cast<double>(i) / 120.0, 1e-9);
      EXPECT_FALSE(frames[i].discontinuity);
      if (i > 0) path_m += (frames[i][Segment::Pelvis].p - frames[i - 1][Segment::Pelvis].p).norm();
    }
    EXPECT_GT(path_m, e.least_path_m) << e.name;
    EXPECT_LT(path_m, e.most_path_m) << e.name;
  }
}

}  // namespace
}  // namespace kinemap
