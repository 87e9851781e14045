// SPDX-License-Identifier: BSD-3-Clause
//
// The node part: parameters, the planning scene, error codes, markers. What is decided is decided in certifier.cpp.
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include <class_loader/class_loader.hpp>
#include <moveit/planning_interface/planning_response_adapter.hpp>
#include <moveit/utils/logger.hpp>
#include <rclcpp/rclcpp.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "fcl_artic_moveit/certifier.h"

namespace fcl_artic_moveit {
namespace {

constexpr const char* kName = "CertifySolution";

/// The parameter's value, declared by whoever comes first.
template <class T>
T parameter(rclcpp::Node& node, const std::string& name, const T& fallback) {
  if (!node.has_parameter(name)) return node.declare_parameter<T>(name, fallback);
  T value = fallback;
  node.get_parameter(name, value);
  return value;
}

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

/// What was shown before goes; of a contact: a ball where it is, an arrow along the normal, the two names.
visualization_msgs::msg::MarkerArray markersOf(const Verdict& verdict, const std::string& frame,
                                               const rclcpp::Time& now) {
  using visualization_msgs::msg::Marker;
  visualization_msgs::msg::MarkerArray out;
  Marker clear;
  clear.action = Marker::DELETEALL;
  out.markers.push_back(clear);
  if (verdict.status != fcl_artic::Status::contact) return out;
  const Verdict::Contact& contact = verdict.contact;
  Marker ball = redMarker(frame, now, 0, Marker::SPHERE);
  ball.pose.position = toPoint(contact.point);
  ball.scale.x = ball.scale.y = ball.scale.z = 0.02;
  Marker arrow = redMarker(frame, now, 1, Marker::ARROW);
  arrow.points = {toPoint(contact.point), toPoint(contact.point + 0.1 * contact.normal)};
  arrow.scale.x = 0.008;
  arrow.scale.y = 0.016;
  Marker text = redMarker(frame, now, 2, Marker::TEXT_VIEW_FACING);
  text.pose.position = toPoint(contact.point + Eigen::Vector3d(0, 0, 0.05));
  text.scale.z = 0.03;
  text.text = contact.body1.id + " - " + contact.body2.id;
  out.markers.insert(out.markers.end(), {ball, arrow, text});
  return out;
}

}  // namespace

/// Response adapter that refuses solutions that are not certified free of contact, between waypoints too.
///
/// Parameters, below the pipeline's namespace, in `certify_solution`: `interpolation` (auto), `turns` (ask), `margin`
/// (0.0 m), `budget` (0: no limit), `on_undecided` (refuse; warn), `display_contacts_topic` (display_contacts; empty:
/// none). README.md says what they mean.
class CertifySolution : public planning_interface::PlanningResponseAdapter {
 public:
  CertifySolution() : logger_(moveit::getLogger("fcl_artic.certify_solution")) {}

  /// @throws std::invalid_argument naming the parameter's value.
  void initialize(const rclcpp::Node::SharedPtr& node, const std::string& parameter_namespace) override {
    const std::string prefix = (parameter_namespace.empty() ? "" : parameter_namespace + ".") + "certify_solution.";
    CertifierOptions options;
    options.motion.interpolation = interpolationNamed(parameter<std::string>(*node, prefix + "interpolation", "auto"));
    options.motion.turns = turnsNamed(parameter<std::string>(*node, prefix + "turns", "ask"));
    options.margin = parameter<double>(*node, prefix + "margin", 0.0);
    const auto budget = parameter<int64_t>(*node, prefix + "budget", 0);
    if (budget < 0) throw std::invalid_argument(prefix + "budget is " + std::to_string(budget) + ", below 0");
    options.budget = static_cast<std::uint64_t>(budget);
    const auto on_undecided = parameter<std::string>(*node, prefix + "on_undecided", "refuse");
    if (on_undecided != "refuse" && on_undecided != "warn") {
      throw std::invalid_argument("'" + on_undecided + "' is no value of " + prefix + "on_undecided: refuse, warn are");
    }
    refuse_undecided_ = on_undecided == "refuse";
    const auto topic = parameter<std::string>(*node, prefix + "display_contacts_topic", "display_contacts");
    if (!topic.empty()) {
      publisher_ = node->create_publisher<visualization_msgs::msg::MarkerArray>(topic, rclcpp::SystemDefaultsQoS());
    }
    clock_ = node->get_clock();
    certifier_ = std::make_unique<Certifier>(options);
  }

  [[nodiscard]] std::string getDescription() const override { return kName; }

  void adapt(const planning_scene::PlanningSceneConstPtr& scene, const planning_interface::MotionPlanRequest& request,
             planning_interface::MotionPlanResponse& response) const override {
    if (!certifier_) return refuse(response, "initialize() was not called");
    if (!scene) return refuse(response, "there is no planning scene");
    if (!response.trajectory) return refuse(response, "there is no trajectory");
    try {
      // As planners begin: the scene's state, and what the request says of it.
      const moveit::core::RobotStatePtr start = scene->getCurrentStateUpdated(request.start_state);
      const Verdict verdict = certifier_->certify(*scene->getCollisionEnv(), scene->getAllowedCollisionMatrix(),
                                                  *response.trajectory, start.get());
      for (const std::string& note : verdict.notes) RCLCPP_WARN(logger_, "%s", note.c_str());
      if (publisher_) publisher_->publish(markersOf(verdict, scene->getPlanningFrame(), clock_->now()));
      if (verdict.isFree()) {
        RCLCPP_INFO(logger_, "%s", verdict.message.c_str());
      } else if (verdict.status == fcl_artic::Status::undecided && !refuse_undecided_) {
        RCLCPP_WARN(logger_, "%s", verdict.message.c_str());
      } else {
        refuse(response, verdict.message);
      }
    } catch (const std::exception& error) {
      refuse(response, std::string("the trajectory is not certified: ") + error.what());
    }
  }

 private:
  void refuse(planning_interface::MotionPlanResponse& response, const std::string& why) const {
    RCLCPP_ERROR(logger_, "%s", why.c_str());
    response.error_code.val = moveit_msgs::msg::MoveItErrorCodes::INVALID_MOTION_PLAN;
    response.error_code.message = why;
    response.error_code.source = kName;
  }

  rclcpp::Logger logger_;
  rclcpp::Publisher<visualization_msgs::msg::MarkerArray>::SharedPtr publisher_;
  rclcpp::Clock::SharedPtr clock_;
  std::unique_ptr<const Certifier> certifier_;
  bool refuse_undecided_ = true;
};

}  // namespace fcl_artic_moveit

CLASS_LOADER_REGISTER_CLASS(fcl_artic_moveit::CertifySolution, planning_interface::PlanningResponseAdapter)
