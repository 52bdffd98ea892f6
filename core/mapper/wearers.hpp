// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/touch.hpp"

namespace kinemap {

/// Who wears the suit, one after another. Each has a touching point of the own: wearer k is the graph's
/// touch_points[k]. The bones in the stream tell wearers apart, and their names where the suit has them; who comes back
/// is known again.
class Wearers {
 public:
  explicit Wearers(const MapperConfig::Hand& config) : config_(config), known_(1), touches_(1, TouchBelief(config)) {}

  /// What the suit says of its wearer; holds for whoever draws next.
  void tell(const WearerInfo& info) { told_ = info; }

  /// Somebody draws, whose bones give this stature away (m): one of those known, or another one. What is expected of
  /// the hand is renewed.
  void meet(std::optional<double> stature_m);

  [[nodiscard]] std::size_t count() const { return known_.size(); }
  /// Who drew last.
  [[nodiscard]] std::size_t current() const { return current_; }
  [[nodiscard]] TouchBelief& touch(std::size_t k) { return touches_[k]; }
  [[nodiscard]] const TouchBelief& touch(std::size_t k) const { return touches_[k]; }
  [[nodiscard]] const WearerInfo& info(std::size_t k) const { return known_[k].info; }
  /// As the bones give it away, m.
  [[nodiscard]] const std::optional<double>& stature_m(std::size_t k) const { return known_[k].stature_m; }

  struct Known {
    WearerInfo info;
    std::optional<double> stature_m;
  };

  /// Its members, for Mapper::checkpoint().
  template <class A>
  void fields(A& a) {
    a(told_, known_, current_);
    touches_.resize(known_.size(), TouchBelief(config_));
    for (TouchBelief& touch : touches_) a(touch);
  }

 private:
  [[nodiscard]] bool may_be(const Known& wearer, const std::optional<double>& stature_m) const;

  MapperConfig::Hand config_;
  std::optional<WearerInfo> told_;  ///< since somebody drew
  std::vector<Known> known_;        ///< in the order in which they came; never empty
  std::vector<TouchBelief> touches_;
  std::size_t current_ = 0;
};

}  // namespace kinemap
