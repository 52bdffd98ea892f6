// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/levers.hpp"

#include <nlohmann/json.hpp>

namespace kinemap::bench {
namespace {

constexpr Lever kLevers[] = {
    {"wrist as touching point", "the wrist is taken for the point that touches, as in the paper",
     R"({"mapper": {"hand": {"tip_m": 0.001, "tip_sigma_m": 0}}})"},
    {"touching point not estimated", "the finger tip of a hand of nominal length touches",
     R"({"mapper": {"hand": {"tip_sigma_m": 0}}})"},
    {"reach not cut off", "the way of the hand to the surface and back counts as contact",
     R"({"mapper": {"landmarks": {"reach_max_s": 0}}})"},
    {"no right angles", "walls need not be parallel or at right angles",
     R"({"mapper": {"walls": {"right_angle_sigma_rad": 0}}})"},
    {"over-confident heading", "odometry is believed to turn by 0.3°/√s only",
     R"({"mapper": {"odometry": {"heading_rad_per_sqrt_s": 0.0052, "magnetic_rad_per_sqrt_s": 0.0052}}})"},
    {"heading as a random walk", "the heading is not expected to come back by itself",
     R"({"mapper": {"odometry": {"heading_return_s": 1000000.0}}})"},
    {"contacts as if independent", "each contact counts as a measurement of its own",
     R"({"mapper": {"hand": {"contact_correlation_s": 0.001}}})"},
    {"no robust losses", "contacts and seats that do not fit pull with all their weight",
     R"({"mapper": {"hand": {"loss_scale": 1000}, "seats": {"loss_scale": 1000}}})"},
    {"no doubt", "a difference is judged as if the graph's covariance were true",
     R"({"mapper": {"association": {"doubt": 1, "gate_sigma": 4.5}}})"},
    {"no free space", "that nobody walks through things counts neither for nor against a closure",
     R"({"mapper": {"association": {"free_space_most": 0}}})"},
    {"each closure by itself", "closures that bear each other out are not taken together",
     R"({"mapper": {"association": {"joint_evidence": 1000}}})"},
    {"nothing waits", "the better of two candidates is taken however little the other one is behind",
     R"({"mapper": {"association": {"ambiguity": 0}}})"},
    {"no second thoughts", "a visit stays on its object, whatever the optimum says",
     R"({"mapper": {"association": {"min_relief": 1000000}}})"},
    {"closures never refused", "a closure stays however much it costs",
     R"({"mapper": {"association": {"max_cost_increase": 1000000}}})"},
};

}  // namespace

std::span<const Lever> levers() { return kLevers; }

const Lever& feet_not_heard() {
  static constexpr Lever kFeet{"feet not heard", "what standing feet say of the suit's slipping does not count",
                               R"({"tracker": {"slip": {"held_m": 100}}})"};
  return kFeet;
}

Result<Config> without(const Config& config, const Lever& lever) {
  nlohmann::ordered_json json = to_json(config);
  json.merge_patch(nlohmann::ordered_json::parse(lever.overrides));
  return config_from_text(json.dump(), "lever \"" + std::string(lever.name) + "\"");
}

}  // namespace kinemap::bench
