// SPDX-License-Identifier: Apache-2.0
#include "protocol/journal_entries.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace kinemap::journal {
namespace {

using Json = nlohmann::json;

// One function an entry describes its keys; writing and reading walk the same function, so that they cannot drift
// apart. A visitor offers `operator()(key, value)`.

template <class V>
void fields(V& v, SessionStart& e) {
  v("id", e.id);
  v("created_unix_ms", e.created_unix_ms);
  v("software", e.software);
  v("format", e.format);
}
template <class V>
void fields(V& v, StreamMark& e) {
  v("time", e.time_s);
  v("index", e.index);
  v("unix_ms", e.unix_ms);
  v("time_code_ms", e.time_code_ms);
  v("pose", e.T_odom_pelvis);
  v("path", e.path_m);
  v("turn", e.turn_rad);
}
template <class V>
void fields(V&, StreamSilence&) {}
template <class V>
void fields(V& v, WearerInfo& e) {
  v("name", e.name);
  v("fingertip", e.p_hand_fingertip);
  v("palm", e.p_hand_palm);
  v("stature", e.stature_m);
}
template <class V>
void fields(V& v, KeyPose& e) {
  v("id", e.id);
  v("time", e.time_s);
  v("pose", e.T_odom_pelvis);
  v("path", e.path_m);
  v("turn", e.turn_rad);
  v("discontinuity", e.discontinuity);
  v("stance", e.p_pelvis_stance);
  v("field_disturbed", e.field_disturbed);
  v("slip", e.slip);
}
template <class V>
void fields(V& v, Trace& e) {
  v("begin", e.begin_s);
  v("end", e.end_s);
  v("stature", e.stature_m);
  v("contacts", e.contacts);
}
template <class V>
void fields(V& v, Pivot& e) {
  v("begin", e.begin_s);
  v("end", e.end_s);
  v("point", e.p_hand);
  v("covariance", e.covariance);
  v("stature", e.stature_m);
}
template <class V>
void fields(V& v, Sitting& e) {
  v("begin", e.begin_s);
  v("end", e.end_s);
  v("key_pose", e.key_pose);
  v("pose", e.T_key_seat);
  v("height", e.height_m);
  v("spread", e.spread_m);
}

template <class V>
void fields(V& v, Announced& e) {
  v("time", e.time_s);
  v("revision", e.revision);
  v("objects", e.objects);
  v("rooms", e.rooms);
}

template <class V>
void fields(V& v, UnfinishedTrace& e) {
  v("begin", e.begin_s);
  v("seen", e.seen_s);
  v("held", e.held);
  v("hips", e.hips);
  v("stature", e.stature_m);
  v("contacts", e.contacts);
}
template <class V>
void fields(V& v, UnfinishedSitting& e) {
  v("begin", e.begin_s);
  v("seen", e.seen_s);
  v("still_time", e.still_s);
  v("unsupported_time", e.unsupported_s);
  v("still", e.still);
  v("outside", e.outside);
  v("velocity", e.velocity);
  v("samples", e.samples);
}

constexpr const char* name(const SessionStart&) { return "session"; }
constexpr const char* name(const StreamMark&) { return "mark"; }
constexpr const char* name(const StreamSilence&) { return "silence"; }
constexpr const char* name(const WearerInfo&) { return "wearer"; }
constexpr const char* name(const KeyPose&) { return "key_pose"; }
constexpr const char* name(const Trace&) { return "trace"; }
constexpr const char* name(const Pivot&) { return "pivot"; }
constexpr const char* name(const Sitting&) { return "sitting"; }
constexpr const char* name(const Announced&) { return "map"; }
constexpr const char* name(const UnfinishedTrace&) { return "unfinished_trace"; }
constexpr const char* name(const UnfinishedSitting&) { return "unfinished_sitting"; }

class Writer {
 public:
  template <class T>
  void operator()(const char* key, const T& value) {
    json_[key] = of(value);
  }
  /// What is unknown is left out.
  template <class T>
  void operator()(const char* key, const std::optional<T>& value) {
    if (value) json_[key] = of(*value);
  }
  Json take() { return std::move(json_); }

 private:
  template <class T>
  static Json of(const T& value) {
    return value;
  }
  static Json of(const Pose& T) { return {T.p.x(), T.p.y(), T.p.z(), T.q.w(), T.q.x(), T.q.y(), T.q.z()}; }
  static Json of(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
  static Json of(const Eigen::Matrix3d& m) {
    Json list = Json::array();
    for (Eigen::Index i = 0; i < 9; ++i) list.push_back(m(i / 3, i % 3));
    return list;
  }
  static Json of(const Slip& s) { return {s.turn_rad, s.way_m.x(), s.way_m.y(), s.stood_s, s.apart_rad}; }
  static Json of(const HandContact& c) { return {c.time_s, c.key_pose, of(c.T_key_hand)}; }
  static Json of(const SeatSample& s) { return {s.time_s, s.key_pose, of(s.T_key_seat), s.height_m}; }
  static Json of(const HipState& hip) { return {hip.near, hip.held, hip.rests_since_s}; }
  static Json of(const std::array<HipState, 2>& hips) { return {of(hips[0]), of(hips[1])}; }
  template <class T>
  static Json of(const std::vector<T>& values) {
    Json list = Json::array();
    for (const auto& value : values) list.push_back(of(value));
    return list;
  }

  Json json_ = Json::object();
};

class Reader {
 public:
  explicit Reader(const Json& json) : json_(json) {}

  template <class T>
  void operator()(const char* key, T& value) {
    const auto it = json_.find(key);
    good_ = good_ && it != json_.end() && get(*it, value);
  }
  template <class T>
  void operator()(const char* key, std::optional<T>& value) {
    const auto it = json_.find(key);
    if (it != json_.end()) good_ = good_ && get(*it, value.emplace());
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  static bool get(const Json& json, std::string& value) {
    if (!json.is_string()) return false;
    value = json.get_ref<const std::string&>();
    return true;
  }
  static bool get(const Json& json, bool& value) {
    if (!json.is_boolean()) return false;
    value = json.get<bool>();
    return true;
  }
  static bool get(const Json& json, double& value) {
    if (!json.is_number()) return false;
    value = json.get<double>();
    return std::isfinite(value);
  }
  static bool get(const Json& json, std::int64_t& value) {
    if (!json.is_number_integer()) return false;
    value = json.get<std::int64_t>();
    return true;
  }
  static bool get(const Json& json, std::uint64_t& value) {
    if (!json.is_number_unsigned()) return false;
    value = json.get<std::uint64_t>();
    return true;
  }
  static bool get(const Json& json, std::uint32_t& value) {
    std::uint64_t wide = 0;
    if (!get(json, wide) || wide > UINT32_MAX) return false;
    value = static_cast<std::uint32_t>(wide);
    return true;
  }
  template <class T, std::size_t N>
  static bool get(const Json& json, std::array<T, N>& values) {
    if (!json.is_array() || json.size() != N) return false;
    for (std::size_t i = 0; i < N; ++i)
      if (!get(json[i], values[i])) return false;
    return true;
  }
  static bool get(const Json& json, Eigen::Vector3d& p) {
    std::array<double, 3> v{};
    if (!get(json, v)) return false;
    p = {v[0], v[1], v[2]};
    return true;
  }
  static bool get(const Json& json, Eigen::Matrix3d& m) {
    std::array<double, 9> v{};
    if (!get(json, v)) return false;
    for (Eigen::Index i = 0; i < 9; ++i) m(i / 3, i % 3) = v[static_cast<std::size_t>(i)];
    return true;
  }
  static bool get(const Json& json, Pose& T) {
    std::array<double, 7> v{};
    if (!get(json, v)) return false;
    T = {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
    return std::abs(T.q.norm() - 1.0) < 1e-6;
  }
  static bool get(const Json& json, Slip& s) {
    std::array<double, 5> v{};
    if (!get(json, v)) return false;
    s = {v[0], {v[1], v[2]}, v[3], v[4]};
    return true;
  }
  static bool get(const Json& json, HandContact& c) {
    return json.is_array() && json.size() == 3 && get(json[0], c.time_s) && get(json[1], c.key_pose) &&
           get(json[2], c.T_key_hand);
  }
  static bool get(const Json& json, SeatSample& s) {
    return json.is_array() && json.size() == 4 && get(json[0], s.time_s) && get(json[1], s.key_pose) &&
           get(json[2], s.T_key_seat) && get(json[3], s.height_m);
  }
  static bool get(const Json& json, HipState& hip) {
    return json.is_array() && json.size() == 3 && get(json[0], hip.near) && get(json[1], hip.held) &&
           get(json[2], hip.rests_since_s);
  }
  template <class T>
  static bool get(const Json& json, std::vector<T>& values) {
    if (!json.is_array()) return false;
    values.resize(json.size());
    for (std::size_t i = 0; i < json.size(); ++i)
      if (!get(json[i], values[i])) return false;
    return true;
  }

  const Json& json_;
  bool good_ = true;
};

template <class E>
bool read_as(const Json& json, std::optional<Entry>& entry) {
  E e;
  if (json["type"] != name(e)) return false;
  Reader reader(json);
  fields(reader, e);
  if (reader.good()) entry = std::move(e);
  return true;
}

template <class... E>
std::optional<Entry> read_any(const Json& json, const std::variant<E...>*) {
  std::optional<Entry> entry;
  (read_as<E>(json, entry) || ...);
  return entry;
}

/// Whether CBOR is of the shape that entries have: not deep, and no size said that is not there.
class Shape : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t size) override { return enter(size); }
  bool start_array(std::size_t size) override { return enter(size); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  static constexpr int kDeepest = 8;             // an entry's contacts' poses are at 4
  static constexpr std::size_t kMost = 1 << 24;  // elements of one array

  bool enter(std::size_t size) { return ++depth_ <= kDeepest && (size <= kMost || size == std::size_t(-1)); }
  bool leave() {
    --depth_;
    return true;
  }
  int depth_ = 0;
};

}  // namespace

std::string encode(const Entry& entry) {
  return std::visit(
      [](auto e) {
        Writer writer;
        fields(writer, e);
        Json json = writer.take();
        json["type"] = name(e);
        std::string bytes;
        Json::to_cbor(json, bytes);
        return bytes;
      },
      entry);
}

std::optional<Entry> decode(std::string_view payload) {
  // In this order: from_cbor throws at sizes that memory cannot hold, and takes as much stack as the bytes nest deep.
  if (Shape shape; !Json::sax_parse(payload, &shape, Json::input_format_t::cbor)) return std::nullopt;
  const Json json = Json::from_cbor(payload.begin(), payload.end(), true, false);
  if (!json.is_object() || !json.contains("type")) return std::nullopt;
  return read_any(json, static_cast<const Entry*>(nullptr));
}

}  // namespace kinemap::journal
