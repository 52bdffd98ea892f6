// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <string>
#include <thread>

#include "daemon/append_file.hpp"
#include "daemon/latest.hpp"
#include "daemon/ring.hpp"

namespace kinemap {

struct RecorderStats {
  std::uint64_t datagrams = 0;      ///< on the disk, or waiting for it
  std::uint64_t dropped = 0;        ///< given up: they came too fast, too much was waiting, or the budget was used up
  std::uint64_t files = 0;          ///< begun in this daemon's life
  std::uint64_t bytes = 0;          ///< length of all of these
  std::uint64_t waiting_bytes = 0;  ///< for the disk, or for it to be clear to which session they belong
  bool healthy = true;              ///< false: the disk does not take them, or journal.keep_mb is used up
};

/// The suit's datagrams as they came, into `suit-0001.pcap`, `suit-0002.pcap`, … of the session's folder, from which
/// any version of Kinemap can make the map anew. A thread of its own writes; what the disk refuses waits in memory, and
/// beyond that is dropped and counted.
class Recorder {
 public:
  struct Limits : AppendFile::Limits {
    std::uint64_t max_file_bytes = 64ULL * 1024 * 1024;  ///< then the next file begins
    std::chrono::seconds max_file_age{1800};             ///< the same
    std::size_t ring = 8192;                             ///< datagrams; 8 s of a suit at 240 Hz
  };
  /// Called before each new file, on the recorder's thread, with the session's folder: makes room among older sessions;
  /// false when there is none.
  using MakeRoom = std::function<bool(const std::filesystem::path&)>;

  Recorder(const Limits& limits, MakeRoom make_room);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Network thread only; never waits. What is no MXTP is not recorded. `sender`: "address:port"; `port`: ours.
  void offer(std::span<const std::byte> datagram, const std::string& sender, std::uint16_t port);
  /// From now on into this folder. What came before the first call (it is not known yet whose it is) goes there too.
  /// Any thread.
  void begin(const std::filesystem::path& folder);
  /// Any thread.
  [[nodiscard]] RecorderStats stats() const;

 private:
  void run(const std::stop_token& stop);
  void follow_session();
  void take(const std::string& packet);
  void write();
  bool has_file();
  void show();

  Limits limits_;
  MakeRoom make_room_;
  Ring<std::shared_ptr<const std::string>> ring_;  // network → recorder: packets as in the file
  std::mutex mutex_;                               // of next_folder_ only
  std::filesystem::path next_folder_;
  LatestValue<RecorderStats> shown_;

  // The recorder's thread only.
  std::filesystem::path folder_;
  std::unique_ptr<AppendFile> file_;
  std::chrono::steady_clock::time_point file_begun_, asked_;
  std::deque<std::string> early_;  // before the session is known
  std::uint64_t early_bytes_ = 0;
  std::string batch_;  // records to be written at once
  std::uint64_t batched_ = 0;
  std::uint64_t closed_bytes_ = 0;
  bool full_ = false;  // the budget is used up
  RecorderStats stats_;
  std::jthread thread_;  // last: joined first
};

}  // namespace kinemap
