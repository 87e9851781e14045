// SPDX-License-Identifier: BSD-3-Clause
//
// The node part: parameters, the planning scene, error codes, markers. All decisions are in certifier.cpp.
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <class_loader/class_loader.hpp>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/utils/logger.hpp>
#include <rclcpp/rclcpp.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "fcl_artic_moveit/certifier.h"
#include "node_parameters.h"

namespace fcl_artic_moveit {
namespace {

constexpr const char* kName = "CertifySolution";

/// The values of the parameters.
struct Settings {
  CertifierOptions certifier;
  bool refuse_undecided = true;
  bool repair = false;
  RepairOptions how;  ///< clearance
};

/// The adapter's parameters. All but the topic may be set while the node runs, and are read anew for each plan.
class Parameters {
 public:
  /// Declares them, with the values of the node's YAML files.
  /// @throws std::invalid_argument, rclcpp's exceptions, naming the parameter.
  Parameters(rclcpp::Node& node, const std::string& prefix) : of_(node, prefix) {
    of_.declareCertifier(0);
    of_.declare("time_limit", rclcpp::ParameterValue(0.0),
                "s after which a plan is undecided; 0: the request's allowed_planning_time", 0);
    of_.declare("on_undecided", rclcpp::ParameterValue("refuse"), "refuse, or warn and let the plan pass");
    of_.declare("repair", rclcpp::ParameterValue(false),
                "whether a plan that touches is replaced by a way around, timed anew and certified");
    of_.declare("repair_clearance", rclcpp::ParameterValue(0.005), "m that such a way keeps beyond margin and padding",
                0);
    of_.declare("display_contacts_topic", rclcpp::ParameterValue("display_contacts"),
                "topic of the visualization_msgs/MarkerArray; empty: none", -1, true);
    (void)settings();
    guard_ = of_.onChange({"display_contacts_topic"},
                          [this](const std::vector<rclcpp::Parameter>& changed) { (void)settings(changed); });
  }

  /// @param changed  values that count before the node's.
  /// @throws std::invalid_argument naming parameter and value.
  Settings settings(const std::vector<rclcpp::Parameter>& changed = {}) const {
    Settings out;
    try {
      out.certifier = of_.certifier(changed);
      out.certifier.time_limit = of_.number("time_limit", changed);
      out.certifier.check();
      const std::string on_undecided = of_.text("on_undecided", changed);
      if (on_undecided != "refuse" && on_undecided != "warn") {
        throw std::invalid_argument("'" + on_undecided + "' is no value of on_undecided: refuse, warn are");
      }
      out.refuse_undecided = on_undecided == "refuse";
      const rclcpp::Parameter repair = of_.parameter("repair", changed);
      if (repair.get_type() != rclcpp::ParameterType::PARAMETER_BOOL) {
        throw std::invalid_argument("repair is " + repair.value_to_string() + ", not true or false");
      }
      out.repair = repair.as_bool();
      if (out.repair && !Certifier::canRepair()) {
        throw std::invalid_argument("repair: this package was built without fcl_artic's component ompl");
      }
      out.how.clearance = of_.number("repair_clearance", changed);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("parameters " + of_.prefix() + "*: " + error.what());
    }
    return out;
  }
  std::string topic() const { return of_.text("display_contacts_topic"); }

 private:
  NodeParameters of_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr guard_;
};

geometry_msgs::msg::Point toPoint(const Eigen::Vector3d& p) {
  geometry_msgs::msg::Point out;
  out.x = p.x();
  out.y = p.y();
  out.z = p.z();
  return out;
}

visualization_msgs::msg::Marker redMarker(const std::string& frame, const rclcpp::Time& now, int id, int type) {
  visualization_msgs::msg::Marker marker;
  marker.header.frame_id = frame;
  marker.header.stamp = now;
  marker.ns = "certify_solution";
  marker.id = id;
  marker.type = type;
  marker.action = visualization_msgs::msg::Marker::ADD;
  marker.pose.orientation.w = 1;
  marker.color.r = 1;
  marker.color.a = 1;
  return marker;
}

/// Removes the markers that were shown before. Each contact gets a ball where it is, an arrow along the normal, and the
/// two names.
visualization_msgs::msg::MarkerArray markersOf(const std::vector<Verdict::Contact>& contacts, const std::string& frame,
                                               const rclcpp::Time& now) {
  using visualization_msgs::msg::Marker;
  visualization_msgs::msg::MarkerArray out;
  Marker clear;
  clear.action = Marker::DELETEALL;
  out.markers.push_back(clear);
  for (const Verdict::Contact& contact : contacts) {
    const int id = static_cast<int>(out.markers.size());
    Marker ball = redMarker(frame, now, id, Marker::SPHERE);
    ball.pose.position = toPoint(contact.point);
    ball.scale.x = ball.scale.y = ball.scale.z = 0.02;
    Marker arrow = redMarker(frame, now, id + 1, Marker::ARROW);
    arrow.points = {toPoint(contact.point), toPoint(contact.point + 0.1 * contact.normal)};
    arrow.scale.x = 0.008;
    arrow.scale.y = 0.016;
    Marker text = redMarker(frame, now, id + 2, Marker::TEXT_VIEW_FACING);
    text.pose.position = toPoint(contact.point + Eigen::Vector3d(0, 0, 0.05));
    text.scale.z = 0.03;
    text.text = contact.body1.id + " - " + contact.body2.id;
    out.markers.insert(out.markers.end(), {ball, arrow, text});
  }
  return out;
}

}  // namespace

/// Response adapter that refuses solutions that are not certified free of contact, between waypoints too. Its
/// parameters stand below the pipeline's namespace, in `certify_solution`; README.md says what they mean.
class CertifySolution : public planning_interface::PlanningResponseAdapter {
 public:
  CertifySolution() : logger_(moveit::getLogger("fcl_artic.certify_solution")) {}

  /// @throws std::invalid_argument naming the parameter and its value.
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string& parameter_namespace) override {
    parameters_.reset();
    auto parameters = std::make_unique<Parameters>(
        *node, (parameter_namespace.empty() ? "" : parameter_namespace + ".") + "certify_solution.");
    const std::string topic = parameters->topic();
    if (!topic.empty()) {
      publisher_ = node->create_publisher<visualization_msgs::msg::MarkerArray>(topic, rclcpp::SystemDefaultsQoS());
    }
    node_ = node;
    parameters_ = std::move(parameters);
  }

  [[nodiscard]] std::string getDescription() const override { return kName; }

  void adapt(const planning_scene::PlanningSceneConstPtr& scene, const planning_interface::MotionPlanRequest& request,
             planning_interface::MotionPlanResponse& response) const override {
    std::vector<Verdict::Contact> contacts;
    try {
      if (!parameters_) throw std::invalid_argument("initialize() was not called");
      if (!scene) throw std::invalid_argument("there is no planning scene");
      if (!response.trajectory) throw std::invalid_argument("there is no trajectory");
      Settings settings = parameters_->settings();
      if (settings.certifier.time_limit == 0)
        settings.certifier.time_limit = std::max(0.0, request.allowed_planning_time);
      // The start that planners take: the scene's state, with the request's changes.
      const moveit::core::RobotStatePtr start = scene->getCurrentStateUpdated(request.start_state);
      Verdict verdict = certifier_.certify(*scene->getCollisionEnv(), scene->getAllowedCollisionMatrix(),
                                           *response.trajectory, start.get(), settings.certifier);
      if (verdict.status == fcl_artic::Status::contact && settings.repair) {
        repair(*scene, request, settings, response, verdict);
      }
      for (const std::string& note : verdict.notes) RCLCPP_WARN(logger_, "%s", note.c_str());
      contacts = verdict.contacts;
      if (verdict.isFree()) {
        RCLCPP_INFO(logger_, "%s", verdict.message.c_str());
      } else if (verdict.status == fcl_artic::Status::undecided && !settings.refuse_undecided) {
        RCLCPP_WARN(logger_, "%s", verdict.message.c_str());
      } else {
        refuse(response, verdict.message);
      }
    } catch (const std::exception& error) {
      refuse(response, std::string("the trajectory is not certified: ") + error.what());
    }
    if (publisher_) {
      publisher_->publish(markersOf(contacts, scene ? scene->getPlanningFrame() : "", node_->get_clock()->now()));
    }
  }

 private:
  /// Puts a way around in place of the trajectory and the verdict. If there is none, the message says why.
  void repair(const planning_scene::PlanningScene& scene, const planning_interface::MotionPlanRequest& request,
              Settings& settings, planning_interface::MotionPlanResponse& response, Verdict& verdict) const {
    settings.how.velocity_scaling = request.max_velocity_scaling_factor;
    settings.how.acceleration_scaling = request.max_acceleration_scaling_factor;
    if (settings.certifier.time_limit > 0) settings.how.seconds = settings.certifier.time_limit;
    try {
      Repair mended = certifier_.repair(*scene.getCollisionEnv(), scene.getAllowedCollisionMatrix(),
                                        *response.trajectory, settings.certifier, settings.how);
      RCLCPP_WARN(logger_, "repaired by %zu detour(s), timed anew: %s", mended.detours, verdict.message.c_str());
      response.trajectory = std::move(mended.trajectory);
      verdict = std::move(mended.verdict);
    } catch (const std::runtime_error& error) {
      verdict.message += std::string(" It was not repaired: ") + error.what() + '.';
    }
  }

  void refuse(planning_interface::MotionPlanResponse& response, const std::string& why) const {
    RCLCPP_ERROR(logger_, "%s", why.c_str());
    response.error_code.val = moveit_msgs::msg::MoveItErrorCodes::INVALID_MOTION_PLAN;
    response.error_code.message = why;
    response.error_code.source = kName;
  }

  rclcpp::Logger logger_;
  rclcpp::Node::SharedPtr node_;
  rclcpp::Publisher<visualization_msgs::msg::MarkerArray>::SharedPtr publisher_;
  std::unique_ptr<const Parameters> parameters_;
  Certifier certifier_;
};

}  // namespace fcl_artic_moveit

CLASS_LOADER_REGISTER_CLASS(fcl_artic_moveit::CertifySolution, planning_interface::PlanningResponseAdapter)
