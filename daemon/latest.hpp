// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>

namespace kinemap {

/// The newest of a series of small plain values: one writer that never waits, any number of readers (a sequence lock).
///
/// Invariant: `sequence_` is odd while a write is under way; a reader that saw the same even number before and after
/// copied one whole value. Every word is stored with release and loaded with acquire order: a reader that sees a word
/// of a later write therefore also sees the later sequence number and tries again. So no fence is needed
/// (ThreadSanitizer does not know them).
template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  LatestValue() { set(T{}); }

  /// The one writer's thread only.
  void set(const T& value) {
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof(T));
    const auto sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// Any thread. Repeats while a write is under way, which lasts nanoseconds.
  [[nodiscard]] T get() const {
    std::array<std::uint64_t, kWords> words;
    for (;;) {
      const auto before = sequence_.load(std::memory_order_acquire);
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before) break;
    }
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    return value;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

/// The newest of a series of immutable objects, shared with whoever asks. Neither side is the 120 Hz path, and the lock
/// is held for the copy of a pointer; std::atomic<std::shared_ptr> of g++ 12 takes a lock too, in a way that
/// ThreadSanitizer reports as a race.
template <class T>
class Latest {
 public:
  explicit Latest(std::shared_ptr<const T> value) : value_(std::move(value)) {}

  void set(std::shared_ptr<const T> value) {
    const std::lock_guard lock(mutex_);
    value_.swap(value);  // the old one is destroyed outside the lock
  }
  [[nodiscard]] std::shared_ptr<const T> get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const T> value_;
};

}  // namespace kinemap
