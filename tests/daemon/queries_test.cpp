// SPDX-License-Identifier: Apache-2.0
#include "daemon/queries.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "daemon/params.hpp"
#include "daemon/url.hpp"
#include "protocol/rooms.hpp"
#include "tests/daemon/support.hpp"

namespace kinemap {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

MapObject chair(std::uint32_t id, double x, double y) {
  MapObject object;
  object.id = id;
  object.type = ObjectType::Chair;
  object.functions = {"sit"};
  object.pose = level_pose({x, y, 0.45}, 0.0);
  return object;
}

/// A level rectangle, 2 m × 1 m, its centre at (x, y).
MapObject table(std::uint32_t id, double x, double y) {
  MapObject object;
  object.id = id;
  object.type = ObjectType::Table;
  object.functions = {"place"};
  object.pose = level_pose({x, y, 0.74}, 0.0);
  using P = Eigen::Vector3d;
  object.corners = {P(x - 1, y - 0.5, 0.74), P(x + 1, y - 0.5, 0.74), P(x + 1, y + 0.5, 0.74), P(x - 1, y + 0.5, 0.74)};
  object.size = {2.0, 1.0};
  return object;
}

/// Upright, from (x, y0) to (x, y1).
MapObject wall(std::uint32_t id, double x, double y0, double y1) {
  MapObject object;
  object.id = id;
  object.type = ObjectType::Wall;
  object.functions = {"bound"};
  object.pose = level_pose({x, (y0 + y1) / 2, 1.25}, 0.0);
  using P = Eigen::Vector3d;
  object.corners = {P(x, y0, 0), P(x, y1, 0), P(x, y1, 2.5), P(x, y0, 2.5)};
  object.size = {y1 - y0, 2.5};
  return object;
}

MapSnapshot sample_map() {
  MapSnapshot map;
  map.revision = 5;
  map.objects = {wall(1, 10, 0, 8), table(2, 0, 0), chair(4, 3, 0), chair(7, 0, 1.5)};
  map.objects[2].last_seen_s = 9.0;
  for (unsigned i = 0; i < 5; ++i)
    map.trajectory.push_back({i, i * 2.0, level_pose({i * 1.0, 0, 1}, 0.1), level_pose({i * 1.1, 0, 1}, 0.0)});
  map.rooms = {{3, {{2, -1}, {10, -1}, {10, 8}, {2, 8}}, 72.0, 2.5, true, {1}, {}}};
  map.T_map_odom = level_pose({1, 2, 0}, 0.0);
  return map;
}

Json value_of(const Answer& answer) {
  if (const auto* error = std::get_if<ApiError>(&answer)) return {{"unexpected error", error->message}};
  return Json::parse(std::get<std::string>(answer));
}

ApiError error_of(const Answer& answer) {
  const auto* error = std::get_if<ApiError>(&answer);
  return error != nullptr ? *error : ApiError{200, "", "no error"};
}

std::vector<int> ids(const Answer& answer) {
  std::vector<int> list;
  const Json json = value_of(answer);
  for (const auto& object : json.at("objects")) list.push_back(object.at("id"));
  return list;
}

using Ids = std::vector<int>;

TEST(QueryObjects, WithoutParametersAllByTheirId) {
  const auto answer = query_objects(sample_map(), {});
  EXPECT_EQ(ids(answer), (Ids{1, 2, 4, 7}));
  EXPECT_EQ(value_of(answer)["revision"], 5);
  EXPECT_EQ(value_of(answer)["matched"], 4);
  EXPECT_FALSE(value_of(answer)["objects"][0].contains("distance"));
}

TEST(QueryObjects, ByTypeAndFunction) {
  EXPECT_EQ(ids(query_objects(sample_map(), {{"type", "chair"}})), (Ids{4, 7}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"type", "chair,wall"}})), (Ids{1, 4, 7}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"function", "place"}})), (Ids{2}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"function", "place,sit"}})), (Ids{2, 4, 7}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"type", "table"}, {"function", "sit"}})), (Ids{}));
}

TEST(QueryObjects, NearSortsByTheDistanceToTheOutline) {
  // The table's edge is 0.4 m away, though its centre is 1.4 m away; the chair at (3, 0) is 1.6 m away.
  const auto answer = query_objects(sample_map(), {{"near", "1.4,0"}});
  EXPECT_EQ(ids(answer), (Ids{2, 4, 7, 1}));
  EXPECT_NEAR(value_of(answer)["objects"][0]["distance"].get<double>(), 0.4, 1e-6);
  EXPECT_NEAR(value_of(answer)["objects"][3]["distance"].get<double>(), 8.6, 1e-6);
  EXPECT_EQ(ids(query_objects(sample_map(), {{"near", "1.4,0"}, {"within", "1.7"}})), (Ids{2, 4}));
}

TEST(QueryObjects, NearInSpaceCountsTheHeightToo) {
  // 2 m over the table's middle; the wall is 10 m away, and reaches up to 2.5 m.
  const auto answer = query_objects(sample_map(), {{"near", "0,0,2.74"}, {"type", "table,wall"}});
  EXPECT_EQ(ids(answer), (Ids{2, 1}));
  EXPECT_NEAR(value_of(answer)["objects"][0]["distance"].get<double>(), 2.0, 1e-6);
  EXPECT_NEAR(value_of(answer)["objects"][1]["distance"].get<double>(), std::hypot(10.0, 0.24), 1e-6);
}

TEST(QueryObjects, SortsByWhatIsAskedFor) {
  EXPECT_EQ(ids(query_objects(sample_map(), {{"sort", "-id"}})), (Ids{7, 4, 2, 1}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"sort", "-size"}, {"limit", "1"}})), (Ids{1}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"sort", "last_seen"}})), (Ids{1, 2, 7, 4}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"near", "0,0"}, {"sort", "-distance"}})), (Ids{1, 4, 7, 2}));
  EXPECT_EQ(ids(query_objects(sample_map(), {{"near", "0,0"}, {"sort", "id"}})), (Ids{1, 2, 4, 7}));
}

TEST(QueryRooms, HaveTheirObjects) {
  EXPECT_EQ(ids(query_objects(sample_map(), {{"room", "3"}})), (Ids{1, 4}));
  const auto rooms = value_of(query_rooms(sample_map()));
  EXPECT_EQ(rooms["revision"], 5);
  EXPECT_EQ(rooms["rooms"][0]["objects"], (Json{1, 4}));
  EXPECT_EQ(value_of(query_room(sample_map(), "3")), rooms["rooms"][0]);
  EXPECT_EQ(error_of(query_room(sample_map(), "4")).message, "no room 4; ids run 3–3");
  EXPECT_EQ(error_of(query_room(sample_map(), "x")).parameter, "id");
  EXPECT_EQ(error_of(query_room(MapSnapshot{}, "4")).message, "no room 4; the map has no rooms yet");
}

TEST(QueryRooms, AScreenBelongsToTheRoomThatItFaces) {
  auto map = sample_map();
  MapObject screen = wall(9, 10.02, 1, 2);
  screen.type = ObjectType::Screen;
  screen.plane = PlaneEquation{{-1, 0, 0}, -10.02};
  EXPECT_TRUE(is_in_room(screen, map.rooms[0]));
  screen.plane = PlaneEquation{{1, 0, 0}, 10.02};
  EXPECT_FALSE(is_in_room(screen, map.rooms[0]));
}

TEST(QueryObjects, LimitCutsButSaysHowManyMatched) {
  const auto answer = query_objects(sample_map(), {{"near", "0,0"}, {"limit", "2"}});
  EXPECT_EQ(ids(answer), (Ids{2, 7}));
  EXPECT_EQ(value_of(answer)["matched"], 4);
}

TEST(QueryObjects, RefusesWhatItDoesNotUnderstand) {
  const auto message = [](const Params& params) {
    const auto error = error_of(query_objects(sample_map(), params));
    return std::to_string(error.status) + " " + error.code + " " + error.message;
  };
  EXPECT_THAT(
      message({{"type", "wal"}}),
      HasSubstr(
          "400 bad_parameter type must be one or several, with commas, of wall, table, screen, chair, not \"wal\""));
  EXPECT_THAT(message({{"function", "fly"}}), HasSubstr("of sit, place, view, bound, not \"fly\""));
  EXPECT_THAT(message({{"type", "wall,"}}), HasSubstr("not \"\""));
  for (const char* near : {"1", "1,2,3,4", "nan,0", "1,,2", ""})
    EXPECT_THAT(message({{"near", near}}), HasSubstr("near must be two or three numbers"));
  EXPECT_THAT(message({{"within", "2"}}), HasSubstr("within must be used with near"));
  EXPECT_THAT(message({{"near", "0,0"}, {"within", "-1"}}), HasSubstr("within must be a number"));
  EXPECT_THAT(message({{"near", "0,0"}, {"within", "inf"}}), HasSubstr("within must be a number"));
  EXPECT_THAT(message({{"room", "9"}}), HasSubstr("room must be one of 3, not \"9\""));
  EXPECT_THAT(message({{"room", "x"}}), HasSubstr("room must be a whole number"));
  EXPECT_THAT(message({{"sort", "colour"}}), HasSubstr("sort must be one of id, distance, size"));
  EXPECT_THAT(message({{"sort", "--id"}}), HasSubstr("sort must be one of"));
  EXPECT_THAT(message({{"sort", "distance"}}), HasSubstr("something else without near"));
  EXPECT_THAT(message({{"limit", "0"}}), HasSubstr("limit must be a whole number from 1"));
  EXPECT_THAT(message({{"limit", "2.5"}}), HasSubstr("limit must be a whole number"));
  EXPECT_THAT(message({{"limit", std::string(500, '9')}}), HasSubstr("…\""));
}

TEST(CheckParams, EachMustBeKnownAndStandOnce) {
  EXPECT_FALSE(check_params({{"type", "wall"}, {"limit", "1"}}, object_params()));
  const auto unknown = check_params({{"typ", "wall"}}, object_params());
  ASSERT_TRUE(unknown);
  EXPECT_THAT(unknown->message, HasSubstr("unknown parameter \"typ\"; there are: type, function"));
  EXPECT_EQ(unknown->parameter, "typ");
  EXPECT_EQ(unknown->given, "wall");
  EXPECT_THAT(check_params({{"x", "1"}}, {})->message, HasSubstr("there are none here"));
  EXPECT_THAT(check_params({{"type", "wall"}, {"type", "chair"}}, object_params())->message, HasSubstr("stands twice"));
}

TEST(QueryObject, ByIdOr404WithTheIdsThereAre) {
  EXPECT_EQ(value_of(query_object(sample_map(), "4"))["type"], "chair");
  const auto missing = error_of(query_object(sample_map(), "99"));
  EXPECT_EQ(missing.status, 404U);
  EXPECT_EQ(missing.message, "no object 99; ids run 1–7");
  EXPECT_THAT(error_of(query_object(MapSnapshot{}, "1")).message, HasSubstr("no objects yet"));
  for (const char* id : {"", "x", "-1", "4x", "1.0", "99999999999"})
    EXPECT_EQ(error_of(query_object(sample_map(), id)).status, 400U) << id;
}

TEST(QueryTrajectory, SinceAndUntilAreInclusive) {
  const auto times = [](const Params& params) {
    std::vector<double> list;
    const Json json = value_of(query_trajectory(sample_map(), params));
    for (const auto& pose : json.at("poses")) list.push_back(pose.at("time"));
    return list;
  };
  EXPECT_EQ(times({}), (std::vector<double>{0, 2, 4, 6, 8}));
  EXPECT_EQ(times({{"since", "2"}, {"until", "6"}}), (std::vector<double>{2, 4, 6}));
  EXPECT_EQ(times({{"since", "8.5"}}), std::vector<double>{});
  EXPECT_EQ(times({{"every", "3"}}), (std::vector<double>{0, 4, 8}));
  EXPECT_EQ(times({{"since", "1"}, {"every", "2"}}), (std::vector<double>{2, 4, 6, 8}));
  const auto first = value_of(query_trajectory(sample_map(), {{"since", "4"}}))["poses"][0];
  EXPECT_NEAR(first["odometry"]["position"][0].get<double>(), 2.2, 1e-9);
  EXPECT_EQ(first["position"], (Json{2.0, 0.0, 1.0}));  // T_map_pelvis, not odometry
  EXPECT_EQ(error_of(query_trajectory(sample_map(), {{"since", "soon"}})).status, 400U);
}

TEST(QueryPose, IsTheOdometryCorrectedByTheMap) {
  EXPECT_EQ(error_of(query_pose(sample_map(), {}, 0.0)).status, 503U);
  const auto json = value_of(query_pose(sample_map(), test::body_at(3.5, {0.5, 0.25, 1.0}), 0.75));
  EXPECT_EQ(json["age"], 0.75);
  EXPECT_FALSE(json.contains("covariance"));
  auto map = sample_map();
  map.pelvis_covariance.emplace(Eigen::Matrix<double, 6, 6>::Identity() * 1.23456e-8);
  const auto covariance = value_of(query_pose(map, test::body_at(3.5, {0, 0, 1}), 0.0))["covariance"];
  ASSERT_EQ(covariance.size(), 6U);
  EXPECT_EQ(covariance[5], (Json{0.0, 0.0, 0.0, 0.0, 0.0, 1.2346e-8}));
  EXPECT_EQ(json["position"], (Json{1.5, 2.25, 1.0}));
  EXPECT_EQ(json["odometry"]["position"], (Json{0.5, 0.25, 1.0}));
  EXPECT_EQ(json["time"], 3.5);
}

TEST(QueryBody, HasEverySegmentInTheMapFrame) {
  EXPECT_EQ(error_of(query_body(sample_map(), {}, 0.0)).status, 503U);
  SuitFrame frame;
  for (std::size_t i = 0; i < kSegmentCount; ++i) frame.segments[i].p = {0.1 * static_cast<double>(i), 0, 1};
  const auto json = value_of(query_body(sample_map(), live_body_of(frame, 0.0), 0.0));
  ASSERT_EQ(json["segments"].size(), kSegmentCount);
  EXPECT_EQ(json["segments"][10], (Json{2.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(json["correction"]["position"], (Json{1.0, 2.0, 0.0}));
}

TEST(LevelDistance, IsZeroOverATableAndReachesAWallsNearestPoint) {
  EXPECT_EQ(level_distance(table(1, 0, 0), {0.9, -0.4}), 0.0);
  EXPECT_NEAR(level_distance(table(1, 0, 0), {2, 1.5}), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(level_distance(wall(1, 10, 0, 8), {9, 7}), 1.0, 1e-12);
  EXPECT_NEAR(level_distance(wall(1, 10, 0, 8), {13, 12}), 5.0, 1e-12);
  auto reversed = table(1, 0, 0);
  std::reverse(reversed.corners->begin(), reversed.corners->end());
  EXPECT_EQ(level_distance(reversed, {0.9, -0.4}), 0.0);
}

TEST(Url, PathAndParametersAreDecoded) {
  const auto target = parse_target("/api/v1/objects?type=wall&near=1%2C-2&name=a+b%20c&flag&&x=#fragment");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/api/v1/objects");
  EXPECT_EQ(target->params, (Params{{"type", "wall"}, {"near", "1,-2"}, {"name", "a b c"}, {"flag", ""}, {"x", ""}}));
  EXPECT_EQ(parse_target("/a+b%2Fc")->path, "/a+b/c");
  EXPECT_EQ(parse_target("/")->path, "/");
}

TEST(Url, BrokenEscapesAndControlCharactersAreRefused) {
  for (const char* bad :
       {"", "objects", "http://x/", "/%", "/%2", "/%zz", "/%+1", "/a%00b", "/a%0d%0ab", "/?a=%1", "/?%g0=1", "/?a=%-1"})
    EXPECT_FALSE(parse_target(bad)) << bad;
}

Routes some_routes() {
  Routes routes;
  for (const char* path : {"/", "/healthz", "/api/v1/map", "/api/v1/objects", "/api/v1/objects/{id}", "/file/{id}.txt"})
    routes.add({.path = path, .answer = [path](const Call& call) {
                  return reply_of(std::string(path) + " " + std::string(call.id));
                }});
  return routes;
}

TEST(Routes, APathFindsItsRoute) {
  const Routes routes = some_routes();
  const auto body = [&](std::string_view path) { return *routes.answer(path, {}).body; };
  EXPECT_EQ(body("/"), "/ ");
  EXPECT_EQ(body("/api/v1/objects"), "/api/v1/objects ");
  EXPECT_EQ(body("/api/v1/objects/17"), "/api/v1/objects/{id} 17");
  EXPECT_EQ(body("/file/a.txt"), "/file/{id}.txt a");
  for (const char* path : {"", "/api/v1/objects/", "/api/v1/objects/1/2", "/file/.txt", "/file/a", "/api/v1/map/"})
    EXPECT_EQ(routes.answer(path, {}).status, 404U) << path;
  EXPECT_EQ(routes.answer("/api/v1/map", {{"x", "1"}}).status, 400U);
}

TEST(Routes, AnUnknownPathIsToldTheNearest) {
  const Routes routes = some_routes();
  EXPECT_EQ(routes.unknown("/api/v1/mpa").nearest, "/api/v1/map");
  EXPECT_EQ(routes.unknown("/api/v2/objects").nearest, "/api/v1/objects");
  EXPECT_EQ(routes.unknown("/health").nearest, "/healthz");
  EXPECT_EQ(routes.unknown(std::string(100000, 'x')).message.size(),
            routes.unknown(std::string(80, 'x')).message.size());
}

TEST(ErrorText, IsJsonWhateverTheMessageHolds) {
  const auto json = Json::parse(error_text({404, "not_found", "a \"quote\" and a byte \xff"}));
  EXPECT_EQ(json["error"]["code"], "not_found");
}

}  // namespace
}  // namespace kinemap
