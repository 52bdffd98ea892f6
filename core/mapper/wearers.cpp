// SPDX-License-Identifier: Apache-2.0
#include "core/mapper/wearers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinemap {
namespace {

// m: bones keep their lengths to a millimetre, the shank to 4 mm. Of two people one pair in eight is nearer.
constexpr double kSameBody = 0.015;

}  // namespace

void Wearers::meet(std::optional<double> stature_m) {
  const auto fits = [&](const Known& wearer) { return may_be(wearer, stature_m); };
  if (!fits(known_[current_])) {
    const auto found = std::find_if(known_.begin(), known_.end(), fits);
    current_ = static_cast<std::size_t>(found - known_.begin());
    if (found == known_.end()) {
      known_.emplace_back();
      touches_.emplace_back(config_);
    }
  }
  Known& wearer = known_[current_];
  if (told_) {
    if (told_->name.empty()) told_->name = wearer.info.name;
    wearer.info = *std::exchange(told_, std::nullopt);
  }
  if (stature_m) wearer.stature_m = stature_m;
  touches_[current_].expect(wearer.info, wearer.stature_m);
}

bool Wearers::may_be(const Known& wearer, const std::optional<double>& stature_m) const {
  const bool other_name = told_ && !told_->name.empty() && !wearer.info.name.empty() && told_->name != wearer.info.name;
  const bool other_body = stature_m && wearer.stature_m && std::abs(*stature_m - *wearer.stature_m) > kSameBody;
  return !other_name && !other_body;
}

}  // namespace kinemap
