// SPDX-License-Identifier: BSD-3-Clause
#include "tree_campaign.h"

#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "fcl_artic/urdf/urdf.h"
#include "random_tree.h"

namespace urdf_trees {
namespace {

using namespace fcl_artic;

constexpr int kSamples = 256;

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
class TreeCase {
 public:
  TreeCase(std::uint64_t seed, const std::string& folder)
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
  CertifiedResult ask(const Robot& robot, ContactMode mode, campaign::Case& c, const std::string& without = {},
                      bool certificate = false, std::vector<LinkPairFinding>* neighbours = nullptr) const {
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
    const JointMotion motion = JointMotion::linear(tree, q0, q1);
    c.query([&] { return manager.writeQuery(motion, request); });
    manager.continuousCollide(motion, request, result);
    return result;
  }

  /// Neighbours of which the manager says that it can't decide are not watched, nor, of those that it says touch
  /// throughout, the shapes that touch throughout this motion: there are to be some.
  /// @return what contradicts the rule; empty: nothing.
  std::string leaveOut(const std::vector<LinkPairFinding>& neighbours, const CertifiedResult& result,
                       campaign::Tally& tally) {
    for (const LinkPairFinding& found : neighbours) {
      if (!found.leftOut()) continue;
      tally.count("left out");
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
  double touchesBefore(double end, bool all, std::uint64_t& samples) const {
    std::vector<double> times;
    for (int s = 0; s <= kSamples; ++s) times.push_back(static_cast<double>(s) / kSamples);
    for (int k = 4; k <= 20; ++k) times.push_back(end - std::ldexp(1, -k));  // an answer may be a little late
    for (const double t : times) {
      if (t < 0 || !(all || t < end)) continue;
      ++samples;
      if (touches(t, Size::smaller)) return t;
    }
    return -1;
  }

  const RandomTree& tree() const { return tree_; }
  std::size_t numWatched() const { return watched_.size(); }

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

/// Counts a tree's parts.
void count(const TreeCase& tree, const Robot& robot, campaign::Tally& tally) {
  tally.count("links", static_cast<std::uint64_t>(robot.tree->numLinks()));
  tally.count("joints", static_cast<std::uint64_t>(robot.tree->numJoints()));
  tally.count("pairs", tree.numWatched());  // watched ones, of shapes
  for (const char* name : {"revolute", "continuous", "prismatic", "fixed", "planar", "floating", "mimics", "chains"})
    tally.count(name, 0);
  const std::vector<Link>& links = tree.tree().links();
  for (const Link& link : links) {
    tally.count("mimics", link.master >= 0);
    tally.count("chains", link.master >= 0 && links[static_cast<std::size_t>(link.master)].master >= 0);
    for (const Shape& shape : link.shapes) tally.count("meshes", shape.mesh);
    if (link.parent >= 0) tally.count(typeName(link.type));
  }
}

void judge(TreeCase& tree, const std::string& file,
           const std::function<void(campaign::Case&, const CertifiedResult&)>& certificates, campaign::Case& c) {
  const Robot robot = tree.read(file);
  std::vector<LinkPairFinding> neighbours;
  const CertifiedResult r = tree.ask(robot, ContactMode::first, c, {}, static_cast<bool>(certificates), &neighbours),
                        any = tree.ask(robot, ContactMode::any, c);
  const std::string untrue = tree.leaveOut(neighbours, r, c.tally);
  if (!untrue.empty()) c.fault("untrue", "neighbours: " + untrue);
  if (certificates) certificates(c, r);

  count(tree, robot, c.tally);
  c.tally.count("free", r.isFree());
  c.tally.count("hits", !r.isFree());
  c.tally.count("starts", !r.isFree() && r.t_upper <= 0);
  c.tally.count("uncertain", !r.isFree() && !r.certain);

  std::uint64_t samples = 0;
  const double seen = tree.touchesBefore(r.t_lower, r.isFree(), samples);
  c.tally.count("samples", samples);
  if (seen >= 0) c.fault("missed", campaign::format("touches at %.17g, free before %.17g", seen, r.t_lower));
  if (r.status == Status::undecided || any.status == Status::undecided) c.fault("untrue", "undecided without a budget");
  if (r.certain && !r.isFree() && !tree.touches(r.t_upper, Size::larger))
    c.fault("untrue", campaign::format("nothing touches at %.17g", r.t_upper));
  if (any.certain && !any.isFree() && !tree.touches(any.t_upper, Size::larger))
    c.fault("untrue", campaign::format("any contact: nothing touches at %.17g", any.t_upper));
  if (r.isFree() != any.isFree() && (r.isFree() ? any.certain : r.certain)) c.fault("differing", "modes differ");

  if (!c.mutants || !r.certain || r.isFree() || r.contacts.empty()) return;
  const CertifiedResult spoilt = tree.ask(robot, ContactMode::first, c, touchingLink(r.contacts[0]));
  if (!spoilt.isFree() && spoilt.t_lower < r.t_upper + 0.05) return;  // hidden by a contact of others
  c.tally.mutant("a link without geometry", 0.9, true,
                 tree.touchesBefore(spoilt.t_lower, spoilt.isFree(), samples) >= 0);
}

}  // namespace

campaign::Campaign campaignOfTrees(std::function<void(campaign::Case&, const CertifiedResult&)> certificates) {
  campaign::Campaign all;
  all.name = "trees";
  all.number = [](std::uint64_t seed, std::uint64_t index) {
    return campaign::CaseId{"", pairs::Random::mix(seed, index)};
  };
  all.look = [folder = std::make_shared<const Folder>(), certificates = std::move(certificates)](campaign::Case& c) {
    TreeCase tree(c.id.seed, folder->path());
    judge(tree, "tree_" + std::to_string(c.id.seed) + ".urdf", certificates, c);
  };
  return all;
}

}  // namespace urdf_trees
