// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "daemon/latest.hpp"
#include "daemon/realtime.hpp"
#include "daemon/ring.hpp"
#include "protocol/assembler.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

using test::eventually;

std::vector<SuitFrame> glider_frames(std::uint32_t count) {
  std::vector<SuitFrame> frames;
  Assembler assembler{AssemblerConfig{}};
  for (std::uint32_t i = 0; i < count; ++i)
    assembler.add(test::glider_datagram(i), i / 120.0, "test:1", [&](const SuitFrame& f) { frames.push_back(f); });
  assembler.flush([&](const SuitFrame& f) { frames.push_back(f); });
  return frames;
}

TEST(Pipeline, TellsTheWatchdogThatTheSolverGoesOn) {
  Pipeline pipeline{TrackerConfig{}, MapperConfig{}};
  EXPECT_EQ(pipeline.solver_progress().steps, 0U);
  for (const auto& frame : glider_frames(600)) pipeline.offer(frame);
  pipeline.offer_silence();
  EXPECT_TRUE(eventually([&] {
    const auto stats = pipeline.stats();
    return stats.tracker.frames == 600 && stats.solver.messages > 0 && !pipeline.solver_progress().has_work &&
           pipeline.solver_progress().steps == pipeline.stats().solver.messages;
  }));
  EXPECT_GT(pipeline.solver_progress().cpu_ns, 0U);
  EXPECT_EQ(pipeline.stats().solver_at_entry_s, 0.0) << "it is at none";
}

/// Empty, or why no thread can have it here.
std::string realtime_refused_here(int priority) {
  std::string refusal;
  std::jthread([&] { refusal = set_realtime(::pthread_self(), priority); }).join();
  return refusal;
}

/// How the thread of this name is scheduled: policy and priority.
std::pair<int, int> scheduling_of(const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string comm;
    std::getline(std::ifstream(task.path() / "comm"), comm);
    if (comm != name) continue;
    const auto id = static_cast<pid_t>(std::stol(task.path().filename().string()));
    sched_param param{};
    ::sched_getparam(id, &param);
    return {::sched_getscheduler(id), param.sched_priority};
  }
  return {-1, -1};
}

TEST(Pipeline, DetectionAloneGetsRealtimePriorityWhereItIsAskedFor) {
  if (const auto refusal = realtime_refused_here(7); !refusal.empty()) GTEST_SKIP() << refusal;
  const Pipeline pipeline{TrackerConfig{}, MapperConfig{}, {}, nullptr, 7};
  EXPECT_EQ(scheduling_of("detection"), std::pair(SCHED_FIFO, 7));
  EXPECT_EQ(scheduling_of("solver"), std::pair(SCHED_OTHER, 0));
  EXPECT_EQ(pipeline.stats().realtime_priority, 7);
  EXPECT_EQ(pipeline.stats().realtime_refusal, "");
}

TEST(Pipeline, SaysWhyRealtimePriorityIsRefusedAndGoesOn) {
  // Of this thread and those that it starts, not of the process: nobody, who may not have it.
  std::jthread([] {
    const rlimit none{0, 0};
    ASSERT_EQ(::setrlimit(RLIMIT_RTPRIO, &none), 0);
    if (::geteuid() == 0) {
      ASSERT_EQ(::syscall(SYS_setresuid, 65534, 65534, 65534), 0);
    }
    Pipeline pipeline{TrackerConfig{}, MapperConfig{}, {}, nullptr, 7};
    EXPECT_EQ(scheduling_of("detection"), std::pair(SCHED_OTHER, 0));
    EXPECT_THAT(pipeline.stats().realtime_refusal, testing::HasSubstr("LimitRTPRIO=7"));
    for (const auto& frame : glider_frames(60)) pipeline.offer(frame);
    EXPECT_TRUE(eventually([&] { return pipeline.stats().tracker.frames == 60; }));
  }).join();
}

TEST(Ring, RefusesAndCountsWhenFull) {
  Ring<int> ring(2);
  EXPECT_TRUE(ring.push(1));
  EXPECT_FALSE(ring.full());
  EXPECT_TRUE(ring.push(2));
  EXPECT_TRUE(ring.full());
  EXPECT_FALSE(ring.push(3));
  EXPECT_EQ(ring.stats().capacity, 2U);
  EXPECT_EQ(ring.stats().fill, 2U);
  EXPECT_EQ(ring.stats().refused, 1U);
  EXPECT_EQ(ring.pop(), 1);
  EXPECT_EQ(ring.pop(), 2);
  EXPECT_EQ(ring.pop(), std::nullopt);
}

TEST(Ring, DestroysWhatWasNotTaken) {
  const auto item = std::make_shared<int>(7);
  {
    Ring<std::shared_ptr<int>> ring(4);
    ring.push(item);
    ring.push(item);
    EXPECT_EQ(*ring.pop().value(), 7);
    EXPECT_EQ(item.use_count(), 2);
  }
  EXPECT_EQ(item.use_count(), 1);
}

TEST(Ring, CarriesEverythingInOrderBetweenThreads) {
  constexpr int kCount = 20000;
  Ring<int> ring(64);
  std::jthread producer([&] {
    for (int i = 0; i < kCount;)
      if (ring.push(i))
        ++i;
      else
        std::this_thread::yield();
  });
  for (int expected = 0; expected < kCount;) {
    const auto ticket = ring.ticket();
    const auto item = ring.pop();
    if (!item) {
      ring.wait(ticket);  // a lost wake-up would hang here
      continue;
    }
    ASSERT_EQ(*item, expected++);
  }
}

TEST(LatestValue, ReadersNeverSeeHalfAValue) {
  using Value = std::array<std::uint64_t, 9>;
  LatestValue<Value> latest;
  std::jthread writer([&](const std::stop_token& stop) {
    for (std::uint64_t i = 1; !stop.stop_requested(); ++i) {
      Value value;
      value.fill(i);
      latest.set(value);
    }
  });
  std::uint64_t before = 0;
  for (int i = 0; i < 20000; ++i) {
    const Value value = latest.get();
    for (const auto word : value) ASSERT_EQ(word, value[0]);
    ASSERT_GE(value[0], before);
    before = value[0];
  }
}

TEST(Latest, SharesTheNewest) {
  Latest<int> latest(std::make_shared<const int>(1));
  const auto old = latest.get();
  latest.set(std::make_shared<const int>(2));
  EXPECT_EQ(*old, 1);
  EXPECT_EQ(*latest.get(), 2);
}

TEST(Pipeline, StartsAndStopsFiftyTimesWithWorkInHand) {
  const auto frames = glider_frames(60);
  ASSERT_EQ(frames.size(), 60U);
  for (int i = 0; i < 50; ++i) {
    Pipeline pipeline{TrackerConfig{}, MapperConfig{}};
    for (const auto& frame : frames) pipeline.offer(frame);
    pipeline.offer(WearerInfo{"somebody", {}, {}, {}});
    if (i % 3 == 0) {
      EXPECT_TRUE(eventually([&] { return pipeline.live_body().known; }));
    }
    EXPECT_NE(pipeline.map(), nullptr);
  }
}

TEST(Pipeline, FramesBecomeEventsAndALiveBody) {
  const auto frames = glider_frames(480);
  Pipeline pipeline{TrackerConfig{}, MapperConfig{}};
  EXPECT_FALSE(pipeline.live_body().known);
  for (const auto& frame : frames) EXPECT_TRUE(pipeline.offer(frame));
  ASSERT_TRUE(eventually([&] { return pipeline.stats().tracker.frames == frames.size(); }));
  EXPECT_NEAR(pipeline.live_body().T_odom(Segment::Pelvis).p.x(), 479.0 / 120.0, 1e-3);
  EXPECT_NEAR(pipeline.live_body().time_s, 479.0 / 120.0, 2e-3);
  // The same frames through a tracker in this thread give the same key poses, and each reaches the solver.
  Tracker tracker{TrackerConfig{}};
  std::vector<Event> events;
  for (const auto& frame : frames) tracker.step(frame, events);
  EXPECT_EQ(pipeline.stats().tracker.key_poses, tracker.stats().key_poses);
  EXPECT_GT(events.size(), 10U);
  EXPECT_TRUE(eventually([&] { return pipeline.stats().solver.messages == events.size(); }));
  EXPECT_EQ(pipeline.stats().frames.refused, 0U);
}

TEST(Pipeline, SilenceSettlesTheMapAndFramesMayFollow) {
  const auto frames = glider_frames(300);
  Pipeline pipeline{TrackerConfig{}, MapperConfig{}};
  for (int i = 0; i < 200; ++i) pipeline.offer(frames[i]);
  ASSERT_TRUE(pipeline.offer_silence());
  // On the way the trajectory is published every few key poses; with the silence comes its very end.
  const auto ends_at = [&](double time_s) {
    const auto map = pipeline.map();
    return !map->trajectory.empty() && std::abs(map->trajectory.back().time_s - time_s) < 1e-9;
  };
  ASSERT_TRUE(eventually([&] { return ends_at(frames[199].time_s); }));
  EXPECT_EQ(pipeline.map()->trajectory.size(), pipeline.stats().tracker.key_poses);
  for (int i = 200; i < 300; ++i) pipeline.offer(frames[i]);
  ASSERT_TRUE(pipeline.offer_silence());
  EXPECT_TRUE(eventually([&] { return ends_at(frames[299].time_s); }));
}

TEST(Pipeline, FramesBeyondTheRingAreCountedNotWaitedFor) {
  const auto frames = glider_frames(300);
  // One place in each ring: whatever the threads manage to take, all is accounted for.
  Pipeline pipeline(TrackerConfig{}, MapperConfig{}, {1, 1, 1});
  std::uint64_t taken = 0, refused = 0;
  for (const auto& frame : frames) (pipeline.offer(frame) ? taken : refused) += 1;
  ASSERT_TRUE(eventually([&] { return pipeline.stats().tracker.frames == taken; }));
  EXPECT_EQ(pipeline.stats().frames.refused, refused);
  EXPECT_EQ(taken + refused, frames.size());
  // No key pose is lost between the threads, however small the ring.
  EXPECT_TRUE(eventually([&] { return pipeline.stats().solver.messages == pipeline.stats().tracker.key_poses; }));
}

TEST(Pipeline, ALostDiscontinuityIsSaidByTheNextFrame) {
  auto frames = glider_frames(202);
  frames[200].discontinuity = true;
  Pipeline pipeline(TrackerConfig{}, MapperConfig{}, {1, 1024, 1});
  std::uint64_t taken = 0;
  bool refused = false;
  while (taken < 1000 && !refused) (pipeline.offer(frames[200]) ? void(++taken) : void(refused = true));
  if (!refused) GTEST_SKIP() << "SKIPPED: the detection thread was never behind";
  ASSERT_TRUE(eventually([&] { return pipeline.stats().tracker.frames == taken; }));
  const auto before = pipeline.stats().tracker.key_poses;
  // The next one moved by 8 mm, which alone is no key pose; a new beginning is.
  ASSERT_TRUE(pipeline.offer(frames[201]));
  ASSERT_TRUE(eventually([&] { return pipeline.stats().tracker.frames == taken + 1; }));
  EXPECT_EQ(pipeline.stats().tracker.key_poses, before + 1);
}

}  // namespace
}  // namespace kinemap
