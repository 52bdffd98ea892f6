// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/mvnx_writer.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

#include "protocol/wire/file.hpp"

namespace kinemap {

namespace {

void append_escaped(std::string& out, const std::string& text) {
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
}

/// Six decimals, as MVN writes them; independent of the locale.
void append_number(std::string& out, double value) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 6);
  if (end.ec == std::errc{}) out.append(text.data(), end.ptr);
}

template <std::size_t N>
void append_numbers(std::string& out, const std::array<double, N>& values) {
  for (const double v : values) {
    if (!out.empty() && out.back() != '>') out += ' ';
    append_number(out, v);
  }
}

void append_frame(std::string& out, const std::string& attributes, std::span<const MvnxPose> poses,
                  const std::optional<std::array<double, 3>>& com) {
  out += "      <frame " + attributes + ">\n        <orientation>";
  for (const MvnxPose& p : poses) append_numbers(out, p.orientation);
  out += "</orientation>\n        <position>";
  for (const MvnxPose& p : poses) append_numbers(out, p.position);
  out += "</position>\n";
  if (com) {
    out += "        <centerOfMass>";
    append_numbers(out, *com);
    out += "</centerOfMass>\n";
  }
  out += "      </frame>\n";
}

void append_segments(std::string& out, const MvnxSubject& subject) {
  out += "    <segments>\n";
  int id = 0;
  for (const MvnxSegment& s : subject.segments) {
    out += "      <segment label=\"";
    append_escaped(out, s.label);
    out += "\" id=\"" + std::to_string(++id) + "\">\n        <points>\n";
    for (const MvnxPoint& p : s.points) {
      out += "          <point label=\"";
      append_escaped(out, p.label);
      out += "\">\n            <pos_b>";
      append_numbers(out, p.position);
      out += "</pos_b>\n          </point>\n";
    }
    out += "        </points>\n      </segment>\n";
  }
  out += "    </segments>\n";
}

std::string head(const MvnxSubject& subject) {
  const std::string count = std::to_string(subject.segments.size());
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<mvnx version=\"4\">\n";
  out += "  <comment></comment>\n  <subject label=\"";
  append_escaped(out, subject.name);
  out += "\" frameRate=\"";
  std::array<char, 32> rate{};
  out.append(rate.data(), std::to_chars(rate.data(), rate.data() + rate.size(), subject.frame_rate_hz).ptr);
  out += "\" segmentCount=\"" + count + "\">\n";
  append_segments(out, subject);
  out += "    <frames segmentCount=\"" + count + "\">\n";
  std::vector<MvnxPose> poses(subject.segments.size());
  append_frame(out, R"(time="0" index="" tc="" ms="" type="identity")", poses, {});
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].position = subject.segments[i].origin;
  append_frame(out, R"(time="0" index="" tc="" ms="" type="tpose")", poses, {});
  return out;
}

}  // namespace

class MvnxWriter::Impl {
 public:
  std::string path;
  File file;
  std::size_t segments = 0;
  std::string line;
  std::optional<Error> error;

  bool put(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), file.get()) == text.size()) return true;
    if (!error) error = Error{path + ": cannot write: " + std::strerror(errno)};
    return false;
  }
  void finish() {
    if (!file) return;
    put("    </frames>\n  </subject>\n</mvnx>\n");
    if (std::fclose(file.release()) != 0 && !error) error = Error{path + ": cannot write: " + std::strerror(errno)};
  }
};

MvnxWriter::MvnxWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MvnxWriter::~MvnxWriter() {
  if (impl_) impl_->finish();
}
MvnxWriter::MvnxWriter(MvnxWriter&&) noexcept = default;
MvnxWriter& MvnxWriter::operator=(MvnxWriter&&) noexcept = default;

Result<MvnxWriter> MvnxWriter::create(const std::string& path, const MvnxSubject& subject) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->segments = subject.segments.size();
  impl->file.reset(std::fopen(path.c_str(), "wb"));
  if (!impl->file) return Error{path + ": cannot create: " + std::strerror(errno)};
  if (!impl->put(head(subject))) return *impl->error;
  return MvnxWriter(std::move(impl));
}

bool MvnxWriter::write(const MvnxFrame& frame) {
  if (impl_->error || !impl_->file) return false;
  if (frame.segments.size() != impl_->segments) {
    impl_->error = Error{impl_->path + ": a frame has " + std::to_string(frame.segments.size()) + " segments, not " +
                         std::to_string(impl_->segments) + " as the subject"};
    return false;
  }
  const auto ms = std::llround(frame.time_s * 1e3);
  impl_->line.clear();
  append_frame(impl_->line,
               "time=\"" + std::to_string(ms) + "\" index=\"" + std::to_string(frame.index) + "\" type=\"normal\"",
               frame.segments, frame.center_of_mass);
  return impl_->put(impl_->line);
}

std::optional<Error> MvnxWriter::close() {
  impl_->finish();
  return impl_->error;
}

}  // namespace kinemap
