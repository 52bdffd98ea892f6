// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kinemap {

/// Values to bytes and back, in the memory's own order: for the program that wrote them, not for exchange. One list of
/// members serves both ways: `fields(Archive&, T&)` beside the type T, or a member `fields(Archive&)`.
class Archive {
 public:
  Archive() = default;                                                        ///< saves
  explicit Archive(std::string_view bytes) : from_(bytes), loading_(true) {}  ///< loads

  template <class... T>
  void operator()(T&... values) {
    (value(values), ...);
  }

  [[nodiscard]] std::string& bytes() { return to_; }
  /// Loading: all bytes were there, and none is left.
  [[nodiscard]] bool whole() const { return sound_ && from_.empty(); }

 private:
  void raw(void* data, std::size_t size) {
    if (size == 0) return;  // an empty list points nowhere
    if (!loading_) {
      to_.append(static_cast<const char*>(data), size);
    } else if (size <= from_.size()) {
      std::memcpy(data, from_.data(), size);
      from_.remove_prefix(size);
    } else {
      sound_ = false;
      from_ = {};
    }
  }
  /// The number of elements of a list; each takes a byte at least.
  std::size_t length(std::size_t now) {
    raw(&now, sizeof now);
    if (loading_ && (!sound_ || now > from_.size())) sound_ = false, from_ = {}, now = 0;
    return now;
  }

  template <class T>
  void value(T& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      raw(&x, sizeof x);
    else if constexpr (requires { x.fields(*this); })
      x.fields(*this);
    else
      fields(*this, x);
  }
  template <class T>
  void value(std::vector<T>& list) {
    list.resize(length(list.size()));
    for (T& x : list) value(x);
  }
  template <class T, std::size_t N>
  void value(std::array<T, N>& list) {
    for (T& x : list) value(x);
  }
  template <class T>
  void value(std::optional<T>& x) {
    bool there = x.has_value();
    value(there);
    if (!there) return x.reset();
    if (!x) x.emplace();
    value(*x);
  }
  void value(std::string& text) {
    text.resize(length(text.size()));
    raw(text.data(), text.size());
  }
  void value(Eigen::Quaterniond& q) { value(q.coeffs()); }
  template <class T, int R, int C, int O, int MR, int MC>
  void value(Eigen::Matrix<T, R, C, O, MR, MC>& m) {
    const std::size_t rows = length(static_cast<std::size_t>(m.rows()));
    const std::size_t cols = length(static_cast<std::size_t>(m.cols()));
    const bool fits = (R == Eigen::Dynamic || rows == static_cast<std::size_t>(R)) &&
                      (C == Eigen::Dynamic || cols == static_cast<std::size_t>(C));
    if (loading_ && (!sound_ || !fits || rows * cols * sizeof(T) > from_.size())) {
      sound_ = false, from_ = {};
      return;
    }
    if constexpr (R == Eigen::Dynamic || C == Eigen::Dynamic)
      m.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
    raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(T));
  }

  std::string to_;
  std::string_view from_;
  bool loading_ = false, sound_ = true;
};

}  // namespace kinemap
