// SPDX-License-Identifier: BSD-3-Clause
// Splines of random plans of the bundled arm among pipes, beside FCL at samples of a spline that is evaluated apart.
#include <iostream>
#include <random>

#include "arm.h"
#include "fcl_artic/manager.h"
#include "fcl_artic/urdf/urdf.h"
#include "planning/fcl_state_check.h"

namespace fcl_artic::plans {
namespace sampled_test {
namespace {

using Eigen::VectorXd;

/// The quintic, or with no accelerations the cubic, by its conditions at both ends solved as a linear system, s in
/// [0, 1]: no formula is shared with what is judged.
class Spline {
 public:
  Spline(const Plan& plan, std::size_t k) {
    const double h = plan.times[k + 1] - plan.times[k];
    const int conditions = plan.accelerations.empty() ? 2 : 3, n = 2 * conditions;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n), b(n, 6);
    for (int j = 0; j < n; ++j) {
      for (int d = 0; d < conditions; ++d) {
        double factor = 1;
        for (int i = 0; i < d; ++i) factor *= j - i;
        A(d, j) = j == d ? factor : 0;
        A(conditions + d, j) = factor;
      }
    }
    const Plan::Rows* rows[3] = {&plan.positions, &plan.velocities, &plan.accelerations};
    for (int d = 0; d < conditions; ++d) {
      for (int v = 0; v < 6; ++v) {
        b(d, v) = std::pow(h, d) * (*rows[d])[k][static_cast<std::size_t>(v)];
        b(conditions + d, v) = std::pow(h, d) * (*rows[d])[k + 1][static_cast<std::size_t>(v)];
      }
    }
    c_ = A.fullPivLu().solve(b);
  }
  VectorXd at(double s) const {
    VectorXd q = VectorXd::Zero(6);
    for (Eigen::Index j = c_.rows() - 1; j >= 0; --j) q = q * s + c_.row(j).transpose();
    return q;
  }

 private:
  Eigen::MatrixXd c_;
};

TEST(PlanSampledTest, NoSampleTouchesWhatIsCertifiedFree) {
  const std::string data = FCL_ARTIC_SOURCE "/data";
  const Robot robot = loadUrdf(data + "/puma560/puma560.urdf");
  const Scene scene = loadScene(data + "/pipes.obj");
  ArticulatedCollisionManager manager(robot.tree);
  robot.addTo(manager);
  scene.addTo(manager);
  manager.setup();
  planning_data::FclStateCheck check(robot, scene);
  VectorXd from(6), to(6);
  from << -2.1, 1, -1, -0.1, -0.1, 0;
  to << 0.9, 0.4, -2, 0, 0.2, 0;
  std::mt19937 random(42);
  std::uniform_real_distribution<double> unit(-1, 1);
  int free = 0, contact = 0;
  constexpr int kSamples = 60;
  for (int run = 0; run < 24; ++run) {
    Plan plan;
    for (int k = 0; k < 4; ++k) {
      plan.times.push_back(0.7 * k);
      std::vector<double> q, v, a;
      for (int j = 0; j < 6; ++j) {
        q.push_back(from[j] + k / 3.0 * (to[j] - from[j]) + 0.15 * unit(random));
        v.push_back(k == 0 || k == 3 ? 0 : 0.8 * unit(random));
        a.push_back(2 * unit(random));
      }
      plan.positions.push_back(q);
      plan.velocities.push_back(v);
      if (run % 2) plan.accelerations.push_back(a);
    }
    MotionOptions options;
    options.ignore_limits = true;
    const PlanMotion motion = toMotion(*robot.tree, plan, options);
    const CertifiedResult result = manager.continuousCollide(motion.trajectory);
    double seen = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3 && !std::isfinite(seen); ++k) {
      const Spline spline(plan, k);
      for (int i = 0; i <= kSamples; ++i) {
        const double s = static_cast<double>(i) / kSamples;
        if (!check.collides(spline.at(s))) continue;
        seen = plan.times[k] + s * (plan.times[k + 1] - plan.times[k]);
        break;
      }
    }
    if (result.isFree()) {
      ++free;
      EXPECT_FALSE(std::isfinite(seen)) << "run " << run << ": certified free, FCL sees a contact at " << seen;
    } else {
      ++contact;
      EXPECT_GE(seen, result.t_lower - 1e-9) << "run " << run;
    }
  }
  std::cout << free << " free, " << contact << " in contact\n";
  EXPECT_GE(free, 3);
  EXPECT_GE(contact, 3);
}

}  // namespace
}  // namespace sampled_test
}  // namespace fcl_artic::plans
