// SPDX-License-Identifier: BSD-3-Clause
//
// Axes in files: of any length, also where a joint follows one that stands still and is put where that leaves it.
#include <gtest/gtest.h>

#include "fcl_artic/urdf/urdf.h"
#include "temp_folder.h"

namespace urdf_test {

using namespace fcl_artic;
using Eigen::Vector3d;

using UrdfAxes = TempFolderTest;

TEST_F(UrdfAxes, OfAnyLengthAreTheirDirection) {
  for (const char* scale : {"1", "e-320", "e-200", "e-162", "e200"}) {
    const std::string s = std::string(scale) == "1" ? "" : scale, axis = "'0 1" + s + " 1" + s + "'";
    const std::string file =
        write("robot.urdf",
              "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='d'/><link name='e'/>"
              "<joint name='still' type='fixed'><parent link='a'/><child link='b'/></joint>"
              "<joint name='slides' type='prismatic'><parent link='a'/><child link='c'/><axis xyz=" +
                  axis +
                  "/><limit lower='-1' upper='1' effort='1' velocity='1'/><mimic joint='still' offset='0.5'/></joint>"
                  "<joint name='turns' type='revolute'><parent link='a'/><child link='d'/><axis xyz=" +
                  axis +
                  "/><limit lower='-1' upper='1' effort='1' velocity='1'/><mimic joint='still' offset='0.5'/></joint>"
                  "<joint name='moves' type='revolute'><parent link='a'/><child link='e'/><axis xyz=" +
                  axis + "/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>");
    const Robot robot = loadUrdf(file);
    const KinematicTree& tree = *robot.tree;
    ASSERT_EQ(tree.dof(), 1) << scale;
    const Vector3d direction = Vector3d(0, 1, 1).normalized();
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.5);
    EXPECT_LE((tree.linkPose(tree.linkId("c"), q).translation() - 0.5 * direction).norm(), 1e-15) << scale;
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.5, direction).toRotationMatrix();
    for (const char* link : {"d", "e"}) {
      EXPECT_LE((tree.linkPose(tree.linkId(link), q).linear() - turned).norm(), 1e-15) << scale << ' ' << link;
    }
  }
}

}  // namespace urdf_test
