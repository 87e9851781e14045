// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/in_between.h"

#include <stdexcept>
#include <string>

#include "numerics/rotation.h"

namespace fcl_artic {
namespace {

/// How far R^T R of a pose may be from the identity, in each entry; it is made orthonormal then.
constexpr double kNotRigid = 1e-6;

/// @return the poses, made orthonormal.
std::vector<RigidTransform> requirePoses(const std::vector<Eigen::Isometry3d>& M_0, int links,
                                         const std::string& what) {
  if (M_0.size() != static_cast<std::size_t>(links)) {
    throw std::invalid_argument(what + " has " + std::to_string(M_0.size()) + " poses, the tree has " +
                                std::to_string(links) + " links");
  }
  std::vector<RigidTransform> poses;
  for (std::size_t i = 0; i < M_0.size(); ++i) {
    const auto nameOf = [&] { return what + ": pose " + std::to_string(i) + " is not rigid: it"; };
    poses.push_back(requireRigid(M_0[i], kNotRigid, nameOf));
  }
  return poses;
}

}  // namespace

std::shared_ptr<const KinematicTree> inBetweenTree(const KinematicTree& tree) {
  auto out = std::make_shared<KinematicTree>(tree.name());
  for (LinkId link = 0; link < tree.numLinks(); ++link) out->addLink(tree.linkName(link));
  std::string world = "in_between_world";
  while (out->hasLink(world)) world += "_";
  out->addLink(world);
  for (LinkId link = 0; link < tree.numLinks(); ++link) {
    const JointId above = tree.parentJoint(link);
    Joint joint;
    joint.type = JointType::floating;
    joint.name = above < 0 ? world + "/" + tree.linkName(link) : tree.joint(above).name;
    joint.parent = above < 0 ? world : tree.linkName(tree.parentLink(link));
    joint.child = tree.linkName(link);
    out->addJoint(joint);
  }
  return out;
}

JointMotion inBetweenMotion(const KinematicTree& tree, const std::vector<Eigen::Isometry3d>& M_0_begin,
                            const std::vector<Eigen::Isometry3d>& M_0_end) {
  const int links = tree.numLinks() - 1;
  bool ours = links >= 0 && tree.numJoints() == links && tree.dof() == 7 * links && tree.parentLink(links) < 0;
  for (JointId j = 0; ours && j < links; ++j) ours = tree.joint(j).type == JointType::floating;
  if (!ours)
    throw std::invalid_argument("inBetweenMotion: the tree '" + tree.name() + "' was not made by inBetweenTree()");
  const std::vector<RigidTransform> begin = requirePoses(M_0_begin, links, "M_0_begin");
  const std::vector<RigidTransform> end = requirePoses(M_0_end, links, "M_0_end");
  const auto configuration = [&](const std::vector<RigidTransform>& M_0) {
    Eigen::VectorXd q(tree.dof());
    for (LinkId link = 0; link < links; ++link) {
      const LinkId parent = tree.parentLink(link);
      const RigidTransform& M_0i = M_0[static_cast<std::size_t>(link)];
      const RigidTransform M_pi = parent == links ? M_0i : M_0[static_cast<std::size_t>(parent)].inverse() * M_0i;
      const int v = tree.jointVariable(tree.parentJoint(link));
      q.segment<3>(v) = M_pi.translation();
      q.segment<4>(v + 3) = Eigen::Quaterniond(Eigen::Matrix3d(M_pi.linear())).normalized().coeffs();
    }
    return q;
  };
  return JointMotion::linear(tree, configuration(begin), configuration(end));
}

}  // namespace fcl_artic
