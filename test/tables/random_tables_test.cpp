// SPDX-License-Identifier: BSD-3-Clause
//
// Tables against none: random motions of two links with levers of every kind between them, asked with the table that
// their set-up made and without. A motion that is free by the table and in proven contact without it is a fault.
//
// Without: a table holds for its pair's own margin, or for none. A manager whose pair has no margin of its own, asked
// with a request's, looks nothing up; where the pair keeps none, 1e-12 m are asked for. (The pairs left to the query
// then are those that the table alone decides: were both to look it up, that count would be 0.)
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "fcl_artic/manager.h"
#include "random_links.h"

namespace random_tables_test {

using namespace fcl_artic;
using Eigen::VectorXd;
using tables::RandomLinks;

namespace {

constexpr double kNear = 0.003;

std::uint64_t asked(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Asks with tables and without.
class Both {
 public:
  explicit Both(const RandomLinks& links) : links_(links), with_(links.tree), without_(links.tree) {
    for (ArticulatedCollisionManager* manager : {&with_, &without_}) {
      manager->bind("a", links.a.get(), links.on_a);
      manager->bind("b", links.b.get(), links.on_b);
    }
    if (links.margin > 0) with_.setMargin("a", "b", links.margin);
    with_.setup();
    without_.setup();
  }
  CertifiedResult with(const JointMotion& motion, ContactMode mode) const { return ask(with_, motion, mode, 0); }
  CertifiedResult without(const JointMotion& motion, ContactMode mode, double more = 0) const {
    return ask(without_, motion, mode, std::max(links_.margin, 1e-12) + more);
  }
  JointMotion linear(const VectorXd& q0, const VectorXd& q1) const { return JointMotion::linear(*links_.tree, q0, q1); }
  bool leftOut(const VectorXd& q) const {
    return with(linear(q, q), ContactMode::any).statistics.pairs_after_culling == 0;
  }
  /// Whether the table alone leaves the pair out: nothing else does.
  bool byTableAlone(const JointMotion& motion) const {
    return without(motion, ContactMode::any).statistics.pairs_after_culling > 0;
  }

 private:
  static CertifiedResult ask(const ArticulatedCollisionManager& manager, const JointMotion& motion, ContactMode mode,
                             double margin) {
    CertifiedRequest request;
    request.mode = mode;
    request.margin = margin;
    CertifiedResult result;
    manager.continuousCollide(motion, request, result);
    return result;
  }
  const RandomLinks& links_;
  ArticulatedCollisionManager with_, without_;
};

struct Counts {
  std::uint64_t queries = 0, free = 0, contact = 0, by_table = 0, near = 0, wrong = 0, unlike = 0;
};

/// From a state that the table leaves out to another such state, in which the links are as near as may be. There the
/// cells are that should not be proven.
VectorXd nearest(const Both& both, const RandomLinks& links, pairs::Random& random, VectorXd q) {
  constexpr double kGaps[] = {0.2, 0.1, 0.06, 0.04, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005, 0.003, 0.002, 0.001, 0};
  constexpr int kLevels = sizeof kGaps / sizeof *kGaps;
  int level = 0;  // gaps from here on are not reached yet
  for (int i = 0; i < 80 && level < kLevels; ++i) {
    VectorXd other = links.draw(random);
    for (Eigen::Index v = 0; v < q.size(); ++v) {
      other[v] = q[v] + (random.chance(0.5) ? random.logUniform(1e-4, 1) * (other[v] - q[v]) : 0);
    }
    const JointMotion still = both.linear(other, other);
    const auto within = [&](int l) { return !both.without(still, ContactMode::any, kGaps[l]).isFree(); };
    if (!both.leftOut(other) || (level > 0 && !within(level - 1))) continue;
    q = other;
    while (level < kLevels && within(level)) ++level;
  }
  return q;
}

}  // namespace

TEST(RandomTables, NothingFreeByATableTouches) {
  const std::uint64_t queries = asked("FCL_ARTIC_TABLE_QUERIES", 40000), seed = asked("FCL_ARTIC_TABLE_SEED", 1);
  constexpr std::uint64_t kPerPair = 1000;
  const ContactMode modes[] = {ContactMode::first, ContactMode::any, ContactMode::firstOfEveryPair};
  const char* const names[] = {"first", "any", "every pair"};
  Counts counts[3];
  std::uint64_t pairs = 0, with_table = 0, faulty_pairs = 0, done = 0;
  for (; done < queries; ++pairs) {
    pairs::Random random(pairs::Random::mix(seed, pairs));
    const RandomLinks links(random);
    const Both both(links);
    std::vector<VectorXd> out, in;  // states that the table leaves out, and others
    std::vector<VectorXd> found;
    for (int i = 0; i < 100; ++i) {
      const VectorXd q = links.draw(random);
      (both.leftOut(q) ? out : in).push_back(q);
    }
    if (out.empty() || in.empty() ||
        std::none_of(out.begin(), out.end(), [&](const VectorXd& q) { return both.byTableAlone(both.linear(q, q)); })) {
      continue;
    }
    ++with_table;
    bool faulty = false;
    for (std::uint64_t i = 0; i < kPerPair; ++i, ++done) {
      const auto any = [&](const std::vector<VectorXd>& states) {
        return states[static_cast<std::size_t>(random.below(static_cast<int>(states.size())))];
      };
      VectorXd q0 = links.draw(random);
      if (i % 8 < 2 && i < kPerPair / 2) found.push_back(nearest(both, links, random, any(out)));
      if (i % 4 == 0) q0 = any(found);
      const double size = random.logUniform(1e-5, 1);
      const VectorXd q1 = q0 + size * (links.draw(random) - q0);
      const JointMotion motion = both.linear(q0, q1);
      const std::size_t m = i % 3;
      Counts& count = counts[m];
      const CertifiedResult with = both.with(motion, modes[m]), without = both.without(motion, modes[m]);
      ++count.queries;
      count.free += with.isFree();
      count.contact += with.status == Status::contact;
      const bool by_table = with.statistics.pairs_after_culling < without.statistics.pairs_after_culling;
      count.by_table += by_table;
      if (by_table && i % 8 < 4) count.near += 2 * !both.without(motion, ContactMode::any, kNear).isFree();
      const bool wrong = with.isFree() && without.status == Status::contact && without.certain;
      const bool unlike = with.status == Status::contact && with.certain && without.isFree();
      count.wrong += wrong;
      count.unlike += unlike;
      faulty = faulty || wrong || unlike;
      if (!wrong && !unlike) continue;
      ADD_FAILURE() << "seed " << seed << ", pair " << pairs << ", mode " << names[m]
                    << (wrong ? ": free by the table, in contact without" : ": in contact, but free without the table")
                    << ", margin " << links.margin << "\nfrom " << q0.transpose() << "\n  to " << q1.transpose();
      if (::testing::Test::HasFailure() && count.wrong > 5) break;
    }
    faulty_pairs += faulty;
  }
  std::cout << "seed " << seed << ": " << pairs << " pairs of links, with a table " << with_table << ", at fault "
            << faulty_pairs << "\n";
  for (int m = 0; m < 3; ++m) {
    const Counts& c = counts[m];
    std::cout << names[m] << ": " << c.queries << " motions, free " << c.free << ", in contact " << c.contact
              << ", decided by the table alone " << c.by_table << ", of them within 3 mm about " << c.near << ", wrong "
              << c.wrong << ", unlike " << c.unlike << "\n";
    const double n = static_cast<double>(c.queries);
    EXPECT_GT(static_cast<double>(c.by_table), 0.2 * n) << "the cases say little";
    EXPECT_GT(static_cast<double>(c.near), 0.01 * n) << "the cases say little";
    EXPECT_GT(static_cast<double>(c.contact), 0.05 * n);
  }
}

}  // namespace random_tables_test
