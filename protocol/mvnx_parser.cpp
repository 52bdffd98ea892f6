// SPDX-License-Identifier: Apache-2.0
#include "protocol/mvnx_parser.hpp"

#include <expat.h>

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <string_view>

namespace kinemap::mvnx {

namespace {

constexpr int kDeepest = 64;
constexpr std::size_t kLongestText = 256 * 1024;  // of one list of numbers; 23 segments need 2 kB
constexpr std::size_t kLongestToken = 4 * 1024 * 1024;
constexpr std::size_t kMostSegments = 255;
constexpr std::size_t kMostPoints = 1024;

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string out;
  for (const auto part : parts) out += part;
  return out;
}

const char* attribute(const XML_Char** attributes, std::string_view name) {
  for (; *attributes; attributes += 2) {
    if (name == attributes[0]) return attributes[1];
  }
  return nullptr;
}

template <class T>
std::optional<T> number(const char* text) {
  if (!text) return std::nullopt;
  const std::string_view view(text);
  T value{};
  const auto [end, error] = std::from_chars(view.data(), view.data() + view.size(), value);
  if (error != std::errc{} || end != view.data() + view.size()) return std::nullopt;
  return value;
}

/// Numbers between blanks; false when something else is among them.
bool read_numbers(std::string_view text, std::vector<double>& out) {
  out.clear();
  for (;;) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return true;
    text.remove_prefix(begin);
    const std::size_t length = std::min(text.find_first_of(" \t\r\n"), text.size());
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + length, value);
    if (error != std::errc{} || end != text.data() + length) return false;
    out.push_back(value);
    text.remove_prefix(length);
  }
}

}  // namespace

class Parser::Impl {
 public:
  Impl(std::string p, Handler h) : path(std::move(p)), handler(std::move(h)), parser(XML_ParserCreate(nullptr)) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(
        parser, [](void* self, const XML_Char* name, const XML_Char** a) { static_cast<Impl*>(self)->start(name, a); },
        [](void* self, const XML_Char* name) { static_cast<Impl*>(self)->end(name); });
    XML_SetCharacterDataHandler(
        parser, [](void* self, const XML_Char* s, int n) { static_cast<Impl*>(self)->characters(s, n); });
    XML_SetDefaultHandler(parser, [](void* self, const XML_Char*, int) { static_cast<Impl*>(self)->quiet = 0; });
    XML_SetStartDoctypeDeclHandler(parser, [](void* self, const XML_Char*, const XML_Char*, const XML_Char*, int) {
      static_cast<Impl*>(self)->fail("a document type (<!DOCTYPE>) is not allowed");
    });
  }
  ~Impl() { XML_ParserFree(parser); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void fail(const std::string& what) {
    if (error) return;
    error = Error{path + ':' + std::to_string(XML_GetCurrentLineNumber(parser)) + ": " + what};
    XML_StopParser(parser, XML_FALSE);
  }

  void start(std::string_view name, const XML_Char** attributes) {
    quiet = 0;
    if (error) return;
    if (++depth > kDeepest) return fail("elements are nested more than " + std::to_string(kDeepest) + " deep");
    if (depth == 1) return start_document(name, attributes);
    if (name == "subject") return start_subject(attributes);
    if (name == "frame") return start_frame(attributes);
    if (in_frame) return listen(name == "position" || name == "orientation" || name == "centerOfMass");
    if (name == "segment") {
      const char* label = attribute(attributes, "label");
      subject.segments.push_back({label ? label : "", {}});
      if (subject.segments.size() > kMostSegments) fail("more than 255 segments");
    } else if (name == "point" && !subject.segments.empty()) {
      const char* label = attribute(attributes, "label");
      auto& points = subject.segments.back().points;
      points.push_back({label ? label : "", {}});
      if (points.size() > kMostPoints) fail("a segment with more than 1024 points");
    } else {
      listen(name == "pos_b" || name == "pos_s");
    }
  }

  void start_document(std::string_view name, const XML_Char** attributes) {
    if (name != "mvnx") return fail(joined({"the document is <", name, ">; <mvnx> is expected"}));
    const auto version = number<int>(attribute(attributes, "version"));
    if (!version || (*version != 3 && *version != 4)) {
      const char* given = attribute(attributes, "version");
      return fail(joined({"<mvnx version=\"", given ? given : "", "\">: version 3 or 4 is expected"}));
    }
    file_version = *version;
  }

  void start_subject(const XML_Char** attributes) {
    subject = {};
    subject.version = file_version;
    if (const char* label = attribute(attributes, "label")) subject.name = label;
    const char* rate = attribute(attributes, "frameRate");
    subject.frame_rate_hz = number<double>(rate).value_or(0.0);
    if (rate && !(subject.frame_rate_hz >= 1.0 && subject.frame_rate_hz <= 1000.0)) {
      return fail(joined({"frameRate=\"", rate, "\": 1 to 1000 is expected"}));
    }
    subject_told = false;
  }

  void start_frame(const XML_Char** attributes) {
    if (in_frame) return fail("<frame> within <frame>");
    if (!subject_told) {
      subject_told = true;
      if (auto what = handler.on_subject(subject); !what.empty()) return fail(what);
    }
    in_frame = true;
    const char* type = attribute(attributes, "type");
    frame.type = type ? type : "normal";
    frame.index = number<std::uint64_t>(attribute(attributes, "index"));
    frame.time_ms = number<double>(attribute(attributes, "time"));
    frame.position.clear();
    frame.orientation.clear();
    frame.center_of_mass.clear();
    frame.line = XML_GetCurrentLineNumber(parser);
  }

  void listen(bool on) {
    listening = on;
    text.clear();
  }

  void characters(const XML_Char* s, int n) {
    quiet = 0;
    if (!listening || error) return;
    text.append(s, static_cast<std::size_t>(n));
    if (text.size() > kLongestText) fail("a list of numbers longer than " + std::to_string(kLongestText) + " bytes");
  }

  void end(std::string_view name) {
    quiet = 0;
    --depth;
    if (error) return;
    if (listening) {
      listening = false;
      return end_numbers(name);
    }
    if (name == "frame" && in_frame) {
      in_frame = false;
      if (auto what = handler.on_frame(frame); !what.empty()) fail(what);
    }
  }

  void end_numbers(std::string_view name) {
    std::vector<double> point;
    std::vector<double>& into = name == "position"       ? frame.position
                                : name == "orientation"  ? frame.orientation
                                : name == "centerOfMass" ? frame.center_of_mass
                                                         : point;
    if (!read_numbers(text, into)) return fail(joined({"<", name, "> has something that is no number"}));
    if (&into != &point) return;
    if (point.size() != 3) return fail(joined({"<", name, "> has ", std::to_string(point.size()), " numbers, not 3"}));
    if (subject.segments.empty() || subject.segments.back().points.empty()) return;
    subject.segments.back().points.back().position = {point[0], point[1], point[2]};
  }

  std::string path;
  Handler handler;
  XML_Parser parser;
  std::optional<Error> error;
  std::size_t quiet = 0;  ///< bytes since anything was understood
  int depth = 0;
  int file_version = 0;
  Subject subject;
  bool subject_told = false;
  Frame frame;
  bool in_frame = false;
  bool listening = false;
  std::string text;
};

Parser::Parser(std::string path, Handler handler)
    : impl_(std::make_unique<Impl>(std::move(path), std::move(handler))) {}
Parser::~Parser() = default;

std::optional<Error> Parser::feed(const char* bytes, std::size_t size) {
  impl_->quiet += size;
  const bool ok = XML_Parse(impl_->parser, bytes, static_cast<int>(size), XML_FALSE) == XML_STATUS_OK;
  if (!ok) impl_->fail(XML_ErrorString(XML_GetErrorCode(impl_->parser)));
  // expat keeps an unfinished token in memory, however long it grows.
  if (impl_->quiet > kLongestToken) impl_->fail("no end of a tag within 4 MiB");
  return impl_->error;
}

std::optional<Error> Parser::finish(bool& cut_short) {
  cut_short = false;
  if (impl_->error || XML_Parse(impl_->parser, "", 0, XML_TRUE) == XML_STATUS_OK) return impl_->error;
  const XML_Error code = XML_GetErrorCode(impl_->parser);
  cut_short = code == XML_ERROR_NO_ELEMENTS || code == XML_ERROR_UNCLOSED_TOKEN || code == XML_ERROR_PARTIAL_CHAR ||
              code == XML_ERROR_UNCLOSED_CDATA_SECTION;
  impl_->fail(XML_ErrorString(code));
  return impl_->error;
}

}  // namespace kinemap::mvnx
