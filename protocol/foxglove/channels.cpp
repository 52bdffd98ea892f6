// SPDX-License-Identifier: Apache-2.0
#include "protocol/foxglove/channels.hpp"

#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

namespace kinemap::foxglove {
namespace {

using Json = nlohmann::ordered_json;

struct Info {
  const char* topic;
  const char* schema;
};
constexpr std::array<Info, kChannelCount> kInfo{{{"/tf", "foxglove.FrameTransforms"},
                                                 {"/map/scene", "foxglove.SceneUpdate"},
                                                 {"/map/trajectory", "foxglove.PosesInFrame"},
                                                 {"/map/floor", "foxglove.Grid"},
                                                 {"/log", "foxglove.Log"}}};

const Info& info(Channel channel) { return kInfo[static_cast<std::size_t>(channel)]; }

// The building blocks of schemas. Everything that we send is always there, so all members are required.
Json type(const char* name) { return {{"type", name}}; }
Json text() { return type("string"); }
Json number() { return type("number"); }
Json boolean() { return type("boolean"); }
Json count() { return {{"type", "integer"}, {"minimum", 0}}; }
Json list(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
Json object(std::initializer_list<std::pair<const char*, Json>> members) {
  Json json = {{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const auto& [name, schema] : members) {
    json["properties"][name] = schema;
    json["required"].push_back(name);
  }
  return json;
}
Json one_of(std::initializer_list<const char*> names) {
  Json json = {{"oneOf", Json::array()}};
  for (const char* name : names) json["oneOf"].push_back({{"title", name}, {"const", json["oneOf"].size()}});
  return json;
}

Json nsec() { return {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}; }
Json time() { return object({{"sec", count()}, {"nsec", nsec()}}); }
Json duration() { return object({{"sec", type("integer")}, {"nsec", nsec()}}); }
Json vector2() { return object({{"x", number()}, {"y", number()}}); }
Json vector3() { return object({{"x", number()}, {"y", number()}, {"z", number()}}); }
Json quaternion() { return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}}); }
Json pose() { return object({{"position", vector3()}, {"orientation", quaternion()}}); }
Json colour() { return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}}); }

Json transforms() {
  return object({{"transforms", list(object({{"timestamp", time()},
                                             {"parent_frame_id", text()},
                                             {"child_frame_id", text()},
                                             {"translation", vector3()},
                                             {"rotation", quaternion()}}))}});
}

Json cube() { return object({{"pose", pose()}, {"size", vector3()}, {"color", colour()}}); }
Json line() {
  return object({{"type", one_of({"LINE_STRIP", "LINE_LOOP", "LINE_LIST"})},
                 {"pose", pose()},
                 {"thickness", number()},
                 {"scale_invariant", boolean()},
                 {"points", list(vector3())},
                 {"color", colour()},
                 {"colors", list(colour())},
                 {"indices", list(count())}});
}
Json triangles() {
  return object({{"pose", pose()},
                 {"points", list(vector3())},
                 {"color", colour()},
                 {"colors", list(colour())},
                 {"indices", list(count())}});
}
Json label() {
  return object({{"pose", pose()},
                 {"billboard", boolean()},
                 {"font_size", number()},
                 {"scale_invariant", boolean()},
                 {"color", colour()},
                 {"text", text()}});
}

Json scene() {
  Json entity = object({{"timestamp", time()},
                        {"frame_id", text()},
                        {"id", text()},
                        {"lifetime", duration()},
                        {"frame_locked", boolean()},
                        {"metadata", list(object({{"key", text()}, {"value", text()}}))},
                        {"arrows", list(type("object"))},
                        {"cubes", list(cube())},
                        {"spheres", list(type("object"))},
                        {"cylinders", list(type("object"))},
                        {"lines", list(line())},
                        {"triangles", list(triangles())},
                        {"texts", list(label())},
                        {"models", list(type("object"))}});
  Json deletion = object({{"timestamp", time()}, {"type", one_of({"MATCHING_ID", "ALL"})}, {"id", text()}});
  return object({{"deletions", list(std::move(deletion))}, {"entities", list(std::move(entity))}});
}

Json trajectory() { return object({{"timestamp", time()}, {"frame_id", text()}, {"poses", list(pose())}}); }

Json floor() {
  const Json numeric = one_of({"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"});
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"pose", pose()},
                 {"column_count", count()},
                 {"cell_size", vector2()},
                 {"row_stride", count()},
                 {"cell_stride", count()},
                 {"fields", list(object({{"name", text()}, {"offset", count()}, {"type", numeric}}))},
                 {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
}

Json log() {
  return object({{"timestamp", time()},
                 {"level", one_of({"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"})},
                 {"message", text()},
                 {"name", text()},
                 {"file", text()},
                 {"line", count()}});
}

Json schema(Channel channel) {
  switch (channel) {
    case Channel::Transforms:
      return transforms();
    case Channel::Scene:
      return scene();
    case Channel::Trajectory:
      return trajectory();
    case Channel::Floor:
      return floor();
    case Channel::Log:
      return log();
  }
  return {};
}

}  // namespace

const char* topic(Channel channel) { return info(channel).topic; }
const char* schema_name(Channel channel) { return info(channel).schema; }

std::string schema_text(Channel channel) {
  Json json = {{"title", schema_name(channel)}};
  json.update(schema(channel));
  return json.dump();
}

std::uint64_t nanoseconds(double time_s) { return static_cast<std::uint64_t>(std::llround(time_s * 1e9)); }

}  // namespace kinemap::foxglove
