// SPDX-License-Identifier: Apache-2.0
// What goes over the wire and into the files.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/tools/sim_fixture.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap::sim {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SimFiles : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::temp_directory_path() /
           (std::string("kinemap_sim_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }
  SimOptions options(const char* name, std::uint64_t seed) const {
    SimOptions o = seeded(seed);
    o.out_dir = (dir_ / name).string();
    return o;
  }
  fs::path dir_;
};

TEST_F(SimFiles, SameSeedGivesTheSameBytes) {
  const auto a = simulate_to_directory(options("a", 11)), b = simulate_to_directory(options("b", 11)),
             c = simulate_to_directory(options("c", 12));
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(bytes_of(a->session_path), bytes_of(b->session_path));
  EXPECT_EQ(bytes_of(a->truth_path), bytes_of(b->truth_path));
  EXPECT_NE(bytes_of(a->session_path), bytes_of(c->session_path));
  EXPECT_GT(bytes_of(a->session_path).size(), a->samples * 700);
}

TEST_F(SimFiles, TruthSaysAllThatIsKnown) {
  const auto report = simulate_to_directory(options("a", 6));
  ASSERT_TRUE(report);
  const auto truth = nlohmann::json::parse(bytes_of(report->truth_path));
  EXPECT_EQ(truth["format"], "kinemap/truth");
  EXPECT_EQ(truth["version"], 1);
  EXPECT_EQ(truth["objects"].size(), report->objects);
  std::set<int> ids;
  for (const auto& object : truth["objects"]) {
    ids.insert(object["id"].get<int>());
    EXPECT_EQ(object["pose"]["position"].size(), 3U);
    if (object["type"] == "chair") continue;
    // Corners lie on the plane and are as far apart as the size says.
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < 3; ++k) corners[i][static_cast<long>(k)] = object["corners"][i][k].get<double>();
    }
    const Vec3 n(object["plane"]["normal"][0], object["plane"]["normal"][1], object["plane"]["normal"][2]);
    for (const auto& corner : corners) EXPECT_NEAR(n.dot(corner), object["plane"]["offset"].get<double>(), 1e-5);
    const double a = (corners[1] - corners[0]).norm(), b = (corners[2] - corners[1]).norm();
    EXPECT_NEAR(a * b, object["size"][0].get<double>() * object["size"][1].get<double>(), 1e-4);
    if (object["type"] == "screen") {
      EXPECT_EQ(object["class"] == "big", std::max(a, b) > 1.0);
    }
  }
  for (const auto& interval : truth["intervals"]) {
    EXPECT_LE(interval["begin"].get<double>(), interval["end"].get<double>());
    if (interval["label"] == "trace") {
      EXPECT_LT(interval["begin"].get<double>(), interval["contact_begin"].get<double>());
      EXPECT_LT(interval["contact_end"].get<double>(), interval["end"].get<double>());
    }
  }
  const auto& trajectory = truth["trajectory"];
  ASSERT_GT(trajectory.size(), 10 * report->duration_s);
  EXPECT_EQ(trajectory[0][0], 0.0);
  EXPECT_NEAR(trajectory.back()[0].get<double>(), report->duration_s, 0.05);
}

TEST_F(SimFiles, MvnxHoldsEveryFrame) {
  SimOptions o = options("m", 3);
  o.format = Format::Mvnx;
  const auto report = simulate_to_directory(o);
  ASSERT_TRUE(report) << report.error();
  const std::string text = bytes_of(report->session_path);
  std::size_t frames = 0;
  for (std::size_t at = text.find("type=\"normal\""); at != std::string::npos;
       at = text.find("type=\"normal\"", at + 1))
    ++frames;
  EXPECT_EQ(frames, report->samples);
}

TEST_F(SimFiles, ADirectoryThatCannotBeMadeIsAnError) {
  fs::create_directories(dir_);
  std::ofstream(dir_ / "file") << "x";
  const auto report = simulate_to_directory(options("file/below", 1));
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().find("below"), std::string::npos);
}

struct Received {
  std::size_t samples = 0, poses = 0, meta = 0, scale = 0, com = 0, faults = 0, flips = 0;
  std::vector<std::uint32_t> counters, times;
};

Received receive(const SimOptions& options, double until_s) {
  auto source = LiveSource::create(options);
  EXPECT_TRUE(source);
  Received r;
  std::array<float, 4> last{1, 0, 0, 0};
  for (auto packets = source->next(); packets && packets->time_s < until_s; packets = source->next()) {
    ++r.samples;
    for (const auto& bytes : packets->datagrams) {
      const auto decoded = mxtp::decode(bytes);
      if (std::holds_alternative<mxtp::Fault>(decoded)) {
        ++r.faults;
        continue;
      }
      const auto& datagram = std::get<mxtp::Datagram>(decoded);
      r.meta += datagram.header.type == 12;
      r.scale += datagram.header.type == 13;
      r.com += datagram.header.type == 24;
      if (datagram.header.type != 2) continue;
      ++r.poses;
      r.counters.push_back(datagram.header.sample_counter);
      r.times.push_back(datagram.header.time_code_ms);
      const auto& items = std::get<mxtp::PoseItems>(datagram.payload).items;
      EXPECT_EQ(items.size(), mxtp::kBodySegments);
      const auto& q = items[4].orientation;
      r.flips += q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3] < 0;
      last = q;
    }
  }
  return r;
}

TEST(SimStream, DatagramsDecodeAtEveryRate) {
  for (const double rate : {60.0, 100.0, 120.0, 240.0}) {
    SCOPED_TRACE(rate);
    SimOptions options = seeded(5, rate);
    options.send_center_of_mass = true;
    options.packet_loss = 0.0;
    const Received r = receive(options, 20.0);
    EXPECT_EQ(r.faults, 0U);
    EXPECT_EQ(r.poses, r.samples);
    EXPECT_EQ(r.com, r.samples);
    EXPECT_NEAR(static_cast<double>(r.samples), 20.0 * rate, 2.0);
    EXPECT_NEAR(static_cast<double>(r.meta), 20.0, 1.0);
    EXPECT_GE(r.scale, 19U);
    EXPECT_GT(r.flips, 0U);
    for (std::size_t i = 1; i < r.counters.size(); ++i) ASSERT_EQ(r.counters[i], r.counters[i - 1] + 1);
    EXPECT_NEAR((r.times.back() - r.times.front()) / 1000.0, 20.0, 0.05);
  }
}

/// Strength and dip as the pelvis' tracker has them, and how far the pelvis is from the nearest metal.
struct FieldSample {
  double norm, dip, metal_m;
};
std::vector<FieldSample> fields(Severity drift) {
  SimOptions options = seeded(4);
  options.drift = drift;
  options.send_tracker = true;
  auto source = LiveSource::create(options);
  EXPECT_TRUE(source);
  std::vector<FieldSample> out;
  while (const auto packets = source->next()) {
    for (const auto& bytes : packets->datagrams) {
      const auto decoded = mxtp::decode(bytes);
      const auto* datagram = std::get_if<mxtp::Datagram>(&decoded);
      const auto* trackers = datagram ? std::get_if<mxtp::TrackerItems>(&datagram->payload) : nullptr;
      if (trackers == nullptr) continue;
      EXPECT_EQ(trackers->items.size(), 17U);
      const auto& [id, q, free, acceleration, turn, m] = trackers->items[0];
      EXPECT_EQ(id, 1);
      const Vec3 field = Quat(q[0], q[1], q[2], q[3]) * Vec3(m[0], m[1], m[2]);
      double metal = 1e9;
      const Vec3 p = source->session().to_building(source->sample().truth[kPelvis].p);
      for (const auto& patch : source->session().patches()) metal = std::min(metal, patch.metal.distance(p.head<2>()));
      out.push_back({field.norm(), std::asin(-field.z() / field.norm()), metal});
    }
  }
  return out;
}

TEST(SimStream, TheFieldIsBentBesideMetalAndNearlyCalmElsewhere) {
  const auto spread = [](const std::vector<FieldSample>& all, double near, double far) {
    double sum = 0.0, sum2 = 0.0, n = 0.0;
    for (const auto& f : all) {
      if (f.metal_m < near || f.metal_m > far) continue;
      n += 1.0, sum += f.norm, sum2 += f.norm * f.norm;
      EXPECT_GT(f.norm, 0.3);
      EXPECT_LT(f.norm, 1.8);
      EXPECT_GT(f.dip, radians(25.0));
    }
    EXPECT_GT(n, 200.0);
    return std::sqrt(sum2 / n - sum * sum / n / n);
  };
  const auto bent = fields(Severity::Default);
  EXPECT_GT(spread(bent, 0.0, 0.35), 2.0 * spread(bent, 0.75, 1e8));
  EXPECT_LT(spread(fields(Severity::Good), 0.0, 2e9), 0.06);  // no metal at all
}

TEST(SimStream, NoTrackersUnlessAskedFor) {
  auto source = LiveSource::create(seeded(4));
  ASSERT_TRUE(source);
  for (int i = 0; i < 60; ++i) {
    const auto packets = source->next();
    ASSERT_TRUE(packets);
    for (const auto& bytes : packets->datagrams) EXPECT_FALSE(bytes[4] == std::byte{'2'} && bytes[5] == std::byte{'3'});
  }
}

TEST(SimStream, LossesComeInBurstsAsOftenAsAsked) {
  for (const auto& [drift, part] : {std::pair(Severity::Good, 0.0), {Severity::Default, 0.01}, {Severity::Bad, 0.30}}) {
    SimOptions options = seeded(2);
    options.drift = drift;
    const Received r = receive(options, 1e9);
    const double lost = 1.0 - static_cast<double>(r.poses) / static_cast<double>(r.samples);
    EXPECT_NEAR(lost, part, 0.3 * part) << to_string(drift);
    std::size_t gaps = 0, missing = 0;
    for (std::size_t i = 1; i < r.counters.size(); ++i) {
      gaps += r.counters[i] != r.counters[i - 1] + 1;
      missing += r.counters[i] - r.counters[i - 1] - 1;
    }
    if (part > 0.0) {
      EXPECT_GT(static_cast<double>(missing) / static_cast<double>(gaps), 2.0);
    }
  }
}

}  // namespace
}  // namespace kinemap::sim
