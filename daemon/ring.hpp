// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace kinemap {

/// How full a ring is, and what it lost.
struct RingStats {
  std::uint64_t capacity = 0;
  std::uint64_t fill = 0;     ///< at the time of asking
  std::uint64_t refused = 0;  ///< pushes that found the ring full
};

/// A bounded lock-free queue from one thread to one other (boost::lockfree::spsc_queue) that counts refusals and wakes
/// its consumer.
///
/// Thread safety: `push` by the producer only; `pop` and `wait` by the consumer only; `stats` and `wake` by anyone.
/// Boost 1.74's queue copies on push and lets the consumer move on pop; put large or allocating things in as
/// shared_ptr.
template <class T>
class Ring {
 public:
  explicit Ring(std::size_t capacity) : capacity_(capacity), queue_(capacity) {}

  /// False, and counted, when the ring is full: the queue has no way to make room, since only the consumer may take
  /// out.
  bool push(const T& item) {
    if (!queue_.push(item)) {
      refused_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    wake();
    return true;
  }

  std::optional<T> pop() {
    std::optional<T> item;
    queue_.consume_one([&item](T& front) { item.emplace(std::move(front)); });
    return item;
  }

  [[nodiscard]] bool full() const { return queue_.read_available() >= capacity_; }

  /// To be read before looking into the ring; `wait` returns at once if anything was pushed (or `wake` called) since.
  [[nodiscard]] std::int32_t ticket() const { return signal_.load(std::memory_order_acquire); }
  void wait(std::int32_t ticket) const { signal_.wait(ticket, std::memory_order_acquire); }
  void wake() {
    signal_.fetch_add(1, std::memory_order_release);
    signal_.notify_all();  // no system call while the consumer is awake
  }

  [[nodiscard]] RingStats stats() const {
    return {capacity_, queue_.read_available(), refused_.load(std::memory_order_relaxed)};
  }

 private:
  std::size_t capacity_;
  boost::lockfree::spsc_queue<T> queue_;
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::int32_t> signal_{0};  // 32 bits: waits directly on a futex
};

}  // namespace kinemap
