// SPDX-License-Identifier: BSD-3-Clause
//
// Normals of bodies that are in each other from the start: along them the two pieces that are named part by the least
// depth. How deep the bodies are is known, as they are brought together from where they just touch.
#include "fcl_artic/continuous_collision.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <gtest/gtest.h>

#include "fcl_artic/point_cloud.h"

namespace parting_normals_test {
namespace {

using namespace fcl_artic;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;
using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return a + (b - a) * std::ldexp(static_cast<double>(engine_() >> 11), -53); }
  Vector3d vector() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  Isometry3d turn() {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)).normalized().toRotationMatrix();
    return pose;
  }

 private:
  std::mt19937_64 engine_;
};

const char* const kKinds[] = {"sphere",    "capsule", "box",  "cylinder",  "cone",
                              "ellipsoid", "convex",  "mesh", "halfspace", "cloud"};
constexpr int kNumKinds = 10;

const std::vector<Vector3d> kCorners{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}, {0, 0, -1}};  // of a tetrahedron
const std::vector<fcl::Triangle> kFaces{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

std::vector<Vector3d> times(double s, std::vector<Vector3d> points) {
  for (Vector3d& p : points) p *= s;
  return points;
}

Geometry tetrahedron(double s, bool mesh) {
  if (mesh) {
    auto out = std::make_shared<Mesh>();
    out->beginModel();
    out->addSubModel(times(s, kCorners), kFaces);
    out->endModel();
    return out;
  }
  auto faces = std::make_shared<std::vector<int>>();
  for (const fcl::Triangle& f : kFaces) {
    faces->push_back(3);
    for (int k = 0; k < 3; ++k) faces->push_back(static_cast<int>(f[k]));
  }
  return std::make_shared<fcl::Convexd>(std::make_shared<std::vector<Vector3d>>(times(s, kCorners)), 4, faces);
}

Geometry make(int kind, Random& random, double s) {
  switch (kind) {
    case 0:
      return std::make_shared<fcl::Sphered>(s);
    case 1:
      return std::make_shared<fcl::Capsuled>(0.5 * s, s);
    case 2:
      return std::make_shared<fcl::Boxd>(2 * s, s, 1.5 * s);
    case 3:
      return std::make_shared<fcl::Cylinderd>(s, 2 * s);
    case 4:
      return std::make_shared<fcl::Coned>(s, 2 * s);
    case 5:
      return std::make_shared<fcl::Ellipsoidd>(s, 0.6 * s, 0.8 * s);
    case 6:
    case 7:
      return tetrahedron(s, kind == 7);
    case 8:
      return std::make_shared<fcl::Halfspaced>(random.vector().normalized(), 0.0);
  }
  std::vector<Vector3d> points;
  for (int i = 0; i < 5; ++i) points.push_back(s * random.vector());
  return std::make_shared<PointCloud>(points, 0.2 * s);
}

/// The piece of a body that a contact names, as a body; the body itself where it is one piece.
Geometry pieceOf(const Geometry& body, std::intptr_t number) {
  if (const auto* mesh = dynamic_cast<const Mesh*>(body.get())) {
    const fcl::Triangle& t = mesh->tri_indices[number];
    return std::make_shared<fcl::TriangleP<double>>(mesh->vertices[t[0]], mesh->vertices[t[1]], mesh->vertices[t[2]]);
  }
  if (const auto* cloud = dynamic_cast<const PointCloud*>(body.get())) {
    const auto i = static_cast<std::size_t>(number);
    return std::make_shared<PointCloud>(std::vector<Vector3d>{cloud->points()[i]}, cloud->radius(i));
  }
  return body;
}

bool apart(const Geometry& a, const Isometry3d& A, const Geometry& b, const Isometry3d& B) {
  CertifiedPairRequest request;
  CertifiedPairResult result;
  request.max_contacts = 0;
  continuousCollide(a.get(), A, A, b.get(), B, B, fcl::CCDM_TRANS, request, result);
  return result.isFree();
}

Isometry3d moved(Isometry3d pose, const Vector3d& by) {
  pose.translation() += by;
  return pose;
}

/// Two bodies that just touch, with B farther along `out` apart; false where they are not found so.
bool bringTogether(const Geometry& a, const Isometry3d& A, const Geometry& b, Isometry3d& B, Vector3d& out) {
  constexpr double kFar = 20;
  if (!apart(a, A, b, moved(B, kFar * out))) out = -out;  // into a half-space
  if (!apart(a, A, b, moved(B, kFar * out))) return false;
  double far = kFar, near = kFar;
  while (near > -kFar && apart(a, A, b, moved(B, near * out))) near -= 0.05;
  if (near <= -kFar) return false;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (near + far);
    (apart(a, A, b, moved(B, middle * out)) ? far : near) = middle;
  }
  B = moved(B, near * out);
  return true;
}

TEST(PartingNormals, TheNamedPiecesPartAlongThemByTheLeastDepth) {
  constexpr int kCases = 4;
  int asked = 0, deep = 0;
  for (int i = 0; i < kNumKinds; ++i) {
    for (int j = 0; j < kNumKinds; ++j) {
      if (i == 8 && j == 8) continue;
      for (int k = 0; k < kCases; ++k) {
        const std::string name = std::string(kKinds[i]) + ", " + kKinds[j] + ", case " + std::to_string(k);
        Random random(static_cast<std::uint64_t>(1000 * (kNumKinds * i + j) + k));
        const double size = k % 2 ? 1 : std::pow(10, random.in(-4, 0));
        const Geometry a = make(i, random, 1), b = make(j, random, size);
        const Isometry3d A = random.turn();
        Vector3d out = random.vector().normalized();
        Isometry3d B = moved(random.turn(), 0.7 * random.vector());
        if (!bringTogether(a, A, b, B, out)) continue;
        const double depth = size * std::pow(10, random.in(-5, -2));
        B = moved(B, -depth * out);
        CertifiedPairRequest request;
        CertifiedPairResult result;
        continuousCollide(a.get(), A, A, b.get(), B, moved(B, random.vector()), fcl::CCDM_TRANS, request, result);
        if (result.t_upper > 0) continue;
        ASSERT_EQ(result.contacts.size(), 1u) << name;
        const CertifiedContact& c = result.contacts[0];
        ++asked;
        EXPECT_NEAR(c.normal.norm(), 1, 1e-9) << name;
        if (c.feature != FeatureKind::volume) continue;  // of two triangles it is that of the features that meet
        ++deep;
        // They part along `out` by this depth, so the least depth is no larger. The 2 % are for curved bodies: a
        // polytope with some hundred corners stands for them.
        const Geometry of_a = pieceOf(a, c.b1), of_b = pieceOf(b, c.b2);
        EXPECT_TRUE(apart(of_a, A, of_b, moved(B, 1.02 * depth * c.normal + 2e-6 * c.normal)))
            << name << ": size " << size << ", depth " << depth << ", normal " << c.normal.transpose() << ", out "
            << out.transpose();
      }
    }
  }
  EXPECT_GT(asked, 200);
  EXPECT_GT(deep, 190);
}

// The direction between their middles, (0, -1, 0), lies in the face.
TEST(PartingNormals, ABallOnAFacePartsAcrossTheFace) {
  const Isometry3d here = Isometry3d::Identity();
  for (const double radius : {1e-4, 1e-2}) {
    for (const bool mesh : {true, false}) {
      const Geometry a = tetrahedron(1, mesh), b = std::make_shared<fcl::Sphered>(radius);
      for (const Vector3d& at : {Vector3d(0, -0.3333, 1), Vector3d(0, -0.9, 1), Vector3d(0.1, 0.2, 1)}) {
        CertifiedPairRequest request;
        CertifiedPairResult result;
        continuousCollide(a.get(), here, here, b.get(), moved(here, at), moved(here, at + Vector3d::UnitX()),
                          fcl::CCDM_TRANS, request, result);
        ASSERT_EQ(result.contacts.size(), 1u);
        EXPECT_NEAR(result.contacts[0].normal.z(), 1, 1e-6) << at.transpose() << (mesh ? ", mesh" : ", convex");
      }
    }
  }
}

}  // namespace
}  // namespace parting_normals_test
