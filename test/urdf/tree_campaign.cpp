// SPDX-License-Identifier: BSD-3-Clause
#include "tree_campaign.h"

#include <stdlib.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "fcl_artic/urdf/urdf.h"
#include "random_tree.h"

namespace urdf_trees {
namespace {

using namespace fcl_artic;

constexpr int kSamples = 256;
constexpr std::size_t kMostFaults = 20;

/// A folder of this run's own, with the meshes.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "fcl_artic_trees_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder can be made in the system's temporary one");
    path_ = name;
    writeMeshes(path_.string());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// A shape of a link (-1: an obstacle).
struct Body {
  int link;
  const Shape* shape;
};

enum class Size { smaller, larger };

bool touch(const Shape& a, const Isometry3d& M_a, const Shape& b, const Isometry3d& M_b, Size size) {
  const double reach = a.radius + b.radius;
  if ((M_a.translation() - M_b.translation()).squaredNorm() > reach * reach) return false;
  const Geometry &x = size == Size::smaller ? a.smaller : a.larger, &y = size == Size::smaller ? b.smaller : b.larger;
  fcl::CollisionResultd result;
  if (fcl::collide(x.get(), M_a, y.get(), M_b, fcl::CollisionRequestd(), result) > 0) return true;
  if (size == Size::smaller || !a.mesh || !b.mesh) return false;
  fcl::DistanceResultd distance;
  return fcl::distance(x.get(), M_a, y.get(), M_b, fcl::DistanceRequestd(), distance) <= 2 * kAround;
}

/// One tree on one motion, among obstacles.
class Case {
 public:
  Case(std::uint64_t seed, const std::string& folder)
      : random_(seed), folder_(folder), tree_(random_, folder), way_(tree_.way(random_, reach())) {
    for (std::size_t i = 0; i < tree_.links().size(); ++i) {
      for (const Shape& shape : tree_.links()[i].shapes) bodies_.push_back({static_cast<int>(i), &shape});
    }
    placeObstacles();
    chooseWatched();
  }

  Robot read(const std::string& name) {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << tree_.urdf(random_);
    Robot robot = loadUrdf(path);
    std::filesystem::remove(path);
    return robot;
  }

  /// @param without  link whose geometry is left out; empty: none.
  /// @param[out] neighbours  what the manager found of these; null: not asked.
  CertifiedResult ask(const Robot& robot, ContactMode mode, const std::string& without = {}, bool certificate = false,
                      std::vector<LinkPairFinding>* neighbours = nullptr) const {
    const KinematicTree& tree = *robot.tree;
    ArticulatedCollisionManager manager(robot.tree);
    for (const LinkGeometry& g : robot.geometry) {
      if (tree.linkName(g.link) != without) manager.bind(g.link, g.object.get(), g.offset);
    }
    manager.setAllowedCollisions(allowed_);
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
    for (const Shape& obstacle : obstacles_) {
      objects.push_back(std::make_unique<fcl::CollisionObjectd>(
          std::const_pointer_cast<fcl::CollisionGeometryd>(obstacle.exact), obstacle.offset));
      manager.registerObject(objects.back().get());
    }
    manager.setup();
    if (neighbours) *neighbours = manager.neighbours();
    Eigen::VectorXd q0 = tree.neutralConfiguration(), q1 = q0;
    for (std::size_t i = 1; i < way_.size(); ++i) {
      if (way_[i].from.empty() || tree_.links()[i].master >= 0) continue;
      const int variable = tree.jointVariable(tree.jointId(RandomTree::jointName(static_cast<int>(i))));
      for (std::size_t k = 0; k < way_[i].from.size(); ++k) {
        q0[variable + static_cast<int>(k)] = way_[i].from[k];
        q1[variable + static_cast<int>(k)] = way_[i].to[k];
      }
    }
    CertifiedRequest request;
    request.mode = mode;
    request.certificate = certificate;
    CertifiedResult result;
    manager.continuousCollide(JointMotion::linear(tree, q0, q1), request, result);
    return result;
  }

  /// Neighbours of which the manager says that it can't decide are not watched, nor, of those that it says touch
  /// throughout, the shapes that touch throughout this motion: there are to be some.
  /// @return what contradicts the rule; empty: nothing.
  std::string leaveOut(const std::vector<LinkPairFinding>& neighbours, const CertifiedResult& result, long* left_out) {
    for (const LinkPairFinding& found : neighbours) {
      if (!found.leftOut()) continue;
      ++*left_out;
      const auto& said = result.unproven_neighbours;
      const std::pair<std::string, std::string> names(found.link1, found.link2);
      if (found.undecided() && (!said || std::find(said->begin(), said->end(), names) == said->end())) {
        return "nobody says " + found.link1 + ", " + found.link2;
      }
      const auto isLeftOut = [&](const auto& pair) {
        return areOf(pair, found) && (found.undecided() || touchThroughout(pair.first, pair.second));
      };
      const auto kept = std::remove_if(watched_.begin(), watched_.end(), isLeftOut);
      if (kept == watched_.end()) return found.link1 + ", " + found.link2 + ": no two shapes touch throughout";
      watched_.erase(kept, watched_.end());
    }
    return {};
  }

  bool touches(double t, Size size) const {
    const std::vector<Isometry3d> M = shapePoses(t);
    return std::any_of(watched_.begin(), watched_.end(), [&](const auto& pair) {
      const auto [i, j] = pair;
      return touch(*bodies_[i].shape, M[i], *bodies_[j].shape, M[j], size);
    });
  }

  /// A sampled time before `end` at which something touches; -1: none.
  double touchesBefore(double end, bool all, long* samples) const {
    std::vector<double> times;
    for (int s = 0; s <= kSamples; ++s) times.push_back(static_cast<double>(s) / kSamples);
    for (int k = 4; k <= 20; ++k) times.push_back(end - std::ldexp(1, -k));  // an answer may be a little late
    for (const double t : times) {
      if (t < 0 || !(all || t < end)) continue;
      ++*samples;
      if (touches(t, Size::smaller)) return t;
    }
    return -1;
  }

  const RandomTree& tree() const { return tree_; }
  long numWatched() const { return static_cast<long>(watched_.size()); }

 private:
  bool areOf(const std::pair<std::size_t, std::size_t>& shapes, const LinkPairFinding& found) const {
    const int a = bodies_[shapes.first].link, b = bodies_[shapes.second].link;
    if (a < 0 || b < 0) return false;
    const std::string x = RandomTree::linkName(a), y = RandomTree::linkName(b);
    return std::minmax(x, y) == std::minmax(found.link1, found.link2);
  }
  bool touchThroughout(std::size_t i, std::size_t j) const {
    for (int s = 0; s <= kSamples; ++s) {
      const std::vector<Isometry3d> M = shapePoses(static_cast<double>(s) / kSamples);
      if (!touch(*bodies_[i].shape, M[i], *bodies_[j].shape, M[j], Size::larger)) return false;
    }
    return true;
  }

  /// Large trees meet themselves soon.
  double reach() { return random_.uniform(0.3, 4) / std::sqrt(static_cast<double>(tree_.links().size())); }

  std::vector<Isometry3d> shapePoses(double t) const {
    const std::vector<Isometry3d> M_0 = tree_.poses(way_, t);
    std::vector<Isometry3d> M;
    for (const Body& body : bodies_) {
      M.push_back(body.link < 0 ? body.shape->offset : M_0[static_cast<std::size_t>(body.link)] * body.shape->offset);
    }
    return M;
  }

  /// Where nothing touches them at t = 0.
  void placeObstacles() {
    const std::vector<Isometry3d> M = shapePoses(0);
    const int wanted = random_.below(5);
    obstacles_.reserve(static_cast<std::size_t>(wanted));  // bodies_ points to them
    for (int tries = 0; tries < 40 && static_cast<int>(obstacles_.size()) < wanted; ++tries) {
      Shape shape = randomShape(random_, random_.uniform(0.2, 0.8), folder_);
      const std::size_t near = static_cast<std::size_t>(random_.below(static_cast<int>(M.size())));
      shape.offset.translation() = M[near].translation() + random_.vector(0.1, 1.2);
      bool clear = true;
      for (std::size_t i = 0; i < M.size(); ++i)
        clear = clear && !touch(*bodies_[i].shape, M[i], shape, shape.offset, Size::larger);
      if (clear) obstacles_.push_back(std::move(shape));
    }
    for (const Shape& obstacle : obstacles_) bodies_.push_back({-1, &obstacle});
  }

  /// Pairs of links that touch at t = 0 are allowed, most of them.
  void chooseWatched() {
    const std::vector<Isometry3d> M = shapePoses(0);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
        const int a = bodies_[i].link, b = bodies_[j].link;
        if (a < 0 || a == b) continue;
        const bool touching = b >= 0 && touch(*bodies_[i].shape, M[i], *bodies_[j].shape, M[j], Size::larger);
        if (touching && !random_.chance(0.01)) allowed_.allow(RandomTree::linkName(a), RandomTree::linkName(b));
      }
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
        const int a = bodies_[i].link, b = bodies_[j].link;
        if (a < 0 || a == b) continue;
        if (b >= 0 && allowed_.allowed(RandomTree::linkName(a), RandomTree::linkName(b))) continue;
        if (tree_.carrier(a) == tree_.carrier(b)) continue;  // stand still against each other
        watched_.emplace_back(i, j);
      }
    }
  }

  pairs::Random random_;
  std::string folder_;
  RandomTree tree_;
  std::vector<JointWay> way_;
  std::vector<Shape> obstacles_;
  std::vector<Body> bodies_;
  std::vector<std::pair<std::size_t, std::size_t>> watched_;
  AllowedCollisionMatrix allowed_;
};

/// The contact's link that is not the other one's base.
const std::string& touchingLink(const CertifiedContact& contact) {
  return contact.body2.link >= 0 ? contact.body2.name : contact.body1.name;
}

void judge(const Options& options, int number, const std::string& folder, Report& report) {
  Case c(pairs::Random::mix(options.seed, static_cast<std::uint64_t>(number)), folder);
  const Robot robot = c.read("tree_" + std::to_string(number) + ".urdf");
  const auto fault = [&](long& count, const std::string& what) {
    ++count;
    if (report.faults.size() < kMostFaults) report.faults.push_back("tree " + std::to_string(number) + ": " + what);
  };
  std::vector<LinkPairFinding> neighbours;
  const CertifiedResult r = c.ask(robot, ContactMode::first, {}, static_cast<bool>(options.certificates), &neighbours),
                        any = c.ask(robot, ContactMode::any);
  const std::string untrue = c.leaveOut(neighbours, r, &report.left_out);
  if (!untrue.empty()) fault(report.untrue, "neighbours: " + untrue);
  if (options.certificates) options.certificates(number, r);

  ++report.trees;
  report.links += robot.tree->numLinks();
  report.joints += robot.tree->numJoints();
  report.pairs += c.numWatched();
  for (const Link& link : c.tree().links()) {
    report.mimics += link.master >= 0;
    report.chains += link.master >= 0 && c.tree().links()[static_cast<std::size_t>(link.master)].master >= 0;
    for (const Shape& shape : link.shapes) report.meshes += shape.mesh;
    if (link.parent < 0) continue;
    static const JointType kinds[] = {JointType::revolute, JointType::continuous, JointType::prismatic,
                                      JointType::fixed,    JointType::planar,     JointType::floating};
    ++report.of_kind[std::find(kinds, kinds + 6, link.type) - kinds];
  }
  report.free += r.isFree();
  report.hits += !r.isFree();
  report.at_start += !r.isFree() && r.t_upper <= 0;
  report.uncertain += !r.isFree() && !r.certain;

  const double seen = c.touchesBefore(r.t_lower, r.isFree(), &report.samples);
  if (seen >= 0)
    fault(report.missed, "touches at " + std::to_string(seen) + ", free before " + std::to_string(r.t_lower));
  if (r.status == Status::undecided || any.status == Status::undecided)
    fault(report.untrue, "undecided without a budget");
  if (r.certain && !r.isFree() && !c.touches(r.t_upper, Size::larger))
    fault(report.untrue, "nothing touches at " + std::to_string(r.t_upper));
  if (any.certain && !any.isFree() && !c.touches(any.t_upper, Size::larger)) {
    fault(report.untrue, "any contact: nothing touches at " + std::to_string(any.t_upper));
  }
  if (r.isFree() != any.isFree() && (r.isFree() ? any.certain : r.certain)) fault(report.differing, "modes differ");

  if (!options.spoil || !r.certain || r.isFree() || r.contacts.empty()) return;
  const CertifiedResult spoilt = c.ask(robot, ContactMode::first, touchingLink(r.contacts[0]));
  if (!spoilt.isFree() && spoilt.t_lower < r.t_upper + 0.05) return;  // hidden by a contact of others
  long ignored = 0;
  ++report.spoilt;
  report.spoilt_seen += c.touchesBefore(spoilt.t_lower, spoilt.isFree(), &ignored) >= 0;
}

}  // namespace

void Report::add(const Report& o) {
  trees += o.trees;
  links += o.links;
  joints += o.joints;
  mimics += o.mimics;
  chains += o.chains;
  meshes += o.meshes;
  for (int k = 0; k < 6; ++k) of_kind[k] += o.of_kind[k];
  hits += o.hits;
  at_start += o.at_start;
  free += o.free;
  uncertain += o.uncertain;
  pairs += o.pairs;
  left_out += o.left_out;
  samples += o.samples;
  missed += o.missed;
  untrue += o.untrue;
  differing += o.differing;
  spoilt += o.spoilt;
  spoilt_seen += o.spoilt_seen;
  faults.insert(faults.end(), o.faults.begin(), o.faults.end());
}

Report run(const Options& options) {
  const Folder folder;
  std::atomic<int> next{0};
  std::mutex mutex;
  Report sum;
  std::exception_ptr thrown;
  const auto work = [&] {
    Report own;
    try {
      for (int n; (n = next++) < options.trees;) judge(options, options.first + n, folder.path(), own);
    } catch (...) {
      next = options.trees;
      const std::lock_guard<std::mutex> lock(mutex);
      thrown = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    sum.add(own);
  };
  std::vector<std::thread> others;
  for (int k = 1; k < options.threads; ++k) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
  if (thrown) std::rethrow_exception(thrown);
  return sum;
}

std::string toText(const Report& r) {
  std::ostringstream out;
  out << r.trees << " trees: " << r.links << " links, " << r.joints << " joints (revolute " << r.of_kind[0]
      << ", continuous " << r.of_kind[1] << ", prismatic " << r.of_kind[2] << ", fixed " << r.of_kind[3] << ", planar "
      << r.of_kind[4] << ", floating " << r.of_kind[5] << "; " << r.mimics << " mimic, " << r.chains
      << " of them a mimic), " << r.meshes << " meshes, " << r.pairs << " watched pairs of shapes, " << r.left_out
      << " pairs of neighbours left out\n"
      << r.hits << " contacts (" << r.at_start << " at the start, " << r.uncertain << " not certain), " << r.free
      << " free; " << r.samples << " samples\n"
      << "missed " << r.missed << ", untrue " << r.untrue << ", modes that differ " << r.differing << "\n";
  if (r.spoilt) out << "spoilt answers " << r.spoilt << ", seen " << r.spoilt_seen << "\n";
  for (const std::string& fault : r.faults) out << fault << "\n";
  return out.str();
}

}  // namespace urdf_trees
