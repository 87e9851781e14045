// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "readers.h"
#include "report.h"
#include "shapes.h"

namespace verify {
namespace {

/// An obstacle as a file has it.
struct Obstacle {
  std::string name, file;
  Collision shape;              // its place: not used
  Pose pose;                    // lengths not yet scaled
  std::vector<double> at;       // the translation, where one pose at most is not 0; else empty
  std::vector<double> lengths;  // that the translation is made of
};

/// Poses one after the other, as the file has them.
class Chain {
 public:
  Chain() {
    for (std::size_t k = 0; k < 9; k += 4) pose_.R[k] = constant(integer(1));
  }
  /// @param here  comes before all that there is.
  void putBefore(const Place& here) {
    Pose p;
    p.R = here.R;
    for (std::size_t k = 0; k < 3; ++k) p.t[k] = exactly(here.t[k]);
    pose_ = {p.R * pose_.R, p.R * pose_.t + p.t};
    lengths_.insert(lengths_.end(), here.t.begin(), here.t.end());
    const bool moves = here.t != std::vector<double>(3, 0);
    Fix turn;  // 1000 ulp of 2^-64 are less than a double's rounding
    for (std::size_t k = 0; k < 9; ++k) turn += bound(here.R[k] - constant(integer(k % 4 == 0)));
    if (!moves && turn <= ulps(1000)) return;
    ++count_;
    at_ = here.t;
  }
  void finish(Obstacle& o) const {
    o.pose = pose_;
    o.lengths = lengths_;
    if (count_ <= 1) o.at = at_;
  }

 private:
  Pose pose_{};
  std::vector<double> lengths_, at_ = std::vector<double>(3, 0);
  int count_ = 0;
};

/// All links, each joint at 0.
void readUrdf(const std::string& path, const Packages& packages, std::vector<Obstacle>& obstacles) {
  Robot robot(path, packages);
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    if (robot.joints[j].mimics && robot.drivenBy(j).driver.offset != 0)
      throw BadInput("'" + path + "': joint " + inQuotes(robot.joints[j].name) +
                     " mimics another one with an offset: not compared as a scene");
  for (const Link& link : robot.links)
    for (const Collision& collision : link.collisions) {
      Chain chain;
      chain.putBefore(collision.place);
      for (const Joint* j = robot.jointAbove(link.name); j != nullptr; j = robot.jointAbove(j->parent))
        chain.putBefore(j->origin);
      Obstacle o{link.name, path, collision, {}, {}, {}};
      chain.finish(o);
      obstacles.push_back(std::move(o));
    }
}

std::vector<Obstacle> readScene(const std::string& path, const Packages& packages) {
  std::vector<Obstacle> obstacles;
  const std::filesystem::path file(path);
  std::string ending = file.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (ending == ".urdf") {
    readUrdf(path, packages, obstacles);
  } else if (ending == ".stl" || ending == ".obj") {
    Obstacle o{file.stem().string(), path, {{}, Geometry::mesh, {1, 1, 1}, path}, {}, {}, {}};
    Chain().finish(o);
    obstacles.push_back(std::move(o));
  } else {
    throw BadInput("'" + path + "' is not compared: it is neither URDF, STL nor OBJ");
  }
  return obstacles;
}

/// A name without #NUMBER at its end. If several have one name, each but the first gets such a number.
std::string withoutNumber(const std::string& name) {
  const std::size_t at = name.rfind('#');
  const bool number =
      at != name.npos && at + 1 < name.size() && name.find_first_not_of("0123456789", at + 1) == name.npos;
  return number ? name.substr(0, at) : name;
}
/// A name without any such numbers. (Another file may have taken the names of this one.)
std::string baseOf(std::string name) {
  for (std::string less = withoutNumber(name); less != name; less = withoutNumber(name)) name = less;
  return name;
}
/// Whether `name` is `own`, or that with numbers after it.
bool isCalled(std::string name, const std::string& own) {
  while (name != own && withoutNumber(name) != name) name = withoutNumber(name);
  return name == own;
}

class SceneComparison {
 public:
  SceneComparison(const World& world, const Solids& solids, double scale)
      : world_(world), scale_(scale), shapes_(world, solids, scale) {
    for (std::size_t b = 0; b < world.bodies.size(); ++b)
      if (world.bodies[b].role == Role::obstacle) bodies_[baseOf(world.bodies[b].name)].insert(static_cast<int>(b));
  }

  Comparison run(const std::vector<Obstacle>& obstacles) {
    for (const Obstacle& o : obstacles) find(o);
    for (const auto& [name, bodies] : bodies_)
      for (const int b : bodies) result_.differences.push_back(world_.describe(b) + " is in no scene");
    result_.notes.push_back("the scene has " + counted(obstacles.size(), "obstacle") +
                            (result_.differences.empty() ? ", as the world has" : ""));
    if (rounded_ > 0)
      result_.notes.push_back(std::to_string(rounded_) +
                              " of them stand where several poses, one after the other, put them: within 2^-49 in each "
                              "entry of a rotation, and 2^-48 of the lengths that add up");
    shapes_.note("obstacles", result_);
    return std::move(result_);
  }

 private:
  void find(const Obstacle& o) {
    std::string why;
    std::set<int>& open = bodies_[baseOf(o.name)];
    for (const int b : open) {
      if (!isCalled(world_.bodies[static_cast<std::size_t>(b)].name, o.name)) continue;
      if (++pairs_ > 2000000) throw BadInput("the scene has too many obstacles of one name: not compared");
      if (isObstacle(o, b)) {
        open.erase(b);
        rounded_ += o.at.empty();
        return;
      }
      if (why.empty()) why = shapes_.why();
    }
    result_.differences.push_back("no obstacle of the world is " + inQuotes(o.name) + " of '" + o.file + "'" + why);
  }

  bool isObstacle(const Obstacle& o, int body) {
    const Body& b = world_.bodies[static_cast<std::size_t>(body)];
    return b.frame == 0 && isRotation(o.pose.R, b.numbers) && isThere(o, b.numbers + 9) &&
           shapes_.same(o.shape, {o.name, b.name}, body);
  }

  /// Whether an obstacle is where the file has it: to the very bit where one pose places it. Where several poses place
  /// it, a writer multiplies them in doubles, so the claim may be about a place that is off the file's. Each R t + t'
  /// is off by less than 8 u of all lengths so far, u = 2^-53: 3 u in each entry of R, which is made of sines, and 3 u
  /// of the sum. For four of them that is 32 u = 2^-48; a longer chain of a writer may be refused.
  bool isThere(const Obstacle& o, const double* t) const {
    const Tm scale = exactly(scale_);
    Fix sum;
    for (const double x : o.lengths) sum += abs(enclose(x).x) + ulps(1);
    const Fix most = shifted(mulUp(sum, enclose(scale_).x + ulps(1)), 48) + ulps(1);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!o.at.empty() && t[k] != o.at[k] * scale_) return false;
      if (o.at.empty() && bound(o.pose.t[k] * scale - exactly(t[k])) > most) return false;
    }
    return true;
  }

  const World& world_;
  const double scale_;
  ShapeComparison shapes_;
  std::map<std::string, std::set<int>> bodies_;  // of role obstacle that no file has yet, by name without numbers
  std::size_t pairs_ = 0, rounded_ = 0;
  Comparison result_;
};

}  // namespace

Comparison compareWithScenes(const World& world, const std::vector<std::string>& paths, const Packages& packages,
                             const Solids& solids, double scale) {
  std::vector<Obstacle> obstacles;
  for (const std::string& path : paths)
    for (Obstacle& o : readScene(path, packages)) obstacles.push_back(std::move(o));
  return SceneComparison(world, solids, scale).run(obstacles);
}

}  // namespace verify
