// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/events.hpp"
#include "core/pose.hpp"

namespace kinemap {

enum class ObjectType : std::uint8_t { Wall, Table, Screen, Chair };

/// Lower-case name used in the map JSON and on the command line ("wall", …).
const char* to_string(ObjectType type);
std::optional<ObjectType> object_type_from(const std::string& name);

/// Why a wall ends where it does.
enum class EndKind : std::uint8_t {
  Corner,    ///< it meets the next wall
  Inferred,  ///< it meets a wall that nobody touched, but that must be there
  Open       ///< so far it was touched or walked along; nobody knows what comes then: the wall may be longer
};
const char* to_string(EndKind kind);  ///< "corner", "inferred", "open"
std::optional<EndKind> end_kind_from(const std::string& name);

struct PlaneEquation {
  Eigen::Vector3d normal;  ///< unit, map frame; towards the side from which the surface was touched
  double offset = 0.0;     ///< n·p = offset, m
};

/// One standard deviation each, from the graph's marginal covariance.
struct ObjectSigma {
  double position_m = 0.0;
  double heading_rad = 0.0;
  std::array<double, 2> size_m{0.0, 0.0};
};

/// When an object was traced or sat on once, stream time, s.
struct Visit {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// One object of the map, in the map frame (z up, metres); protocol/README.md gives the same fields in JSON.
struct MapObject {
  std::uint32_t id = 0;
  ObjectType type = ObjectType::Wall;
  std::vector<std::string> functions;  ///< what it is for: "sit", "place", "view", "bound"
  Pose pose;                           ///< centre; chair: seat centre at seat height, +x where the sitter faces
  std::optional<PlaneEquation> plane;
  std::optional<std::array<Eigen::Vector3d, 4>> corners;  ///< in order round the rectangle
  std::optional<std::array<double, 2>> size;              ///< [long, short], walls [length, height], m
  ObjectSigma sigma;
  int observations = 0;
  double first_seen_s = 0.0;
  double last_seen_s = 0.0;
  std::vector<Visit> visits;                   ///< by ascending time; empty: not known
  bool height_assumed = false;                 ///< walls: the height was not observed
  std::optional<std::array<EndKind, 2>> ends;  ///< walls: at corners[0] and at corners[1]

  /// A wall of which an end was not seen: `size` is the least that it can be.
  [[nodiscard]] bool open_ended() const { return ends && ((*ends)[0] == EndKind::Open || (*ends)[1] == EndKind::Open); }
};

/// A closed ring of walls, seen from inside. Side k goes from corner k to the next one.
struct Room {
  std::uint32_t id = 0;
  std::vector<Eigen::Vector2d> polygon;  ///< counter-clockwise, map frame, m
  double area_m2 = 0.0;
  double height_m = 0.0;
  bool height_assumed = true;
  std::vector<std::uint32_t> wall_ids;
  std::vector<std::size_t> inferred_sides;  ///< sides where nobody touched a wall, but one must be; ascending
};

/// Where the wearer walked through a wall.
struct Doorway {
  Eigen::Vector2d position;             ///< middle of the ways through it, map frame, m
  double heading_rad = 0.0;             ///< of a way through it
  std::vector<std::uint32_t> room_ids;  ///< the known rooms that it joins, ascending; none to two
};

/// How far the odometry from one key pose to the next may be off: one standard deviation each, in the first one's
/// frame. All 0: not known.
struct StepSigma {
  double level_m = 0.0;  ///< forward and sideways, each
  double up_m = 0.0;
  double tilt_rad = 0.0;  ///< roll and pitch, each
  double heading_rad = 0.0;
};

struct TrajectoryPose {
  KeyPoseId id = 0;
  double time_s = 0.0;
  Pose T_map_pelvis;
  Pose T_odom_pelvis;
  StepSigma step{};  ///< from the key pose before; the first one has none
};

/// A trace that was neither wall nor rectangle, kept so that nothing is dropped in silence.
struct UnresolvedTrace {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string reason;
};

/// Part of the right hand that touches.
enum class HandPart : std::uint8_t { Tips, Palm };
const char* to_string(HandPart part);  ///< "tips", "palm"
std::optional<HandPart> hand_part_from(const std::string& name);

/// With what the wearer touches, as the contacts (and pivot gestures) tell.
struct TouchingHand {
  HandPart part = HandPart::Tips;
  double probability = 0.0;                          ///< of that part, 0.5 … 1
  Eigen::Vector3d p_hand = Eigen::Vector3d::Zero();  ///< touching point in the hand segment's frame (origin: wrist), m
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Zero();
};

/// Who drew, and with what.
struct MapWearer {
  std::string name;                 ///< as the suit says; may be empty
  std::optional<double> stature_m;  ///< body height as the bone lengths give it away
  TouchingHand hand;
};

struct GraphSummary {
  std::size_t key_poses = 0;
  std::size_t landmarks = 0;
  std::size_t contacts = 0;
  std::size_t loop_closures = 0;          ///< observations associated with an object that was there
  std::size_t loop_closures_revoked = 0;  ///< closures that the optimum contradicted, taken back
  std::size_t optimisations = 0;
  std::size_t optimisations_failed = 0;
  double last_cost = 0.0;
};

/// Everything the mapper knows at one instant. Immutable once published; shared between threads by shared_ptr<const
/// MapSnapshot>.
struct MapSnapshot {
  std::uint64_t revision = 0;      ///< grows by one at each publication
  double time_s = 0.0;             ///< stream time of the newest event in it
  std::vector<MapObject> objects;  ///< by ascending id
  std::vector<Room> rooms;
  std::vector<Doorway> doorways;
  std::vector<TrajectoryPose> trajectory;
  std::vector<UnresolvedTrace> unresolved;
  Pose T_map_odom;  ///< live correction: T_map_pelvis = T_map_odom * T_odom_pelvis
  /// Of the newest key pose: position (m) and rotation vector (rad) about the pelvis, both in the map's axes.
  std::optional<Eigen::Matrix<double, 6, 6>> pelvis_covariance;
  std::optional<TouchingHand> hand;  ///< of who drew last; absent until something was touched
  std::vector<MapWearer> wearers;    ///< in the order in which they came; empty while there was one alone
  GraphSummary graph;
};

}  // namespace kinemap
