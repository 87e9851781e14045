// SPDX-License-Identifier: BSD-3-Clause
#include "page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include <fcl/config.h>
#include <fmt/format.h>
#if FCL_HAVE_OCTOMAP
#include <fcl/geometry/octree/octree.h>
#endif

#include "fcl_artic/point_cloud.h"
#include "numerics/rotation.h"
#include "page_parts.h"
#include "render/triangles.h"
#include "text/xml.h"
#include "title_line.h"

namespace fcl_artic::app {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// As much as a browser draws fluently, and as a page of some ten megabytes holds.
constexpr std::size_t kMaxTriangles = 1000000, kMaxBalls = 500000;
constexpr std::size_t kFewestPoses = 360, kMaxPoses = 3000, kPosesForPiece = 4;

std::string base64(const void* data, std::size_t size) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t n = std::min<std::size_t>(3, size - i);
    const unsigned word = bytes[i] << 16 | (n > 1 ? bytes[i + 1] << 8 : 0) | (n > 2 ? bytes[i + 2] : 0);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

/// Numbers as the page's script takes them: little-endian, as are all processors that this library supports.
template <class Number>
std::string base64(const std::vector<Number>& numbers) {
  return base64(numbers.data(), numbers.size() * sizeof(Number));
}

Json numbersJson(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

/// x, y, z, and a unit quaternion x, y, z, w.
std::array<double, 7> poseNumbers(const Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Vector3d& x = pose.translation();
  return {x.x(), x.y(), x.z(), q.x(), q.y(), q.z(), q.w()};
}

/// A geometry for the page's script. Numbers are floats, relative to a centre: far from the origin floats are coarse.
struct Shape {
  Json json;
  Vector3d center = Vector3d::Zero();
};

/// Counts how many of a kind there are in all, and so says which part of them is drawn.
class Thinning {
 public:
  explicit Thinning(std::size_t most) : most_(most) {}
  void count(std::size_t n) { all_ += n; }
  /// Every so manieth is drawn.
  std::size_t every() const { return (all_ + most_ - 1) / std::max<std::size_t>(most_, 1); }

 private:
  std::size_t most_, all_ = 0;
};

Vector3d middleOf(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  return box.isEmpty() ? Vector3d(Vector3d::Zero()) : Vector3d(box.center());
}

Shape trianglesShape(const render::Triangles& triangles, std::size_t every) {
  Shape shape;
  shape.center = middleOf(triangles.vertices);
  std::vector<float> positions;
  std::vector<std::uint32_t> corners;
  std::vector<std::int64_t> number(triangles.vertices.size(), -1);  // of the vertices that are left
  for (std::size_t f = 0; f < triangles.faces.size(); f += every) {
    for (const int corner : triangles.faces[f]) {
      std::int64_t& n = number[static_cast<std::size_t>(corner)];
      if (n < 0) {
        n = static_cast<std::int64_t>(positions.size() / 3);
        const Vector3d p = triangles.vertices[static_cast<std::size_t>(corner)] - shape.center;
        for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>(p[i]));
      }
      corners.push_back(static_cast<std::uint32_t>(n));
    }
  }
  shape.json = {{"kind", "triangles"},
                {"count", triangles.faces.size()},
                {"every", every},
                {"positions", base64(positions)},
                {"corners", base64(corners)}};
  return shape;
}

/// A ball, or the ball within a cube.
struct Ball {
  Vector3d center;
  double radius;
};

Shape ballsShape(const char* kind, const std::vector<Ball>& balls, std::size_t every) {
  Shape shape;
  Eigen::AlignedBox3d box;
  for (const Ball& b : balls) box.extend(b.center);
  if (!balls.empty()) shape.center = box.center();
  std::vector<float> numbers;
  for (std::size_t i = 0; i < balls.size(); i += every) {
    const Vector3d p = balls[i].center - shape.center;
    for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(p[k]));
    numbers.push_back(static_cast<float>(balls[i].radius));
  }
  shape.json = {{"kind", kind}, {"count", balls.size()}, {"every", every}, {"balls", base64(numbers)}};
  return shape;
}

/// Geometries, each once however many bodies have it.
class Shapes {
 public:
  explicit Shapes(const std::vector<PageBody>& bodies) {
    for (const PageBody& body : bodies) {
      const fcl::CollisionGeometryd& geometry = *body.geometry;
      if (content_.count(&geometry)) continue;
      Content& content = content_[&geometry];
      if (const auto* cloud = dynamic_cast<const PointCloud*>(&geometry)) {
        content.kind = "points";
        for (std::size_t i = 0; i < cloud->points().size(); ++i) {
          content.balls.push_back({cloud->points()[i], cloud->radius(i)});
        }
      } else if (geometry.getNodeType() == fcl::GEOM_OCTREE) {
        content.kind = "cells";
#if FCL_HAVE_OCTOMAP
        for (const auto& cell : static_cast<const fcl::OcTreed&>(geometry).toBoxes()) {
          content.balls.push_back({{cell[0], cell[1], cell[2]}, cell[3] / 2});
        }
#endif
      } else {
        content.triangles = render::triangulate(geometry);
      }
      triangles_.count(content.triangles.faces.size());
      balls_.count(content.balls.size());
    }
  }

  /// The number of a body's geometry, and where its centre is in the geometry's frame.
  std::pair<std::size_t, Vector3d> of(const PageBody& body) {
    Content& content = content_.at(body.geometry.get());
    if (content.number < 0) {
      const Shape shape = content.kind
                              ? ballsShape(content.kind, content.balls, std::max<std::size_t>(1, balls_.every()))
                              : trianglesShape(content.triangles, std::max<std::size_t>(1, triangles_.every()));
      content.center = shape.center;
      content.number = static_cast<int>(json_.size());
      json_.push_back(shape.json);
    }
    return {static_cast<std::size_t>(content.number), content.center};
  }

  Json json() const {
    return json_;
  }

 private:
  struct Content {
    const char* kind = nullptr;  // of balls; null: triangles
    render::Triangles triangles;
    std::vector<Ball> balls;
    int number = -1;
    Vector3d center = Vector3d::Zero();
  };
  std::map<const fcl::CollisionGeometryd*, Content> content_;
  Thinning triangles_{kMaxTriangles}, balls_{kMaxBalls};
  Json json_ = Json::array();
};

/// Times of the poses on the page: evenly over the motion, and the ends of brackets.
std::vector<double> timesOfPoses(const Report& report) {
  const std::size_t count = std::clamp(kPosesForPiece * report.pieces, kFewestPoses, kMaxPoses);
  std::set<double> times{report.begin, report.end};
  for (std::size_t i = 1; i < count; ++i) {
    times.insert(report.begin + (report.end - report.begin) * static_cast<double>(i) / static_cast<double>(count));
  }
  const auto add = [&](double t) {
    if (t > report.begin && t < report.end) times.insert(t);
  };
  add(report.result.t_lower);
  for (const CertifiedContact& c : report.result.contacts) {
    add(c.t_lower);
    add(c.t_upper);
  }
  return {times.begin(), times.end()};
}

Json clearanceSteps(const std::vector<DistanceStep>& steps, Clearance DistanceStep::*which) {
  Json out = Json::array();
  for (const DistanceStep& step : steps) {
    const Clearance& c = step.*which;
    const bool any = std::isfinite(c.upper);
    out.push_back({{"lower", c.lower},
                   {"upper", any ? Json(c.upper) : Json()},
                   {"pair", any ? Json{c.body1.name, c.body2.name} : Json()},
                   {"cut_off", !any && !c.within_tolerance}});
  }
  return out;
}

Json distancesJson(const Distances& distances) {
  if (!distances.missing.empty()) return {{"missing", distances.missing}};
  Json times = Json::array();
  for (const DistanceStep& step : distances.steps) times.push_back(step.begin);
  if (!distances.steps.empty()) times.push_back(distances.steps.back().end);
  const auto measured = [&](Clearance DistanceStep::*which) {
    return std::any_of(distances.steps.begin(), distances.steps.end(),
                       [&](const DistanceStep& s) { return (s.*which).statistics.pairs > 0; });
  };
  // Each step is a part of one piece, which has each pair once. A query that guesses a contact first looks at no pair.
  std::uint64_t pairs = 0;
  for (const DistanceStep& step : distances.steps)
    pairs = std::max(pairs, step.obstacles.statistics.pairs + step.links.statistics.pairs);
  Json out{{"most", distances.most}, {"times", times}, {"pairs", pairs}, {"obstacles", nullptr}, {"links", nullptr}};
  if (measured(&DistanceStep::obstacles)) out["obstacles"] = clearanceSteps(distances.steps, &DistanceStep::obstacles);
  if (measured(&DistanceStep::links)) out["links"] = clearanceSteps(distances.steps, &DistanceStep::links);
  return out;
}

/// By contact: where a witness within the tolerances has the robot's bodies, and an obstacle that is off its pose; null
/// without a witness.
/// @param center  that positions are relative to.
Json witnessesJson(const Report& report, const std::vector<PageBody>& bodies, Shapes& shapes, const Vector3d& center) {
  Json out = Json::array();
  std::vector<Isometry3d> M_0;
  for (const CertifiedContact& c : report.result.contacts) {
    if (c.q_witness.size() == 0) {
      out.push_back(nullptr);
      continue;
    }
    report.tree.forwardKinematics(c.q_witness, M_0);
    Json placed = Json::array();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const PageBody& body = bodies[i];
      const bool first = body.name == c.body1.name, second = body.name == c.body2.name;
      const Isometry3d& own = first ? c.deviation1 : c.deviation2;
      const bool off = (first || second) && !isIdentity(own);
      if (body.link < 0 && !off) continue;
      Isometry3d pose = body.link >= 0 ? c.base_deviation * M_0[static_cast<std::size_t>(body.link)] * body.pose
                        : body.motion  ? body.motion(c.t_upper)
                                       : body.pose;
      if (off) pose = pose * own;
      pose.translate(shapes.of(body).second);
      pose.pretranslate(-center);
      placed.push_back({{"body", i}, {"pose", poseNumbers(pose)}});
    }
    out.push_back(placed);
  }
  return out;
}

/// The bodies, their motions and their looks, for the page's script.
Json motionJson(const Report& report, const std::vector<PageBody>& bodies, const Distances& distances) {
  const KinematicTree& tree = report.tree;
  const std::vector<double> times = timesOfPoses(report);
  std::vector<float> joint_values, poses;
  std::map<LinkId, std::size_t> frames;  // of the links that carry anything
  std::vector<const PageBody*> movers;   // with frames after those
  for (const PageBody& body : bodies) {
    if (body.link >= 0) frames.emplace(body.link, frames.size());
    if (body.motion) movers.push_back(&body);
  }
  std::vector<LinkId> links(frames.size());
  for (const auto& [link, frame] : frames) links[frame] = link;
  std::vector<Isometry3d> M_0;
  Vector3d center = Vector3d::Zero();
  for (const double t : times) {
    const Eigen::VectorXd q = report.configuration(t);
    tree.forwardKinematics(q, M_0);
    if (poses.empty() && !links.empty()) {
      for (const LinkId link : links) center += M_0[static_cast<std::size_t>(link)].translation();
      center /= static_cast<double>(links.size());
    }
    for (Eigen::Index v = 0; v < q.size(); ++v) joint_values.push_back(static_cast<float>(q[v]));
    const auto add = [&](Isometry3d pose) {
      pose.translation() -= center;
      for (const double number : poseNumbers(pose)) poses.push_back(static_cast<float>(number));
    };
    for (const LinkId link : links) add(M_0[static_cast<std::size_t>(link)]);
    for (const PageBody* mover : movers) add(mover->motion(t));
  }
  Shapes shapes(bodies);
  Json body_list = Json::array();
  std::size_t mover = links.size();
  for (const PageBody& body : bodies) {
    const auto [shape, middle] = shapes.of(body);
    Isometry3d pose = body.motion ? Isometry3d(Isometry3d::Identity()) : body.pose;
    pose.translate(middle);
    Json frame;
    if (body.motion) {
      frame = mover++;
    } else if (body.link >= 0) {
      frame = frames.at(body.link);
    } else {
      pose.pretranslate(-center);
    }
    body_list.push_back(
        {{"name", body.name}, {"kind", body.kind}, {"frame", frame}, {"shape", shape}, {"pose", poseNumbers(pose)}});
    if (body.kind == "attached object") body_list.back()["link"] = tree.linkName(body.link);
  }
  Json variables = Json::array();
  for (int v = 0; v < tree.dof(); ++v) {
    const int quaternion = tree.quaternionVariable(tree.variableJoint(v));
    const bool length = !tree.isAngle(v) && (quaternion < 0 || v < quaternion);
    variables.push_back({{"name", tree.variableName(v)},
                         {"unit", tree.isAngle(v) ? "rad"
                                  : length        ? "m"
                                                  : "quaternion"}});
  }
  const Json witnesses = witnessesJson(report, bodies, shapes, center);
  return {{"center", numbersJson(center)}, {"times", times},         {"frames", links.size() + movers.size()},
          {"poses", base64(poses)},        {"variables", variables}, {"values", base64(joint_values)},
          {"shapes", shapes.json()},       {"bodies", body_list},    {"distances", distancesJson(distances)},
          {"pieces", report.pieces},       {"witnesses", witnesses}};
}

/// JSON for within a page's <script>: nothing in it ends the script or begins a comment, and names that are no UTF-8
/// are shown as far as they are.
std::string scriptText(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else if (c == '>') {
      out += "\\u003e";
    } else if (c == '&') {
      out += "\\u0026";
    } else {
      out += c;
    }
  }
  return out;
}

/// A page with its {{parts}} filled in.
std::string filled(std::string_view page, const std::map<std::string_view, std::string>& parts) {
  std::string out;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    out += page.substr(at, open - at);
    if (open == std::string_view::npos) return out;
    const std::size_t close = page.find("}}", open);
    out += parts.at(page.substr(open + 2, close - open - 2));
    at = close + 2;
  }
}

}  // namespace

std::vector<PageBody> linksOf(const KinematicTree& tree, const std::vector<LinkGeometry>& geometry) {
  std::vector<PageBody> bodies;
  for (const LinkGeometry& g : geometry) {
    bodies.push_back({tree.linkName(g.link), "link", g.link, g.offset, g.object->collisionGeometry(), {}});
  }
  return bodies;
}

double sizeOf(const Report& report, const std::vector<PageBody>& bodies) {
  std::vector<Isometry3d> M_0;
  report.tree.forwardKinematics(report.configuration(report.begin), M_0);
  Eigen::AlignedBox3d box;
  for (const PageBody& body : bodies) {
    if (body.link < 0) continue;
    const Vector3d at = M_0[static_cast<std::size_t>(body.link)] * body.pose * body.geometry->aabb_center;
    const Vector3d reach = Vector3d::Constant(body.geometry->aabb_radius);
    if (!reach.allFinite()) continue;
    box.extend(Vector3d(at - reach));
    box.extend(Vector3d(at + reach));
  }
  const double size = box.isEmpty() ? 0 : box.diagonal().norm() / 2;
  return size > 0 ? size : 1;
}

std::string htmlPage(const Report& report, const std::vector<PageBody>& bodies, const Distances& distances) {
  return filled(page_parts::kPage, {{"title", text::xmlText(titleLine(report.result))},
                                    {"headline", text::xmlText(headline(report))},
                                    {"status", toString(report.result.status)},
                                    {"style", std::string(page_parts::kStyle)},
                                    {"script", std::string(page_parts::kViewer)},
                                    {"answer", scriptText(jsonReport(report))},
                                    {"motion", scriptText(motionJson(report, bodies, distances))},
                                    {"text", text::xmlText(textReport(report))},
                                    {"version", FCL_ARTIC_VERSION}});
}

}  // namespace fcl_artic::app
