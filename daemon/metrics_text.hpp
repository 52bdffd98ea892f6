// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/durations.hpp"

namespace kinemap {

/// Writes Prometheus' text format 0.0.4 (prometheus.io/docs/instrumenting/exposition_formats): families, each with its
/// samples.
class MetricsText {
 public:
  using Labels = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  /// Begins a family, to which the samples that follow belong.
  void counter(std::string_view name, std::string_view help) { family(name, "counter", help); }
  void gauge(std::string_view name, std::string_view help) { family(name, "gauge", help); }
  void sample(Labels labels, double value) { line("", labels, number(value)); }
  void sample(Labels labels, std::uint64_t value) { line("", labels, std::to_string(value)); }

  /// A family of one sample without labels.
  template <class N>
  void counter(std::string_view name, std::string_view help, N value) {
    counter(name, help);
    sample({}, value);
  }
  template <class N>
  void gauge(std::string_view name, std::string_view help, N value) {
    gauge(name, help);
    sample({}, value);
  }
  void histogram(std::string_view name, std::string_view help, const Durations& durations);

  std::string take() { return std::move(text_); }

 private:
  void family(std::string_view name, std::string_view type, std::string_view help);
  void line(std::string_view suffix, Labels labels, std::string_view value);
  static std::string number(double value);

  std::string text_;
  std::string name_;  ///< of the family
};

}  // namespace kinemap
