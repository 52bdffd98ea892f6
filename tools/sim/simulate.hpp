// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "protocol/wire/mxtp.hpp"
#include "protocol/wire/result.hpp"
#include "tools/sim/options.hpp"
#include "tools/sim/stream.hpp"

namespace kinemap::sim {

/// What was simulated.
struct SimReport {
  double duration_s = 0.0;
  std::size_t samples = 0;
  std::size_t samples_lost = 0;
  std::size_t datagrams = 0;
  double walked_m = 0.0;     ///< level way of the true pelvis
  double end_error_m = 0.0;  ///< level distance between reported and true pelvis at the end
  int rooms = 0;
  std::size_t objects = 0;  ///< visited
  std::size_t traces = 0, sittings = 0, distractors = 0;
  std::string session_path, truth_path;
};

/// Called with the part done, 0–1, some hundred times.
using Progress = std::function<void(double)>;

/// Writes session.pcap (or session.mvnx) and truth.json into options.out_dir, which is made if it is missing.
Result<SimReport> simulate_to_directory(const SimOptions& options, const Progress& progress = {});

/// A session datagram by datagram, for sending live. The caller waits until `Packets::time_s` and sends.
class LiveSource {
 public:
  static Result<LiveSource> create(const SimOptions& options);
  /// The next sample's datagrams (none when it is lost); nullopt at the end.
  std::optional<Packets> next();
  [[nodiscard]] const Session& session() const { return *session_; }
  [[nodiscard]] const Sample& sample() const;  ///< the one that next() gave last
  /// truth.json of what was taken so far; complete once next() gave nullopt.
  [[nodiscard]] std::string truth() const;
  [[nodiscard]] const SimReport& report() const { return report_; }

 private:
  explicit LiveSource(std::unique_ptr<Session> session);
  struct Tools;
  std::unique_ptr<Session> session_;
  std::shared_ptr<Tools> tools_;
  SimReport report_;
};

}  // namespace kinemap::sim
