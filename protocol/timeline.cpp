// SPDX-License-Identifier: Apache-2.0
#include "protocol/timeline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kinemap {

namespace {

constexpr std::int64_t kDayMs = 86'400'000;
constexpr double kLowestHz = 20.0;
constexpr double kHighestHz = 500.0;
/// Rates that MVN offers. A measured rate this near to one of them is that one: the steps of the time code explain the
/// rest.
constexpr std::array kNominalHz{60.0, 75.0, 80.0, 100.0, 120.0, 150.0, 240.0};
constexpr double kPrimingSpanS = 0.08;
constexpr double kPrimingTolerance = 0.03;  ///< two steps of 1 ms over the span
constexpr double kMarkEveryS = 1.0;
constexpr std::size_t kMostMarks = 9;
constexpr double kMarkTolerance = 0.003;  ///< two steps of 1 ms over the shortest distance of marks
constexpr double kChangedRate = 0.02;     ///< the sender was set to another rate
constexpr double kFreeErrorS = 0.003;     ///< an error below this may be the steps of the time code
constexpr double kJumpS = 0.1;            ///< a time code off by more than this (and 5 % of a gap) has jumped

}  // namespace

double time_code_step_s(std::uint32_t a, std::uint32_t b) {
  std::int64_t step = static_cast<std::int64_t>(b) - static_cast<std::int64_t>(a);
  const bool of_day = a < kDayMs && b < kDayMs;
  if (of_day && step < -kDayMs / 2) step += kDayMs;
  if (of_day && step > kDayMs / 2) step -= kDayMs;
  return static_cast<double>(step) * 1e-3;
}

void Timeline::adopt(double measured_hz, double tolerance) {
  if (!std::isfinite(measured_hz) || measured_hz < kLowestHz || measured_hz > kHighestHz) return;
  for (const double nominal : kNominalHz) {
    if (std::abs(measured_hz / nominal - 1.0) < tolerance) {
      rate_hz_ = nominal;
      return;
    }
  }
  rate_hz_ = measured_hz;
}

void Timeline::prime(std::span<const SampleClock> samples) {
  if (rate_hz_ > 0.0 || samples.size() < 2) return;
  const SampleClock& a = samples.front();
  const SampleClock& b = samples.back();
  const auto steps = static_cast<double>(b.index - a.index);
  const double code_s = time_code_step_s(a.time_code_ms, b.time_code_ms);
  if (code_s >= kPrimingSpanS) {
    adopt(steps / code_s, kPrimingTolerance);
  } else if (code_s == 0.0 && b.arrival_s - a.arrival_s >= kPrimingSpanS) {
    adopt(steps / (b.arrival_s - a.arrival_s),
          0.1);  // the time code stands still: the network's jitter is all there is
  }
}

void Timeline::learn(const SampleClock& sample) {
  if (marks_.empty()) {
    marks_.push_back(sample);
    return;
  }
  const double since_s = time_code_step_s(marks_.back().time_code_ms, sample.time_code_ms);
  if (since_s < kMarkEveryS) return;
  const double recent_hz = static_cast<double>(sample.index - marks_.back().index) / since_s;
  const bool changed = rate_hz_ > 0.0 && std::abs(recent_hz / rate_hz_ - 1.0) > kChangedRate;
  if (changed) marks_.erase(marks_.begin(), marks_.end() - 1);
  const double span_s = time_code_step_s(marks_.front().time_code_ms, sample.time_code_ms);
  const auto steps = static_cast<double>(sample.index - marks_.front().index);
  // The longer the span, the finer the steps of the time code can be told from a rate that is really another one.
  adopt(steps / span_s, std::max(kMarkTolerance / span_s, 0.0005));
  marks_.push_back(sample);
  if (marks_.size() > kMostMarks) marks_.pop_front();
}

/// How far to move on for a counter step of `step_s`: as much, plus a little towards the time code once they differ for
/// sure.
double Timeline::follow(double step_s) {
  const double error_s = code_time_s_ - (time_s_ + step_s);
  const double excess_s = std::abs(error_s) - kFreeErrorS;
  if (excess_s <= 0.0) return step_s;
  return step_s + std::copysign(std::min(0.05 * excess_s, 0.5 * step_s), error_s);
}

Timeline::Stamp Timeline::stamp(const SampleClock& sample) {
  if (!last_) {
    last_ = sample;
    learn(sample);
    return {time_s_, false};
  }
  const double arrival_step_s = std::max(0.0, sample.arrival_s - last_->arrival_s);
  Stamp out;
  if (restarted_) {
    time_s_ += std::max(arrival_step_s, rate_hz_ > 0.0 ? 1.0 / rate_hz_ : 1e-3);
    code_time_s_ = time_s_;
    restarted_ = false;
    marks_.clear();
  } else {
    const double steps = std::max(1.0, static_cast<double>(sample.index - last_->index));
    double code_step_s = time_code_step_s(last_->time_code_ms, sample.time_code_ms);
    // A time code that stands still tells nothing.
    if (code_step_s == 0.0) code_step_s = rate_hz_ > 0.0 ? steps / rate_hz_ : arrival_step_s;
    const double step_s = rate_hz_ > 0.0 ? steps / rate_hz_ : std::clamp(code_step_s, 0.0, 10.0);
    if (std::abs(code_step_s - step_s) <= kJumpS + 0.05 * step_s) {
      code_time_s_ += code_step_s;
      time_s_ += follow(step_s);
    } else {
      // Two clocks against one: a sender that paused, counter and all.
      const bool paused = code_step_s > step_s && std::abs(code_step_s - arrival_step_s) <= kJumpS + 0.05 * code_step_s;
      time_s_ += paused ? code_step_s : step_s;
      code_time_s_ = time_s_;
      marks_.clear();
      out.clock_jumped = true;
    }
  }
  last_ = sample;
  learn(sample);
  out.time_s = time_s_;
  return out;
}

void Timeline::restart() { restarted_ = last_.has_value(); }

}  // namespace kinemap
