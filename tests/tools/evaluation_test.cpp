// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/evaluation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "core/assignment.hpp"
#include "tools/kinemap/alignment.hpp"
#include "tools/kinemap/shape.hpp"

namespace kinemap::eval {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;

TruthObject truth_object(std::uint32_t id, ObjectType type, const Pose& pose, std::array<double, 2> size) {
  return {id, type, class_of(type, size[0]), pose, size, std::nullopt};
}

/// The object of a map that is exactly the true one.
MapObject map_object(const TruthObject& truth) {
  MapObject object;
  object.id = truth.id + 100;
  object.type = truth.type;
  object.pose = truth.pose;
  if (truth.type == ObjectType::Chair) return object;
  object.size = truth.size;
  const double u = truth.size[0] / 2, v = truth.size[1] / 2;
  const bool level = truth.type == ObjectType::Table;
  object.plane = PlaneEquation{truth.pose.q * (level ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()), 0.0};
  object.corners.emplace();
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = i == 1 || i == 2 ? u : -u, b = i >= 2 ? v : -v;
    (*object.corners)[i] = truth.pose * (level ? Eigen::Vector3d(a, b, 0) : Eigen::Vector3d(0, a, b));
  }
  return object;
}

/// A room of 6 × 4 m with a table, two screens, two chairs, and a walk through it.
Truth room() {
  Truth truth;
  truth.objects = {truth_object(1, ObjectType::Wall, level_pose({3, 0, 1.25}, kPi / 2), {6, 2.5}),
                   truth_object(2, ObjectType::Wall, level_pose({6, 2, 1.25}, kPi), {4, 2.5}),
                   truth_object(3, ObjectType::Table, level_pose({3, 2, 0.74}, 0.4), {1.6, 0.8}),
                   truth_object(4, ObjectType::Screen, level_pose({0.02, 2, 1.4}, 0), {1.3, 0.8}),
                   truth_object(5, ObjectType::Screen, level_pose({3, 2, 1.0}, 0.4 + kPi / 2), {0.5, 0.3}),
                   truth_object(6, ObjectType::Chair, level_pose({3, 1, 0.45}, kPi / 2), {}),
                   truth_object(7, ObjectType::Chair, level_pose({4, 3, 0.45}, -kPi / 2), {})};
  for (int i = 0; i <= 40; ++i) {
    const double t = i * 0.5;
    truth.trajectory.push_back({t, level_pose({3 + 2 * std::cos(t), 2 + 1.5 * std::sin(t), 0.95}, t)});
  }
  return truth;
}

/// The map of one who made no error, in another frame.
MapSnapshot perfect_map(const Truth& truth, const Pose& T_map_truth) {
  MapSnapshot map;
  for (const TruthObject& object : truth.objects) {
    TruthObject moved = object;
    moved.pose = T_map_truth * object.pose;
    map.objects.push_back(map_object(moved));
  }
  for (const auto& [t, pose] : truth.trajectory) {
    const Pose moved = T_map_truth * pose;
    map.trajectory.push_back({static_cast<KeyPoseId>(map.trajectory.size()), t, moved, moved});
  }
  return map;
}

TEST(Assignment, MatchesBruteForce) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> cost(0.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    const int rows = 1 + round % 5, columns = 1 + round / 5 % 5, n = std::max(rows, columns);
    Eigen::MatrixXd m(rows, columns);
    for (double& value : m.reshaped()) value = cost(random) < 0.3 ? kInfinite : cost(random);
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::pair<int, double> best{0, 0.0};  // pairs (negative), cost
    do {
      std::pair<int, double> now{0, 0.0};
      for (int r = 0; r < rows; ++r)
        if (order[r] < columns && std::isfinite(m(r, order[r]))) now = {now.first - 1, now.second + m(r, order[r])};
      best = std::min(best, now);
    } while (std::next_permutation(order.begin(), order.end()));
    std::pair<int, double> found{0, 0.0};
    std::vector<int> used(columns, 0);
    const auto assignment = assign(m);
    for (int r = 0; r < rows; ++r) {
      if (!assignment[r]) continue;
      const auto c = static_cast<int>(*assignment[r]);
      EXPECT_EQ(used[c]++, 0) << "one column, two rows";
      found = {found.first - 1, found.second + m(r, c)};
    }
    EXPECT_EQ(found.first, best.first);
    EXPECT_NEAR(found.second, best.second, 1e-9);
  }
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0)).size(), 2U);
}

TEST(Alignment, RecoversAnyHeadingAndTranslation) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-5.0, 5.0);
  for (int round = 0; round < 50; ++round) {
    const Pose T = level_pose({any(random), any(random), any(random)}, any(random));
    std::vector<Eigen::Vector3d> a, b;
    for (int i = 0; i < 10; ++i) {
      a.emplace_back(any(random), any(random), any(random));
      b.push_back(T * a.back());
    }
    const auto found = align(a, b);
    ASSERT_TRUE(found);
    EXPECT_LT((found->p - T.p).norm(), 1e-9);
    EXPECT_LT(found->q.angularDistance(T.q), 1e-7);
    EXPECT_NEAR(rmse(*found, a, b), 0.0, 1e-9);
  }
}

TEST(Alignment, RefusesWhatHasNoHeading) {
  const std::vector<Eigen::Vector3d> one = {{1, 2, 3}}, same = {{1, 2, 3}, {1, 2, 3}}, upright = {{1, 2, 3}, {1, 2, 4}};
  EXPECT_FALSE(align(one, one));
  EXPECT_FALSE(align(same, same));
  EXPECT_FALSE(align(upright, upright));
}

TEST(Alignment, RmseOfAKnownOffset) {
  const std::vector<Eigen::Vector3d> a = {{0, 0, 0}, {1, 0, 0}}, b = {{0, 0, 0}, {1, 0, 2}};
  EXPECT_DOUBLE_EQ(rmse(Pose{}, a, b), std::sqrt(2.0));
}

TEST(Alignment, PositionBetweenSamples) {
  const std::vector<TimedPose> path = {{0.0, level_pose({0, 0, 1}, 0)}, {2.0, level_pose({4, 0, 1}, 0)}};
  EXPECT_EQ(pose_at(path, 0.5)->p, Eigen::Vector3d(1, 0, 1));
  EXPECT_EQ(pose_at(path, 2.0)->p, Eigen::Vector3d(4, 0, 1));
  EXPECT_FALSE(pose_at(path, 2.1));
  EXPECT_FALSE(pose_at(path, -0.1));
  EXPECT_FALSE(pose_at({}, 0.0));
}

TEST(Evaluation, APerfectMapInAnotherFrameHasNoError) {
  const Truth truth = room();
  const auto result = evaluate(perfect_map(truth, level_pose({7, -3, 1}, 2.1)), truth);
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->matches.size(), truth.objects.size());
  EXPECT_TRUE(result->missed.empty() && result->spurious.empty() && result->duplicates.empty());
  for (const Match& match : result->matches) {
    EXPECT_EQ(match.object_id, match.truth_id + 100);
    EXPECT_NEAR(match.mape_percent(), 0.0, 1e-9);
    EXPECT_NEAR(match.level_error_m, 0.0, 1e-9);
    EXPECT_NEAR(match.heading_error_rad, 0.0, 1e-7);
  }
  EXPECT_NEAR(result->rmse_optimised_m, 0.0, 1e-9);
  const Report report = summarise({*result});
  EXPECT_EQ(recall(report.total), 1.0);
  EXPECT_EQ(precision(report.total), 1.0);
}

TEST(Evaluation, MeasuresWhatIsWrong) {
  const Truth truth = room();
  MapSnapshot map = perfect_map(truth, Pose{});
  (*map.objects[0].size) = {5.4, 9.0};   // wall: 10 %; its height is not judged
  (*map.objects[2].size) = {0.88, 1.6};  // table, sides swapped: 0 % and 10 %
  map.objects[5].pose = level_pose({3.3, 1.4, 0.5}, kPi / 2 + 0.2);
  const auto result = evaluate(map, truth);
  ASSERT_TRUE(result) << result.error();
  const auto match = [&](std::uint32_t id) {
    return *std::find_if(result->matches.begin(), result->matches.end(),
                         [&](const Match& m) { return m.truth_id == id; });
  };
  EXPECT_NEAR(match(1).mape_percent(), 10.0, 1e-9);
  ASSERT_EQ(match(3).edge_errors_percent.size(), 2U);
  EXPECT_NEAR(match(3).mape_percent(), 5.0, 1e-9);
  EXPECT_TRUE(match(6).edge_errors_percent.empty());
  EXPECT_NEAR(match(6).level_error_m, 0.5, 1e-9);
  EXPECT_NEAR(match(6).height_error_m, 0.05, 1e-9);
  EXPECT_NEAR(match(6).heading_error_rad, 0.2, 1e-9);
}

TEST(Evaluation, CountsMissedFalseAndDoubleObjects) {
  const Truth truth = room();
  MapSnapshot map = perfect_map(truth, Pose{});
  map.objects.erase(map.objects.begin() + 3);  // the big screen is missed
  MapObject twin = map.objects[2];             // the table a second time, 30 cm off
  twin.id = 201;
  twin.pose.p.x() += 0.3;
  map.objects.push_back(twin);
  MapObject ghost = map.objects.back();
  ghost.id = 202;
  ghost.type = ObjectType::Chair;
  ghost.pose.p = {-20, 0, 0};
  map.objects.push_back(ghost);
  const auto result = evaluate(map, truth);
  ASSERT_TRUE(result) << result.error();
  EXPECT_EQ(result->missed, std::vector<std::uint32_t>{4});
  EXPECT_EQ(result->duplicates, std::vector<std::uint32_t>{201});
  EXPECT_EQ(result->spurious, std::vector<std::uint32_t>{202});
  const Report report = summarise({*result});
  EXPECT_EQ(report.total.truth, 7U);
  EXPECT_EQ(report.total.found, 6U);
  EXPECT_EQ(report.total.estimated, 8U);
  EXPECT_EQ(report.total.duplicates, 1U);
  EXPECT_DOUBLE_EQ(recall(report.classes[static_cast<std::size_t>(Class::BigScreen)].counts), 0.0);
  EXPECT_DOUBLE_EQ(precision(report.classes[static_cast<std::size_t>(Class::Table)].counts), 0.5);
}

TEST(Evaluation, OnlyTheSameKindAndFaceStandsForAnObject) {
  const Shape table = shape_of(truth_object(1, ObjectType::Table, level_pose({0, 0, 0.7}, 0), {1.6, 0.8}));
  Shape other = table;
  EXPECT_EQ(matching_cost(table, other), 0.0);
  other.type = ObjectType::Screen;
  EXPECT_EQ(matching_cost(table, other), kInfinite);
  other = table;
  other.centre.x() = 1.3;
  EXPECT_EQ(matching_cost(table, other), kInfinite);

  const Shape wall = shape_of(truth_object(2, ObjectType::Wall, level_pose({0, 0, 1.25}, 0), {4, 2.5}));
  Shape face = wall;
  face.centre = {0.1, 1.0, 1.25};
  EXPECT_NEAR(matching_cost(wall, face), 0.1 + 0.25, 1e-12);
  face.heading = kPi;  // the other face of a partition
  EXPECT_EQ(matching_cost(wall, face), kInfinite);
  face = wall;
  face.centre.y() = 4.1;  // the next wall along the same line
  EXPECT_EQ(matching_cost(wall, face), kInfinite);
}

TEST(Evaluation, HeadingsOfTablesHaveNoSense) {
  Shape table = shape_of(truth_object(1, ObjectType::Table, level_pose({0, 0, 0.7}, 0), {1.6, 0.8})), turned = table;
  turned.heading = kPi + 0.1;
  EXPECT_NEAR(heading_error(table, turned), 0.1, 1e-12);
  turned.heading = kPi / 2;
  EXPECT_NEAR(heading_error(table, turned), kPi / 2, 1e-12);
  table.size = {0.8, 0.8};
  EXPECT_NEAR(heading_error(table, turned), 0.0, 1e-12);
}

TEST(Evaluation, AnotherSessionsTruthIsRefused) {
  const Truth truth = room();
  MapSnapshot map = perfect_map(truth, Pose{});
  for (TrajectoryPose& pose : map.trajectory) pose.time_s += 1000.0;
  const auto result = evaluate(map, truth);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().find("0 of 41 poses"), std::string::npos) << result.error();
}

TEST(Evaluation, PoolsSessions) {
  const Truth truth = room();
  const auto good = evaluate(perfect_map(truth, Pose{}), truth);
  MapSnapshot map = perfect_map(truth, Pose{});
  (*map.objects[2].size) = {1.76, 0.88};
  const auto bad = evaluate(map, truth);
  const Report report = summarise({*good, *bad});
  const Spread& tables = report.classes[static_cast<std::size_t>(Class::Table)].mape_percent;
  EXPECT_EQ(tables.n, 2U);
  EXPECT_NEAR(tables.mean, 5.0, 1e-9);
  EXPECT_NEAR(tables.std, std::sqrt(50.0), 1e-9);
  EXPECT_EQ(report.rmse_optimised_m.n, 2U);
  EXPECT_NE(to_markdown(report).find("| table | 5.0 ± 7.1 | 5.0 | 2 / 2 |"), std::string::npos) << to_markdown(report);
  EXPECT_EQ(to_json(report)["classes"]["table"]["mape_percent"]["mean"], 5.0);
}

TEST(Consistency, ErrorsAreJudgedByTheSigmasOfTheMap) {
  const Truth truth = room();
  const Pose T_map_truth = level_pose({7, -3, 1}, 2.1);
  MapSnapshot map = perfect_map(truth, T_map_truth);
  MapObject& table = map.objects[2];
  *table.size = {1.66, 0.77};
  table.pose.p = T_map_truth * Eigen::Vector3d(3.04, 1.9, 0.74);
  table.sigma = {0.05, 0.1, {0.03, 0.015}};
  MapObject& wall = map.objects[0];
  wall.pose.p = T_map_truth * Eigen::Vector3d(2.0, 0.06, 1.25);  // sliding along it is no error
  wall.sigma.position_m = 0.02;
  const auto result = evaluate(map, truth);
  ASSERT_TRUE(result) << result.error();
  const NormalisedErrors& errors = result->matches[2].normalised;
  ASSERT_EQ(errors.size.size(), 2U);
  EXPECT_NEAR(errors.size[0], 2.0, 1e-9);
  EXPECT_NEAR(errors.size[1], -2.0, 1e-9);
  ASSERT_EQ(errors.position.size(), 2U);
  EXPECT_NEAR(errors.position[0], 0.8, 1e-9);
  EXPECT_NEAR(errors.position[1], -2.0, 1e-9);
  EXPECT_NEAR(errors.heading.at(0), 0.0, 1e-9);
  EXPECT_NEAR(result->matches[0].normalised.position.at(0), 3.0, 1e-9);
  EXPECT_TRUE(result->matches[0].normalised.size.empty()) << "the map does not say how certain it is";
}

TEST(Consistency, IsJudgedWhereTheTrajectoryBegins) {
  // A heading that drifts: the map is right where it begins and turns away from there.
  const Truth truth = room();
  MapSnapshot map = perfect_map(truth, Pose{});
  for (std::size_t i = 0; i < map.trajectory.size(); ++i)
    map.trajectory[i].T_map_pelvis.p += Eigen::Vector3d(0.02 * static_cast<double>(i), 0, 0);
  MapObject& chair = map.objects[5];
  chair.sigma.position_m = 0.1;
  chair.pose.p.x() += 0.4;
  const auto result = evaluate(map, truth);
  ASSERT_TRUE(result) << result.error();
  EXPECT_NEAR(result->matches[5].normalised.position[0], 4.0, 1e-9);
  EXPECT_LT(std::abs(result->matches[5].normalised.aligned_position[0]), 2.0) << "drift spread over the map";
}

TEST(Consistency, OfANormalSample) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> sample(20000);
  for (double& value : sample) value = normal(random);
  const Consistency c = consistency_of(sample);
  EXPECT_NEAR(c.within_1, 0.683, 0.01);
  EXPECT_NEAR(c.within_2, 0.954, 0.01);
  EXPECT_NEAR(c.mean, 0.0, 0.03);
  EXPECT_NEAR(c.rms, 1.0, 0.03);
  EXPECT_EQ(consistency_of({}).n, 0U);
}

/// Table 3 was touched at 10–20 s and 50–60 s, the table beside it, 8, at 30–40 s.
const std::vector<TruthVisit> kTwoTables = {{3, 10, 20}, {8, 30, 40}, {3, 50, 60}};

MapObject visited(std::uint32_t id, std::vector<Visit> visits) {
  MapObject object;
  object.id = id;
  object.visits = std::move(visits);
  return object;
}

TEST(Association, RightOnesAreLeftAlone) {
  const auto check =
      check_association({visited(1, {{9, 19}, {51, 62}}), visited(2, {{31, 39}})}, kTwoTables, {{1, 3}, {2, 8}});
  EXPECT_EQ(check.visits, 3U);
  EXPECT_TRUE(check.wrong.empty() && check.split.empty() && check.phantom.empty() && check.misplaced.empty());
}

TEST(Association, AWrongClosureIsTheVisitThatDoesNotBelong) {
  const auto check = check_association({visited(1, {{9, 19}, {31, 39}, {51, 62}})}, kTwoTables, {{1, 3}});
  ASSERT_EQ(check.wrong.size(), 1U);
  EXPECT_EQ(check.wrong[0].object_id, 1U);
  EXPECT_EQ(check.wrong[0].owner_id, 3U);
  EXPECT_EQ(check.wrong[0].visited_id, 8U);
  EXPECT_EQ(check.wrong[0].visit.begin_s, 31.0);
  // One visit each: it belongs to the one on which it lies.
  const auto even = check_association({visited(1, {{9, 19}, {31, 39}})}, kTwoTables, {{1, 8}});
  ASSERT_EQ(even.wrong.size(), 1U);
  EXPECT_EQ(even.wrong[0].owner_id, 8U);
}

TEST(Association, MissedClosuresGesturesThatMeanNothingAndSwappedObjects) {
  const auto check = check_association(
      {visited(1, {{9, 19}}), visited(2, {{51, 62}}), visited(5, {{42, 48}}), visited(6, {{32, 41}, {70, 71}})},
      kTwoTables, {{1, 3}, {6, 3}});
  EXPECT_EQ(check.split, std::vector<std::uint32_t>{2});
  EXPECT_EQ(check.phantom, std::vector<std::uint32_t>{5});
  EXPECT_EQ(check.misplaced, std::vector<std::uint32_t>{6});
  ASSERT_EQ(check.wrong.size(), 1U);
  EXPECT_FALSE(check.wrong[0].visited_id) << "nothing was touched at 70 s";
}

TEST(Association, IsNotJudgedWithoutTimes) {
  EXPECT_EQ(check_association({visited(1, {{9, 19}})}, {}, {}).visits, 0U);
  EXPECT_TRUE(check_association({visited(1, {})}, kTwoTables, {}).phantom.empty());
}

TEST(Spread, OfNothingOneAndMany) {
  EXPECT_EQ(spread_of({}).n, 0U);
  EXPECT_EQ(spread_of({3.0}).std, 0.0);
  const Spread many = spread_of({4.0, 1.0, 2.0, 9.0});
  EXPECT_EQ(many.mean, 4.0);
  EXPECT_EQ(many.median, 3.0);
  EXPECT_EQ(many.max, 9.0);
  EXPECT_NEAR(many.std, std::sqrt(38.0 / 3.0), 1e-12);
}

nlohmann::json truth_json() {
  return {{"format", "kinemap/truth"},
          {"version", 1},
          {"objects",
           {{{"id", 1},
             {"type", "screen"},
             {"class", "big"},
             {"size", {0.9, 0.5}},
             {"pose", {{"position", {1, 2, 3}}, {"orientation", {1, 0, 0, 0}}}}},
            {{"id", 2}, {"type", "chair"}, {"pose", {{"position", {1, 2, 3}}, {"orientation", {1, 0, 0, 0}}}}}}},
          {"unvisited", nlohmann::json::array()},
          {"trajectory", {{0, 1, 2, 3, 1, 0, 0, 0}, {1, 1, 2, 3, 1, 0, 0, 0}}}};
}

TEST(Truth, Reads) {
  const auto truth = truth_from_text(truth_json().dump());
  ASSERT_TRUE(truth) << truth.error();
  EXPECT_EQ(truth->objects[0].klass, Class::BigScreen) << "the truth's own word counts, not the size";
  EXPECT_EQ(truth->objects[1].klass, Class::Chair);
  EXPECT_EQ(truth->trajectory[1].pose.p, Eigen::Vector3d(1, 2, 3));
}

TEST(Truth, VisitsAreTheContactsWhereTheyAreKnown) {
  nlohmann::json json = truth_json();
  json["intervals"] = {
      {{"begin", 1}, {"end", 2}, {"label", "walk"}},
      {{"begin", 2}, {"end", 9}, {"label", "trace"}, {"object", 1}, {"contact_begin", 3}, {"contact_end", 8}},
      {{"begin", 9}, {"end", 12}, {"label", "sit"}, {"object", 2}}};
  const auto truth = truth_from_text(json.dump());
  ASSERT_TRUE(truth) << truth.error();
  ASSERT_EQ(truth->visits.size(), 2U);
  EXPECT_EQ(truth->visits[0].begin_s, 3.0);
  EXPECT_EQ(truth->visits[0].end_s, 8.0);
  EXPECT_EQ(truth->visits[1].object, 2U);
  EXPECT_EQ(truth->visits[1].end_s, 12.0);
}

TEST(Truth, ErrorsNameTheKeyPath) {
  const std::tuple<const char*, nlohmann::json, const char*> cases[] = {
      {"/format", "kinemap/map", "format: expected \"kinemap/truth\""},
      {"/version", 7, "version: this program reads version 1"},
      {"/objects/1/type", "sofa", "objects[1].type: unknown object type \"sofa\""},
      {"/objects/0/class", "huge", "objects[0].class: expected \"big\" or \"small\""},
      {"/objects/0/size", nlohmann::json::array({0, 1}), "objects[0].size: expected two lengths > 0"},
      {"/trajectory/1", nlohmann::json::array({1, 2}), "trajectory[1]: expected an array of 8"},
      {"/trajectory/1/0", 0, "trajectory[1]: expected ascending times"},
  };
  for (const auto& [pointer, value, expected] : cases) {
    nlohmann::json json = truth_json();
    json[nlohmann::json::json_pointer(pointer)] = value;
    const auto truth = truth_from_text(json.dump());
    ASSERT_FALSE(truth) << pointer;
    EXPECT_EQ(truth.error(), expected);
  }
}

}  // namespace
}  // namespace kinemap::eval
