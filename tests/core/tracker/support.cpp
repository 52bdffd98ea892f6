// SPDX-License-Identifier: Apache-2.0
#include "tests/core/tracker/support.hpp"

#include <sstream>

namespace kinemap::test {

Outcome track(const std::vector<SuitFrame>& frames, const TrackerConfig& config) {
  Tracker tracker(config);
  Outcome outcome;
  for (const SuitFrame& frame : frames) tracker.step(frame, outcome.events);
  tracker.finish(outcome.events);
  for (const Event& event : outcome.events) {
    if (const auto* key_pose = std::get_if<KeyPose>(&event)) outcome.key_poses.push_back(*key_pose);
    if (const auto* trace = std::get_if<Trace>(&event)) outcome.traces.push_back(*trace);
    if (const auto* sitting = std::get_if<Sitting>(&event)) outcome.sittings.push_back(*sitting);
  }
  outcome.stats = tracker.stats();
  return outcome;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  unsigned seed = 1;
  for (const double stature : {1.55, 1.75, 1.95}) {
    for (const double rate : {60.0, 240.0}) {
      for (const double loss : {0.0, 0.5}) {
        all.push_back({stature, {}, {rate, loss, seed}});
        for (const double body : {-0.03, 0.03}) {
          all.push_back({stature, {body, 2 * kDegree, 6 * kDegree, seed++}, {rate, loss, seed}});
        }
      }
    }
  }
  return all;
}

std::string describe(const Case& c) {
  std::ostringstream text;
  text << "stature " << c.stature_m << " m, " << c.sampling.rate_hz << " Hz, loss " << c.sampling.loss
       << ", body error " << c.errors.body << ", seed " << c.errors.seed;
  return text.str();
}

std::vector<Act> between_standing(double duration_s, std::function<Figure(double)> figure) {
  const auto stand = [](double) { return standing(); };
  return {{2.0, stand}, {duration_s, std::move(figure)}, {2.5, stand}};
}

}  // namespace kinemap::test
