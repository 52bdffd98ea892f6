// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/wire/result.hpp"

namespace kinemap::mvnx {

struct Point {
  std::string label;
  std::array<double, 3> position{};  ///< in the segment's frame, as the file has it
};
struct Segment {
  std::string label;
  std::vector<Point> points;
};
/// All that stands before the frames.
struct Subject {
  int version = 0;  ///< of the file: 3 or 4
  std::string name;
  double frame_rate_hz = 0.0;  ///< 0 when the file does not say
  std::vector<Segment> segments;
};
/// One <frame>, as the file has it. Lists that the file lacks are empty; numbers may be anything.
struct Frame {
  std::string type;  ///< "normal", "tpose", "npose", "identity"
  std::optional<std::uint64_t> index;
  std::optional<double> time_ms;
  std::vector<double> position;     ///< 3 per segment, m
  std::vector<double> orientation;  ///< 4 per segment, w x y z
  std::vector<double> center_of_mass;
  std::uint64_t line = 0;
};

/// What a file yields. A handler returns an empty string, or what is wrong there, which ends the reading.
struct Handler {
  std::function<std::string(const Subject&)> on_subject;  ///< once per subject, before its first frame
  std::function<std::string(const Frame&)> on_frame;
};

/// A push parser of MVNX over expat. Document types (and with them entities of their own) are refused, as are nesting
/// and tokens that no MVNX has, so that memory is bounded.
class Parser {
 public:
  Parser(std::string path, Handler handler);
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// Takes the next bytes. An Error names path:line.
  std::optional<Error> feed(const char* bytes, std::size_t size);
  /// The file has ended. `cut_short` is set when it ended amid the document: all before was good.
  std::optional<Error> finish(bool& cut_short);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap::mvnx
