// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/simulate.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "protocol/wire/mvnx_writer.hpp"
#include "protocol/wire/pcap.hpp"
#include "tools/sim/truth.hpp"

namespace kinemap::sim {

namespace {

namespace fs = std::filesystem;

constexpr double kCaptureEpoch_s = 1700000000.0;  // any fixed day: the same seed gives the same bytes

MvnxSubject subject_of(const Session& session) {
  MvnxSubject subject;
  subject.name = "Simulated " + std::to_string(session.options().seed);
  subject.frame_rate_hz = session.options().rate_hz;
  const auto scale = scale_of(session.reported_body());
  for (const auto& s : scale.segments)
    subject.segments.push_back({s.name, {s.origin[0], s.origin[1], s.origin[2]}, {}});
  for (const auto& p : scale.points) {
    subject.segments[p.segment - 1U].points.push_back({p.name, {p.position[0], p.position[1], p.position[2]}});
  }
  return subject;
}

/// Where the session goes: a capture of datagrams or an MVNX file.
class Sink {
 public:
  static Result<Sink> create(const Session& session, const std::string& path) {
    Sink sink;
    if (session.options().format == Format::Mvnx) {
      auto writer = MvnxWriter::create(path, subject_of(session));
      if (!writer) return Error{writer.error()};
      sink.mvnx_.emplace(std::move(*writer));
    } else {
      auto writer = PcapWriter::create(path, session.options().port);
      if (!writer) return Error{writer.error()};
      sink.pcap_.emplace(std::move(*writer));
    }
    return sink;
  }
  bool write(const Sample& sample, const Packets& packets) {
    if (pcap_) {
      for (const auto& datagram : packets.datagrams) {
        if (!pcap_->write(kCaptureEpoch_s + packets.time_s, datagram)) return false;
      }
      return true;
    }
    std::array<MvnxPose, kBones> poses;
    for (std::size_t i = 0; i < kBones; ++i) {
      const auto& s = sample.reported[i];
      poses[i] = {{s.p.x(), s.p.y(), s.p.z()}, {s.q.w(), s.q.x(), s.q.y(), s.q.z()}};
    }
    const Vec3 com = center_of_mass(sample.reported);
    return mvnx_->write({sample.index, sample.time_s, poses, std::array<double, 3>{com.x(), com.y(), com.z()}});
  }
  std::optional<Error> close() { return pcap_ ? pcap_->close() : mvnx_->close(); }

 private:
  std::optional<PcapWriter> pcap_;
  std::optional<MvnxWriter> mvnx_;
};

std::optional<Error> write_text(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << '\n';
  out.close();
  if (!out) return Error{path + ": cannot be written"};
  return std::nullopt;
}

}  // namespace

struct LiveSource::Tools {
  explicit Tools(const Session& session) : transmitter(session), truth(session) {}
  Transmitter transmitter;
  TruthWriter truth;
  Sample sample;
  Vec2 last{0, 0};
};

LiveSource::LiveSource(std::unique_ptr<Session> session)
    : session_(std::move(session)), tools_(std::make_shared<Tools>(*session_)) {
  report_.duration_s = session_->duration_s();
  report_.rooms = static_cast<int>(session_->building().rooms.size());
  report_.objects = session_->script().visited.size();
  for (const auto& interval : session_->script().score.intervals) {
    report_.traces += interval.label == "trace" ? 1 : 0;
    report_.sittings += interval.label == "sit" ? 1 : 0;
    report_.distractors += interval.label.rfind("distractor", 0) == 0 ? 1 : 0;
  }
}

Result<LiveSource> LiveSource::create(const SimOptions& options) {
  auto session = Session::create(options);
  if (!session) return Error{session.error()};
  return LiveSource(std::move(*session));
}

std::optional<Packets> LiveSource::next() {
  Tools& t = *tools_;
  if (!session_->next(t.sample)) return std::nullopt;
  t.truth.add(t.sample);
  const Vec2 at = t.sample.truth[kPelvis].p.head<2>();
  if (report_.samples > 0) report_.walked_m += (at - t.last).norm();
  t.last = at;
  report_.end_error_m = (t.sample.reported[kPelvis].p.head<2>() - at).norm();
  auto packets = t.transmitter.send(t.sample);
  ++report_.samples;
  report_.datagrams += packets.datagrams.size();
  report_.samples_lost = t.transmitter.lost();
  return packets;
}

const Sample& LiveSource::sample() const { return tools_->sample; }

std::string LiveSource::truth() const { return tools_->truth.json().dump(); }

Result<SimReport> simulate_to_directory(const SimOptions& options, const Progress& progress) {
  auto source = LiveSource::create(options);
  if (!source) return Error{source.error()};
  std::error_code failed;
  fs::create_directories(options.out_dir, failed);
  if (failed) return Error{options.out_dir + ": cannot be made: " + failed.message()};
  const bool mvnx = options.format == Format::Mvnx;
  const std::string session_path = (fs::path(options.out_dir) / (mvnx ? "session.mvnx" : "session.pcap")).string();
  const std::string truth_path = (fs::path(options.out_dir) / "truth.json").string();
  auto sink = Sink::create(source->session(), session_path);
  if (!sink) return Error{sink.error()};
  const std::size_t total = source->session().frames(), every = std::max<std::size_t>(1, total / 200);
  for (std::size_t i = 0; const auto packets = source->next(); ++i) {
    if (!sink->write(source->sample(), *packets)) break;
    if (progress && i % every == 0) progress(static_cast<double>(i) / static_cast<double>(total));
  }
  if (auto error = sink->close()) return *error;
  if (auto error = write_text(truth_path, source->truth())) return *error;
  if (progress) progress(1.0);
  SimReport report = source->report();
  report.session_path = session_path;
  report.truth_path = truth_path;
  return report;
}

}  // namespace kinemap::sim
