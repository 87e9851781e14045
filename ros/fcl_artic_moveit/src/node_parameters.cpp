// SPDX-License-Identifier: BSD-3-Clause
#include "node_parameters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace fcl_artic_moveit {
namespace {

constexpr double kMaxBudget = 9007199254740992;  // 2^53: all whole numbers up to it are doubles

}  // namespace

NodeParameters::NodeParameters(rclcpp::Node& node, std::string prefix) : node_(node), prefix_(std::move(prefix)) {}

void NodeParameters::declareCertifier(std::int64_t budget) {
  declare("interpolation", rclcpp::ParameterValue("auto"),
          "what lies between two waypoints, as fcl_artic certify names it. joint_trajectory_controller: jtc by its "
          "interpolation_method splines, jtc-none by none, jtc-upsampled of its topic by positions_upsampling.enable; "
          "others: auto, linear, cubic, quintic, blends, tangent-half-angle");
  declare("blend", rclcpp::ParameterValue(0.0), "s, half the duration of a blend, of interpolation blends", 0);
  declare("turns", rclcpp::ParameterValue("ask"),
          "steps of half a turn or more of joints that turn forever: ask, given, shortest");
  declare("margin", rclcpp::ParameterValue(0.0), "m that every pair has to keep beyond the padding", 0);
  declare("joint_tolerance_angle", rclcpp::ParameterValue(0.0),
          "rad by which each joint that turns may be off; free is every path within", 0);
  declare("joint_tolerance_length", rclcpp::ParameterValue(0.0), "m by which each joint that slides may be off", 0);
  declare("joint_tolerances", rclcpp::ParameterValue(std::vector<std::string>()),
          "of single joints, in place of these: JOINT=VALUE, rad or m");
  declare("base_tolerance_length", rclcpp::ParameterValue(0.0), "m by which the robot's base may be off", 0);
  declare("base_tolerance_angle", rclcpp::ParameterValue(0.0),
          "rad by which it may be turned about the origin of the model's frame", 0);
  declare("object_tolerance", rclcpp::ParameterValue(0.0), "m by which each object of the world may be off", 0);
  declare("mimic_tolerance", rclcpp::ParameterValue(1e-3),
          "rad or m by which a mimic joint of the group may be off from where its master has it", 0);
  declare("budget", rclcpp::ParameterValue(budget), "tests after which an answer is undecided; 0: no limit", 0);
}

void NodeParameters::declare(const std::string& name, rclcpp::ParameterValue value, const std::string& description,
                             double least, bool read_only) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = description;
  descriptor.read_only = read_only;
  if (value.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE) {
    descriptor.dynamic_typing = true;  // YAML's `margin: 0` is an integer
    descriptor.floating_point_range.resize(1);
    descriptor.floating_point_range[0].from_value = least;
    descriptor.floating_point_range[0].to_value = std::numeric_limits<double>::max();
  } else if (value.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER) {
    descriptor.integer_range.resize(1);
    descriptor.integer_range[0].from_value = static_cast<std::int64_t>(least);
    descriptor.integer_range[0].to_value = static_cast<std::int64_t>(kMaxBudget);
  }
  const std::string full = prefix_ + name;
  if (!node_.has_parameter(full)) {
    node_.declare_parameter(full, value, descriptor);
    return;
  }
  // move_group declares all that its YAML files have, without descriptions.
  const rcl_interfaces::msg::ParameterDescriptor before = node_.describe_parameter(full);
  if (!before.dynamic_typing || before.read_only) return;
  value = node_.get_parameter(full).get_parameter_value();
  node_.undeclare_parameter(full);
  node_.declare_parameter(full, value, descriptor, true);
}

CertifierOptions NodeParameters::certifier(const std::vector<rclcpp::Parameter>& changed) const {
  CertifierOptions out;
  out.motion.interpolation = interpolationNamed(text("interpolation", changed));
  out.motion.turns = turnsNamed(text("turns", changed));
  out.motion.blend = number("blend", changed);
  out.margin = number("margin", changed);
  CellTolerances& tolerances = out.tolerances;
  tolerances.joints = {number("joint_tolerance_angle", changed), number("joint_tolerance_length", changed)};
  tolerances.own = numbers("joint_tolerances", changed);
  tolerances.base.length = number("base_tolerance_length", changed);
  tolerances.base.angle = number("base_tolerance_angle", changed);
  tolerances.objects = number("object_tolerance", changed);
  out.motion.mimic_tolerance = number("mimic_tolerance", changed);
  out.check();
  const double budget = number("budget", changed);
  if (!(budget >= 0 && budget <= kMaxBudget) || budget != std::floor(budget)) {
    throw std::invalid_argument("budget is " + std::to_string(budget) + "; it has to be a whole number, 0 or more");
  }
  out.budget = static_cast<std::uint64_t>(budget);
  return out;
}

std::map<std::string, double> NodeParameters::numbers(const std::string& name,
                                                      const std::vector<rclcpp::Parameter>& changed) const {
  const rclcpp::Parameter given = parameter(name, changed);
  std::map<std::string, double> out;
  if (given.get_type() != rclcpp::ParameterType::PARAMETER_STRING_ARRAY) {
    throw std::invalid_argument(name + " is " + given.value_to_string() + ", no list of NAME=NUMBER");
  }
  for (const std::string& one : given.as_string_array()) {
    const std::size_t equals = one.rfind('=');
    std::istringstream number(equals == std::string::npos ? "" : one.substr(equals + 1));
    number.imbue(std::locale::classic());
    double value = 0;
    if (equals == 0 || !(number >> value) || !(number >> std::ws).eof()) {
      throw std::invalid_argument(name + ": '" + one + "' is not NAME=NUMBER");
    }
    if (!out.emplace(one.substr(0, equals), value).second) {
      throw std::invalid_argument(name + ": '" + one + "' is a second one of this name");
    }
  }
  return out;
}

rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr NodeParameters::onChange(
    std::vector<std::string> fixed, std::function<void(const std::vector<rclcpp::Parameter>&)> check) {
  return node_.add_on_set_parameters_callback(
      [this, fixed = std::move(fixed), check = std::move(check)](const std::vector<rclcpp::Parameter>& changed) {
        rcl_interfaces::msg::SetParametersResult result;
        result.successful = true;
        const auto own = [this](const rclcpp::Parameter& one) { return one.get_name().rfind(prefix_, 0) == 0; };
        if (std::none_of(changed.begin(), changed.end(), own)) return result;
        try {
          for (const rclcpp::Parameter& one : changed) {
            // If it was declared before, it may not be read-only.
            const auto is = [&](const std::string& name) { return one.get_name() == prefix_ + name; };
            if (std::any_of(fixed.begin(), fixed.end(), is) && !(one == node_.get_parameter(one.get_name()))) {
              throw std::invalid_argument(one.get_name() + " counts at the start, and not after");
            }
          }
          check(changed);
        } catch (const std::exception& error) {
          result.successful = false;
          result.reason = error.what();
        }
        return result;
      });
}

rclcpp::Parameter NodeParameters::parameter(const std::string& name,
                                            const std::vector<rclcpp::Parameter>& changed) const {
  for (const rclcpp::Parameter& one : changed) {
    if (one.get_name() == prefix_ + name) return one;
  }
  return node_.get_parameter(prefix_ + name);
}

std::string NodeParameters::text(const std::string& name, const std::vector<rclcpp::Parameter>& changed) const {
  const rclcpp::Parameter value = parameter(name, changed);
  if (value.get_type() == rclcpp::ParameterType::PARAMETER_STRING) return value.as_string();
  throw std::invalid_argument(name + " is " + value.value_to_string() + ", no text");
}

double NodeParameters::number(const std::string& name, const std::vector<rclcpp::Parameter>& changed) const {
  const rclcpp::Parameter value = parameter(name, changed);
  if (value.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE) return value.as_double();
  if (value.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER) return static_cast<double>(value.as_int());
  throw std::invalid_argument(name + " is " + value.value_to_string() + ", no number");
}

}  // namespace fcl_artic_moveit
