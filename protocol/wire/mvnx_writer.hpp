// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap {

/// A named point on a segment (hand points, foot contacts, …), in the segment's frame in the T-pose, m.
struct MvnxPoint {
  std::string label;  ///< as MVN names them, e.g. "pRightTopOfHand"
  std::array<double, 3> position{};
};

struct MvnxSegment {
  std::string label;               ///< "Pelvis", …, in stream order
  std::array<double, 3> origin{};  ///< in the T-pose, m, z up
  std::vector<MvnxPoint> points;
};

struct MvnxSubject {
  std::string name;
  double frame_rate_hz = 120.0;
  std::vector<MvnxSegment> segments;
};

/// One segment of one frame: world frame, z up, m; unit quaternion w x y z.
struct MvnxPose {
  std::array<double, 3> position{};
  std::array<double, 4> orientation{1, 0, 0, 0};
};

struct MvnxFrame {
  std::uint64_t index = 0;
  double time_s = 0.0;                 ///< since the first normal frame; written in whole milliseconds, as MVN does
  std::span<const MvnxPose> segments;  ///< as many as the subject has
  std::optional<std::array<double, 3>> center_of_mass;
};

/// Writes MVNX version 4: subject, segments with their points, an identity and a tpose frame, then the normal frames
/// one by one.
class MvnxWriter {
 public:
  static Result<MvnxWriter> create(const std::string& path, const MvnxSubject& subject);
  ~MvnxWriter();  ///< closes; a file that was not close()d may lack its end
  MvnxWriter(MvnxWriter&&) noexcept;
  MvnxWriter& operator=(MvnxWriter&&) noexcept;

  /// False when the file could not be written or the frame has not the subject's number of segments; `close` says why.
  bool write(const MvnxFrame& frame);
  std::optional<Error> close();

 private:
  class Impl;
  explicit MvnxWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap
