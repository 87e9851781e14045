// SPDX-License-Identifier: BSD-3-Clause
#include "picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "kinematics/angles.h"
#include "renderer.h"
#include "text.h"
#include "triangles.h"

namespace fcl_artic::render {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Poses = std::vector<Isometry3d>;

/// Linear colour of an sRGB value 0xRRGGBB.
Vector3f color(unsigned hex) {
  const auto linear = [](unsigned byte) {
    const double c = byte / 255.0;
    return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  };
  return {linear(hex >> 16 & 255), linear(hex >> 8 & 255), linear(hex & 255)};
}

// Links in cool colours, the scene in sand: red and amber are left for what touches.
constexpr unsigned kLinkColors[] = {0x64748B, 0x3F7CAC, 0x5AA9A2, 0x6C83C9, 0x8FB8DE,
                                    0x4C956C, 0x8E7DBE, 0x2F6690, 0x7FB69A};
constexpr unsigned kObstacleColors[] = {0xD3CCBF, 0xC6BFB2, 0xDAD5CB, 0xBDB8AE};
constexpr unsigned kTouchingLink = 0xE4572E, kTouchingObstacle = 0xF2A93B, kMarker = 0xC1121F;
constexpr unsigned kGhostBefore = 0x4A90D9, kGhostAfter = 0xA8A29A, kTrace = 0xE4572E;

/// Links as they are drawn at any pose.
struct LinkPart {
  LinkId link;
  Isometry3d offset;
  std::shared_ptr<const Surface> surface;
};

struct Ball {
  Vector3d center = Vector3d::Zero();
  double radius = 1;
};

class Surfaces {
 public:
  std::shared_ptr<const Surface> of(const fcl::CollisionGeometryd* geometry) {
    auto& slot = known_[geometry];
    if (!slot) slot = makeSurface(triangulate(*geometry));
    return slot;
  }

 private:
  std::map<const fcl::CollisionGeometryd*, std::shared_ptr<const Surface>> known_;
};

/// Some corners of a body in the world: enough to frame it.
void addSample(const Surface& surface, const Isometry3d& M_0, std::vector<Vector3d>& points) {
  const std::size_t step = std::max<std::size_t>(1, surface.corners.size() / 300);
  for (std::size_t i = 0; i < surface.corners.size(); i += step)
    points.push_back(M_0 * surface.corners[i].cast<double>());
}

Ball ballAround(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  if (box.isEmpty()) return {};
  Ball ball{box.center(), 0};
  for (const Vector3d& p : points) ball.radius = std::max(ball.radius, (p - ball.center).norm());
  ball.radius = std::max(ball.radius, 1e-3);
  return ball;
}

Vector3d towardsCamera(double azimuth, double elevation) {
  const double a = azimuth * kPi / 180, e = elevation * kPi / 180;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

/// The nearest camera in the given direction that has all points in view, with some air around them.
Camera frame(const std::vector<Vector3d>& points, const Ball& ball, const Vector3d& direction, double aspect) {
  constexpr double kAir = 1.10;
  constexpr double kTitle = 0.89;  // share of the upper half that the title leaves
  const double tan_y = std::tan(kFieldOfView / 2) / kAir, tan_x = tan_y * aspect, tan_up = kTitle * tan_y;
  const Vector3d up = std::abs(direction.z()) > 0.9999 ? Vector3d::UnitY() : Vector3d::UnitZ();
  const Vector3d x = up.cross(direction).normalized(), y = direction.cross(x);
  // A point at (px, py, pz) along x, y, direction is in view from (cx, cy, cz) when px - cx and cx - px are at most (cz
  // - pz) tan_x. That is cx >= px + pz tan_x - cz tan_x and cx <= px - pz tan_x + cz tan_x. The extremes over the
  // points give the least cz, and cx in the middle of the values that are left. Likewise y.
  double high_x = -1e300, low_x = 1e300, high_y = -1e300, low_y = 1e300;
  for (const Vector3d& p : points) {
    const double px = p.dot(x), py = p.dot(y), pz = p.dot(direction);
    high_x = std::max(high_x, px + pz * tan_x);
    low_x = std::min(low_x, px - pz * tan_x);
    high_y = std::max(high_y, py + pz * tan_up);
    low_y = std::min(low_y, py - pz * tan_y);
  }
  const double cz = std::max((high_x - low_x) / (2 * tan_x), (high_y - low_y) / (tan_up + tan_y));
  Camera camera;
  camera.eye = x * (high_x + low_x) / 2 + y * (high_y - cz * tan_up + low_y + cz * tan_y) / 2 + direction * cz;
  camera.target = camera.eye - direction;
  const double distance = std::max((camera.eye - ball.center).dot(direction), ball.radius);
  camera.near = std::max(0.02 * distance, distance - 2.2 * ball.radius);
  camera.far = distance + 40 * ball.radius;
  return camera;
}

/// A rod from a to b with radius ra at a and rb at b, in the world.
void addRod(Triangles& out, const Vector3d& a, const Vector3d& b, double ra, double rb, int sectors = 24) {
  const Vector3d along = (b - a).normalized(), side = along.unitOrthogonal(), other = along.cross(side);
  const int base = static_cast<int>(out.vertices.size());
  for (int s = 0; s < sectors; ++s) {
    const Vector3d d = std::cos(2 * kPi * s / sectors) * side + std::sin(2 * kPi * s / sectors) * other;
    out.vertices.push_back(a + ra * d);
    out.vertices.push_back(b + rb * d);
  }
  out.vertices.push_back(a);
  out.vertices.push_back(b);
  for (int s = 0; s < sectors; ++s) {
    const int i = base + 2 * s, j = base + 2 * ((s + 1) % sectors), ends = base + 2 * sectors;
    for (const std::array<int, 3>& face :
         {std::array{i, j, j + 1}, {i, j + 1, i + 1}, {ends, j, i}, {ends + 1, i + 1, j + 1}}) {
      out.faces.push_back(face);
    }
  }
}

void addBall(Triangles& out, const Vector3d& center, double radius) {
  constexpr int kRings = 12;
  for (int i = 0; i < kRings; ++i) {
    const double a = kPi * i / kRings - kPi / 2, b = kPi * (i + 1) / kRings - kPi / 2;
    addRod(out, center + radius * std::sin(a) * Vector3d::UnitZ(), center + radius * std::sin(b) * Vector3d::UnitZ(),
           radius * std::cos(a), radius * std::cos(b));
  }
}

Body annotation(const Triangles& triangles, unsigned hex, float glow) {
  Body body;
  body.surface = makeSurface(triangles);
  body.color = color(hex);
  body.glow = glow;
  return body;
}

/// Puts the parts of a picture together.
class Composer {
 public:
  Composer(const Robot& robot, const std::vector<Scene::Obstacle>& obstacles, const JointPath& motion,
           const CertifiedResult& result)
      : tree_(*robot.tree), motion_(motion), result_(result) {
    for (const LinkGeometry& g : robot.geometry) {
      parts_.push_back({g.link, g.offset, surfaces_.of(g.object->collisionGeometry().get())});
    }
    if (const CertifiedContact* c = contact()) {
      for (const BodyRef* body : {&c->body1, &c->body2}) {
        if (body->link >= 0)
          touching_links_.insert(body->link);
        else
          touching_objects_.insert(body->object);
      }
    }
    pose_ = posesAt(result.t_lower);
    if (result.M_0_at_lower.size() == pose_.size()) pose_ = result.M_0_at_lower;
    addGhosts();
    for (const LinkPart& part : parts_) addSample(*part.surface, poseOf(part, pose_), points_);
    addObstacles(obstacles);
    if (const CertifiedContact* c = contact()) points_.push_back(c->point);
    ball_ = ballAround(points_);
    addRobot();
    addTrace();
    stage_.focus = ball_.center;
    stage_.radius = ball_.radius;
    if (const CertifiedContact* c = contact()) stage_.highlight_center = c->point;
    for (Body& body : stage_.solid) body.highlight_radius *= static_cast<float>(ball_.radius);
    stage_.ground_z = groundHeight();
  }

  /// The camera from this direction.
  Camera cameraFrom(double azimuth, double elevation, double aspect) const {
    return frame(points_, ball_, towardsCamera(azimuth, elevation), aspect);
  }

  /// The view that shows most of the contact, of the bodies that touch and of the robot.
  Camera chooseCamera(Renderer& renderer, double aspect) const {
    constexpr int kHeight = 120;
    const int width = static_cast<int>(kHeight * aspect);
    std::vector<Body> all = stage_.solid;
    std::vector<int> groups = groups_;
    if (const CertifiedContact* c = contact()) {
      Triangles ball;
      addBall(ball, c->point, 0.035 * ball_.radius);
      all.push_back(annotation(ball, kMarker, 1));
      groups.push_back(kContactGroup);
    }
    std::vector<Body> alone;  // without the scene, for comparison
    std::vector<int> alone_groups;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (groups[i] == kSceneGroup) continue;
      alone.push_back(all[i]);
      alone_groups.push_back(groups[i]);
    }
    std::size_t corners = 0;
    for (const Body& body : all) corners += body.surface->corners.size();
    const int turns = corners > 600000 ? 6 : 12;
    Camera best;
    double best_score = -1;
    for (const double elevation : {16.0, 30.0}) {
      for (int turn = 0; turn < turns; ++turn) {
        const double azimuth = -55 + 360.0 * turn / turns;
        const Camera camera = cameraFrom(azimuth, elevation, aspect);
        const std::vector<int> seen = renderer.visiblePixels(all, groups, camera, width, kHeight);
        const std::vector<int> there = renderer.visiblePixels(alone, alone_groups, camera, width, kHeight);
        const auto share = [&](std::size_t group) {
          return group < seen.size() && group < there.size() ? std::min(1.0, seen[group] / (there[group] + 1.0)) : 0.0;
        };
        const double clutter = static_cast<double>(seen[kSceneGroup]) / (width * kHeight);
        double score = share(kRobotGroup) - 0.5 * clutter + 0.02 * std::cos((azimuth + 55) * kPi / 180);
        if (const CertifiedContact* c = contact()) {
          // The share of the contact that nothing hides, the robot included.
          const double full =
              kPi * std::pow(0.035 * ball_.radius / ((camera.eye - c->point).norm() * std::tan(kFieldOfView / 2)) *
                                 kHeight / 2,
                             2);
          const double contact_seen =
              seen.size() > kContactGroup ? std::min(1.0, seen[kContactGroup] / std::max(0.4 * full, 1.0)) : 0.0;
          const Vector3d view = (camera.eye - c->point).normalized();
          // Normal and way are best seen from the side.
          score += 1.6 * contact_seen + 0.8 * share(kTouchingGroup) + 0.5 * (1 - std::abs(c->normal.dot(view))) +
                   0.5 * (1 - std::abs(way_.dot(view)));
        }
        if (score > best_score) {
          best_score = score;
          best = camera;
        }
      }
    }
    return best;
  }

  /// The stage with the annotations that this camera calls for.
  Stage stageFor(const Camera& camera) const {
    Stage stage = stage_;
    if (const CertifiedContact* c = contact()) {
      const double view_height = 2 * (camera.eye - c->point).norm() * std::tan(kFieldOfView / 2);
      Triangles mark;
      addBall(mark, c->point, 0.0085 * view_height);
      const Vector3d tip = c->point + 0.13 * view_height * c->normal;
      const Vector3d neck = c->point + 0.095 * view_height * c->normal;
      addRod(mark, c->point, neck, 0.0032 * view_height, 0.0032 * view_height);
      addRod(mark, neck, tip, 0.0105 * view_height, 0);
      stage.annotations.push_back(annotation(mark, kMarker, 0.35f));
    }
    return stage;
  }

 private:
  static constexpr std::size_t kSceneGroup = 0, kRobotGroup = 1, kTouchingGroup = 2, kContactGroup = 3;

  const CertifiedContact* contact() const { return result_.contacts.empty() ? nullptr : &result_.contacts.front(); }

  Poses posesAt(double t) const {
    Poses M_0;
    tree_.forwardKinematics(motion_(t), M_0);
    return M_0;
  }
  static Isometry3d poseOf(const LinkPart& part, const Poses& M_0) {
    return M_0[static_cast<std::size_t>(part.link)] * part.offset;
  }

  void add(Body body, std::size_t group) {
    stage_.solid.push_back(std::move(body));
    groups_.push_back(static_cast<int>(group));
  }

  void addRobot() {
    for (const LinkPart& part : parts_) {
      Body body;
      body.surface = part.surface;
      body.M_0 = poseOf(part, pose_);
      body.clear_of_ghosts = true;
      const bool touches = touching_links_.count(part.link) != 0;
      body.color = color(kLinkColors[static_cast<std::size_t>(part.link) % std::size(kLinkColors)]);
      if (touches) {
        body.highlight = color(kTouchingLink);
        body.highlight_radius = 0.3f;  // of the ball's radius, set when that is known
        body.highlight_floor = 0.85f;
      }
      add(std::move(body), touches ? kTouchingGroup : kRobotGroup);
    }
  }

  void addObstacles(const std::vector<Scene::Obstacle>& obstacles) {
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const fcl::CollisionObjectd& object = *obstacles[i].object;
      Body body;
      body.surface = surfaces_.of(object.collisionGeometry().get());
      body.M_0 = Isometry3d(object.getTransform());
      body.color = color(kObstacleColors[i % std::size(kObstacleColors)]);
      if (touching_objects_.count(&object)) {
        body.highlight = color(kTouchingObstacle);
        body.highlight_radius = 0.35f;
        // A small obstacle is coloured as a whole, a large one around the contact.
        std::vector<Vector3d> sample;
        addSample(*body.surface, body.M_0, sample);
        const double size = ballAround(sample).radius;
        body.highlight_floor =
            static_cast<float>(std::clamp(1.1 - size / (0.6 * ballAround(points_).radius), 0.0, 0.9));
      }
      addSample(*body.surface, body.M_0, scene_points_);
      add(std::move(body), kSceneGroup);
    }
  }

  /// Adds poses along the motion, but only of bodies that are elsewhere than at t_lower.
  void addGhosts() {
    const double t = result_.t_lower;
    const bool stopped = result_.status != Status::free;
    const int before = std::max(1, static_cast<int>(std::lround(8 * t)));
    const int after = stopped ? std::max(1, static_cast<int>(std::lround(6 * (1 - t)))) : 0;
    for (int i = after; i >= 1; --i) addGhost(t + (1 - t) * i / after, kGhostAfter, i == after ? 0.32f : 0.17f);
    for (int i = 0; i < before; ++i) {
      const float along = static_cast<float>(i) / static_cast<float>(before);
      addGhost(t * i / before, kGhostBefore, i == 0 ? 0.55f : 0.26f + 0.16f * along);
    }
  }

  void addGhost(double t, unsigned tint, float opacity) {
    const Poses M_0 = posesAt(t);
    Ghost ghost;
    ghost.opacity = opacity;
    for (const LinkPart& part : parts_) {
      const Isometry3d there = poseOf(part, M_0), here = poseOf(part, pose_);
      if ((there.matrix() - here.matrix()).cwiseAbs().maxCoeff() < 1e-3) continue;
      Body body;
      body.surface = part.surface;
      body.M_0 = there;
      body.color = 0.25f * color(kLinkColors[static_cast<std::size_t>(part.link) % std::size(kLinkColors)]) +
                   0.75f * color(tint);
      addSample(*part.surface, there, points_);
      ghost.bodies.push_back(std::move(body));
    }
    if (!ghost.bodies.empty()) stage_.ghosts.push_back(std::move(ghost));
  }

  /// The way of the contact point, fixed to the link that goes further, up to the contact.
  void addTrace() {
    const CertifiedContact* c = contact();
    if (!c || result_.t_lower <= 0) return;
    constexpr int kSteps = 96;
    std::vector<Vector3d> best;
    double best_length = 0.02 * ball_.radius;
    for (const BodyRef* body : {&c->body1, &c->body2}) {
      if (body->link < 0) continue;
      const auto link = static_cast<std::size_t>(body->link);
      const Vector3d x_i = pose_[link].inverse() * c->point;
      std::vector<Vector3d> way;
      double length = 0;
      for (int i = 0; i <= kSteps; ++i) {
        way.push_back(posesAt(result_.t_lower * i / kSteps)[link] * x_i);
        if (i > 0) length += (way[static_cast<std::size_t>(i)] - way[static_cast<std::size_t>(i) - 1]).norm();
      }
      if (length > best_length) {
        best_length = length;
        best = std::move(way);
      }
    }
    Triangles tube;
    const double radius = 0.0035 * ball_.radius;
    for (std::size_t i = 0; i + 1 < best.size(); ++i) {
      if ((best[i + 1] - best[i]).norm() > 0) addRod(tube, best[i], best[i + 1], radius, radius, 10);
    }
    if (tube.faces.empty()) return;
    way_ = (best.back() - best.front()).normalized();
    addBall(tube, best.front(), 2.5 * radius);
    Body body = annotation(tube, kTrace, 0.5f);
    body.throws_shadow = false;
    add(std::move(body), kSceneGroup);
  }

  /// Lowest point of the robot and of the scene around it.
  double groundHeight() const {
    double z = std::numeric_limits<double>::infinity();
    for (const LinkPart& part : parts_) {
      const Isometry3d M_0 = poseOf(part, pose_);
      for (const Vector3f& corner : part.surface->corners) z = std::min(z, (M_0 * corner.cast<double>()).z());
    }
    for (const Vector3d& p : scene_points_) {
      if ((p - ball_.center).norm() < 2.5 * ball_.radius) z = std::min(z, p.z());
    }
    return (std::isfinite(z) ? z : 0) - 2e-3 * ball_.radius;
  }

  const KinematicTree& tree_;
  const JointPath& motion_;
  const CertifiedResult& result_;
  Surfaces surfaces_;
  std::vector<LinkPart> parts_;
  std::set<LinkId> touching_links_;
  std::set<const fcl::CollisionObjectd*> touching_objects_;
  Poses pose_;
  std::vector<Vector3d> points_, scene_points_;
  Ball ball_;
  Vector3d way_ = Vector3d::Zero();  // direction in which the contact point came, unit; zero without a trace
  Stage stage_;
  std::vector<int> groups_;
};

}  // namespace

void requirePictures() {}

Image drawPicture(const Robot& robot, const std::vector<Scene::Obstacle>& obstacles, const JointPath& motion,
                  const CertifiedResult& result, const PictureOptions& options) {
  const Composer composer(robot, obstacles, motion, result);
  Renderer renderer;
  const double aspect = static_cast<double>(options.width) / options.height;
  const Camera camera = options.camera ? composer.cameraFrom((*options.camera)[0], (*options.camera)[1], aspect)
                                       : composer.chooseCamera(renderer, aspect);
  Image image = renderer.draw(composer.stageFor(camera), camera, options.width, options.height);
  drawTitle(image, options.title);
  return image;
}

void writePicture(const std::string& path, const Robot& robot, const std::vector<Scene::Obstacle>& obstacles,
                  const JointPath& motion, const CertifiedResult& result, const PictureOptions& options) {
  writePng(path, drawPicture(robot, obstacles, motion, result, options));
}

}  // namespace fcl_artic::render
