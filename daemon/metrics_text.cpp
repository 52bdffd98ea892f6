// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics_text.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace kinemap {
namespace {

/// Backslashes and line ends, and quotes where the text stands in quotes, are written with a backslash.
void append_escaped(std::string& out, std::string_view text, bool quoted) {
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
    } else {
      if (c == '\\' || (quoted && c == '"')) out += '\\';
      out += c;
    }
  }
}

}  // namespace

std::string MetricsText::number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);  // the shortest that reads back as the same
}

void MetricsText::family(std::string_view name, std::string_view type, std::string_view help) {
  name_ = name;
  fmt::format_to(std::back_inserter(text_), "# HELP {} ", name);
  append_escaped(text_, help, false);
  fmt::format_to(std::back_inserter(text_), "\n# TYPE {} {}\n", name, type);
}

void MetricsText::line(std::string_view suffix, Labels labels, std::string_view value) {
  text_ += name_;
  text_ += suffix;
  char before = '{';
  for (const auto& [name, content] : labels) {
    text_ += before;
    text_ += name;
    text_ += "=\"";
    append_escaped(text_, content, true);
    text_ += '"';
    before = ',';
  }
  if (labels.size() > 0) text_ += '}';
  text_ += ' ';
  text_ += value;
  text_ += '\n';
}

void MetricsText::histogram(std::string_view name, std::string_view help, const Durations& durations) {
  family(name, "histogram", help);
  std::uint64_t so_far = 0;
  for (std::size_t i = 0; i < durations.counts.size(); ++i) {
    so_far += durations.counts[i];
    const bool last = i == Durations::kBounds.size();
    line("_bucket", {{"le", last ? "+Inf" : number(Durations::kBounds[i])}}, std::to_string(so_far));
  }
  line("_sum", {}, number(durations.sum_s));
  line("_count", {}, std::to_string(so_far));
}

}  // namespace kinemap
