// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace kinemap::sim {

/// Seeded random numbers whose values do not depend on the standard library: only the engine is taken from it (its
/// output is fixed by the standard), the distributions are ours. Separate streams keep one part's draws from shifting
/// another's.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : engine_(mix(mix(seed) ^ mix(stream + 0x51ed2701U))) {}

  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }  ///< [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Whole number in [low, high].
  int integer(int low, int high) { return low + static_cast<int>(uniform() * (high - low + 1)); }
  bool chance(double probability) { return uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

  /// Normal deviate with the given standard deviation (Box and Muller's method).
  double normal(double sigma = 1.0) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return sigma * radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Normal deviate cut off at ± `limit` standard deviations.
  double bounded_normal(double sigma, double limit) {
    for (;;) {
      const double value = normal();
      if (std::abs(value) <= limit) return sigma * value;
    }
  }

 private:
  static std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser: neighbouring seeds become unrelated
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }
  std::mt19937_64 engine_;
};

/// Ornstein–Uhlenbeck process: stationary, Gaussian, correlated over `tau_s`.
class Wander {
 public:
  Wander(double sigma, double tau_s, Random& random) : sigma_(sigma), tau_s_(tau_s), value_(random.normal(sigma)) {}
  double step(double dt_s, Random& random) {
    const double keep = std::exp(-dt_s / tau_s_);
    value_ = keep * value_ + random.normal(sigma_ * std::sqrt(1.0 - keep * keep));
    return value_;
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double sigma_;
  double tau_s_;
  double value_;
};

}  // namespace kinemap::sim
