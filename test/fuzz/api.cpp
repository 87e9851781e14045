// SPDX-License-Identifier: BSD-3-Clause
// Trees, geometries, motions and requests with hostile numbers. Inputs that are accepted are asked, and the answer is
// compared with balls inside the shapes. If such a ball of a link meets one of an obstacle, or its centre a half-space,
// the motion is not free. The judge's poses are the tree's, its arithmetic is its own.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "fcl_artic/continuous_collision.h"
#include "fuzz.h"

namespace {

using namespace fcl_artic;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// A shape, and the radius of a ball about its origin that is inside; negative: none is known.
struct Shape {
  Geometry geometry;
  double ball = -1;
};

Shape makeShape(fuzz::Bytes& in) {
  const auto size = [&] { return std::abs(in.number()); };
  switch (in.below(10)) {
    case 0: {
      const double x = size(), y = size(), z = size();
      return {std::make_shared<fcl::Boxd>(x, y, z), std::min({x, y, z}) / 2};
    }
    case 1: {
      const double r = in.number();
      return {std::make_shared<fcl::Sphered>(r), r};
    }
    case 2: {
      const double r = size(), l = size();
      return {std::make_shared<fcl::Capsuled>(r, l), r};
    }
    case 3: {
      const double r = size(), l = size();
      return {std::make_shared<fcl::Cylinderd>(r, l), std::min(r, l / 2)};
    }
    case 4: {
      const double r = size(), l = size();
      return {std::make_shared<fcl::Coned>(r, l)};
    }
    case 5: {
      const double a = size(), b = size(), c = size();
      return {std::make_shared<fcl::Ellipsoidd>(a, b, c), std::min({a, b, c})};
    }
    case 6: {
      const Eigen::Vector3d n = in.vector();
      return {std::make_shared<fcl::Halfspaced>(n, in.number())};
    }
    case 7: {
      const Eigen::Vector3d n = in.vector();
      return {std::make_shared<fcl::Planed>(n, in.number())};
    }
    case 8: {
      const Eigen::Vector3d a = in.vector(), b = in.vector(), c = in.vector();
      return {std::make_shared<fcl::TrianglePd>(a, b, c)};
    }
    default: {
      std::vector<Eigen::Vector3d> vertices;
      for (int k = 4 + in.below(5); k > 0; --k) vertices.push_back(in.vector());
      std::vector<fcl::Triangle> triangles;
      for (int k = 1 + in.below(6); k > 0; --k) {
        const int n = static_cast<int>(vertices.size());
        const int a = in.below(n), b = in.below(n), c = in.below(n);
        triangles.emplace_back(a, b, c);
      }
      auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
      for (const Eigen::Vector3d& v : vertices) {
        if (!v.allFinite() || v.cwiseAbs().maxCoeff() > 1e30) return {};  // FCL's own tree of it is at fault then
      }
      mesh->beginModel();
      mesh->addSubModel(vertices, triangles);
      mesh->endModel();
      return {mesh};
    }
  }
}

struct Body {
  LinkId link;
  Eigen::Isometry3d offset;
  std::unique_ptr<fcl::CollisionObjectd> object;
  double ball;
};

/// Calls; wrong input may be refused. @return false when it was.
template <typename F>
bool accepted(F&& call) {
  try {
    call();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

std::shared_ptr<KinematicTree> makeTree(fuzz::Bytes& in) {
  auto tree = std::make_shared<KinematicTree>("r");
  const int links = 1 + in.below(6);
  for (int i = 0; i < links; ++i) tree->addLink("l" + std::to_string(i));
  for (int i = 1; i < links; ++i) {
    Joint joint;
    joint.name = "j" + std::to_string(i);
    joint.type = static_cast<JointType>(in.below(7));
    joint.parent = "l" + std::to_string(in.below(i));
    joint.child = "l" + std::to_string(i);
    joint.origin = in.pose();
    joint.axis = in.coin() ? Eigen::Vector3d(Eigen::Vector3d::Unit(in.below(3))) : in.vector();
    joint.lower = in.number();
    joint.upper = in.number();
    joint.mimics = in.below(4) == 0;
    if (joint.mimics) joint.mimic = {"j" + std::to_string(in.below(links)), in.number(), in.number()};
    accepted([&] { tree->addJoint(joint); });
  }
  return tree;
}

Eigen::VectorXd makeConfiguration(fuzz::Bytes& in, const KinematicTree& tree) {
  Eigen::VectorXd q = tree.neutralConfiguration();
  for (int v = 0; v < tree.dof(); ++v) q[v] = in.number();
  for (JointId j = 0; j < tree.numJoints(); ++j) {
    const int v = tree.quaternionVariable(j);
    if (v < 0 || in.below(8) == 0) continue;
    const double length = q.segment<4>(v).norm();
    q.segment<4>(v) =
        length > 1e-3 && length < 1e3 ? Eigen::Vector4d(q.segment<4>(v) / length) : Eigen::Vector4d(0, 0, 0, 1);
  }
  return q;
}

CertifiedRequest makeRequest(fuzz::Bytes& in) {
  static constexpr std::uint64_t kBudgets[] = {1, 100, 3000, 20000};
  CertifiedRequest request;
  request.work_budget = kBudgets[in.below(4)];
  request.mode = static_cast<ContactMode>(in.below(3));
  request.max_contacts = static_cast<std::size_t>(in.below(4));
  request.check_scene = in.below(8) != 0;
  request.check_self = in.below(4) != 0;
  request.ignore_initial_contact = in.below(4) == 0;
  if (in.below(4) == 0) request.margin = in.number();
  if (in.below(4) == 0) request.tolerance_time = in.number();
  if (in.below(4) == 0) request.tolerance_distance = in.number();
  if (in.below(4) == 0) request.method = Method::redon2004;
  return request;
}

/// How far inputs come; printed at the end, as cases that are all refused tell nothing.
struct Counts {
  long inputs = 0, set_up = 0, asked = 0, free = 0, contact = 0, compared = 0;
  ~Counts() {
    std::fprintf(stderr,
                 "api: %ld inputs, %ld set up; %ld queries, %ld free, %ld contacts; %ld poses of balls compared\n",
                 inputs, set_up, asked, free, contact, compared);
  }
} counts;

/// Two balls meet, deeper than any rounding here.
bool ballsMeet(const Eigen::Vector3d& a, double r, const Eigen::Vector3d& b, double s) {
  const double size = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), r, s, 1.0});
  return r > 0 && s > 0 && size < 1e6 && (a - b).norm() < r + s - 1e-6 * size;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes in(data, size);
  ++counts.inputs;
  const std::shared_ptr<KinematicTree> tree = makeTree(in);
  ArticulatedCollisionManager manager(tree);
  std::vector<Body> links, obstacles;
  for (int k = 1 + in.below(5); k > 0; --k) {
    Shape shape = makeShape(in);
    if (!shape.geometry) return 0;
    Body body{in.below(tree->numLinks()), in.pose(), std::make_unique<fcl::CollisionObjectd>(shape.geometry),
              shape.ball};
    if (accepted([&] { manager.bind(body.link, body.object.get(), body.offset); })) links.push_back(std::move(body));
  }
  for (int k = in.below(5); k > 0; --k) {
    Shape shape = makeShape(in);
    if (!shape.geometry) return 0;
    const Eigen::Isometry3d M = in.pose();
    Body body{-1, M, std::make_unique<fcl::CollisionObjectd>(shape.geometry, M), shape.ball};
    if (accepted([&] { manager.registerObject(body.object.get()); })) obstacles.push_back(std::move(body));
  }
  if (in.below(4) == 0) accepted([&] { manager.setMargin("l" + std::to_string(in.below(6)), in.number()); });
  if (!accepted([&] { manager.setup(); })) return 0;
  ++counts.set_up;

  const Eigen::VectorXd q0 = makeConfiguration(in, *tree), q1 = makeConfiguration(in, *tree);
  for (int asked = 0; asked < 2; ++asked) {
    const CertifiedRequest request = makeRequest(in);
    CertifiedResult result;
    const bool shortest = in.coin();
    std::unique_ptr<JointMotion> motion;
    if (!accepted([&] {
          motion = std::make_unique<JointMotion>(shortest ? JointMotion::shortest(*tree, q0, q1)
                                                          : JointMotion::linear(*tree, q0, q1));
        })) {
      return 0;
    }
    if (!accepted([&] { manager.continuousCollide(*motion, request, result); })) continue;
    ++counts.asked;
    counts.free += result.status == Status::free;
    counts.contact += result.status == Status::contact;
    if (!(result.t_lower >= 0 && result.t_lower <= 1)) fuzz::fault("t_lower is outside [0, 1]");
    if (result.status == Status::free && !result.contacts.empty()) fuzz::fault("free, with contacts");
    if (result.certain && !(result.t_lower <= result.t_upper)) fuzz::fault("an empty bracket");
    if (result.status == Status::contact && result.contacts.empty() && request.max_contacts > 0) {
      fuzz::fault("a contact without a contact");
    }
    for (const CertifiedContact& c : result.contacts) {
      if (!c.point.allFinite() || !c.normal.allFinite()) fuzz::fault("a contact's point or normal is not finite");
    }
    if (request.check_scene && !request.ignore_initial_contact) {
      const auto standsStill = [&](LinkId link) {  // as obstacles do: such pairs are not checked
        while (tree->parentJoint(link) >= 0 && tree->joint(tree->parentJoint(link)).type == JointType::fixed) {
          link = tree->parentLink(link);
        }
        return tree->parentJoint(link) < 0;
      };
      std::vector<Eigen::Isometry3d> M_0;
      const double until = result.status == Status::free ? 1 : result.t_lower;
      for (int s = 0; s <= 16; ++s) {
        const double t = s / 16.0;
        if (t > until || (t == until && result.status != Status::free)) break;
        tree->forwardKinematics(motion->configuration(t), M_0);
        for (const Body& a : links) {
          if (standsStill(a.link)) continue;
          for (const Body& b : obstacles) {
            counts.compared += a.ball > 0 && b.ball > 0;
            const Eigen::Vector3d x = M_0[static_cast<std::size_t>(a.link)] * a.offset.translation();
            if (ballsMeet(x, a.ball, b.offset.translation(), b.ball))
              fuzz::fault("a contact is missed at t = " + std::to_string(t));
          }
        }
      }
    }
    if (in.below(4) == 0) {
      accepted([&] {
        ClearanceRequest wanted;
        wanted.work_budget = request.work_budget;
        if (in.coin()) wanted.most = in.number();
        const Clearance c = manager.clearance(*motion, wanted);
        if (!(c.lower <= c.upper)) fuzz::fault("a clearance of nothing");
      });
    }
  }
  return 0;
}
