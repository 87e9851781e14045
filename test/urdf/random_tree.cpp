// SPDX-License-Identifier: BSD-3-Clause
#include "random_tree.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numeric>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/bv/OBBRSS.h>

namespace urdf_trees {
namespace {

using fcl_artic::JointType;

struct MeshData {
  const char* name;
  std::vector<Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
};

MeshData extruded(const char* name, const std::vector<Vector3d>& bottom, const std::vector<fcl::Triangle>& lids) {
  MeshData mesh = {name, bottom, lids};
  const std::size_t n = bottom.size();
  for (const Vector3d& v : bottom) mesh.vertices.push_back(v + Vector3d(0, 0, 1));
  for (const fcl::Triangle& t : lids) mesh.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    mesh.triangles.emplace_back(i, j, j + n);
    mesh.triangles.emplace_back(i, j + n, i + n);
  }
  for (Vector3d& v : mesh.vertices) v -= Vector3d::Constant(0.5);
  return mesh;
}

/// About 1 across: a tetrahedron, an L (not convex), a wall without thickness (not closed).
const std::vector<MeshData>& meshes() {
  using T = fcl::Triangle;
  static const std::vector<MeshData> all = {
      {"tetrahedron.obj",
       {{0.5, 0.5, 0.5}, {0.5, -0.5, -0.5}, {-0.5, 0.5, -0.5}, {-0.5, -0.5, 0.5}},
       {T(0, 1, 2), T(0, 3, 1), T(0, 2, 3), T(1, 3, 2)}},
      extruded("angle.obj", {{0, 0, 0}, {1, 0, 0}, {1, 0.3, 0}, {0.3, 0.3, 0}, {0.3, 1, 0}, {0, 1, 0}},
               {T(0, 1, 2), T(0, 2, 3), T(0, 3, 4), T(0, 4, 5)}),
      {"wall.obj", {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}}, {T(0, 1, 2), T(0, 2, 3)}},
  };
  return all;
}

std::string text(const char* format, double x, double y, double z) {
  char buffer[120];
  std::snprintf(buffer, sizeof buffer, format, x, y, z);
  return buffer;
}

struct Origin {
  Isometry3d M;
  std::string element;
};

/// URDF's angles: about the fixed axes x, then y, then z.
Origin randomOrigin(pairs::Random& random, double distance) {
  const Vector3d xyz = random.vector(0, distance);
  double rpy[3];
  for (double& angle : rpy) angle = random.chance(0.3) ? 0 : random.uniform(-3.2, 3.2);
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
       Eigen::AngleAxisd(rpy[0], Vector3d::UnitX()))
          .toRotationMatrix();
  Isometry3d M = Isometry3d::Identity();
  M.translation() = xyz;
  M.linear() = R;
  return {M, text("<origin xyz='%.17g %.17g %.17g' ", xyz[0], xyz[1], xyz[2]) +
                 text("rpy='%.17g %.17g %.17g'/>", rpy[0], rpy[1], rpy[2])};
}

Eigen::Quaterniond slerp(const double* from, const double* to, double t) {
  const Eigen::Quaterniond a(from[3], from[0], from[1], from[2]), b(to[3], to[0], to[1], to[2]);
  return a.normalized().slerp(t, b.normalized());
}

bool hasOneValue(JointType type) {
  return type == JointType::revolute || type == JointType::continuous || type == JointType::prismatic;
}

template <class T>
void shuffle(pairs::Random& random, std::vector<T>& items) {
  for (std::size_t i = items.size(); i > 1; --i) {
    std::swap(items[i - 1], items[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  }
}

}  // namespace

const char* typeName(JointType type) {
  switch (type) {
    case JointType::fixed:
      return "fixed";
    case JointType::revolute:
      return "revolute";
    case JointType::continuous:
      return "continuous";
    case JointType::prismatic:
      return "prismatic";
    case JointType::planar:
      return "planar";
    default:
      return "floating";
  }
}

void writeMeshes(const std::string& folder) {
  for (const MeshData& mesh : meshes()) {
    std::ofstream out(folder + "/" + mesh.name);
    for (const Vector3d& v : mesh.vertices) out << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
    for (const fcl::Triangle& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
}

Shape randomShape(pairs::Random& random, double size, const std::string& folder) {
  Shape shape;
  const Origin origin = randomOrigin(random, size);
  shape.offset = origin.M;
  std::string geometry;
  const auto make = [&](const auto& sized) {
    shape.exact = sized(0);
    shape.smaller = sized(-kAround);
    shape.larger = sized(kAround);
  };
  switch (random.below(4)) {
    case 0: {
      const Vector3d side(random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size);
      make([&](double more) { return std::make_shared<fcl::Boxd>(side + Vector3d::Constant(2 * more)); });
      shape.radius = 0.5 * side.norm() + 2 * kAround;
      geometry = text("<box size='%.17g %.17g %.17g'/>", side[0], side[1], side[2]);
      break;
    }
    case 1: {
      const double radius = random.uniform(0.1, 0.5) * size;
      make([&](double more) { return std::make_shared<fcl::Sphered>(radius + more); });
      shape.radius = radius + kAround;
      geometry = text("<sphere radius='%.17g'/>", radius, 0, 0);
      break;
    }
    case 2: {
      const double radius = random.uniform(0.05, 0.4) * size, length = random.uniform(0.2, 1.2) * size;
      make([&](double more) { return std::make_shared<fcl::Cylinderd>(radius + more, length + 2 * more); });
      shape.radius = radius + 0.5 * length + 2 * kAround;
      geometry = text("<cylinder radius='%.17g' length='%.17g'/>", radius, length, 0);
      break;
    }
    default: {
      const MeshData& data = meshes()[static_cast<std::size_t>(random.below(static_cast<int>(meshes().size())))];
      const Vector3d scale(random.uniform(0.2, 1) * size, random.uniform(0.2, 1) * size, random.uniform(0.2, 1) * size);
      const auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
      std::vector<Vector3d> vertices;
      for (const Vector3d& v : data.vertices) {
        vertices.push_back(v.cwiseProduct(scale));
        shape.radius = std::max(shape.radius, vertices.back().norm() + kAround);
      }
      mesh->beginModel();
      mesh->addSubModel(vertices, data.triangles);
      mesh->endModel();
      make([&](double) { return mesh; });
      shape.mesh = true;
      geometry = "<mesh filename='" + folder + "/" + data.name + "' " +
                 text("scale='%.17g %.17g %.17g'/>", scale[0], scale[1], scale[2]);
    }
  }
  shape.element = "<collision>" + origin.element + "<geometry>" + geometry + "</geometry></collision>";
  return shape;
}

bool Link::moves(const std::vector<Link>& links) const {
  if (type == JointType::fixed) return false;
  return master < 0 || links[static_cast<std::size_t>(master)].moves(links);
}

RandomTree::RandomTree(pairs::Random& random, const std::string& folder) {
  const int count = 1 + random.below(40);
  const double branching = random.uniform(0, 1);
  static const JointType kinds[] = {JointType::revolute,   JointType::revolute,  JointType::continuous,
                                    JointType::continuous, JointType::prismatic, JointType::prismatic,
                                    JointType::fixed,      JointType::planar,    JointType::floating};
  for (int i = 0; i < count; ++i) {
    Link link;
    if (i > 0) {
      link.parent = random.chance(branching) ? random.below(i) : i - 1;
      link.type = kinds[random.below(9)];
      const Origin origin = randomOrigin(random, 0.5);
      link.origin = origin.M;
      link.origin_element = origin.element;
      link.axis = random.chance(0.5) ? Vector3d(Vector3d::Unit(random.below(3))) : random.vector(0.5, 2);
      if (hasOneValue(link.type) && i > 1 && random.chance(0.2)) {
        const int master = 1 + random.below(i - 1);
        const Link& followed = links_[static_cast<std::size_t>(master)];
        if (hasOneValue(followed.type) || followed.type == JointType::fixed) {  // a mimic too
          link.master = master;
          link.multiplier = random.uniform(-1.5, 1.5);
          link.joint_offset = random.uniform(-0.5, 0.5);
        }
      }
    }
    const int shapes = random.chance(0.15) ? 0 : 1 + (random.chance(0.2) ? random.below(3) : 0);
    for (int k = 0; k < shapes; ++k) link.shapes.push_back(randomShape(random, 0.3, folder));
    links_.push_back(std::move(link));
  }
  if (links_.back().shapes.empty()) links_.back().shapes.push_back(randomShape(random, 0.3, folder));
}

std::string RandomTree::urdf(pairs::Random& random) const {
  std::vector<std::string> elements;
  for (int i = 0; i < static_cast<int>(links_.size()); ++i) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    std::string element = "<link name='" + linkName(i) + "'>";
    for (const Shape& shape : link.shapes) element += shape.element;
    elements.push_back(element + "</link>\n");
    if (link.parent < 0) continue;
    element = "<joint name='" + jointName(i) + "' type='" + typeName(link.type) + "'><parent link='" +
              linkName(link.parent) + "'/><child link='" + linkName(i) + "'/>" + link.origin_element +
              text("<axis xyz='%.17g %.17g %.17g'/>", link.axis[0], link.axis[1], link.axis[2]);
    if (link.type == JointType::revolute || link.type == JointType::prismatic) {
      element += "<limit lower='-4' upper='4' effort='1' velocity='1'/>";
    }
    if (link.master >= 0) {
      element += "<mimic joint='" + jointName(link.master) + "' " +
                 text("multiplier='%.17g' offset='%.17g'/>", link.multiplier, link.joint_offset, 0);
    }
    elements.push_back(element + "</joint>\n");
  }
  shuffle(random, elements);
  return "<?xml version='1.0'?>\n<robot name='tree'>\n" +
         std::accumulate(elements.begin(), elements.end(), std::string()) + "</robot>\n";
}

std::vector<JointWay> RandomTree::way(pairs::Random& random, double reach) const {
  std::vector<JointWay> all;
  for (const Link& link : links_) {
    JointWay way;
    const double size = link.type == JointType::prismatic ? reach / 3 : reach;
    const auto add = [&](double from, double change) {
      way.from.push_back(from);
      way.to.push_back(from + change);
    };
    if (hasOneValue(link.type)) add(random.uniform(-1, 1), random.uniform(-size, size));
    if (link.type == JointType::planar || link.type == JointType::floating) {
      const int lengths = link.type == JointType::planar ? 2 : 3;
      for (int k = 0; k < lengths; ++k) add(random.uniform(-0.3, 0.3), random.uniform(-size, size) / 3);
      if (link.type == JointType::planar) add(random.uniform(-1, 1), random.uniform(-size, size));
    }
    if (link.type == JointType::floating) {
      const Eigen::Quaterniond from(random.rotation()),
          to(from * Eigen::Quaterniond(random.rotation(std::min(3.1, size))));
      const double sign = random.chance(0.5) ? 1 : -1;  // of two quaternions that are one rotation
      for (int k = 0; k < 4; ++k) {
        way.from.push_back(from.coeffs()[k]);
        way.to.push_back(sign * to.coeffs()[k]);
      }
    }
    all.push_back(std::move(way));
  }
  return all;
}

std::vector<Isometry3d> RandomTree::poses(const std::vector<JointWay>& way, double t) const {
  const auto value = [&](int joint, std::size_t k) {
    const JointWay& w = way[static_cast<std::size_t>(joint)];
    return w.from.empty() ? 0 : (1 - t) * w.from[k] + t * w.to[k];
  };
  std::vector<Isometry3d> M_0(links_.size(), Isometry3d::Identity());
  std::vector<double> values(links_.size());  // masters come before their followers here
  for (int i = 0; i < static_cast<int>(links_.size()); ++i) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    if (link.parent < 0) continue;
    Isometry3d& M = M_0[static_cast<std::size_t>(i)];
    M = M_0[static_cast<std::size_t>(link.parent)] * link.origin;
    const Vector3d axis = link.axis.normalized();
    double& q = values[static_cast<std::size_t>(i)];
    if (hasOneValue(link.type)) {
      q = link.master < 0 ? value(i, 0)
                          : link.multiplier * values[static_cast<std::size_t>(link.master)] + link.joint_offset;
    }
    switch (link.type) {
      case JointType::fixed:
        break;
      case JointType::revolute:
      case JointType::continuous:
        M.rotate(Eigen::AngleAxisd(q, axis));
        break;
      case JointType::prismatic:
        M.translate(q * axis);
        break;
      case JointType::planar:
        M.translate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis) *
                    Vector3d(value(i, 0), value(i, 1), 0));
        M.rotate(Eigen::AngleAxisd(value(i, 2), axis));
        break;
      default: {
        const JointWay& w = way[static_cast<std::size_t>(i)];
        M.translate(Vector3d(value(i, 0), value(i, 1), value(i, 2)));
        M.rotate(slerp(&w.from[3], &w.to[3], t));
      }
    }
  }
  return M_0;
}

int RandomTree::carrier(int i) const {
  while (i >= 0) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    if (link.parent >= 0 && link.moves(links_)) break;
    i = link.parent;
  }
  return i;
}

}  // namespace urdf_trees
