// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "core/body.hpp"

namespace kinemap {

/// Looks at one wearer's frames in order and says which of them can be mapped: bones keep their lengths, the pelvis is
/// not pinned. Aligns the signs of quaternions with the frame before, so that they can be interpolated.
class FrameGuard {
 public:
  enum class Verdict {
    Good,
    Pinned,      ///< UpperBody or No-Level scenario: the pelvis stands at the origin, the feet hang below it
    WrongBones,  ///< no possible body, or a bone off by more than 10 cm for less than half a second
  };
  struct Result {
    Verdict verdict = Verdict::Good;
    bool odd_bones = false;  ///< a bone's length disagrees with those before
    bool new_body = false;   ///< bones of other lengths have stayed: the wearer was measured anew
    bool jumped = false;     ///< moved since the last good frame as no body can: the suit's world was moved
  };

  /// `time_s` of the frame must be set. Changes only the signs of its quaternions.
  Result check(SuitFrame& frame);
  /// Another wearer, or the suit was set up anew.
  void reset();

 private:
  static constexpr std::size_t kBones = 20;
  using Lengths = std::array<double, kBones>;

  void align_signs(SuitFrame& frame);
  bool is_pinned(const SuitFrame& frame);
  Verdict check_bones(const SuitFrame& frame, Result& out);
  static Lengths lengths_of(const SuitFrame& frame);

  std::optional<std::array<Eigen::Quaterniond, kSegmentCount>> last_q_;
  std::optional<Pose> last_pelvis_;
  double last_s_ = 0.0;
  std::optional<Lengths> lengths_;
  std::optional<double> wrong_since_s_;
  bool pinned_ = false;
  std::optional<double> pinned_like_since_s_;
};

}  // namespace kinemap
