// SPDX-License-Identifier: BSD-3-Clause
// Robots, allowed pairs, scenes, OctoMaps.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>

#include "fcl_artic/urdf/urdf.h"
#include "harness.h"

namespace fcl_artic::test {
namespace {

/// A number as a URDF may have it, and what it is.
struct Written {
  std::string text;
  double value;
};
Written written(Random& random, double x) {
  char text[40];
  std::snprintf(text, sizeof text, coin(random) ? "%.*g" : "%.*e", 1 + below(random, 17), x);
  std::string out = text;
  if (below(random, 6) == 0 && out[0] != '-') out = '+' + out;
  return {out, std::strtod(out.c_str(), nullptr)};
}
/// Numbers between blanks, appended to `values`.
std::string list(Random& random, int count, double lower, double upper, std::vector<double>& values) {
  std::string out = below(random, 5) == 0 ? " " : "";
  for (int k = 0; k < count; ++k) {
    const Written w = written(random, randomNumber(random, lower, upper));
    values.push_back(w.value);
    out += (k == 0 ? "" : below(random, 4) == 0 ? "  " : " ") + w.text;
  }
  return out + (below(random, 5) == 0 ? " " : "");
}
std::vector<double> rowsOf(const Eigen::Isometry3d& M) {
  std::vector<double> out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) out.push_back(M(i, j));
  }
  return out;
}
void append(Item& item, const std::vector<double>& numbers) {
  for (const double x : numbers) item.numbers.push_back(x);
}

/// A shape as the readers make it: its kind, and its sizes or places.
Item itemOf(const std::string& what, const fcl::CollisionGeometryd& g) {
  if (const auto* box = dynamic_cast<const fcl::Boxd*>(&g))
    return {what + " box", {box->side[0], box->side[1], box->side[2]}};
  if (const auto* ball = dynamic_cast<const fcl::Sphered*>(&g)) return {what + " sphere", {ball->radius}};
  if (const auto* c = dynamic_cast<const fcl::Cylinderd*>(&g)) return {what + " cylinder", {c->radius, c->lz}};
  if (const auto* c = dynamic_cast<const fcl::Coned*>(&g)) return {what + " cone", {c->radius, c->lz}};
  if (const auto* p = dynamic_cast<const fcl::Planed*>(&g)) return {what + " plane", {p->n[0], p->n[1], p->n[2], p->d}};
  Item item{what + " mesh", {}};
  const auto& mesh = dynamic_cast<const fcl::BVHModel<fcl::OBBRSSd>&>(g);
  for (int t = 0; t < mesh.num_tris; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d& x = mesh.vertices[mesh.tri_indices[t][k]];
      append(item, {x[0], x[1], x[2]});
    }
  }
  return item;
}

// ---- URDF

class UrdfWriter {
 public:
  explicit UrdfWriter(Random& random) : random_(random) {}

  RandomFile write() {
    RandomFile file;
    file.name = "written.urdf";
    file.tolerance = 1e-14;
    file.more["tri.obj"] = "v 0 0 0\nv 1 0 0.25\nv 0 2 0.5\nf 1 2 3\n";
    const int links = 1 + below(random_, 5);
    std::vector<std::string> elements;
    for (int l = 0; l < links; ++l) {
      elements.push_back(link(l));
      if (l > 0) elements.push_back(joint(l, below(random_, l)));
    }
    if (coin(random_)) elements.push_back("<material name=\"grey\"><color rgba=\"1 1 1 1\"/></material>");
    if (coin(random_)) elements.push_back("<gazebo reference=\"l0\"><origin xyz=\"9 9 9\"/></gazebo>");
    if (coin(random_)) elements.push_back("<!-- <link name=\"l9\"/> -->");
    file.content =
        oneOf<std::string>(random_, {"", "<?xml version=\"1.0\"?>\n", "<?xml version='1.0' encoding='utf-8'?>"}) +
        "<robot name=\"r\" xmlns:xacro=\"http://ros.org/wiki/xacro\">" + shuffled(elements) + "</robot>" + end();
    std::sort(reading_.begin(), reading_.end(), [](const Item& a, const Item& b) { return a.what < b.what; });
    file.reading = reading_;
    return file;
  }

 private:
  std::string end() { return oneOf<std::string>(random_, {"", "\n", "\r\n", "\n\n  "}); }
  std::string shuffled(std::vector<std::string>& elements) {
    std::shuffle(elements.begin(), elements.end(), random_);
    std::string out = end();
    for (const std::string& e : elements) out += e + end();
    return out;
  }
  std::string attribute(const std::string& name, const std::string& value) {
    const char quote = coin(random_) ? '"' : '\'';
    return " " + name + "=" + quote + value + quote;
  }

  /// An origin or none; by the rules of URDF: roll about x, then pitch about y, then yaw about z, of what stands still.
  std::string origin(std::vector<double>& rows) {
    std::vector<double> xyz{0, 0, 0}, rpy{0, 0, 0};
    std::string out;
    if (below(random_, 4) > 0) {
      std::vector<std::string> attributes;
      if (coin(random_)) xyz.clear(), attributes.push_back(attribute("xyz", list(random_, 3, -2, 2, xyz)));
      if (coin(random_)) rpy.clear(), attributes.push_back(attribute("rpy", list(random_, 3, -7, 7, rpy)));
      std::shuffle(attributes.begin(), attributes.end(), random_);
      out = "<origin";
      for (const std::string& a : attributes) out += a;
      out += "/>";
    }
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    rows = rowsOf(Eigen::Translation3d(xyz[0], xyz[1], xyz[2]) * AngleAxisd(rpy[2], Vector3d::UnitZ()) *
                  AngleAxisd(rpy[1], Vector3d::UnitY()) * AngleAxisd(rpy[0], Vector3d::UnitX()));
    return out;
  }

  std::string link(int l) {
    const std::string name = "l" + std::to_string(l);
    std::vector<std::string> elements;
    std::vector<Item> items;
    for (int c = below(random_, 4); c > 0; --c) {
      Item item;
      std::vector<std::string> parts{"<geometry>" + shape(item) + "</geometry>"};
      std::vector<double> rows;
      parts.push_back(origin(rows));
      append(item, rows);
      std::shuffle(parts.begin(), parts.end(), random_);
      elements.push_back("<collision" + (coin(random_) ? attribute("name", "c") : "") + ">" + parts[0] + end() +
                         parts[1] + "</collision>");
      item.what = std::to_string(items.size()) + " " + item.what;
      items.push_back(item);
    }
    const std::string visual = coin(random_) ? "<visual><geometry><box size=\"9 9 9\"/></geometry></visual>" : "",
                      inertial = coin(random_) ? "<inertial><mass value=\"1\"/></inertial>" : "";
    for (Item& item : items) item.what = "link " + name + " " + item.what;
    reading_.insert(reading_.end(), items.begin(), items.end());
    reading_.push_back({"link " + name, {}});
    std::string out = "<link" + attribute("name", name) + ">" + end() + visual;
    for (const std::string& e : elements) out += e + end();
    return out + inertial + "</link>";
  }

  std::string shape(Item& item) {
    switch (below(random_, 4)) {
      case 0:
        item.what = "box";
        return "<box" + attribute("size", list(random_, 3, 0.1, 2, item.numbers)) + "/>";
      case 1:
        item.what = "sphere";
        return "<sphere" + attribute("radius", number(0.1, 2, item.numbers)) + "/>";
      case 2: {
        item.what = "cylinder";
        const std::string radius = attribute("radius", number(0.1, 2, item.numbers));
        return "<cylinder" + radius + attribute("length", number(0.1, 2, item.numbers)) + "/>";
      }
      default: {
        item.what = "mesh";
        std::vector<double> s{1, 1, 1};
        std::string scale;
        const double upper = coin(random_) ? -0.1 : 2;
        if (coin(random_)) s.clear(), scale = attribute("scale", list(random_, 3, upper < 0 ? -2 : 0.1, upper, s));
        item.numbers = {0, 0, 0, s[0], 0, s[2] * 0.25, 0, s[1] * 2, s[2] * 0.5};
        return "<mesh" + scale + attribute("filename", "tri.obj") + "/>";
      }
    }
  }
  std::string number(double lower, double upper, std::vector<double>& values) {
    const Written w = written(random_, randomNumber(random_, lower, upper));
    values.push_back(w.value);
    return w.text;
  }

  std::string joint(int child, int parent) {
    const std::string name = "j" + std::to_string(child);
    const std::string type =
        oneOf<std::string>(random_, {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"});
    const bool one = type == "revolute" || type == "continuous" || type == "prismatic";
    Item item{"joint " + name + " " + type + " l" + std::to_string(parent) + " l" + std::to_string(child), {}};
    std::vector<std::string> elements{"<parent" + attribute("link", "l" + std::to_string(parent)) + "/>",
                                      "<child" + attribute("link", "l" + std::to_string(child)) + "/>"};
    std::vector<double> rows;
    elements.push_back(origin(rows));
    append(item, rows);
    if (one || type == "planar") {
      std::vector<double> axis{1, 0, 0};
      if (below(random_, 4) > 0)
        axis.clear(), elements.push_back("<axis" + attribute("xyz", list(random_, 3, 0.1, 3, axis)) + "/>");
      const Eigen::Vector3d u = Eigen::Vector3d(axis[0], axis[1], axis[2]).normalized();
      append(item, {u[0], u[1], u[2]});
    }
    if (type == "revolute" || type == "prismatic") {
      const bool lower = below(random_, 4) > 0;
      std::vector<double> limits;
      std::string text = lower ? attribute("lower", number(-3, -0.1, limits)) : "";
      if (!lower) limits.push_back(0);
      text += attribute("upper", number(0.1, 3, limits));
      append(item, limits);
      elements.push_back("<limit" + text + " effort='1' velocity='1'/>");
    }
    if (one && !masters_.empty() && below(random_, 3) == 0) {
      const std::string master = oneOf(random_, masters_);
      std::vector<double> factor{1}, offset{0};
      std::string text = attribute("joint", master);
      if (coin(random_)) factor.clear(), text += attribute("multiplier", number(-2, 2, factor));
      if (coin(random_)) offset.clear(), text += attribute("offset", number(-1, 1, offset));
      item.what += " mimics " + master;
      append(item, {factor[0], offset[0]});
      elements.push_back("<mimic" + text + "/>");
    } else if (one) {
      masters_.push_back(name);
    }
    if (coin(random_)) elements.push_back("<dynamics damping=\"1\"/>");
    reading_.push_back(item);
    return "<joint" + attribute("name", name) + attribute("type", type) + ">" + shuffled(elements) + "</joint>";
  }

  Random& random_;
  Reading reading_;
  std::vector<std::string> masters_;
};

Reading readUrdf(const RandomFile&, const std::string& path) {
  const Robot robot = loadUrdf(path);
  Reading out;
  std::map<LinkId, int> number;
  for (LinkId l = 0; l < robot.tree->numLinks(); ++l) out.push_back({"link " + robot.tree->linkName(l), {}});
  for (const LinkGeometry& g : robot.geometry) {
    out.push_back(itemOf("link " + robot.tree->linkName(g.link) + " " + std::to_string(number[g.link]++),
                         *g.object->collisionGeometry()));
    append(out.back(), rowsOf(g.offset));
  }
  for (JointId j = 0; j < robot.tree->numJoints(); ++j) {
    const Joint& joint = robot.tree->joint(j);
    static const std::map<JointType, std::string> kTypes{
        {JointType::revolute, "revolute"}, {JointType::continuous, "continuous"}, {JointType::prismatic, "prismatic"},
        {JointType::fixed, "fixed"},       {JointType::floating, "floating"},     {JointType::planar, "planar"}};
    const std::string type = kTypes.at(joint.type);
    Item item{"joint " + joint.name + " " + type + " " + joint.parent + " " + joint.child, rowsOf(joint.origin)};
    if (type != "fixed" && type != "floating") append(item, {joint.axis[0], joint.axis[1], joint.axis[2]});
    if (type == "revolute" || type == "prismatic") append(item, {joint.lower, joint.upper});
    if (joint.mimics) {
      item.what += " mimics " + joint.mimic.master;
      append(item, {joint.mimic.multiplier, joint.mimic.offset});
    }
    out.push_back(item);
  }
  std::sort(out.begin(), out.end(), [](const Item& a, const Item& b) { return a.what < b.what; });
  return out;
}

// ---- SRDF

std::vector<std::string> srdfLinks() {
  return {"a", "b", "c", "d", "e"};
}

RandomFile writeSrdf(Random& random) {
  RandomFile file;
  file.name = "written.srdf";
  std::set<std::pair<std::string, std::string>> defaults, enabled, disabled;
  std::vector<std::string> elements;
  const auto pair = [](const std::string& a, const std::string& b) {
    return std::make_pair(std::min(a, b), std::max(a, b));
  };
  const std::vector<std::string> links = srdfLinks();
  for (int k = 1 + below(random, 8); k > 0; --k) {
    const std::string a = oneOf(random, links);
    std::string b = oneOf(random, links);
    while (b == a) b = oneOf(random, links);
    switch (below(random, 5)) {
      case 0:
        elements.push_back("<disable_default_collisions link='" + a + "'/>");
        for (const std::string& other : links) {
          if (other != a) defaults.insert(pair(a, other));
        }
        break;
      case 1:
      case 2:
        elements.push_back("<enable_collisions link1=\"" + a + "\" link2=\"" + b + "\"/>");
        enabled.insert(pair(a, b));
        break;
      default:
        elements.push_back("<disable_collisions link2=\"" + a + "\" reason=\"Never\" link1='" + b +
                           "'></disable_collisions>");
        disabled.insert(pair(a, b));
    }
  }
  if (coin(random)) elements.push_back("<group name='arm'><chain base_link='a' tip_link='e'/></group>");
  if (coin(random)) elements.push_back("<!-- <disable_collisions link1='a' link2='b'/> -->");
  if (coin(random)) elements.push_back("<virtual_joint name='v' type='fixed' parent_frame='w' child_link='a'/>");
  std::shuffle(elements.begin(), elements.end(), random);
  file.content = "<?xml version=\"1.0\"?>\n<robot name='r'>\n";
  for (const std::string& e : elements) file.content += e + (coin(random) ? "\n" : " ");
  file.content += "</robot>\n";
  // Named pairs win over defaults, and disabled over enabled.
  for (const auto& p : enabled) defaults.erase(p);
  defaults.insert(disabled.begin(), disabled.end());
  for (const auto& [a, b] : defaults) file.reading.push_back({"may touch: " + a + " " + b, {}});
  file.reading.push_back({"end", {}});
  return file;
}

Reading readSrdfFile(const RandomFile&, const std::string& path) {
  KinematicTree tree("r");
  for (const std::string& link : srdfLinks()) tree.addLink(link);
  Reading out;
  const AllowedCollisionMatrix matrix = loadSrdf(path, tree);
  for (const auto& [a, b] : matrix.pairs()) out.push_back({"may touch: " + a + " " + b, {}});
  out.push_back({"end", {}});
  return out;
}

// ---- scenes

Reading readScene(const RandomFile&, const std::string& path) {
  const Scene scene = loadScene(path);
  Reading out;
  for (const Scene::Obstacle& o : scene.obstacles) {
    out.push_back(itemOf(o.name, *o.object->collisionGeometry()));
    append(out.back(), rowsOf(Eigen::Isometry3d(o.object->getTransform())));
  }
  return out;
}

class SceneWriter {
 public:
  explicit SceneWriter(Random& random) : random_(random), end_(coin(random) ? "\n" : "\r\n") {}

  RandomFile write() {
    RandomFile file;
    file.name = "written.scene";
    file.tolerance = 1e-14;
    const bool poses = coin(random_);
    std::string& out = file.content;
    out = "(noname)" + end_;
    for (int o = 0, objects = 1 + below(random_, 4); o < objects; ++o) {
      const std::string name = "object " + std::to_string(o);
      out += "* " + name + end_;
      Eigen::Isometry3d M_object = Eigen::Isometry3d::Identity();
      if (poses) out += pose(M_object);
      const int shapes = 1 + below(random_, 3);
      out += std::to_string(shapes) + end_;
      for (int s = 0; s < shapes; ++s) {
        Item item;
        out += shape(item);
        item.what = name + (s > 0 ? "#" + std::to_string(s + 1) : "") + " " + item.what;
        Eigen::Isometry3d M_shape;
        out += pose(M_shape) + "0 0 0 0" + end_;
        append(item, rowsOf(M_object * M_shape));
        file.reading.push_back(item);
      }
      if (!poses) continue;
      const int frames = below(random_, 2);
      out += std::to_string(frames) + end_;
      Eigen::Isometry3d ignored;
      if (frames) out += "tip" + end_ + pose(ignored);
    }
    out += "." + end_;
    return file;
  }

 private:
  std::string numbers(int count, double lower, double upper, std::vector<double>& values) {
    return list(random_, count, lower, upper, values) + end_;
  }
  std::string pose(Eigen::Isometry3d& M) {
    std::vector<double> x, q;
    std::string out = numbers(3, -2, 2, x);
    out += numbers(3, -1, 1, q);
    out.resize(out.size() - end_.size());
    out += " " + numbers(1, 0.1, 1, q);
    M = Eigen::Translation3d(x[0], x[1], x[2]) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
    return out;
  }
  std::string shape(Item& item) {
    std::vector<double>& n = item.numbers;
    switch (below(random_, 6)) {
      case 0:
        item.what = "box";
        return "box" + end_ + numbers(3, 0.1, 2, n);
      case 1:
        item.what = "sphere";
        return "sphere" + end_ + numbers(1, 0.1, 2, n);
      case 2:
        item.what = "cylinder";
        return "cylinder" + end_ + numbers(2, 0.1, 2, n);
      case 3:
        item.what = "cone";
        return "cone" + end_ + numbers(2, 0.1, 2, n);
      case 4: {
        item.what = "plane";
        std::vector<double> plane;
        const std::string out = "plane" + end_ + numbers(4, 0.1, 2, plane);
        const Eigen::Vector3d normal(plane[0], plane[1], plane[2]);
        n = {plane[0] / normal.norm(), plane[1] / normal.norm(), plane[2] / normal.norm(), -plane[3] / normal.norm()};
        return out;
      }
      default: {
        item.what = "mesh";
        const int vertices = 3 + below(random_, 4), triangles = 1 + below(random_, 3);
        std::string out = "mesh" + end_ + std::to_string(vertices) + " " + std::to_string(triangles) + end_;
        std::vector<double> x;
        for (int v = 0; v < vertices; ++v) out += numbers(3, -2, 2, x);
        for (int t = 0; t < triangles; ++t) {
          std::vector<int> corners;
          for (int v = 0; v < vertices; ++v) corners.push_back(v);
          std::shuffle(corners.begin(), corners.end(), random_);
          for (std::size_t k = 0; k < 3; ++k) {
            const auto at = static_cast<std::size_t>(3 * corners[k]);
            append(item, {x[at], x[at + 1], x[at + 2]});
            out += std::to_string(corners[k]) + " ";
          }
          out += end_;
        }
        return out;
      }
    }
  }

  Random& random_;
  const std::string end_;
};

// ---- OctoMap

class OctoMapWriter {
 public:
  OctoMapWriter(Random& random, bool binary) : random_(random), binary_(binary) {}

  RandomFile write() {
    RandomFile file;
    file.name = binary_ ? "cells.bt" : "cells.ot";
    resolution_ = oneOf<double>(random_, {0.1, 0.05, 0.025});
    char res[32];
    std::snprintf(res, sizeof res, "%g", resolution_);
    const std::string body = node(Eigen::Vector3d::Zero(), resolution_ * 32768, 0, -1);
    std::vector<std::string> lines{"id OcTree\n", "size " + std::to_string(nodes_) + "\n",
                                   std::string("res ") + res + "\n"};
    std::shuffle(lines.begin(), lines.end(), random_);
    file.content = binary_ ? "# Octomap OcTree binary file\n# (feel free to add / change comments)\n#\n"
                           : "# Octomap OcTree file\n\n";
    for (const std::string& line : lines) file.content += line;
    file.content += "data\n" + body;
    for (std::size_t k = 0; k < file_.size(); ++k) {
      file_[k].what = "cells" + (k > 0 ? "#" + std::to_string(k + 1) : "") + " box";
    }
    file.reading = file_;
    return file;
  }

 private:
  /// @param half  of its edge. @param state  of a full tree's node: 1 occupied.
  std::string node(const Eigen::Vector3d& center, double half, int level, int state) {
    ++nodes_;
    constexpr int kInner = 3;
    int children[8];
    bool any = false;
    for (int& child : children) {
      child = below(random_, 4);
      if (child == kInner && (level == 3 || below(random_, 3) > 0)) child = below(random_, 3);
      any = any || child > 0;
    }
    if (!any) children[below(random_, 8)] = 2;
    std::string out, below_it;
    unsigned bits = 0;
    for (int i = 0; i < 8; ++i) {
      const int child = children[i];
      bits |= static_cast<unsigned>(binary_ ? child << 2 * i : (child > 0) << i);
      const Eigen::Vector3d at = center + 0.5 * half * Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      if (child == kInner) below_it += node(at, half / 2, level + 1, 0);
      if (child == 1 || child == 2) {
        ++nodes_;
        if (!binary_) below_it += value(child == 2) + '\0';
      }
      if (child == 2) {
        Item item{"", {half, half, half}};
        Eigen::Isometry3d M(Eigen::Translation3d{at});
        append(item, rowsOf(M));
        file_.push_back(item);
      }
    }
    if (!binary_) return value(state > 0) + static_cast<char>(bits) + below_it;
    out += static_cast<char>(bits & 0xff);
    out += static_cast<char>(bits >> 8);
    return out + below_it;
  }
  std::string value(bool occupied) {
    const auto log_odds = static_cast<float>((occupied ? 1 : -1) * randomNumber(random_, 0.1, 3));
    return {reinterpret_cast<const char*>(&log_odds), sizeof log_odds};
  }

  Random& random_;
  const bool binary_;
  double resolution_ = 0;
  std::size_t nodes_ = 0;
  Reading file_;
};

}  // namespace

void addRobotFormats(std::vector<FileFormat>& formats) {
  formats.push_back({"urdf",
                     [](Random& random) { return UrdfWriter(random).write(); },
                     readUrdf,
                     {{"forgets an origin", "<origin [^>]*/>"},
                      {"forgets an axis", "<axis[^>]*/>"},
                      {"skips a shape", "<collision[\\s\\S]*?</collision>"},
                      {"forgets a scale", " scale=('[^']*'|\"[^\"]*\")"},
                      {"forgets a limit", " lower=('[^']*'|\"[^\"]*\")"},
                      {"forgets a mimic", "<mimic[^>]*/>"},
                      {"forgets a multiplier", " multiplier=('[^']*'|\"[^\"]*\")"}}});
  formats.push_back({"srdf", writeSrdf, readSrdfFile, {{"skips an enabled pair", "<enable_collisions[^>]*/>"}}});
  formats.push_back({"scene", [](Random& random) { return SceneWriter(random).write(); }, readScene});
  formats.push_back({"bt", [](Random& random) { return OctoMapWriter(random, true).write(); }, readScene});
  formats.push_back({"ot", [](Random& random) { return OctoMapWriter(random, false).write(); }, readScene});
}

}  // namespace fcl_artic::test
