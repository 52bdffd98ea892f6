// SPDX-License-Identifier: Apache-2.0
#include "protocol/mvnx.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include "protocol/frame_maker.hpp"
#include "protocol/mvnx_parser.hpp"
#include "protocol/wearer.hpp"
#include "protocol/wire/file.hpp"
#include "protocol/wire/segment_names.hpp"

namespace kinemap {

namespace {

constexpr std::size_t kChunk = 64 * 1024;
constexpr double kFarthestM = 1e5;
constexpr double kUnitTolerance = 0.01;

bool same_label(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

bool is_arm(std::size_t i) { return (i >= 8 && i <= 10) || (i >= 12 && i <= 14); }
bool is_right_arm(std::size_t i) { return i >= 8 && i <= 10; }

/// `R_n_t` of one arm segment: from the frame that is aligned with the world in the T-pose to the one aligned in the
/// N-pose. Raising the arm from hanging to level is a turn about the forward axis, so the frame of the N-pose is the
/// other one turned back.
Eigen::Quaterniond n_from_t(std::size_t i) {
  if (!is_arm(i)) return Eigen::Quaterniond::Identity();
  const double quarter = std::numbers::pi / 2.0;
  return Eigen::Quaterniond(Eigen::AngleAxisd(is_right_arm(i) ? quarter : -quarter, Eigen::Vector3d::UnitX()));
}

Eigen::Quaterniond quaternion(const std::vector<double>& list, std::size_t i) {
  return {list[4 * i], list[4 * i + 1], list[4 * i + 2], list[4 * i + 3]};
}

class MvnxPlayer {
 public:
  MvnxPlayer(const AssemblerConfig& config, const RecordingSink& sink)
      : wanted_(std::max(config.character, 0)), sink_(&sink), maker_(summary_.stream) {
    summary_.format = "mvnx";
  }

  std::string on_subject(const mvnx::Subject& subject) {
    if (subject_number_++ != wanted_) {
      active_ = false;
      return {};
    }
    active_ = true;
    subject_ = subject;
    n_pose_ = subject.version == 3;
    summary_.rate_hz = subject.frame_rate_hz;
    if (subject.segments.empty()) return {};
    if (subject.segments.size() < kSegmentCount) {
      return "the subject has " + std::to_string(subject.segments.size()) + " segments; a whole body has 23";
    }
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      const std::string& label = subject.segments[i].label;
      if (!same_label(label, kSegmentNames[i])) {
        return "segment " + std::to_string(i + 1) + " is \"" + label + "\"; " + std::string(kSegmentNames[i]) +
               " is expected";
      }
    }
    return {};
  }

  std::string on_frame(const mvnx::Frame& frame) {
    if (!active_) return {};
    if (frame.type == "tpose") {
      take_t_pose(frame);
      return {};
    }
    if (frame.type != "normal") return {};
    if (auto what = wrong_shape(frame); !what.empty()) return what;
    if (!wearer_told_) tell_wearer();
    take_normal(frame);
    return {};
  }

  Result<RecordingSummary> finish(const std::string& path) {
    if (summary_.stream.frames == 0) {
      std::string why = path + ": no wearer to map: ";
      if (maker_.pinned()) {
        why += kPinnedMessage;
      } else if (subject_number_ <= wanted_) {
        why += "it has " + std::to_string(subject_number_) + " subjects with frames";
      } else if (summary_.stream.datagrams > 0) {
        why += "none of " + std::to_string(summary_.stream.datagrams) + " frames is a sound body";
      } else {
        why += "it has no frame of type normal";
      }
      return Error{why};
    }
    if (summary_.stream.refused_pinned > 0)
      summary_.warnings.push_back(std::string("part of the recording was refused: ") + kPinnedMessage);
    if (subject_number_ > wanted_ + 1) {
      summary_.warnings.push_back("the file has several subjects; only number " + std::to_string(wanted_) +
                                  " was read");
    }
    return std::move(summary_);
  }

  void warn(std::string what) { summary_.warnings.push_back(std::move(what)); }
  [[nodiscard]] std::uint64_t frames() const { return summary_.stream.frames; }

 private:
  /// The T-pose tells the body's lengths, and by the upper arm's orientation which convention the file really has.
  void take_t_pose(const mvnx::Frame& frame) {
    if (frame.position.size() >= 3 * kSegmentCount) {
      t_pose_ = frame.position;
    }
    if (frame.orientation.size() < 4 * kSegmentCount) return;
    constexpr std::size_t kRightUpperArm = 8;
    const Eigen::Quaterniond pelvis = quaternion(frame.orientation, 0);
    const Eigen::Quaterniond arm = quaternion(frame.orientation, kRightUpperArm);
    if (!(std::abs(pelvis.norm() - 1.0) < kUnitTolerance) || !(std::abs(arm.norm() - 1.0) < kUnitTolerance)) return;
    constexpr double kNear = 30.0 * std::numbers::pi / 180.0;
    if (pelvis.angularDistance(arm) < kNear) n_pose_ = false;
    if (pelvis.angularDistance(arm * n_from_t(kRightUpperArm)) < kNear) n_pose_ = true;
  }

  static std::string wrong_shape(const mvnx::Frame& f) {
    const std::size_t n = f.position.size() / 3;
    if (f.position.empty() || f.orientation.empty()) {
      return "a frame without <position> or <orientation>: export from MVN with both";
    }
    if (f.position.size() % 3 != 0 || f.orientation.size() != 4 * n || n < kSegmentCount) {
      return "a frame with " + std::to_string(f.position.size()) + " position and " +
             std::to_string(f.orientation.size()) +
             " orientation numbers; 3 and 4 for each of at least 23 segments are expected";
    }
    return {};
  }

  static std::optional<mxtp::Fault> fault_of(const mvnx::Frame& f) {
    const auto finite = [](double v) { return std::isfinite(v); };
    if (!std::all_of(f.position.begin(), f.position.end(), finite)) return mxtp::Fault::NotFinite;
    if (!std::all_of(f.orientation.begin(), f.orientation.end(), finite)) return mxtp::Fault::NotFinite;
    if (std::any_of(f.position.begin(), f.position.end(), [](double v) { return std::abs(v) > kFarthestM; })) {
      return mxtp::Fault::OutOfRange;
    }
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      if (std::abs(quaternion(f.orientation, i).norm() - 1.0) > kUnitTolerance) return mxtp::Fault::NotUnit;
    }
    return std::nullopt;
  }

  void take_normal(const mvnx::Frame& f) {
    AssemblerStats& stats = summary_.stream;
    ++stats.datagrams;
    if (const auto fault = fault_of(f)) {
      ++stats.faults[static_cast<std::size_t>(*fault)];
      return;
    }
    SuitFrame frame;
    frame.index = f.index.value_or(last_index_ ? *last_index_ + 1 : 0);
    if (last_index_ && frame.index <= *last_index_) {
      ++stats.late;
      return;
    }
    if (last_index_) stats.lost_samples += frame.index - *last_index_ - 1;
    if (!first_index_) first_index_ = frame.index;
    last_index_ = frame.index;
    frame.time_s = time_of(frame.index, f);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      Eigen::Quaterniond q = quaternion(f.orientation, i).normalized();
      if (n_pose_) q = (q * n_from_t(i)).normalized();
      frame.segments[i] = {{f.position[3 * i], f.position[3 * i + 1], f.position[3 * i + 2]}, q};
    }
    if (f.center_of_mass.size() >= 3) {
      const Eigen::Vector3d com(f.center_of_mass[0], f.center_of_mass[1], f.center_of_mass[2]);
      if (com.allFinite()) frame.center_of_mass = com;
    }
    maker_.take(frame, 1, [this](const SuitFrame& good) {
      summary_.duration_s = good.time_s;
      if (sink_->on_frame) sink_->on_frame(good);
    });
  }

  /// By the index where the rate is known: the file's times are in whole milliseconds.
  double time_of(std::uint64_t index, const mvnx::Frame& f) {
    const auto steps = static_cast<double>(index - *first_index_);
    double time_s = last_time_s_;
    if (subject_.frame_rate_hz > 0.0) {
      time_s = steps / subject_.frame_rate_hz;
    } else if (f.time_ms && std::isfinite(*f.time_ms)) {
      if (!first_time_ms_) first_time_ms_ = *f.time_ms;
      time_s = (*f.time_ms - *first_time_ms_) * 1e-3;
      if (time_s > 0.1) summary_.rate_hz = steps / time_s;
    }
    last_time_s_ = std::max(last_time_s_, time_s);
    return last_time_s_;
  }

  void tell_wearer() {
    wearer_told_ = true;
    mxtp::Scale scale;
    for (std::size_t i = 0; i < subject_.segments.size() && i < kSegmentCount; ++i) {
      mxtp::ScaleSegment segment{std::string(kSegmentNames[i]), {}};
      if (!t_pose_.empty()) {
        for (std::size_t k = 0; k < 3; ++k) segment.origin[k] = static_cast<float>(t_pose_[3 * i + k]);
        scale.segments.push_back(segment);
      }
      for (const mvnx::Point& p : subject_.segments[i].points) {
        Eigen::Vector3d at(p.position[0], p.position[1], p.position[2]);
        if (n_pose_) at = n_from_t(i).conjugate() * at;
        const Eigen::Vector3f f = at.cast<float>();
        scale.points.push_back({static_cast<std::uint16_t>(i + 1), 0, p.label, 0, {f.x(), f.y(), f.z()}});
      }
    }
    summary_.wearer.name = subject_.name;
    describe_body(scale, summary_.wearer);
    if (sink_->on_wearer) sink_->on_wearer(summary_.wearer);
  }

  int wanted_;
  const RecordingSink* sink_;
  RecordingSummary summary_;
  FrameMaker maker_;
  int subject_number_ = 0;
  bool active_ = false;
  mvnx::Subject subject_;
  bool n_pose_ = false;
  bool wearer_told_ = false;
  std::vector<double> t_pose_;  ///< positions, 3 per segment
  std::optional<std::uint64_t> first_index_;
  std::optional<std::uint64_t> last_index_;
  std::optional<double> first_time_ms_;
  double last_time_s_ = 0.0;
};

}  // namespace

Result<RecordingSummary> read_mvnx(const std::string& path, const AssemblerConfig& config, const RecordingSink& sink,
                                   const Progress& progress) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return Error{path + ": cannot open: " + std::strerror(errno)};
  std::error_code no_size;
  const double size = static_cast<double>(std::filesystem::file_size(path, no_size));
  MvnxPlayer player(config, sink);
  mvnx::Parser parser(path, {[&](const mvnx::Subject& s) { return player.on_subject(s); },
                             [&](const mvnx::Frame& f) { return player.on_frame(f); }});
  std::vector<char> chunk(kChunk);
  double read = 0.0;
  for (std::uint64_t round = 0;; ++round) {
    const std::size_t n = std::fread(chunk.data(), 1, chunk.size(), file.get());
    if (n == 0) break;
    if (auto error = parser.feed(chunk.data(), n)) return std::move(*error);
    read += static_cast<double>(n);
    if (progress && round % 16 == 15 && !no_size && size > 0.0) progress(std::min(1.0, read / size));
  }
  if (std::ferror(file.get())) return Error{path + ": cannot read: " + std::strerror(errno)};
  bool cut_short = false;
  if (auto error = parser.finish(cut_short)) {
    if (!cut_short || player.frames() == 0) return std::move(*error);
    player.warn(error->message + " (the file is cut short); what came before was used");
  }
  if (progress) progress(1.0);
  return player.finish(path);
}

}  // namespace kinemap
