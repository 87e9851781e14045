// SPDX-License-Identifier: BSD-3-Clause
#include "motion/variables.h"

#include <algorithm>

namespace fcl_artic {
namespace {

void stateOf(const void* self, double t, double* out) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const BoundedMotion::State state = static_cast<const BoundedMotion*>(self)->state(t);
  Eigen::Map<RowMajor>(out, 3, 3) = state.pose.linear();
  Eigen::Vector3d::Map(out + 9) = state.pose.translation();
  Eigen::Vector3d::Map(out + 12) = state.velocity;
  Eigen::Vector3d::Map(out + 15) = state.acceleration;
  Eigen::Vector3d::Map(out + 18) = state.angular_velocity;
  Eigen::Vector3d::Map(out + 21) = state.angular_acceleration;
}

void boundsOf(const void* self, double begin, double end, double* out) {
  const BoundedMotion::Bounds b = static_cast<const BoundedMotion*>(self)->bounds(begin, end);
  const double all[6] = {b.speed, b.acceleration, b.jerk, b.angular_speed, b.angular_acceleration, b.angular_jerk};
  std::copy(all, all + 6, out);
}

}  // namespace

int numVariables(const MotionElement& element) {
  switch (element.kind) {
    case MotionElement::Kind::revolute:
    case MotionElement::Kind::prismatic:
      return 1;
    case MotionElement::Kind::slide:
    case MotionElement::Kind::turn:
      return 3;
    default:
      return 0;
  }
}

int numVariables(const BodyMotion& motion) {
  int sum = 0;
  for (const MotionElement& element : motion.elements) sum += numVariables(element);
  return sum;
}

int degreeOf(const BodyMotion& motion) {
  int degree = 0;
  for (const MotionElement& element : motion.elements) degree = std::max(degree, element.degree());
  return degree;
}

void writeCoefficients(const MotionElement& element, int variable, int num_variables, int degree,
                       double* coefficients) {
  const int rows = numVariables(element);
  for (int k = 0; k <= degree; ++k) {
    for (int r = 0; r < rows; ++r) coefficients[k * num_variables + variable + r] = element.coefficients(r, k);
  }
}

engine::BoundedSource boundedSource(const BoundedMotion& motion) {
  return {&motion, &stateOf, &boundsOf, motion.hasDerivatives()};
}

}  // namespace fcl_artic
