// SPDX-License-Identifier: BSD-3-Clause
#include "plans/document.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "kinematics/angles.h"
#include "plans/refuse.h"
#include "plans/variables.h"

namespace fcl_artic::plans {
namespace {

constexpr int kDeepestMessage = 20;  // messages within messages
constexpr double kFlat = 1e-6;       // of a planar joint's pose: m out of its plane, and part of the quaternion
constexpr double kIdentity = 1e-9;   // a pose that nobody has to know of

/// The start state in a message.
struct Start {
  std::map<std::string, double> state;
  std::vector<Carried> carried;
  std::vector<std::string> notes;
};

std::string shown(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= 40 ? text : text.substr(0, 37) + "...";
}

/// Keys under which a message holds another one, or several.
constexpr std::initializer_list<const char*> kInner{"trajectory", "planned_trajectory", "goal", "msg"};
constexpr const char* kRecorded = "executed_trajectory";  // of a move_group's result: no plan

/// The value of the first of the keys that an object has; null if it has none.
const Json* find(const Json& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const auto found = object.find(key);
    if (found != object.end()) return &*found;
  }
  return nullptr;
}

bool isEmptyText(const Json& value) {
  return value.is_string() && value.get_ref<const std::string&>().empty();
}

bool areRows(const Json& value) {
  return value.is_array() && !value.empty() && value[0].is_array() && !value[0].empty() && value[0][0].is_number();
}

/// Whether a value is a plan, or holds one, however deep: there is a waypoint in it.
bool holdsPlan(const Json& value) {
  if (value.is_array()) return std::any_of(value.begin(), value.end(), holdsPlan);
  if (!value.is_object()) return false;
  for (const char* list : {"points", "waypoints"}) {
    const Json* rows = find(value, {list});
    if (rows && rows->is_array() && !rows->empty()) return true;
  }
  if (find(value, {"from", "start"}) && find(value, {"to", "goal"})) return true;
  return std::any_of(value.begin(), value.end(), holdsPlan);
}

/// The keys of an object that have plans, or are parts of one. The parts of one plan count once, by the first of them.
std::vector<std::string> plansIn(const Json& object) {
  static const std::set<std::string> kParts{"joint_trajectory", "multi_dof_joint_trajectory"},
      kEnds{"waypoints", "from", "start", "to", "goal"}, kLists{"trajectory", "planned_trajectory", "msg", "plans"},
      kOthers{"trajectory_start", "start_state", "multi_dof_trajectory", kRecorded};
  std::vector<std::string> out;
  bool parts = false, ends = false;
  for (const auto& [key, value] : object.items()) {
    if (kOthers.count(key)) continue;
    const bool inside = holdsPlan(value), end = kEnds.count(key) && !(key == "goal" && inside);
    const bool points = key == "points" && value.is_array() && !value.empty();
    if (!(inside || end || points || (kLists.count(key) && areRows(value)))) continue;
    bool* once = end ? &ends : kParts.count(key) ? &parts : nullptr;
    if (once && *once) continue;
    if (once) *once = true;
    out.push_back(key);
  }
  return out;
}

const Json& listOf(const Json& object, const char* key, const std::string& where) {
  static const Json none = Json::array();
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return none;
  if (!found->is_array()) refuse(fmt::format("{}: '{}' is no list: {}", where, key, shown(*found)));
  return *found;
}

double numberOf(const Json& value, const std::string& where) {
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) {
    const std::string text = value.get<std::string>();
    if (text == "NaN" || text == "nan") return std::numeric_limits<double>::quiet_NaN();
    if (text == "Infinity" || text == "inf") return std::numeric_limits<double>::infinity();
    if (text == "-Infinity" || text == "-inf") return -std::numeric_limits<double>::infinity();
    if (text == "...") refuse(where + ": the list was cut short by who printed it (ros2 topic echo --full-length)");
  }
  refuse(fmt::format("{}: {} is not a number", where, shown(value)));
}

/// Refuses keys that are not read and may be a place or motion: a slip, a unit, a key of another message.
/// @param known  both of them.
void requireKnown(const Json& object, const std::string& where, const std::vector<std::string_view>& known) {
  for (const auto& item : object.items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    refuse(fmt::format("{}{}the key '{}' is not known", where, where.empty() ? "" : ": ", item.key()));
  }
}

/// Refuses two keys that mean the same: whoever gives both means one.
void refuseTwo(const Json& value, std::initializer_list<const char*> keys) {
  const char* first = nullptr;
  for (const char* key : keys) {
    if (!value.contains(key)) continue;
    if (first) refuse(fmt::format("has both '{}' and '{}'", first, key));
    first = key;
  }
}

std::vector<double> numbersOf(const Json& list, const std::string& where) {
  if (list.is_null()) return {};
  if (!list.is_array()) refuse(fmt::format("{}: {} is no list of numbers", where, shown(list)));
  std::vector<double> out;
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(numberOf(list[i], fmt::format("{}, value {}", where, i)));
  return out;
}

std::vector<std::string> textsOf(const Json& list, const std::string& where) {
  if (!list.is_array()) refuse(fmt::format("{}: {} is no list of names", where, shown(list)));
  std::vector<std::string> out;
  for (const Json& value : list) {
    if (!value.is_string()) refuse(fmt::format("{}: {} is no name", where, shown(value)));
    out.push_back(value.get<std::string>());
  }
  return out;
}

/// Seconds: {sec, nanosec} (ROS 2), {secs, nsecs} (ROS 1), or a number.
double secondsOf(const Json& duration, const std::string& where) {
  if (!duration.is_object()) return numberOf(duration, where);
  const Json *whole = find(duration, {"sec", "secs"}), *part = find(duration, {"nanosec", "nsecs"});
  if (!whole || !part || duration.size() != 2)
    refuse(fmt::format("{}: {} is not sec and nanosec", where, shown(duration)));
  const double nanoseconds = numberOf(*part, where);
  if (!(std::abs(nanoseconds) < 1e9)) refuse(fmt::format("{}: {} nanoseconds", where, shown(*part)));
  return numberOf(*whole, where) + 1e-9 * nanoseconds;
}

/// A pose as the values of a joint: x, y, z and a quaternion x, y, z, w.
std::vector<double> poseOf(const Json& transform, const std::string& where) {
  const auto part = [&](const char* key, std::initializer_list<const char*> entries, std::vector<double>& out) {
    const Json* values = transform.is_object() ? find(transform, {key}) : nullptr;
    if (!values || !values->is_object()) refuse(fmt::format("{}: no '{}' in {}", where, key, shown(transform)));
    for (const char* entry : entries) {
      const Json* value = find(*values, {entry});
      if (!value) refuse(fmt::format("{}: no '{}' in {}", where, entry, shown(*values)));
      out.push_back(numberOf(*value, where));
    }
  };
  std::vector<double> pose;
  if (transform.is_object()) requireKnown(transform, where, {"translation", "rotation"});
  part("translation", {"x", "y", "z"}, pose);
  part("rotation", {"x", "y", "z", "w"}, pose);
  return pose;
}

/// A joint that moves by poses, and the names of its variables.
struct PoseJoint {
  JointType type;
  std::string parent;  ///< the link that it moves against
  std::vector<std::string> variables;
};

PoseJoint poseJoint(const KinematicTree& tree, const std::string& name, const std::string& where) {
  if (const JointId j = tree.findJoint(name); j >= 0) {
    const Joint& joint = tree.joint(j);
    if (joint.type != JointType::planar && joint.type != JointType::floating) {
      refuse(fmt::format("{}: joint '{}' of robot '{}' is neither planar nor floating", where, name, tree.name()));
    }
    PoseJoint out{joint.type, joint.parent, {}};
    for (int i = 0; i < tree.numVariables(j); ++i) {
      out.variables.push_back(tree.variableName(tree.jointVariable(j) + i));
    }
    return out;
  }
  refuse(
      fmt::format("{}: robot '{}' has no planar or floating joint '{}': an SRDF's virtual_joint of this name moves its "
                  "base (--srdf, --virtual-joint)",
                  where, tree.name(), name));
}

/// Poses are those of a joint against its parent link. A frame_id must be that link's, or, as in MoveIt's messages, the
/// root's. (MoveIt transforms poses from other frames, as it knows where these stand.)
void requireFrame(const KinematicTree& tree, const Json& message, const PoseJoint& joint, const std::string& name,
                  const std::string& where) {
  const Json* header = find(message, {"header"});
  const Json* frame = header && header->is_object() ? find(*header, {"frame_id"}) : nullptr;
  const bool is_root = frame && *frame == tree.linkName(tree.topologicalOrder().front());
  if (!frame || isEmptyText(*frame) || *frame == joint.parent || is_root) return;
  refuse(
      fmt::format("{}: its poses are in the frame {} (header, frame_id), and joint '{}' moves against '{}': give them "
                  "in that, or no frame",
                  where, shown(*frame), name, joint.parent));
}

/// Values of the joint's variables at a pose.
std::vector<double> valuesAt(const PoseJoint& joint, const std::vector<double>& pose, const std::string& where) {
  if (joint.type == JointType::floating) return pose;
  if (!(std::abs(pose[2]) <= kFlat && std::abs(pose[3]) <= kFlat && std::abs(pose[4]) <= kFlat)) {
    refuse(where + ": the pose leaves the plane of the planar joint");
  }
  return {pose[0], pose[1], 2 * std::atan2(pose[5], pose[6])};
}

bool isMimic(const KinematicTree& tree, const std::string& name) {
  const JointId j = tree.findJoint(name);
  return j >= 0 && tree.joint(j).mimics;
}

bool isJoint(const KinematicTree& tree, const std::string& name) {
  return tree.findJoint(name) >= 0;
}

/// Checks that mimic joints stand where the joints that they follow have them, here and all along the plan.
void requireFollowing(const KinematicTree& tree, const std::map<std::string, double>& followers, const Start& start,
                      const std::string& where) {
  Eigen::VectorXd q = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) {
    const auto value = start.state.find(tree.variableName(v));
    if (value != start.state.end()) q[v] = value->second;
  }
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const Joint& joint = tree.joint(j);
    const auto value = followers.find(joint.name);
    if (value == followers.end()) continue;
    if (!start.state.count(joint.mimic.master)) {
      refuse(fmt::format("{}: joint '{}' is at {}, and the joint that it mimics, '{}', has no value there", where,
                         joint.name, value->second, joint.mimic.master));
    }
    const double wanted = tree.jointValue(j, q);
    if (std::abs(value->second - wanted) <= kSameValue) continue;
    refuse(fmt::format("{}: joint '{}' is at {}, where the joint that it mimics, '{}', has it at {}", where, joint.name,
                       value->second, joint.mimic.master, wanted));
  }
}

/// moveit_msgs/RobotState. Names that the robot lacks are noted.
Start startOf(const KinematicTree& tree, const Json& robot_state) {
  Start start;
  const std::string where = "trajectory_start";
  if (!robot_state.is_object()) refuse(where + " is no object");
  requireKnown(robot_state, where, {"joint_state", "multi_dof_joint_state", "attached_collision_objects", "is_diff"});
  for (const char* key : {"joint_state", "multi_dof_joint_state"}) {
    const Json* part = find(robot_state, {key});
    if (part && !part->is_object() && !part->is_null())
      refuse(fmt::format("{}: '{}' is no object: {}", where, key, shown(*part)));
  }
  if (const Json* joints = find(robot_state, {"joint_state"}); joints && joints->is_object()) {
    requireKnown(*joints, where, {"header", "name", "position", "velocity", "effort"});
    const std::vector<std::string> names = textsOf(listOf(*joints, "name", where), where);
    const std::vector<double> values = numbersOf(listOf(*joints, "position", where), where + ", position");
    if (names.size() != values.size()) {
      refuse(fmt::format("{}: {} positions of {} joints", where, values.size(), names.size()));
    }
    std::map<std::string, double> followers;
    std::set<std::string> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!seen.insert(names[i]).second) refuse(fmt::format("{}: joint '{}' is there twice", where, names[i]));
      if (isVariable(tree, names[i])) start.state[names[i]] = values[i];
      if (isMimic(tree, names[i])) followers[names[i]] = values[i];
      if (!isJoint(tree, names[i]) && !isVariable(tree, names[i])) {
        start.notes.push_back(fmt::format("{} has a joint '{}', which the robot lacks", where, names[i]));
      }
    }
    requireFollowing(tree, followers, start, where);
  }
  if (const Json* poses = find(robot_state, {"multi_dof_joint_state"}); poses && poses->is_object()) {
    requireKnown(*poses, where, {"header", "joint_names", "transforms", "twist", "wrench"});
    const std::vector<std::string> names = textsOf(listOf(*poses, "joint_names", where), where);
    const Json& transforms = listOf(*poses, "transforms", where);
    if (names.size() != transforms.size()) {
      refuse(fmt::format("{}: {} transforms of {} joints", where, transforms.size(), names.size()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::vector<double> pose = poseOf(transforms[i], where);
      if (isJoint(tree, names[i])) {
        const PoseJoint joint = poseJoint(tree, names[i], where);
        requireFrame(tree, *poses, joint, names[i], where);
        const std::vector<double> values = valuesAt(joint, pose, where);
        for (std::size_t v = 0; v < values.size(); ++v) start.state[joint.variables[v]] = values[v];
        continue;
      }
      const bool moved =
          std::any_of(pose.begin(), pose.begin() + 6, [](double x) { return !(std::abs(x) <= kIdentity); });
      if (moved) {
        refuse(
            fmt::format("{}: joint '{}', which the robot lacks, is not at the identity: where the robot stands is "
                        "said by --base, or it moves by an SRDF's virtual_joint of this name (--virtual-joint)",
                        where, names[i]));
      }
    }
  }
  for (const Json& object : listOf(robot_state, "attached_collision_objects", where)) {
    const Json* body = object.is_object() ? find(object, {"object"}) : nullptr;
    const Json* id = body && body->is_object() ? find(*body, {"id"}) : nullptr;
    const Json* link = object.is_object() ? find(object, {"link_name"}) : nullptr;
    start.carried.push_back({id && id->is_string() ? id->get<std::string>() : "",
                             link && link->is_string() ? link->get<std::string>() : ""});
  }
  return start;
}

/// Adds a row of velocities or accelerations: all points must have them, or none.
void addRates(const Json& point, const char* key, std::size_t k, std::size_t joints, Plan::Rows& rows) {
  const std::string where = fmt::format("waypoint {}", k);
  const std::vector<double> values = numbersOf(listOf(point, key, where), fmt::format("{}, {}", where, key));
  if (values.empty() != (k > 0 && rows.empty()) && k > 0) {
    refuse(fmt::format("{} has {}{}, the one before has{}", where, values.empty() ? "no " : "", key,
                       values.empty() ? "" : " none"));
  }
  if (values.empty()) return;
  if (values.size() != joints) refuse(fmt::format("{} has {} {} for {} joints", where, values.size(), key, joints));
  rows.push_back(values);
}

const Json& pointAt(const Json& points, std::size_t k) {
  if (points[k].is_object()) return points[k];
  if (points[k] == "...")
    refuse(fmt::format("waypoint {}: the list was cut short by who printed it (ros2 topic echo --full-length)", k));
  refuse(fmt::format("waypoint {}: {} is no point", k, shown(points[k])));
}

double timeAt(const Json& point, std::size_t k) {
  const Json* time = find(point, {"time_from_start"});
  if (!time) refuse(fmt::format("waypoint {} has no time_from_start", k));
  return secondsOf(*time, fmt::format("waypoint {}, time_from_start", k));
}

/// Keys of both kinds of trajectory, and those that may stand beside them where it is a plan itself.
const std::vector<std::string_view> kTrajectory{"header", "joint_names", "points", "name", "id", "state"};

/// trajectory_msgs/JointTrajectory.
void addJoints(const Json& message, Plan& plan) {
  requireKnown(message, "joint_trajectory", kTrajectory);
  const Json& points = listOf(message, "points", "joint_trajectory");
  plan.joints = textsOf(listOf(message, "joint_names", "joint_trajectory"), "joint_names");
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Json& point = pointAt(points, k);
    plan.times.push_back(timeAt(point, k));
    const std::string where = fmt::format("waypoint {}", k);
    requireKnown(point, where, {"positions", "velocities", "accelerations", "effort", "time_from_start"});
    plan.positions.push_back(numbersOf(listOf(point, "positions", where), where + ", positions"));
    addRates(point, "velocities", k, plan.joints.size(), plan.velocities);
    addRates(point, "accelerations", k, plan.joints.size(), plan.accelerations);
  }
}

/// trajectory_msgs/MultiDOFJointTrajectory, beside what the plan has.
void addPoses(const KinematicTree& tree, const Json& message, Plan& plan) {
  requireKnown(message, "multi_dof_joint_trajectory", kTrajectory);
  const Json& points = listOf(message, "points", "multi_dof_joint_trajectory");
  const std::vector<std::string> names =
      textsOf(listOf(message, "joint_names", "multi_dof_joint_trajectory"), "joint_names");
  std::vector<PoseJoint> joints;
  for (const std::string& name : names) {
    joints.push_back(poseJoint(tree, name, "multi_dof_joint_trajectory"));
    requireFrame(tree, message, joints.back(), name, "multi_dof_joint_trajectory");
  }
  if (points.empty()) return;
  const bool first = plan.positions.empty();
  if (!first && plan.positions.size() != points.size()) {
    refuse(fmt::format("{} points of joint_trajectory, {} of multi_dof_joint_trajectory", plan.positions.size(),
                       points.size()));
  }
  if (!plan.velocities.empty()) refuse("velocities beside a multi_dof_joint_trajectory, whose own are not read");
  for (const PoseJoint& joint : joints) {
    plan.joints.insert(plan.joints.end(), joint.variables.begin(), joint.variables.end());
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Json& point = pointAt(points, k);
    const std::string where = fmt::format("waypoint {}", k);
    requireKnown(point, where, {"transforms", "velocities", "accelerations", "time_from_start"});
    const double time = timeAt(point, k);
    if (first) {
      plan.times.push_back(time);
      plan.positions.emplace_back();
    } else if (time != plan.times[k]) {
      refuse(fmt::format("{}: two times, {} and {}", where, plan.times[k], time));
    }
    for (const char* key : {"velocities", "accelerations"}) {
      if (!listOf(point, key, where).empty()) {
        refuse(fmt::format("{}: {} of a multi_dof_joint_trajectory are not read", where, key));
      }
    }
    const Json& transforms = listOf(point, "transforms", where);
    if (transforms.size() != names.size()) {
      refuse(fmt::format("{} has {} transforms for {} joints", where, transforms.size(), names.size()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string here = fmt::format("{}, joint '{}'", where, names[i]);
      const std::vector<double> values = valuesAt(joints[i], poseOf(transforms[i], here), here);
      plan.positions[k].insert(plan.positions[k].end(), values.begin(), values.end());
    }
  }
}

/// Forgets times that are all 0: nobody has timed such a message.
void forgetNoTimes(Plan& plan) {
  const bool none = std::all_of(plan.times.begin(), plan.times.end(), [](double t) { return t == 0; });
  if (plan.times.size() < 2 || !none) return;
  plan.times.clear();
  plan.notes.emplace_back("all times are 0: waypoints are numbered instead");
}

class Reader {
 public:
  Reader(const KinematicTree& tree, std::vector<Plan>& out) : tree_(tree), out_(out) {}

  void read(const Json& value, const std::string& label, const Start& start, int depth) {
    if (depth > kDeepestMessage) return fail(label, "too many messages within messages");
    if (value.is_array()) return readList(value, label, start, depth);
    if (!value.is_object()) return fail(label, fmt::format("{} is no plan", shown(value)));
    if (const Json* model = find(value, {"model_id"}); model && !isEmptyText(*model) && *model != tree_.name()) {
      return fail(label, fmt::format("the message is for the robot {} (model_id), and this one is '{}': --robot takes "
                                     "the message's",
                                     shown(*model), tree_.name()));
    }
    if (const std::vector<std::string> plans = plansIn(value); plans.size() > 1) {
      return fail(label, fmt::format("it holds more than one plan, in '{}' and in '{}': give each an object of its own",
                                     plans[0], plans[1]));
    }
    if (find(value, {"waypoints", "from", "start"})) {
      return add(label, start, [&](Plan& plan) { readPlan(value, plan); });
    }
    try {
      if (const Json* plans = find(value, {"plans"})) {
        requireKnown(value, "", {"plans", "name", "id"});
        return read(*plans, label, start, depth + 1);
      }
      if (find(value, {"joint_trajectory", "multi_dof_joint_trajectory", "points"})) {
        return add(label, start, [&](Plan& plan) { readMessage(value, plan); });
      }
      if (find(value, kInner)) return readOuter(value, label, start, depth);
    } catch (const std::invalid_argument& error) {
      return fail(label, error.what());
    }
    std::string keys;
    for (const auto& item : value.items()) keys += (keys.empty() ? "" : ", ") + item.key();
    fail(label, fmt::format("no plan in it: none of joint_trajectory, points, trajectory, waypoints, from; its keys "
                            "are: {}",
                            keys.empty() ? "none" : keys));
  }

 private:
  void fail(const std::string& label, const std::string& error) {
    Plan& plan = out_.emplace_back();
    plan.name = label;
    plan.error = error;
  }

  /// Reads a message that holds one with a motion. Other keys beside it are accepted if they are no place and no motion
  /// of this plan.
  void readOuter(const Json& value, const std::string& label, const Start& start, int depth) {
    refuseTwo(value, {"trajectory", "planned_trajectory", "goal", "msg"});
    refuseTwo(value, {"trajectory_start", "start_state"});
    requireKnown(value, "",
                 {"trajectory",
                  "planned_trajectory",
                  "goal",
                  "msg",
                  "trajectory_start",
                  "start_state",
                  "multi_dof_trajectory",  // read below
                  "header",
                  "model_id",
                  "group_name",
                  "planning_time",
                  "error_code",
                  "executed_trajectory",
                  "goal_id",
                  "controller_names",
                  "path_tolerance",
                  "goal_tolerance",
                  "component_path_tolerance",
                  "component_goal_tolerance",
                  "goal_time_tolerance",
                  "topic",
                  "timestamp",
                  "type",
                  "name",
                  "id"});
    const Json& inner = *find(value, kInner);
    Start own = start;
    if (find(value, {kRecorded})) own.notes.push_back(fmt::format("{}, which was recorded, is not read", kRecorded));
    if (const Json* state = find(value, {"trajectory_start", "start_state"})) own = startOf(tree_, *state);
    const Json* poses = find(value, {"multi_dof_trajectory"});
    if (!poses) return readParts(inner, label, own, depth + 1);
    // A goal of FollowJointTrajectory has the two trajectories of a RobotTrajectory.
    const Json both{{"joint_trajectory", inner}, {"multi_dof_joint_trajectory", *poses}};
    add(label, own, [&](Plan& plan) { readMessage(both, plan); });
  }

  template <class Fill>
  void add(const std::string& label, const Start& start, const Fill& fill) {
    Plan& plan = out_.emplace_back();
    plan.name = label;
    plan.state = start.state;
    plan.carried = start.carried;
    plan.notes = start.notes;
    try {
      fill(plan);
    } catch (const std::exception& error) {
      plan.error = error.what();
    }
  }

  void readList(const Json& list, const std::string& label, const Start& start, int depth) {
    if (areRows(list)) {
      return add(label, start, [&](Plan& plan) { Rows(plan).add(list, "", plan.positions); });
    }
    if (list.empty()) return fail(label, "an empty list");
    for (std::size_t i = 0; i < list.size(); ++i) read(list[i], fmt::format("{}[{}]", label, i), start, depth + 1);
  }

  /// Reads one message, or several that are carried out one after the other: each begins where the one before has left
  /// the robot.
  void readParts(const Json& message, const std::string& label, const Start& start, int depth) {
    if (!message.is_array() || message.size() == 1) {
      return read(message.is_array() ? message[0] : message, label, start, depth);
    }
    if (message.empty()) return fail(label, "a message without a trajectory");
    Start now = start;
    const std::size_t first = out_.size();
    for (std::size_t i = 0; i < message.size(); ++i) {
      const std::size_t begin = out_.size();
      read(message[i], fmt::format("{}[{}]", label, i), now, depth);
      for (std::size_t p = begin; p < out_.size(); ++p) {
        Plan& plan = out_[p];
        plan.part = true;
        if (!plan.error.empty()) continue;
        if (plan.joints.empty()) plan.error = "a message in several parts names the joints of each";
        const bool whole = !plan.positions.empty() && plan.positions.front().size() == plan.joints.size() &&
                           plan.positions.back().size() == plan.joints.size();
        if (!whole) continue;  // toMotion() says what is wrong
        if (p > first) plan.error = gapBefore(plan, out_[p - 1], now.state);
        for (std::size_t j = 0; j < plan.joints.size(); ++j) now.state[plan.joints[j]] = plan.positions.back()[j];
      }
    }
  }

  /// Why a part does not begin where the parts before it end; empty: it does.
  std::string gapBefore(const Plan& part, const Plan& before, const std::map<std::string, double>& state) const {
    if (!before.error.empty()) {
      return fmt::format("'{}', the part before it, is wrong: where the robot stands then is not known", before.name);
    }
    Eigen::VectorXd from = tree_.neutralConfiguration(), to = from;
    for (int v = 0; v < tree_.dof(); ++v) {
      const auto known = state.find(tree_.variableName(v));
      if (known != state.end()) from[v] = to[v] = known->second;
    }
    for (std::size_t j = 0; j < part.joints.size(); ++j) {
      const int v = tree_.findVariable(part.joints[j]);
      if (v >= 0 && state.count(part.joints[j])) to[v] = part.positions.front()[j];
    }
    for (int v = 0; v < tree_.dof(); ++v) {
      const JointId j = tree_.variableJoint(v);
      const bool forever = tree_.isAngle(v) && !hasLimits(tree_.joint(j));
      double gap = forever ? std::remainder(to[v] - from[v], kTwoPi) : to[v] - from[v];
      if (const int q = tree_.quaternionVariable(j); q >= 0 && v >= q) {  // of two signs, which say the same
        gap = from.segment<4>(q).dot(to.segment<4>(q)) < 0 ? to[v] + from[v] : gap;
      }
      if (std::abs(gap) <= kSameValue) continue;
      return fmt::format(
          "'{}' is at {:g} at its begin, and at {:g} where the parts of the message before it end: "
          "nobody says how it gets there; take them as plans of their own, or join them",
          tree_.variableName(v), to[v], from[v]);
    }
    return {};
  }

  void readMessage(const Json& message, Plan& plan) {
    const Json* joints = find(message, {"joint_trajectory"});
    const Json* poses = find(message, {"multi_dof_joint_trajectory"});
    if (!joints && !poses) {  // one of these itself
      const Json& points = listOf(message, "points", "message");
      const bool transforms = !points.empty() && points[0].is_object() && find(points[0], {"transforms"});
      (transforms ? poses : joints) = &message;
    }
    if (joints != &message && poses != &message) {
      requireKnown(message, "", {"joint_trajectory", "multi_dof_joint_trajectory", "header", "name", "id", "state"});
    }
    for (const Json* part : {joints, poses}) {
      if (part && !part->is_object()) refuse(fmt::format("{} is no trajectory", shown(*part)));
    }
    readName(message, plan);
    readState(message, plan);
    if (joints) addJoints(*joints, plan);
    if (poses && plan.positions.empty()) plan.joints.clear();  // names without points
    if (poses) addPoses(tree_, *poses, plan);
    forgetNoTimes(plan);
  }

  static void readName(const Json& value, Plan& plan) {
    const Json* name = find(value, {"name", "id"});
    if (!name || name->is_null()) return;
    const std::string text = name->is_string() ? name->get<std::string>() : shown(*name);
    plan.name += (plan.name.empty() ? "" : " ") + text;
  }

  /// Reads rows of a plan: lists, or objects by name. Lists are in the order of the plan's joints. If the plan names no
  /// joints, lists are in the robot's order; then lists and objects must not be mixed.
  class Rows {
   public:
    explicit Rows(Plan& plan) : plan_(plan), ordered_(!plan.joints.empty()) {}

    void add(const Json& list, const std::string& what, Plan::Rows& rows) {
      if (!list.is_array()) refuse(fmt::format("'{}' is no list: {}", what, shown(list)));
      for (std::size_t k = 0; k < list.size(); ++k) {
        const std::string where = fmt::format("waypoint {}{}{}", k, what.empty() ? "" : ", ", what);
        (list[k].is_object() ? named_ : listed_) = true;
        if (named_ && listed_ && !ordered_) {
          refuse(fmt::format("{}: some rows go by name and others do not: 'joints' says what the order of these is",
                             where));
        }
        rows.push_back(list[k].is_object() ? rowOf(list[k], where) : numbersOf(list[k], where));
      }
    }

   private:
    std::vector<double> rowOf(const Json& object, const std::string& where) {
      std::map<std::string_view, const Json*> values;
      for (const auto& item : object.items()) values.emplace(item.key(), &item.value());
      std::vector<std::string>& joints = plan_.joints;
      if (joints.empty()) {
        for (const auto& item : object.items()) joints.push_back(item.key());
      }
      std::vector<double> row;
      for (const std::string& joint : joints) {
        const auto value = values.find(joint);
        if (value == values.end()) refuse(fmt::format("{} has no value of joint '{}'", where, joint));
        row.push_back(numberOf(*value->second, fmt::format("{}, joint '{}'", where, joint)));
      }
      for (const std::string& joint : joints) values.erase(joint);
      if (values.empty()) return row;
      refuse(fmt::format("{} has a value of joint '{}', which others lack", where, values.begin()->first));
    }

    Plan& plan_;
    const bool ordered_;  ///< whether the plan says which joints lists are of
    bool named_ = false, listed_ = false;
  };

  static void readPlan(const Json& value, Plan& plan) {
    requireKnown(value, "",
                 {"name", "id", "joints", "joint_names", "times", "waypoints", "state", "velocities", "accelerations",
                  "from", "to", "start", "goal"});
    refuseTwo(value, {"joints", "joint_names"});
    readName(value, plan);
    if (const Json* joints = find(value, {"joints", "joint_names"})) plan.joints = textsOf(*joints, "joints");
    refuseTwo(value, {"waypoints", "from", "start"});
    refuseTwo(value, {"waypoints", "to", "goal"});
    Rows rows(plan);
    if (const Json* waypoints = find(value, {"waypoints"})) {
      rows.add(*waypoints, "", plan.positions);
    } else {
      const Json *from = find(value, {"from", "start"}), *to = find(value, {"to", "goal"});
      if (!from || !to) refuse("no 'waypoints', and not both of 'from' and 'to'");
      rows.add(Json::array({*from, *to}), "", plan.positions);
    }
    if (const Json* times = find(value, {"times"})) plan.times = numbersOf(*times, "times");
    if (const Json* rates = find(value, {"velocities"})) rows.add(*rates, "velocities", plan.velocities);
    if (const Json* rates = find(value, {"accelerations"})) rows.add(*rates, "accelerations", plan.accelerations);
    readState(value, plan);
  }

  /// Values of joints that the plan does not name.
  static void readState(const Json& value, Plan& plan) {
    const Json* state = find(value, {"state"});
    if (!state) return;
    if (!state->is_object()) refuse("'state' is no object from names to values");
    for (const auto& item : state->items()) {
      plan.state[item.key()] = numberOf(item.value(), fmt::format("state, joint '{}'", item.key()));
    }
  }

  const KinematicTree& tree_;
  std::vector<Plan>& out_;
};

}  // namespace

void readDocument(const KinematicTree& tree, const Json& document, const std::string& label, std::vector<Plan>& out) {
  Reader(tree, out).read(document, label, {}, 0);
}

}  // namespace fcl_artic::plans
