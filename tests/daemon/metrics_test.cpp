// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "daemon/api.hpp"
#include "daemon/metrics_text.hpp"
#include "tests/daemon/support.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Gives each member of a struct of plain counters a number of its own, from `first` on.
template <class T>
std::vector<std::uint64_t> number_members(T& counters, std::uint64_t first) {
  std::vector<std::uint64_t> numbers;
  for (std::size_t i = 0; i < sizeof(T) / sizeof(std::uint64_t); ++i) numbers.push_back(first + i);
  std::memcpy(static_cast<void*>(&counters), numbers.data(), numbers.size() * sizeof(std::uint64_t));
  return numbers;
}

Status sample_status() {
  Status status;
  status.uptime_s = 12.5;
  status.suit.news = std::make_shared<const ReceiverNews>();
  status.suit.now_s = 10.0;
  status.suit.counts.last_frame_s = 9.5;
  status.map = std::make_shared<const MapSnapshot>(sample_map());
  status.pipeline.has_journal = true;
  status.pipeline.has_recorder = true;
  for (const double seconds : {3e-6, 4e-6, 20.0}) status.pipeline.tracker_steps.add(seconds);
  status.pipeline.solver.events.add(0.25);
  status.pipeline.solver_at_entry_s = 12.5;
  return status;
}

TEST(Durations, EachFallsIntoTheBucketThatEndsAtOrAboveIt) {
  Durations durations;
  durations.add(0.0);
  durations.add(1e-6);
  durations.add(1.1e-6);
  durations.add(10.0);
  durations.add(10.1);
  EXPECT_EQ(durations.counts.front(), 2U);
  EXPECT_EQ(durations.counts[1], 1U);
  EXPECT_EQ(durations.counts[Durations::kBounds.size() - 1], 1U);
  EXPECT_EQ(durations.counts.back(), 1U);
  EXPECT_DOUBLE_EQ(durations.sum_s, 20.1 + 2.1e-6);
}

TEST(MetricsText, EscapesAndNumbers) {
  MetricsText out;
  out.gauge("a", "One \\ and\nanother \"line\".");
  out.sample({{"x", "back\\slash"}, {"y", "\"quoted\"\n"}}, 0.1);
  out.sample({}, std::numeric_limits<std::uint64_t>::max());
  out.sample({}, std::numeric_limits<double>::infinity());
  out.sample({}, -std::numeric_limits<double>::infinity());
  out.sample({}, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(out.take(),
            "# HELP a One \\\\ and\\nanother \"line\".\n"
            "# TYPE a gauge\n"
            "a{x=\"back\\\\slash\",y=\"\\\"quoted\\\"\\n\"} 0.1\n"
            "a 18446744073709551615\n"
            "a +Inf\n"
            "a -Inf\n"
            "a NaN\n");
}

TEST(Metrics, HistogramsAreCumulativeAndEndWithAll) {
  const std::string text = metrics_text(sample_status());
  EXPECT_THAT(text, HasSubstr("# TYPE kinemap_tracker_step_seconds histogram\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_bucket{le=\"2.5e-06\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_bucket{le=\"5e-06\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_bucket{le=\"10\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_bucket{le=\"+Inf\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_sum 20.000007\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_tracker_step_seconds_count 3\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_solver_event_seconds_count 1\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_solver_entry_age_seconds 12.5\n"));
}

/// "Every drop is counted and visible": a counter of these structs that /metrics does not show is found here.
TEST(Metrics, NoCounterIsLeftOut) {
  Status status = sample_status();
  std::vector<std::uint64_t> numbers;
  const auto add = [&numbers](std::vector<std::uint64_t> more) {
    numbers.insert(numbers.end(), more.begin(), more.end());
  };
  add(number_members(status.suit.counts.stream, 1'000'000));
  add(number_members(status.pipeline.frames, 2'000'000));
  add(number_members(status.pipeline.events, 2'100'000));
  add(number_members(status.pipeline.notices, 2'200'000));
  add(number_members(status.pipeline.unwritten, 2'300'000));
  auto& counts = status.suit.counts;
  for (auto* one : {&counts.kernel_drops, &counts.truncated, &counts.tcp_accepted, &counts.tcp_refused,
                    &counts.tcp_closed_garbage, &counts.tcp_skipped_bytes, &counts.tcp_open})
    numbers.push_back(*one = 3'000'000 + numbers.size());
  auto& tracker = status.pipeline.tracker;
  for (auto* one : {&tracker.key_poses, &tracker.traces, &tracker.traces_rejected, &tracker.pivots, &tracker.sittings,
                    &tracker.contacts_thinned_out, &status.pipeline.events_held_back})
    numbers.push_back(*one = 4'000'000 + numbers.size());
  auto& journal = status.pipeline.journal;
  for (auto* one : {&journal.entries, &journal.bytes, &journal.waiting_bytes, &journal.lost_entries, &journal.syncs,
                    &journal.free_bytes, &journal.min_free_bytes, &status.pipeline.journal_lag_entries})
    numbers.push_back(*one = 5'000'000 + numbers.size());
  status.pipeline.has_recorder = true;
  auto& recorder = status.pipeline.recorder;
  for (auto* one : {&recorder.datagrams, &recorder.dropped, &recorder.files, &recorder.bytes, &recorder.waiting_bytes})
    numbers.push_back(*one = 7'000'000 + numbers.size());
  auto& api = status.api;
  for (auto* one : {&api.streams, &api.accepted, &api.refused, &api.requests, &api.errors, &api.messages_skipped,
                    &api.slow_clients_closed, &api.slow_requests_closed, &api.gave_way, &api.displaced, &api.revoked,
                    &api.handshakes_failed, &api.unauthorized, &api.forbidden, &api.throttled})
    numbers.push_back(*one = 6'000'000 + numbers.size());

  const std::string text = metrics_text(status);
  for (const auto number : numbers) EXPECT_THAT(text, HasSubstr(fmt::format(" {}\n", number)));
}

TEST(Metrics, DriftIsHowFarTheMapMovesTheWearer) {
  Status status = sample_status();
  MapSnapshot map;
  map.T_map_odom = {{0, 3, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()))};
  status.map = std::make_shared<const MapSnapshot>(map);
  EXPECT_THAT(metrics_text(status), Not(HasSubstr("drift")));  // no suit yet
  // (4, 0) turned is (0, 4), shifted (0, 7): 8.06 m from (4, 0).
  status.body = test::body_at(1.0, {4, 0, 1});
  const std::string text = metrics_text(status);
  EXPECT_THAT(text, HasSubstr("kinemap_drift_corrected_meters 8.06225774829855\n"));
  EXPECT_THAT(text, HasSubstr("kinemap_drift_corrected_radians 1.570796326794896"));
  EXPECT_THAT(status_text(status), HasSubstr(R"("drift":{"distance":8.062,"turn":1.571})"));
}

TEST(Metrics, AreServedAsText) {
  Sources sources;
  const Status status = sample_status();
  sources.map = [&] { return status.map; };
  sources.body = [] { return test::body_at(1.5, {1, 2, 1}); };
  sources.suit = [&] { return status.suit; };
  sources.pipeline = [&] { return status.pipeline; };
  sources.take_notice = [] { return std::nullopt; };
  Api api(sources, Config::Suit{}, 9763);
  const auto answer = api.http({"GET", "/metrics"});
  EXPECT_EQ(answer.status, 200U);
  EXPECT_THAT(answer.headers,
              ::testing::Contains(::testing::Pair("Content-Type", "text/plain; version=0.0.4; charset=utf-8")));
  EXPECT_THAT(*answer.body, HasSubstr("kinemap_http_requests_total 1\n"));
  EXPECT_THAT(*answer.body, HasSubstr("kinemap_build_info{version=\""));
  std::ofstream(KINEMAP_BINARY_DIR "/metrics.txt") << *answer.body;  // for promtool
}

}  // namespace
}  // namespace kinemap
