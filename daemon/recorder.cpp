// SPDX-License-Identifier: Apache-2.0
#include "daemon/recorder.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>

#include "daemon/session_files.hpp"
#include "protocol/wire/pcap.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kEarlyBytes = 16 * 1024 * 1024;  // the newest so much, of a stream that is no session yet
constexpr std::size_t kBatchBytes = 256 * 1024;

double unix_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

bool is_mxtp(std::span<const std::byte> datagram) {
  constexpr std::string_view kMagic = "MXTP";
  return datagram.size() >= kMagic.size() && std::memcmp(datagram.data(), kMagic.data(), kMagic.size()) == 0;
}

/// The name after the last recording that is there.
std::filesystem::path next_name(const std::filesystem::path& folder) {
  int number = 1;
  const auto there = recordings_in(folder);
  if (!there.empty()) std::sscanf(there.back().filename().c_str(), "suit-%d.pcap", &number), ++number;
  return folder / fmt::format("suit-{:04}.pcap", number);
}

}  // namespace

Recorder::Recorder(const Limits& limits, MakeRoom make_room)
    : limits_(limits), make_room_(std::move(make_room)), ring_(limits.ring) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  pthread_setname_np(thread_.native_handle(), "recorder");
}

Recorder::~Recorder() {
  thread_.request_stop();
  thread_.join();  // what was offered is written
}

void Recorder::offer(std::span<const std::byte> datagram, const std::string& sender, std::uint16_t port) {
  if (is_mxtp(datagram)) ring_.push(std::make_shared<const std::string>(pcap_packet(unix_s(), sender, port, datagram)));
}

void Recorder::begin(const std::filesystem::path& folder) {
  {
    const std::lock_guard lock(mutex_);
    if (folder == next_folder_) return;
    next_folder_ = folder;
  }
  ring_.wake();
}

RecorderStats Recorder::stats() const {
  RecorderStats stats = shown_.get();
  stats.dropped += ring_.stats().refused;
  return stats;
}

void Recorder::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { ring_.wake(); });
  show();
  for (;;) {
    const auto ticket = ring_.ticket();
    const bool ending = stop.stop_requested();
    follow_session();
    while (const auto packet = ring_.pop()) take(**packet);
    write();
    show();
    if (ending) return;
    ring_.wait(ticket);
  }
}

void Recorder::follow_session() {
  std::filesystem::path next;
  {
    const std::lock_guard lock(mutex_);
    next = next_folder_;
  }
  if (next.empty() || next == folder_) return;
  write();
  folder_ = next;
  if (file_) closed_bytes_ += file_->bytes();
  file_.reset();
  full_ = false;
  early_bytes_ = 0;
  for (const auto& packet : std::exchange(early_, {})) take(packet);
}

void Recorder::take(const std::string& packet) {
  if (packet.empty()) {
    ++stats_.dropped;  // larger than any packet
    return;
  }
  if (folder_.empty()) {
    early_.push_back(packet);
    early_bytes_ += packet.size();
    while (early_bytes_ > kEarlyBytes) {
      early_bytes_ -= early_.front().size();
      early_.pop_front();
      ++stats_.dropped;
    }
    return;
  }
  batch_ += packet;
  ++batched_;
  if (batch_.size() >= kBatchBytes) write();
}

void Recorder::write() {
  if (batch_.empty() && !file_) return;
  const std::string batch = std::exchange(batch_, {});
  const std::uint64_t datagrams = std::exchange(batched_, 0);
  const bool taken = (batch.empty() || has_file()) && (!file_ || file_->append(batch));
  (taken ? stats_.datagrams : stats_.dropped) += datagrams;
}

/// A file that may grow; begins the next one when the last is long or old enough. False when the budget is used up.
bool Recorder::has_file() {
  const auto now = std::chrono::steady_clock::now();
  const bool due = !file_ || file_->bytes() >= limits_.max_file_bytes || now - file_begun_ >= limits_.max_file_age;
  if (!due) return true;
  // A file that the disk does not take stays until it does: what waits is its own.
  if (file_ && !file_->healthy()) return true;
  if (full_ && now - asked_ < std::chrono::minutes(1)) return false;
  asked_ = now;
  const bool room = make_room_(folder_);
  if (!room && !full_)
    spdlog::error("recording: journal.keep_mb is used up by this session alone; the suit is not recorded any more");
  full_ = !room;
  if (full_) return false;
  if (file_) closed_bytes_ += file_->bytes();
  file_.reset();
  file_ = std::make_unique<AppendFile>("recording", next_name(folder_), 0, limits_);
  file_->append(pcap_file_header());
  file_begun_ = now;
  ++stats_.files;
  return true;
}

void Recorder::show() {
  stats_.bytes = closed_bytes_ + (file_ ? file_->bytes() : 0);
  stats_.waiting_bytes = early_bytes_ + (file_ ? file_->waiting_bytes() : 0);
  stats_.healthy = !full_ && (!file_ || file_->healthy());
  shown_.set(stats_);
}

}  // namespace kinemap
