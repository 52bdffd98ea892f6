// SPDX-License-Identifier: Apache-2.0
#include "daemon/logging.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#ifdef KINEMAP_SYSTEMD
#include <spdlog/sinks/systemd_sink.h>
#endif
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <utility>

namespace kinemap {
namespace {

constexpr std::size_t kMaxKinds = 256;  // what others send is in messages: the table must not grow with it
constexpr std::size_t kMaxKey = 64;

/// Hands on to another sink what the limit lets through.
class LimitedSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LimitedSink(spdlog::sink_ptr to) : sink_(std::move(to)) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const auto left_out =
        limit_.take({message.payload.data(), message.payload.size()}, std::chrono::duration<double>(now).count());
    if (!left_out) return;
    if (*left_out > 0) {
      const std::string note = fmt::format("{} more messages like the next one were left out", *left_out);
      sink_->log({message.time, message.source, message.logger_name, message.level, note});
    }
    sink_->log(message);
  }
  void flush_() override { sink_->flush(); }
  void set_pattern_(const std::string& pattern) override { sink_->set_pattern(pattern); }
  void set_formatter_(std::unique_ptr<spdlog::formatter> formatter) override {
    sink_->set_formatter(std::move(formatter));
  }

 private:
  spdlog::sink_ptr sink_;
  LogLimit limit_;
};

#ifdef KINEMAP_SYSTEMD
/// Whether standard error goes to systemd's journal: systemd.exec(5), JOURNAL_STREAM.
bool writes_to_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &status) == 0 &&
         stream == fmt::format("{}:{}", status.st_dev, status.st_ino);
}
#endif

spdlog::sink_ptr sink() {
#ifdef KINEMAP_SYSTEMD
  if (writes_to_journal()) return std::make_shared<spdlog::sinks::systemd_sink_mt>("kinemapd");
#endif
  return std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
}

}  // namespace

LogLimit::Kind& LogLimit::kind_of(std::string_view message, double now_s) {
  std::string key;
  int words = 1;
  for (const char c : message.substr(0, kMaxKey)) {
    if (c == ' ' && ++words > 3) break;
    if (c < '0' || c > '9') key += c;
  }
  if (kinds_.size() >= kMaxKinds)
    std::erase_if(kinds_, [now_s](const auto& entry) { return now_s >= entry.second.until_s; });
  if (kinds_.size() >= kMaxKinds && !kinds_.contains(key)) key.clear();  // many kinds at once count as one
  return kinds_[key];
}

std::optional<std::uint64_t> LogLimit::take(std::string_view message, double now_s) {
  Kind& kind = kind_of(message, now_s);
  std::uint64_t left_out = 0;
  if (now_s >= kind.until_s) {
    left_out = kind.left_out;
    kind = {now_s + kPeriodS, 0, 0};
  }
  if (kind.passed >= kMessages) {
    ++kind.left_out;
    return std::nullopt;
  }
  ++kind.passed;
  return left_out;
}

void set_up_logging() {
  auto logger = std::make_shared<spdlog::logger>("kinemapd", std::make_shared<LimitedSink>(sink()));
  logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace kinemap
