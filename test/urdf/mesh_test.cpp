// SPDX-License-Identifier: BSD-3-Clause
#include <fcl/geometry/bvh/BVH_model.h>

#include <algorithm>
#include <cmath>

#include "fcl_artic/solid_mesh.h"
#include "fcl_artic/urdf/urdf.h"
#include "temp_folder.h"

namespace fcl_artic {
namespace mesh_test {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

class MeshTest : public TempFolderTest {
 protected:
  std::shared_ptr<Model> load(const std::string& file, const Eigen::Vector3d& scale = {1, 1, 1}) {
    auto model = std::dynamic_pointer_cast<Model>(loadMesh(file, scale, &notes_));
    EXPECT_TRUE(model) << file << " is no BVHModel<OBBRSSd>";
    return model;
  }
  std::string errorOf(const std::string& file, const Eigen::Vector3d& scale = {1, 1, 1}) {
    return messageOf([&] { loadMesh(file, scale); });
  }
  std::vector<std::string> notes_;
};

// Two parts, one of them a quad: 3 triangles within [0, 4] x [0, 2] x [0, 1].
const char* const kTwoParts =
    "o quad\nv 0 0 0\nv 4 0 0\nv 4 2 0\nv 0 2 0\nf 1 2 3 4\n"
    "o triangle\nv 0 0 1\nv 1 0 1\nv 0 1 1\nf 5 6 7\n";

TEST_F(MeshTest, SumsPartsAndScalesEachAxis) {
  const auto model = load(write("parts.obj", kTwoParts), {0.5, -2, 3});
  ASSERT_EQ(model->num_tris, 3);
  EXPECT_EQ(model->aabb_local.min_, fcl::Vector3d(0, -4, 0));
  EXPECT_EQ(model->aabb_local.max_, fcl::Vector3d(2, 0, 3));
  EXPECT_TRUE(notes_.empty());
}

TEST_F(MeshTest, BrokenFacesAreRefused) {
  const auto ply = [](const std::string& faces) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" +
           faces;
  };
  expectContains(errorOf(write("a.ply", ply("0\n"))), "has a face without a corner");
  expectContains(errorOf(write("a.ply", ply("4 0 1 2 99999999\n"))), "has a face with vertex 99999999 of 3");
  expectContains(errorOf(write("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0\n")),
                 "has a face without a corner");
}

TEST_F(MeshTest, OffFacesOfManyCornersAreRead) {
  const auto polygon = [](int corners) {
    std::string file = "OFF\n" + std::to_string(corners) + " 1 0\n", face;
    for (int k = 0; k < corners; ++k) {
      file += std::to_string(std::cos(2 * M_PI * k / corners)) + " " +
              std::to_string(std::sin(2 * M_PI * k / corners)) + " 0\n";
      face += " " + std::to_string(k);
    }
    return file + std::to_string(corners) + face + "\n";
  };
  for (const int corners : {3, 9, 10, 40}) {
    EXPECT_EQ(load(write("a.off", polygon(corners)))->num_tris, corners - 2) << corners;
  }
}

TEST_F(MeshTest, APolygonOfOneCornerNineTimesHasNoArea) {
  const std::string nine = "OFF\n1 1 0\n0 0 0\n9 0 0 0 0 0 0 0 0 0\n";
  expectContains(errorOf(write("nine.off", nine)), "has no triangle with an area");
}

/// Area of all triangles.
double areaOf(const Model& model) {
  double area = 0;
  for (int t = 0; t < model.num_tris; ++t) {
    const fcl::Triangle& tri = model.tri_indices[t];
    const auto& x = model.vertices;
    area += (x[tri[1]] - x[tri[0]]).cross(x[tri[2]] - x[tri[0]]).norm() / 2;
  }
  return area;
}

// Corners that bend inward: a fan from the first corner would cover what is outside. In three planes, both ways round.
TEST_F(MeshTest, PolygonsThatAreNotConvexAreCoveredOnce) {
  // A comb with seven teeth: base 15 x 1, teeth 1 x 3. And an arrow whose first corner is across its dent.
  std::vector<std::vector<std::pair<int, int>>> shapes(2);
  shapes[0] = {{0, 0}, {15, 0}, {15, 1}};
  for (int x = 14; x > 0; x -= 2) {
    shapes[0].insert(shapes[0].end(), {{x, 1}, {x, 4}, {x - 1, 4}, {x - 1, 1}});
  }
  shapes[0].push_back({0, 1});
  shapes[1] = {{0, 0}, {4, 4}, {0, 3}, {-4, 4}};
  const double areas[] = {15 + 7 * 3, 12};
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    for (int plane = 0; plane < 3; ++plane) {
      for (const bool reversed : {false, true}) {
        for (std::size_t first = 0; first < shapes[s].size(); ++first) {
          auto corners = shapes[s];
          std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
          if (reversed) std::reverse(corners.begin(), corners.end());
          std::string file, face = "f";
          for (const auto& [u, v] : corners) {
            const std::string x = std::to_string(u), y = std::to_string(v);
            file += "v " + (plane == 0 ? x + " " + y + " 7" : plane == 1 ? "7 " + x + " " + y : y + " 7 " + x) + "\n";
          }
          for (std::size_t k = 1; k <= corners.size(); ++k) face += " " + std::to_string(k);
          const auto model = load(write("shape.obj", file + face + "\n"));
          EXPECT_LE(model->num_tris, static_cast<int>(corners.size()) - 2);
          EXPECT_NEAR(areaOf(*model), areas[s], 1e-9) << s << " " << plane << " " << reversed << " " << first;
        }
      }
    }
  }
}

// A prism over a polygon that is not convex, and over one that crosses itself. Each edge of a face is one of a
// triangle's, so the solid is closed.
TEST_F(MeshTest, CutPolygonsKeepSolidsClosed) {
  const std::vector<std::vector<std::pair<double, double>>> outlines = {{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}},
                                                                        {{0, 0}, {2, 2}, {2, 0}, {0, 2}},
                                                                        {{0, 0}, {1, 0}, {2, 0}, {1, 0}, {1, 5}}};
  for (const auto& outline : outlines) {
    const std::size_t n = outline.size();
    std::string file, bottom = "f", top = "f", sides;
    for (const int z : {0, 1}) {
      for (const auto& [x, y] : outline) {
        file += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
      }
    }
    for (std::size_t k = 1; k <= n; ++k) {
      const std::size_t next = k % n + 1;
      top += " " + std::to_string(n + k);
      bottom += " " + std::to_string(n + 1 - k);
      sides += "f " + std::to_string(k) + " " + std::to_string(next) + " " + std::to_string(n + next) + " " +
               std::to_string(n + k) + "\n";
    }
    EXPECT_NO_THROW(loadMesh(write("prism.obj", file + bottom + "\n" + top + "\n" + sides), {1, 1, 1}, nullptr, true));
  }
}

TEST_F(MeshTest, NumbersWithoutALeadingDigit) {
  const auto model = load(write("dot.obj", "v .5 -.25 +.125\nv 1. 0 0\nv 0 1.e1 -.5E-1\nf 1 2 3\n"));
  EXPECT_EQ(model->aabb_local.min_, fcl::Vector3d(0, -0.25, -0.05));
  EXPECT_EQ(model->aabb_local.max_, fcl::Vector3d(1, 10, 0.125));
}

// One triangle (0,0,0) (1,0,0) (0,2,0), written in all the ways that OBJ has.
TEST_F(MeshTest, ObjIsReadAsItsSpecificationSays) {
  const auto isTheTriangle = [&](const std::string& content) {
    notes_.clear();
    const auto model = load(write("t.obj", content));
    return model->num_tris == 1 && model->aabb_local.min_ == fcl::Vector3d(0, 0, 0) &&
           model->aabb_local.max_ == fcl::Vector3d(1, 2, 0) && notes_.empty();
  };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 2 0\n";
  EXPECT_TRUE(isTheTriangle(corners + "f 1 2 3\n"));
  EXPECT_TRUE(isTheTriangle(corners + "vn 0 0 1\nvt 0 0\ng a b\ns off\nusemtl m\nf 1//1 2//1 3//1\n"));
  EXPECT_TRUE(isTheTriangle(corners + "f 1/1 2/2/2 3/ # a comment\n"));
  EXPECT_TRUE(isTheTriangle(corners + "f -3 -2 -1\n")) << "back from where the face is";
  EXPECT_TRUE(isTheTriangle("f 1 2 3\n" + corners)) << "vertices that come later";
  EXPECT_TRUE(isTheTriangle(corners + "f 1 \\\n 2 \\ \n3\n"));
  EXPECT_TRUE(isTheTriangle("# C:\\meshes\\\n" + corners + "f 1 2 3\n")) << "a comment doesn't go on";
  EXPECT_TRUE(isTheTriangle("v 0 0 0 1\n\tv\t1 0 0  1.0\nv 0 2 0 1\nf 1 2 3\n")) << "weights";
  EXPECT_TRUE(isTheTriangle("v 0 0 0 .5 .5 .5\nv 1 0 0 1 0 0\nv 0 2 0 0 0 1\nf 1 2 3\n")) << "colours";
  std::string mac = corners + "f 1 2 3\n", dos;
  for (char& c : mac) {
    if (c == '\n') dos += '\r', c = '\r';
    dos += c == '\r' ? '\n' : c;
  }
  EXPECT_TRUE(isTheTriangle(dos));
  EXPECT_EQ(load(write("mac.obj", mac))->num_tris, 1);

  const auto error = [&](const std::string& content) { return errorOf(write("t.obj", corners + content)); };
  expectContains(error("f 1 2 4\n"), "t.obj': line 4: has a face with vertex 4 of 3");
  expectContains(error("f 1 2 0\n"), "has a face with vertex 0 of 3");
  expectContains(error("f -4 2 1\nv 1 1 1\n"), "has a face with vertex -4 of 3");
  expectContains(error("f 1 2 99999999999999999999\n"), "'99999999999999999999' names no vertex");
  expectContains(error("f\n"), "line 4: has a face without a corner");
  expectContains(error("f 1 2 x\n"), "'x' names no vertex");
  expectContains(error("v 1 2\n"), "line 4: '' is not a finite number");
  expectContains(error("v 1 2 0x3\n"), "'0x3' is not a finite number");
  expectContains(error("v 1 2 1e999\n"), "'1e999' is not a finite number");
  expectContains(error("curv 0 1 1 2\n"), "free-form curve");
  expectContains(error("f 1 2 3\nfoo 1\n"), "t.obj': line 5: 'foo' begins a line of no kind that OBJ files have");
}

TEST_F(MeshTest, StripsThatAreNotReadAreRefused) {
  const std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int int vertex_indices\nelement tristrips 1\nproperty list int int "
      "vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n4 0 1 2 3\n";
  expectContains(errorOf(write("a.ply", strips)), "triangle strips");
}

/// One triangle (0,0,0) (1,0,0) (0,2,0) under a node that moves it by (10, 0, 5).
std::string collada(const std::string& unit, const std::string& up) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter=")" +
         unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 2 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>10 0 5</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST_F(MeshTest, ColladaNodesAndUnitsCountAndUpAxisDoesNot) {
  for (const char* up : {"Z_UP", "Y_UP"}) {
    SCOPED_TRACE(up);
    const auto metres = load(write("metres.dae", collada("1", up)));
    EXPECT_EQ(metres->aabb_local.min_, fcl::Vector3d(10, 0, 5));
    EXPECT_EQ(metres->aabb_local.max_, fcl::Vector3d(11, 2, 5));
    const auto centimetres = load(write("centimetres.dae", collada("0.01", up)));
    EXPECT_LT((centimetres->aabb_local.max_ - fcl::Vector3d(0.11, 0.02, 0.05)).norm(), 1e-16);
  }
}

/// Corner k of the triangle, of a file whose up axis counts or does not.
Eigen::Vector3d corner(const std::string& file, bool up_axis, int k, std::vector<std::string>* notes) {
  const auto mesh = std::dynamic_pointer_cast<fcl::BVHModel<fcl::OBBRSSd>>(
      loadMesh(file, Eigen::Vector3d::Ones(), notes, false, up_axis));
  return mesh->vertices[mesh->tri_indices[0][static_cast<std::size_t>(k)]];
}

TEST_F(MeshTest, ColladaUpAxisCountsWhereItIsAskedForAndIsNoted) {
  const struct {
    const char* up;
    Eigen::Vector3d turned;  // of (10, 2, 5)
  } cases[] = {{"Z_UP", {10, 2, 5}}, {"Y_UP", {10, -5, 2}}, {"X_UP", {-2, -5, 10}}};
  for (const auto& c : cases) {
    const std::string file = write("a.dae", collada("1", c.up));
    std::vector<std::string> notes;
    EXPECT_LT((corner(file, false, 2, &notes) - Eigen::Vector3d(10, 2, 5)).norm(), 1e-6) << c.up;
    EXPECT_LT((corner(file, true, 2, &notes) - c.turned).norm(), 1e-6)
        << c.up << ": " << corner(file, true, 2, nullptr).transpose();
    ASSERT_EQ(notes.size(), c.up[0] == 'Z' ? 0u : 2u);
    if (notes.empty()) continue;
    expectContains(notes[0], "taken as it stands");
    expectContains(notes[1], "turned so that z is");
    corner(file, false, 2, &notes);
    EXPECT_EQ(notes.size(), 2u) << "told once";
  }
}

// Triangles without area are segments: those on an edge of another triangle add nothing, others stick out.
TEST_F(MeshTest, TrianglesWithoutAreaStayUnlessAnEdgeCoversThem) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.5 0 0\nv 7 7 7\nv 0 0 0\n";
  const auto loaded = [&](const std::string& faces, double scale = 1) {
    notes_.clear();
    return load(write("flat.obj", corners + faces), {scale, scale, scale});
  };
  for (const double scale : {1.0, 0.0254}) {
    EXPECT_EQ(loaded("f 1 2 3\nf 1 1 2\nf 2 6 6\nf 3 3 3\nf 6 1 1\n", scale)->num_tris, 1) << "edges and corners";
    ASSERT_EQ(notes_.size(), 2u);
    expectContains(notes_[0], "flat.obj': 2 of 6 vertices belong to no triangle");
    expectContains(notes_[1], "flat.obj': 4 of 5 triangles have no area, lie on edges of others");
  }
  // A wire to a far corner, once; a needle's point beyond its foot; a part of an edge.
  const auto wire = loaded("f 1 2 3\nf 1 1 5\nf 5 1 5\n");
  EXPECT_EQ(wire->num_tris, 2);
  EXPECT_EQ(wire->aabb_local.max_, fcl::Vector3d(7, 7, 7));
  EXPECT_EQ(loaded("f 1 2 3\nf 1 4 4\n")->num_tris, 2);
  EXPECT_EQ(loaded("f 1 2 3\nf 5 5 5\n")->num_tris, 2);
  EXPECT_EQ(loaded("f 1 2 3\nf 1 4 2\n")->num_tris, 2) << "no two corners are equal";
  // A needle 1e-6 as thin as long is a triangle.
  EXPECT_EQ(load(write("needle.obj", "v 0 0 0\nv 1 0 0\nv 1 0.000001 0\nf 1 2 3\n"))->num_tris, 1);
}

// A ball that goes through a wire, and through the point of a needle, of a mesh.
TEST_F(MeshTest, WiresAreTouched) {
  for (const char* face : {"f 1 1 4", "f 1 5 4"}) {
    const Scene scene = loadScene(
        write("wire.obj", "v 0 0 0\nv -1 0 0\nv -1 1 0\nv 2 0 0\nv 1 0 0\nf 1 2 3\n" + std::string(face) + "\n"));
    const Robot robot = loadUrdf(write("ball.urdf", R"(<robot name="r"><link name="base"/><link name="ball"><collision>
      <origin xyz="1.5 0 -1"/><geometry><sphere radius="0.1"/></geometry></collision></link><joint name="z" type="prismatic">
      <parent link="base"/><child link="ball"/><axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/>
      </joint></robot>)"));
    ArticulatedCollisionManager manager(robot.tree);
    robot.addTo(manager);
    scene.addTo(manager);
    manager.setup();
    const CertifiedResult result =
        manager.continuousCollide(Eigen::VectorXd::Constant(1, 0), Eigen::VectorXd::Constant(1, 2));
    ASSERT_EQ(result.status, Status::contact) << face;
    EXPECT_NEAR(result.first()->t_lower, 0.45, 1e-4);
  }
}

// At 5,400 km floats are half a metre apart.
TEST_F(MeshTest, CoordinatesOfAMapStayWhereTheyAre) {
  const std::string x = "451237.038 5411234.492 312.537", y = "451238.038 5411234.492 312.537",
                    z = "451237.038 5411235.492 312.537";
  const fcl::Vector3d corner(451237.038, 5411234.492, 312.537);
  const std::pair<std::string, std::string> files[] = {
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex " + x + "\nvertex " + y + "\nvertex " + z +
                    "\nendloop\nendfacet\nendsolid\n"},
      {"a.off", "OFF\n3 1 0\n" + x + "\n" + y + "\n" + z + "\n3 0 1 2\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
       "face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           x + "\n" + y + "\n" + z + "\n3 0 1 2\n"},
      {"a.obj", "v " + x + "\nv " + y + "\nv " + z + "\nf 1 2 3\n"}};
  for (const auto& [name, content] : files) EXPECT_EQ(load(write(name, content))->aabb_local.min_, corner) << name;
  std::string dae = collada("1", "Z_UP");
  dae.replace(dae.find("10 0 5"), 6, x);
  EXPECT_EQ(load(write("a.dae", dae))->aabb_local.min_, corner);
}

// Formats without a reader of our own.
TEST_F(MeshTest, OtherFormatsAreImportedOnlyWhenThatIsAskedFor) {
  const std::string file = write("a.smf", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expectContains(errorOf(file), "a.smf': its name ends in '.smf'");
  expectContains(errorOf(file), "--import");
  const std::string xml = R"(<?xml version="1.0"?><X3D><Scene/></X3D>)";
  for (const char* name : {"a.3mf", "a.amf", "a.x3d"}) {
    const std::string message = messageOf([&] { loadMesh(write(name, xml), {1, 1, 1}, nullptr, false, false, true); });
    expectContains(message, "whose units or parts get lost");
  }
  // AC3D, as text.
  const std::string ac =
      write("a.ac",
            "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\n"
            "kids 1\nOBJECT poly\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n"
            "0 0 0\n1 0 0\n2 0 0\nkids 0\n");
  expectContains(errorOf(ac), "--import");
  std::vector<std::string> notes;
  const auto model = std::dynamic_pointer_cast<Model>(loadMesh(ac, {1, 1, 1}, &notes, false, false, true));
  ASSERT_TRUE(model);
  EXPECT_EQ(model->num_tris, 1);
  ASSERT_EQ(notes.size(), 1u);
  expectContains(notes[0], "was read by assimp, as asked for");
}

// As a solid: triangles without area stay, as they may be what closes it; one that is open is refused.
TEST_F(MeshTest, SolidsMustBeClosed) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.5 0 0\n";
  const std::string closed = write("closed.obj", corners + "f 1 3 2\nf 1 5 4\nf 5 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 5\n");
  const auto solid = loadMesh(closed, {1, -1, 1}, &notes_, true);
  EXPECT_TRUE(std::dynamic_pointer_cast<SolidMesh<fcl::OBBRSSd>>(solid));
  EXPECT_EQ(std::dynamic_pointer_cast<Model>(solid)->num_tris, 6);
  EXPECT_TRUE(notes_.empty());
  EXPECT_EQ(load(closed)->num_tris, 6);
  EXPECT_FALSE(std::dynamic_pointer_cast<SolidMesh<fcl::OBBRSSd>>(loadMesh(closed, {1, 1, 1})));
  const std::string open = write("open.obj", corners + "f 1 3 2\nf 1 5 4\nf 5 2 4\nf 2 3 4\nf 1 2 5\n");
  const std::string message = messageOf([&] { loadMesh(open, {1, 1, 1}, nullptr, true); });
  expectContains(message, "open.obj'");
  expectContains(message, "not closed: 3 edges");
}

// A whole robot and scenes: a ball within a mesh is free of its surface, and not of the solid.
TEST_F(MeshTest, RobotsAndScenesOfSolids) {
  write("box.obj",
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n");
  const std::string mesh =
      "(scene)\n* m\n1\nmesh\n4 4\n-1 -1 -1\n3 0 0\n0 3 0\n0 0 3\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n"
      "0 0 0\n0 0 0 1\n0 0 0 0\n.\n";
  const std::string robot =
      write("ball.urdf", R"(<robot name="r"><link name="base"/><link name="ball"><collision><geometry>
      <sphere radius="0.1"/></geometry></collision></link><joint name="x" type="prismatic"><parent link="base"/>
      <child link="ball"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>)");
  const std::string boxes = write("box.urdf", R"(<robot name="b"><link name="box"><collision><geometry>
      <mesh filename="box.obj"/></geometry></collision></link></robot>)");
  const std::string cart =
      write("cart.urdf", R"(<robot name="c"><link name="base"/><link name="box"><collision><geometry>
      <mesh filename="box.obj" scale="1 1 -1"/></geometry></collision></link><joint name="x" type="prismatic">
      <parent link="base"/><child link="box"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
      </robot>)");
  const std::string small = write("small.scene", "(scene)\n* s\n1\nsphere\n0.1\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  const auto status = [&](const std::string& urdf, const std::string& scene_file, bool solid) {
    UrdfOptions options;
    SceneOptions scene_options;
    options.solid_meshes = scene_options.solid_meshes = solid;
    const Robot r = loadUrdf(urdf, options);
    const Scene scene = loadScene(scene_file, scene_options);
    ArticulatedCollisionManager manager(r.tree);
    r.addTo(manager);
    scene.addTo(manager);
    manager.setup();
    CertifiedResult result;
    manager.continuousCollide(
        JointMotion::linear(*r.tree, Eigen::VectorXd::Constant(1, 0), Eigen::VectorXd::Constant(1, 0.1)),
        CertifiedRequest(), result);
    return result.status;
  };
  for (const auto& [urdf, scene] :
       {std::make_pair(robot, path("box.obj")), {robot, boxes}, {robot, write("mesh.scene", mesh)}, {cart, small}}) {
    EXPECT_EQ(status(urdf, scene, false), Status::free) << urdf << " " << scene;
    EXPECT_EQ(status(urdf, scene, true), Status::contact) << urdf << " " << scene;
  }
}

TEST_F(MeshTest, ErrorsNameTheFile) {
  expectContains(errorOf(path("missing.stl")), "missing.stl': no such file");
  expectContains(errorOf(folder_.string()), "': is a directory, not a file");
  expectContains(errorOf(write("empty.stl", "")), "empty.stl");
  expectContains(errorOf(write("none.stl", "solid none\nendsolid none\n")), "none.stl");
  expectContains(errorOf(write("points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n")), "points.obj");
  expectContains(errorOf(write("thing.xyz", "1 2 3")), "thing.xyz");
  expectContains(errorOf(write("garbage.dae", "<COLLADA><asset>")), "garbage.dae");
  expectContains(errorOf(write("collinear.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n")),
                 "collinear.obj': has no triangle with an area");
  expectContains(errorOf(write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")), "nan.obj");
  const std::string good = write("good.obj", kTwoParts);
  EXPECT_NO_THROW(load(good));
  expectContains(errorOf(good, {1, 0, 1}), "good.obj': its scale");
  expectContains(errorOf(good, {1, 1, INFINITY}), "good.obj': its scale");
}

TEST_F(MeshTest, TruncatedBinaryStlIsAnError) {
  std::string stl(80, ' ');
  stl += std::string("\x02\0\0\0", 4) + std::string(50, '\0');  // announces 2 triangles, holds 1
  expectContains(errorOf(write("short.stl", stl)), "short.stl");
}

}  // namespace
}  // namespace mesh_test
}  // namespace fcl_artic
