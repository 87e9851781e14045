// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <set>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <png.h>

#include "render/image.h"
#include "render/text.h"
#include "render/triangles.h"
#include "run_program.h"

namespace picture_test {

namespace {

using fcl_artic::render::Image;
using fcl_artic::render::Triangles;
using fcl_artic::render::triangulate;

/// Volume inside a closed mesh that is wound counter-clockwise seen from outside (divergence theorem).
double volume(const Triangles& t) {
  double sum = 0;
  for (const auto& [a, b, c] : t.faces) {
    const auto at = [&](int i) { return t.vertices.at(static_cast<std::size_t>(i)); };
    sum += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return sum;
}

/// A prism with 64 sides has 0.9984 of its cylinder's volume; a ball of 64 by 32 facets a little less of its ball's.
constexpr double kShare = 0.99;

TEST(Triangulate, ShapesHaveTheirVolume) {
  EXPECT_NEAR(volume(triangulate(fcl::Boxd(1, 2, 3))), 6, 1e-12);
  const struct {
    std::shared_ptr<fcl::CollisionGeometryd> shape;
    double volume;
  } cases[] = {
      {std::make_shared<fcl::Sphered>(0.5), 4 * M_PI / 3 * 0.125},
      {std::make_shared<fcl::Ellipsoidd>(0.5, 1, 2), 4 * M_PI / 3},
      {std::make_shared<fcl::Cylinderd>(0.5, 2), M_PI * 0.5},
      {std::make_shared<fcl::Coned>(0.5, 3), M_PI * 0.25},
      {std::make_shared<fcl::Capsuled>(0.5, 2), M_PI * 0.5 + 4 * M_PI / 3 * 0.125},
  };
  for (const auto& c : cases) {
    const double got = volume(triangulate(*c.shape));
    EXPECT_LT(got, c.volume) << c.shape->getNodeType();
    EXPECT_GT(got, kShare * c.volume) << c.shape->getNodeType();
  }
}

TEST(Triangulate, ConvexAndMeshesOfAnyTree) {
  const auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>(
      std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}});
  const auto faces = std::make_shared<std::vector<int>>(
      std::vector<int>{4, 0, 3, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4, 3, 2, 3, 4, 3, 3, 0, 4});
  EXPECT_NEAR(volume(triangulate(fcl::Convexd(vertices, 5, faces))), 1.0 / 3, 1e-12);

  const auto tetrahedron = [](auto model) {
    model.beginModel();
    const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    model.addTriangle(o, y, x);
    model.addTriangle(o, x, z);
    model.addTriangle(o, z, y);
    model.addTriangle(x, y, z);
    model.endModel();
    return volume(triangulate(model));
  };
  EXPECT_NEAR(tetrahedron(fcl::BVHModel<fcl::AABBd>()), 1.0 / 6, 1e-12);
  EXPECT_NEAR(tetrahedron(fcl::BVHModel<fcl::OBBd>()), 1.0 / 6, 1e-12);
  EXPECT_NEAR(tetrahedron(fcl::BVHModel<fcl::OBBRSSd>()), 1.0 / 6, 1e-12);
  EXPECT_NEAR(tetrahedron(fcl::BVHModel<fcl::KDOPd<24>>()), 1.0 / 6, 1e-12);
}

TEST(Title, StaysInsideTheImage) {
  Image image{200, 100, std::vector<std::uint8_t>(200 * 100 * 3, 200)};
  const Image before = image;
  drawTitle(image, "");
  EXPECT_EQ(image.rgb, before.rgb);
  drawTitle(image, std::string(500, 'W') + "\x01");
  std::size_t dark = 0, changed_at_right = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) {
      const std::uint8_t value = image.rgb[static_cast<std::size_t>(3 * (200 * y + x))];
      dark += value < 120;
      changed_at_right += x >= 198 && value != 200;
    }
  }
  EXPECT_GT(dark, 20u);
  EXPECT_EQ(changed_at_right, 0u);
}

Image readPng(const std::string& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&header, file.c_str())) {
    ADD_FAILURE() << file << ": " << header.message;
    return {};
  }
  header.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr));
  return image;
}

std::size_t countPixels(const Image& image, bool (*is)(int r, int g, int b)) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) count += is(image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]);
  return count;
}

bool isRed(int r, int g, int b) {
  return r > 120 && 2 * g < r && 2 * b < r;
}
bool isAmber(int r, int g, int b) {
  return r > 150 && g > 90 && 2 * b < r && g < r;
}

TEST_F(ProgramTest, PictureShowsTheContact) {
  const std::string file = path("contact.png");
  const Outcome run =
      this->run("check " + armAndBall() + " --from 0,0 --to 90deg,0 --image " + file + " --size 320x200");
  ASSERT_EQ(run.status, 1) << run.err;
  const Image image = readPng(file);
  EXPECT_EQ(image.width, 320);
  EXPECT_EQ(image.height, 200);
  std::set<int> colors;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    colors.insert(image.rgb[i] << 16 | image.rgb[i + 1] << 8 | image.rgb[i + 2]);
  }
  EXPECT_GT(colors.size(), 500u);
  EXPECT_GT(countPixels(image, isRed), 60u) << "the link that touches, and the contact's mark";
  EXPECT_GT(countPixels(image, isAmber), 20u) << "the obstacle that is touched";
}

TEST_F(ProgramTest, PictureOfAFreeMotionHasNoContact) {
  const std::string file = path("free.png");
  const Outcome run = this->run("check " + armAndBall() + " --from 0,0 --to 40deg,0 --image " + file +
                                " --size 320x200 --camera -60,30");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(countPixels(readPng(file), isRed), 0u);
}

TEST_F(ProgramTest, PictureFollowsTheCamera) {
  const std::string query = "check " + armAndBall() + " --from 0,0 --to 90deg,0 --size 160x100 --image ";
  ASSERT_EQ(this->run(query + path("a.png") + " --camera 0,30").status, 1);
  ASSERT_EQ(this->run(query + path("b.png") + " --camera 90,30").status, 1);
  ASSERT_EQ(this->run(query + path("c.png") + " --camera 0,90").status, 1);
  EXPECT_NE(readPng(path("a.png")).rgb, readPng(path("b.png")).rgb);
  EXPECT_NE(readPng(path("a.png")).rgb, readPng(path("c.png")).rgb);
}

TEST_F(ProgramTest, UnwritablePictureIsAnError) {
  const Outcome run = this->run("check --robot " + arm() + " --from 0,0 --to 1,0 --size 64x64 --image /nowhere/x.png");
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("/nowhere/x.png"), std::string::npos) << run.err;
}

}  // namespace

}  // namespace picture_test
