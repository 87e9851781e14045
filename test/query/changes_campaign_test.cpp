// SPDX-License-Identifier: BSD-3-Clause
//
// Managers through random changes, geometry edited in place among them, against managers built from scratch of what the
// documentation says was read last: the same bits. FCL_ARTIC_CHANGES_CASES sets the number of sequences,
// FCL_ARTIC_CHANGES_SEED the seed of the first one: a finding names its own.
//
// The judge keeps copies of what was read, made from the numbers that the test itself chose; it reads no geometry back.
#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/motion/translation_motion.h>
#include "../support/random_placing.h"
#include "arms.h"
#include "expect.h"
#include "fcl_artic/continuous_manager.h"
#include "meshes.h"

namespace changes_campaign_test {

using namespace fcl_artic;
using namespace fcl_artic::test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Geometry = std::shared_ptr<fcl::CollisionGeometryd>;

/// The numbers of a geometry, and FCL's object with them.
struct Numbers {
  enum Kind { box, sphere, capsule, cylinder, mesh, convex, octree, kinds } kind = box;
  std::vector<double> values;
  std::map<std::array<int, 3>, bool> cells;  ///< of an octree: sure (occupied at any threshold) or not
  double threshold = 0.5;

  static Numbers make(Random& random) {
    Numbers n;
    n.kind = static_cast<Kind>(random.below(kinds));
    const int counts[] = {3, 1, 2, 2, 24, 24, 0};
    for (int i = 0; i < counts[n.kind]; ++i) {
      const bool corner = n.kind == mesh || n.kind == convex;
      const double sign = (i / 3) >> (i % 3) & 1 ? 1 : -1;
      n.values.push_back((corner ? sign : 1) * random.uniform(0.1, 0.4));
    }
    if (n.kind == octree) {
      for (int i = random.below(4); i > 0; --i) n.cells[cell(random)] = random.oneIn(2);
    }
    return n;
  }
  /// One number more or less, or one cell.
  void edit(Random& random) {
    if (kind == octree) {
      if (random.oneIn(4)) {
        threshold = threshold == 0.5 ? 0.9 : 0.5;
      } else {
        cells[cell(random)] = random.oneIn(2);
      }
      return;
    }
    double& value = random.of(values);
    value *= random.oneIn(2) ? random.uniform(0.1, 0.8) : random.uniform(1.3, 6);
    value = std::copysign(std::max(0.02, std::min(std::abs(value), 1.0)), value);
  }
  static std::array<int, 3> cell(Random& random) {
    return {random.below(6) - 3, random.below(6) - 3, random.below(6) - 3};
  }
  static octomap::point3d middle(const std::array<int, 3>& c) {
    return {static_cast<float>(0.2 * c[0] + 0.1), static_cast<float>(0.2 * c[1] + 0.1),
            static_cast<float>(0.2 * c[2] + 0.1)};
  }
  Vector3d corner(int i) const { return Vector3d::Map(&values[static_cast<std::size_t>(3 * i)]); }
};

/// FCL's geometry with given numbers, which can be given others in place.
class Live {
 public:
  explicit Live(const Numbers& n) : kind_(n.kind) {
    switch (n.kind) {
      case Numbers::box:
        geometry = std::make_shared<fcl::Boxd>(1, 1, 1);
        break;
      case Numbers::sphere:
        geometry = std::make_shared<fcl::Sphered>(1);
        break;
      case Numbers::capsule:
        geometry = std::make_shared<fcl::Capsuled>(1, 1);
        break;
      case Numbers::cylinder:
        geometry = std::make_shared<fcl::Cylinderd>(1, 1);
        break;
      case Numbers::mesh:
        geometry = boxMesh({1, 1, 1});
        break;
      case Numbers::convex: {
        corners_ = std::make_shared<std::vector<Vector3d>>(8, Vector3d::Zero());
        const auto faces = std::make_shared<std::vector<int>>(
            std::vector<int>{4, 0, 2, 3, 1, 4, 4, 5, 7, 6, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 4, 6, 2, 4, 1, 3, 7, 5});
        set(n);  // FCL's constructor looks at the corners
        geometry = std::make_shared<fcl::Convexd>(corners_, 6, faces, true);
        break;
      }
      default:
        cells_ = std::make_shared<octomap::OcTree>(0.2);
        geometry = std::make_shared<fcl::OcTreed>(cells_);
    }
    set(n);
  }
  void set(const Numbers& n) {
    const std::vector<double>& v = n.values;
    switch (kind_) {
      case Numbers::box:
        as<fcl::Boxd>().side = Vector3d(v[0], v[1], v[2]);
        break;
      case Numbers::sphere:
        as<fcl::Sphered>().radius = v[0];
        break;
      case Numbers::capsule:
        as<fcl::Capsuled>().radius = v[0];
        as<fcl::Capsuled>().lz = v[1];
        break;
      case Numbers::cylinder:
        as<fcl::Cylinderd>().radius = v[0];
        as<fcl::Cylinderd>().lz = v[1];
        break;
      case Numbers::mesh:
        for (int i = 0; i < 8; ++i) as<Mesh>().vertices[i] = n.corner(i);
        break;
      case Numbers::convex:
        for (int i = 0; i < 8; ++i) (*corners_)[static_cast<std::size_t>(i)] = n.corner(i);
        break;
      default:
        as<fcl::OcTreed>().setOccupancyThres(n.threshold);
        for (const auto& [cell, sure] : n.cells) {
          cells_->setNodeValue(Numbers::middle(cell), octomap::logodds(sure ? 0.95 : 0.7));
        }
    }
  }
  Geometry geometry;

 private:
  template <class T>
  T& as() {
    return static_cast<T&>(*geometry);
  }
  Numbers::Kind kind_;
  std::shared_ptr<octomap::OcTree> cells_;
  std::shared_ptr<std::vector<Vector3d>> corners_;
};

/// What a body is, as its owner has it or as it was read.
struct State {
  Numbers numbers;
  Isometry3d transform = Isometry3d::Identity();                            ///< of what stands still
  Isometry3d begin = Isometry3d::Identity(), end = Isometry3d::Identity();  ///< of what moves
};

struct Body {
  std::string name;
  State now, seen;  ///< `seen`: as read last
  Live live;
  std::shared_ptr<fcl::TranslationMotiond> motion;  ///< null: stands still
  std::unique_ptr<fcl::CollisionObjectd> object;
  std::unique_ptr<fcl::ContinuousCollisionObjectd> moving;
  enum Place { out, obstacle, bound, attached } place = out;
  std::string link;
  Isometry3d offset = Isometry3d::Identity();
  std::vector<std::string> touch;

  Body(std::string name_, const State& state, bool moves)
      : name(std::move(name_)), now(state), seen(state), live(state.numbers) {
    if (moves) {
      motion = std::make_shared<fcl::TranslationMotiond>(state.begin, state.end);
      moving = std::make_unique<fcl::ContinuousCollisionObjectd>(live.geometry, motion);
    } else {
      object = std::make_unique<fcl::CollisionObjectd>(live.geometry, state.transform);
    }
  }
  void editGeometry(Random& random) {
    now.numbers.edit(random);
    live.set(now.numbers);
  }
  void editPlace(Random& random) {
    if (motion) {
      now.begin = random.pose(1.1);
      now.end = now.begin;
      now.end.translation() += random.box(1);
      *motion = fcl::TranslationMotiond(now.begin, now.end);
    } else {
      now.transform = random.pose(1.1);
      object->setTransform(now.transform);
    }
  }
};

State randomState(Random& random) {
  State state;
  state.numbers = Numbers::make(random);
  state.transform = random.pose(1.1);
  state.begin = random.pose(1.1);
  state.end = state.begin;
  state.end.translation() += random.box(1);
  return state;
}

bool sameBits(const void* a, const void* b, std::size_t bytes) {
  return std::memcmp(a, b, bytes) == 0;
}
bool sameBits(double a, double b) {
  return sameBits(&a, &b, sizeof a);
}

/// But for cells' ids, which are addresses.
bool same(const CertifiedContact& x, const CertifiedContact& y) {
  const auto octree = [](const fcl::CollisionGeometryd* o) { return o && o->getNodeType() == fcl::GEOM_OCTREE; };
  return x.body1.name == y.body1.name && x.body2.name == y.body2.name && x.body1.link == y.body1.link &&
         (octree(x.o1) || x.b1 == y.b1) && (octree(x.o2) || x.b2 == y.b2) && x.feature == y.feature &&
         x.certain == y.certain && sameBits(x.t_lower, y.t_lower) && sameBits(x.t_upper, y.t_upper) &&
         sameBits(x.point.data(), y.point.data(), 24) && sameBits(x.normal.data(), y.normal.data(), 24) &&
         x.q_witness.size() == y.q_witness.size() &&
         sameBits(x.q_witness.data(), y.q_witness.data(),
                  sizeof(double) * static_cast<std::size_t>(x.q_witness.size())) &&
         x.base_deviation.matrix() == y.base_deviation.matrix() && x.deviation1.matrix() == y.deviation1.matrix() &&
         x.deviation2.matrix() == y.deviation2.matrix();
}
template <class Result>
bool sameVerdict(const Result& a, const Result& b) {
  return a.status == b.status && a.certain == b.certain && sameBits(a.t_lower, b.t_lower) &&
         sameBits(a.t_upper, b.t_upper);
}
bool same(const CertifiedResult& a, const CertifiedResult& b) {
  if (!sameVerdict(a, b) || a.contacts.size() != b.contacts.size() || a.M_0_at_lower.size() != b.M_0_at_lower.size() ||
      a.ignored_initial_contacts.size() != b.ignored_initial_contacts.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.contacts.size(); ++i) {
    if (!same(a.contacts[i], b.contacts[i])) return false;
  }
  for (std::size_t i = 0; i < a.M_0_at_lower.size(); ++i) {
    if (!sameBits(a.M_0_at_lower[i].data(), b.M_0_at_lower[i].data(), 128)) return false;
  }
  for (std::size_t i = 0; i < a.ignored_initial_contacts.size(); ++i) {
    const auto &x = a.ignored_initial_contacts[i], &y = b.ignored_initial_contacts[i];
    if (x.first.name != y.first.name || x.second.name != y.second.name) return false;
  }
  return true;
}

std::string shown(const CertifiedResult& r) {
  std::string text = std::to_string(static_cast<int>(r.status)) + " [" + std::to_string(r.t_lower) + ", " +
                     std::to_string(r.t_upper) + "]";
  for (const CertifiedContact& c : r.contacts) text += ' ' + c.body1.name + '-' + c.body2.name;
  return text;
}

/// Few joints between links, which then get tables, or many, which is faster.
std::shared_ptr<const KinematicTree> robot(bool with_tables) {
  auto tree = std::make_shared<KinematicTree>("robot");
  for (const char* link : {"base", "upper", "lower", "hand"}) tree->addLink(link);
  const JointType first = with_tables ? JointType::revolute : JointType::floating;
  const JointType second = with_tables ? JointType::revolute : JointType::planar;
  tree->addJoint(makeJoint("one", first, "base", "upper", Vector3d::UnitZ(), pose({0.3, 0, 0})));
  tree->addJoint(makeJoint("two", second, "upper", "lower", Vector3d::UnitZ(), pose({0.6, 0, 0})));
  tree->addJoint(makeJoint("three", JointType::spherical, "lower", "hand", Vector3d::UnitX(), pose({0.4, 0, 0})));
  return tree;
}

/// One manager through one sequence of changes.
class Sequence {
 public:
  explicit Sequence(campaign::Case& c)
      : random_(c.id.seed), case_(c), counts_(c.tally), tree_(robot(random_.oneIn(8))), manager_(tree_) {
    for (int i = 0; i < 9; ++i) {
      bodies_.push_back(std::make_unique<Body>("body" + std::to_string(i), randomState(random_), i >= 7));
    }
    for (auto& q : ends_) q = configuration();
    for (int i = 0; i < 4; ++i) registerOrBind(*bodies_[static_cast<std::size_t>(i)]);
    for (int i = random_.below(4); i > 0; --i) tolerances();
    last_motion_ = 0;
  }

  /// @return an empty string, or what differs.
  std::string run(int steps) {
    for (int i = 0; i < steps && failure_.empty(); ++i) step();
    return failure_;
  }

 private:
  Body& any() { return *random_.of(bodies_); }
  VectorXd configuration() {
    VectorXd q = tree_->neutralConfiguration();
    for (int v = 0; v < tree_->dof(); ++v) q[v] += random_.uniform(-0.7, 0.7);
    for (JointId j = 0; j < tree_->numJoints(); ++j) {
      if (const int v = tree_->quaternionVariable(j); v >= 0) q.segment<4>(v).normalize();
    }
    return q;
  }
  std::string anyLink() { return tree_->linkName(random_.below(tree_->numLinks())); }

  void changed() { ready_ = false; }

  void registerOrBind(Body& body) {
    body.seen = body.now;
    if (body.moving) {
      manager_.registerObject(body.moving.get(), body.name);
      body.place = Body::obstacle;
      moving_order_.push_back(&body);
    } else if (random_.oneIn(2)) {
      manager_.registerObject(body.object.get(), body.name);
      body.place = Body::obstacle;
    } else {
      body.link = anyLink();
      body.offset = random_.pose(0.2);
      manager_.bind(body.link, body.object.get(), body.offset);
      body.place = Body::bound;
    }
    changed();
  }
  void takeOut(Body& body) {
    if (body.place == Body::bound) {
      manager_.unbind(body.object.get());
    } else if (body.moving) {
      manager_.unregisterObject(body.moving.get());
      moving_order_.erase(std::find(moving_order_.begin(), moving_order_.end(), &body));
    } else {
      manager_.unregisterObject(body.object.get());
    }
    if (body.place != Body::bound) forget(body.name);
    body.place = Body::out;
    changed();
  }
  /// What was said of an obstacle goes with it.
  void forget(const std::string& name) {
    const auto isOfIt = [&](const Margin& margin) { return margin.a == name || margin.b == name; };
    margins_.erase(std::remove_if(margins_.begin(), margins_.end(), isOfIt), margins_.end());
    AllowedCollisionMatrix rest;
    for (const auto& [a, b] : allowed_.pairs()) {
      if (a != name && b != name) rest.allow(a, b);
    }
    allowed_ = rest;
    tolerances_.of_object.erase(name);
  }
  void attachOrDetach(Body& body) {
    if (body.moving) return;
    if (body.place == Body::obstacle) {
      body.link = anyLink();
      body.offset = random_.pose(0.2);
      body.touch.clear();
      if (random_.oneIn(2)) body.touch.push_back(anyLink());
      manager_.attach(body.link, body.object.get(), body.offset, body.touch);
      body.place = Body::attached;
      changed();
    } else if (body.place == Body::attached) {
      manager_.detach(body.object.get());
      body.place = Body::obstacle;
      body.seen = body.now;
      changed();
    }
  }
  void readAll() {
    for (auto& body : bodies_) {
      if (body->place != Body::out) body->seen = body->now;
    }
    ready_ = true;
  }
  /// Whether some body that is there has not been read as it is.
  bool setsUpAll() {
    switch (random_.below(2)) {
      case 0:
        manager_.setup();
        break;
      default:
        manager_.update();
    }
    readAll();
    return true;
  }
  void updateSome() {
    std::vector<Body*> still, moving;
    for (auto& body : bodies_) {
      if (body->place != Body::out) (body->moving ? moving : still).push_back(body.get());
    }
    if (!moving.empty() && random_.oneIn(3)) {
      Body& body = *random_.of(moving);
      manager_.update(body.moving.get());
      body.seen = body.now;
    } else if (!still.empty() && random_.oneIn(2)) {
      Body& body = *random_.of(still);
      manager_.update(body.object.get());
      body.seen = body.now;
    } else if (!still.empty()) {
      std::vector<fcl::CollisionObjectd*> objects;
      for (int i = 1 + random_.below(3); i > 0; --i) {
        Body& body = *random_.of(still);
        objects.push_back(body.object.get());
        body.seen = body.now;
      }
      manager_.update(objects);
    } else {
      return;
    }
    ready_ = true;
  }
  /// A name that the manager knows.
  std::string known() {
    std::vector<std::string> names;
    for (LinkId link = 0; link < tree_->numLinks(); ++link) names.push_back(tree_->linkName(link));
    for (auto& body : bodies_) {
      if (body->place == Body::obstacle || body->place == Body::attached) names.push_back(body->name);
    }
    return random_.of(names);
  }
  void margins() {
    const double margin = random_.oneIn(3) ? 0 : random_.uniform(0, 0.2);
    if (random_.oneIn(4)) {
      manager_.resetMargins();
      margins_.clear();
    } else if (random_.oneIn(2)) {
      margins_.push_back({known(), "", margin});
      manager_.setMargin(margins_.back().a, margin);
    } else {
      margins_.push_back({known(), known(), margin});
      manager_.setMargin(margins_.back().a, margins_.back().b, margin);
    }
    changed();
  }
  /// From scratch, tolerances of 0 are not said at all, unless in place of those of all joints.
  void tolerances() {
    const double size = random_.oneIn(3) ? 0 : random_.uniform(0, 0.05);
    const PoseTolerance pose{size, random_.oneIn(2) ? 0 : size, Vector3d::Zero()};
    const Body& body = any();
    const JointId joint = random_.below(tree_->numJoints());
    switch (random_.below(6)) {
      case 0:
        manager_.setJointTolerances(tolerances_.of_all = {size, size});
        break;
      case 1: {
        const JointType type = tree_->joint(joint).type;
        const bool slides = type == JointType::planar || type == JointType::floating;
        const JointTolerance own{size, slides ? size : 0};
        manager_.setJointTolerance(tree_->joint(joint).name, tolerances_.of_joint[tree_->joint(joint).name] = own);
        break;
      }
      case 2:
        manager_.setBaseTolerance(tolerances_.of_base = pose);
        break;
      case 3:
        if (body.place != Body::obstacle && body.place != Body::attached) return;
        manager_.setObjectTolerance(body.name, tolerances_.of_object[body.name] = pose);
        break;
      default:
        manager_.resetTolerances();
        tolerances_ = {};
    }
    said_ = said_ || !manager_.describeTolerances().empty();
    changed();
  }
  void allow() {
    AllowedCollisionMatrix matrix;
    for (int i = random_.below(4); i > 0; --i) {
      const std::string a = known();
      matrix.allow(a, known());
    }
    manager_.setAllowedCollisions(matrix);
    allowed_ = matrix;
    changed();
  }
  /// A geometry that is none: nothing may change, whatever else was edited.
  void spoil() {
    Body& body = any();
    if (body.place == Body::out || body.now.numbers.kind == Numbers::octree || body.now.numbers.kind == Numbers::convex)
      return;
    Numbers bad = body.now.numbers;
    bad.values[0] = std::numeric_limits<double>::quiet_NaN();
    body.live.set(bad);
    int thrown = 0;
    try {
      random_.oneIn(2) ? manager_.setup() : manager_.update();
    } catch (const std::invalid_argument&) {
      ++thrown;
    }
    try {
      body.moving ? manager_.update(body.moving.get()) : manager_.update(body.object.get());
    } catch (const std::invalid_argument&) {
      ++thrown;
    }
    if (thrown != 2) failure_ = "NaN is accepted";
    counts_.count("refused");
    body.live.set(body.now.numbers);
  }

  void step() {
    switch (random_.below(16)) {
      case 0:
      case 1: {
        Body& body = any();
        body.place == Body::out ? registerOrBind(body) : takeOut(body);
        break;
      }
      case 2:
      case 3:
        attachOrDetach(any());
        break;
      case 4:
        setsUpAll();
        break;
      case 5:
      case 6:
        updateSome();
        break;
      case 7:
        random_.oneIn(2) ? margins() : tolerances();
        break;
      case 8:
        if (random_.oneIn(2)) allow();
        break;
      case 9:
        if (random_.oneIn(12)) {
          manager_.clear();
          for (auto& body : bodies_) {
            if (body->place == Body::obstacle || body->place == Body::attached) forget(body->name);
            body->place = Body::out;
          }
          moving_order_.clear();
          changed();
        } else {
          spoil();
        }
        break;
      case 10:
        any().editPlace(random_);
        break;
      case 11:
      case 12:
      case 13:
        editAndLook();
        break;
      default:
        query();
        break;
    }
  }

  /// Edits a body; where it is in use, asks before and after it is read: as often as that differs, edits are telling.
  void editAndLook() {
    Body& body = any();
    if (body.place == Body::out || random_.oneIn(2)) return body.editGeometry(random_);
    setsUpAll();
    const CertifiedResult before = query();
    body.editGeometry(random_);
    if (!same(before, query(true)) && failure_.empty()) failure_ = "an edit reached a query before it was read";
    if (random_.oneIn(3)) {
      setsUpAll();
    } else {
      body.moving ? manager_.update(body.moving.get()) : manager_.update(body.object.get());
      body.seen = body.now;
    }
    counts_.count("edits read");
    counts_.count("edits telling", !same(before, query(true)));
  }

  CertifiedResult query(bool again = false) {
    if (!again) {
      request_ = CertifiedRequest();
      request_.mode = static_cast<ContactMode>(random_.below(3));
      request_.max_contacts = static_cast<std::size_t>(1 + random_.below(4));
      request_.margin = random_.oneIn(2) ? 0 : 0.03;
      request_.ignore_initial_contact = random_.oneIn(3);
      request_.tolerance_time = 1e-3;
      last_motion_ = random_.below(2);
    }
    const JointMotion motion = JointMotion::linear(*tree_, ends_[last_motion_], ends_[last_motion_ + 1]);
    CertifiedResult result;
    result.status = Status::free;
    if (!ready_) {
      counts_.count("not ready");
      try {
        manager_.continuousCollide(motion, request_, result);
        failure_ = "a manager that is not set up answers";
      } catch (const std::logic_error&) {
      }
      if (result.isFree()) failure_ = "a manager that is not set up leaves free";
      return result;
    }
    manager_.continuousCollide(motion, request_, result);
    CertifiedResult expected;
    std::vector<std::unique_ptr<Body>> copies;  // outlives its manager
    const auto scratch = fromScratch(copies);
    scratch->continuousCollide(motion, request_, expected);
    counts_.count("answers");
    counts_.count("with tolerances", !manager_.describeTolerances().empty());
    counts_.count("with tolerances reset", said_ && manager_.describeTolerances().empty());
    counts_.count("contacts", expected.status == Status::contact);
    if (!same(result, expected)) {
      failure_ = "it says " + shown(result) + ", from scratch " + shown(expected);
      for (const auto* asked : {&manager_, scratch.get()})
        case_.query([&] { return asked->writeQuery(motion, request_); });
    }
    return result;
  }

  /// A manager of copies of what was read, in the same order.
  std::unique_ptr<ArticulatedCollisionManager> fromScratch(std::vector<std::unique_ptr<Body>>& copies) const {
    auto scratch = std::make_unique<ArticulatedCollisionManager>(tree_);
    std::map<const void*, const Body*> known;
    for (const auto& body : bodies_) known[body->object.get()] = body.get();
    const auto copyOf = [&](const Body& body) -> Body& {
      copies.push_back(std::make_unique<Body>(body.name, body.seen, body.moving != nullptr));
      return *copies.back();
    };
    for (const auto& [link, object] : manager_.boundObjects()) {
      const Body& body = *known.at(object);
      Body& copy = copyOf(body);
      if (body.place == Body::bound) {
        scratch->bind(link, copy.object.get(), body.offset);
      } else {
        scratch->registerObject(copy.object.get(), copy.name);
        scratch->attach(link, copy.object.get(), body.offset, body.touch);
      }
    }
    for (const Body* body : moving_order_) scratch->registerObject(copyOf(*body).moving.get(), body->name);
    std::vector<const fcl::CollisionObjectd*> obstacles;
    manager_.getObjects(obstacles);
    for (const auto* object : obstacles)
      scratch->registerObject(copyOf(*known.at(object)).object.get(), known.at(object)->name);
    for (const auto& [a, b, margin] : margins_) {
      b.empty() ? scratch->setMargin(a, margin) : scratch->setMargin(a, b, margin);
    }
    scratch->setAllowedCollisions(allowed_);
    if (tolerances_.of_all.any()) scratch->setJointTolerances(tolerances_.of_all);
    for (const auto& [joint, own] : tolerances_.of_joint) {
      if (own.any() || tolerances_.of_all.any()) scratch->setJointTolerance(joint, own);
    }
    if (tolerances_.of_base.any()) scratch->setBaseTolerance(tolerances_.of_base);
    for (const auto& [name, own] : tolerances_.of_object) {
      if (own.any()) scratch->setObjectTolerance(name, own);
    }
    scratch->setup();
    return scratch;
  }

  struct Tolerances {
    JointTolerance of_all;
    std::map<std::string, JointTolerance> of_joint;
    PoseTolerance of_base;
    std::map<std::string, PoseTolerance> of_object;
  };

  struct Margin {
    std::string a, b;
    double value;
  };

  Random random_;
  campaign::Case& case_;
  campaign::Tally& counts_;
  std::shared_ptr<const KinematicTree> tree_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<Body*> moving_order_;
  ArticulatedCollisionManager manager_;
  std::vector<Margin> margins_;
  AllowedCollisionMatrix allowed_;
  Tolerances tolerances_;
  bool said_ = false;  ///< there were tolerances
  VectorXd ends_[3];
  CertifiedRequest request_;
  int last_motion_ = 0;
  bool ready_ = false;
  std::string failure_;
};

/// The same for free bodies.
class ManyBodies {
 public:
  explicit ManyBodies(campaign::Case& c) : random_(c.id.seed), case_(c), counts_(c.tally) {
    for (int i = 0; i < 6; ++i) {
      bodies_.push_back(std::make_unique<Body>("body" + std::to_string(i), randomState(random_), true));
    }
  }
  std::string run(int steps) {
    for (int i = 0; i < steps && failure_.empty(); ++i) step();
    return failure_;
  }

 private:
  void step() {
    Body& body = *random_.of(bodies_);
    const auto at = std::find(order_.begin(), order_.end(), &body);
    const bool there = at != order_.end();
    switch (random_.below(9)) {
      case 0:
      case 1:
        if (there) {
          manager_.unregisterObject(body.moving.get());
          order_.erase(at);
        } else {
          manager_.registerObject(body.moving.get());
          body.seen = body.now;
          order_.push_back(&body);
        }
        ready_ = false;
        break;
      case 2:
        body.editPlace(random_);
        break;
      case 3:
      case 4: {
        const bool look = there && ready_;
        const CertifiedPairsResult before = look ? query() : CertifiedPairsResult();
        body.editGeometry(random_);
        if (!look) break;
        manager_.update(body.moving.get());
        body.seen = body.now;
        counts_.count("edits read");
        counts_.count("edits telling", !same(before, query(true)));
        break;
      }
      case 5:
        manager_.update();
        for (Body* each : order_) each->seen = each->now;
        ready_ = true;
        break;
      case 6:
        manager_.setup();
        ready_ = true;
        break;
      default:
        query();
    }
  }
  static bool same(const CertifiedPairsResult& a, const CertifiedPairsResult& b) {
    if (!sameVerdict(a, b) || a.pairs.size() != b.pairs.size()) return false;
    for (std::size_t i = 0; i < a.pairs.size(); ++i) {
      const CertifiedPairResult &x = a.pairs[i].result, &y = b.pairs[i].result;
      if (!sameVerdict(x, y) || x.contacts.size() != y.contacts.size()) return false;
      for (std::size_t k = 0; k < x.contacts.size(); ++k) {
        if (!changes_campaign_test::same(x.contacts[k], y.contacts[k])) return false;
      }
    }
    return true;
  }
  CertifiedPairsResult query(bool again = false) {
    if (!again) {
      request_ = CertifiedRequest();
      request_.mode = random_.oneIn(2) ? ContactMode::first : ContactMode::firstOfEveryPair;
      request_.margin = random_.oneIn(2) ? 0 : 0.1;
      request_.tolerance_time = 1e-3;
    }
    CertifiedPairsResult result, expected;
    result.status = Status::free;
    try {
      manager_.continuousCollide(request_, result);
      if (!ready_) {
        if (!order_.empty() || result.status != Status::free) failure_ = "a manager that is not set up answers";
      }
    } catch (const std::logic_error&) {
      if (ready_ || result.isFree()) failure_ = "it throws, or leaves free";
      counts_.count("not ready");
      return result;
    }
    ContinuousCollisionManager scratch;
    std::vector<std::unique_ptr<Body>> copies;
    for (const Body* body : order_) {
      copies.push_back(std::make_unique<Body>(body->name, body->seen, true));
      scratch.registerObject(copies.back()->moving.get());
    }
    scratch.setup();
    scratch.continuousCollide(request_, expected);
    counts_.count("answers");
    counts_.count("contacts", expected.status == Status::contact);
    if (!same(result, expected)) {
      failure_ = "it differs from one built from scratch";
      case_.queryWithoutFile("many bodies are no query of a robot");
    }
    return result;
  }

  Random random_;
  campaign::Case& case_;
  campaign::Tally& counts_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<Body*> order_;
  ContinuousCollisionManager manager_;
  CertifiedRequest request_;
  bool ready_ = false;
  std::string failure_;
};

/// Sequences of 30 changes each. How often an edit in place that was looked at has changed the answer, tells whether
/// edits are telling.
template <class Kind>
campaign::Tally expectAsIfBuiltFromScratch(std::uint64_t answers_each) {
  campaign::Campaign sequences;
  sequences.look = [](campaign::Case& c) {
    const std::string failure = Kind(c).run(30);
    if (!failure.empty()) c.fault("differs", failure);
  };
  const campaign::Options o = campaign::optionsOfTest("FCL_ARTIC_CHANGES", 600, 1000003);
  const campaign::Tally all = runWithoutFaults(sequences, o).total;
  EXPECT_GT(all["answers"], answers_each * o.cases);
  EXPECT_GT(all.share("edits telling", "edits read"), 0.1);
  EXPECT_GT(all.share("contacts", "answers"), 0.1);
  EXPECT_LT(all.share("contacts", "answers"), 0.9);
  return all;
}

}  // namespace

TEST(ChangesCampaign, ManagerIsAsIfBuiltFromScratch) {
  const campaign::Tally all = expectAsIfBuiltFromScratch<Sequence>(3);
  EXPECT_GT(all.share("with tolerances", "answers"), 0.1);
  EXPECT_GT(all.share("with tolerances reset", "answers"), 0.03);
}

TEST(ChangesCampaign, ManyBodiesAreAsIfBuiltFromScratch) {
  expectAsIfBuiltFromScratch<ManyBodies>(2);
}

}  // namespace changes_campaign_test
