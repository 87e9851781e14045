// SPDX-License-Identifier: BSD-3-Clause
#include "rules.h"

#include <algorithm>
#include <sstream>

namespace modes {

using namespace fcl_artic;

const std::vector<std::string>& rules() {
  static const std::vector<std::string> names = {"bracket", "most",    "order", "budget",  "ordered",
                                                 "pairs",   "ignored", "cut",   "sampled", "proven"};
  return names;
}

std::string describe(const Asked& asked) {
  static const char* const kModes[] = {"first", "any", "every-pair"};
  static const char* const kStatus[] = {"free", "contact", "undecided"};
  const CertifiedRequest& q = asked.request;
  const CertifiedResult& r = asked.result;
  std::ostringstream out;
  out.precision(17);
  out << "[" << kModes[static_cast<int>(q.mode)] << (q.method == Method::redon2004 ? " Redon2004" : "");
  if (q.method == Method::redon2004) {
    out << "(enclosure " << static_cast<int>(q.redon.enclosure) << (q.redon.simultaneous ? "" : " one-by-one")
        << (q.redon.newton ? "" : " no-newton") << (q.redon.early_validity ? "" : " late-validity")
        << (q.redon.in_time_order ? "" : " boxes-first") << (q.redon.links_in_world ? " links-in-world" : "") << ")";
  }
  out << (q.check_scene ? "" : " no-scene") << (q.check_self ? "" : " no-self")
      << (q.ignore_initial_contact ? " ignore" : "") << " margin " << q.margin << " tolerances " << q.tolerance_time
      << " " << q.tolerance_distance << " most " << q.max_contacts << " budget " << q.work_budget
      << (q.visibility == VisibilityMode::on ? " visibility" : "") << " -> " << kStatus[static_cast<int>(r.status)]
      << (r.certain ? " certain" : "") << " " << r.t_lower << " .. " << r.t_upper << ", " << r.contacts.size()
      << " contacts, " << r.ignored_initial_contacts.size() << " ignored]";
  return out.str();
}

namespace {

/// What an answer says of one motion, in numbers that can be compared: free before `lower`, in contact at or before
/// `upper`.
constexpr double kNever = 1e300;
double provenFree(const CertifiedResult& r) {
  return r.isFree() ? kNever : r.t_lower;
}
double provenContact(const World& world, const CertifiedResult& r) {
  double upper = r.certain || r.t_upper < world.end() ? r.t_upper : kNever;
  for (const CertifiedContact& contact : r.contacts) {
    if (contact.certain) upper = std::min(upper, contact.t_upper);
  }
  return r.isFree() ? kNever : upper;
}

std::set<Pair> ignoredOf(const CertifiedResult& r) {
  std::set<Pair> pairs;
  for (const auto& [a, b] : r.ignored_initial_contacts) pairs.insert(pairOf(a.name, b.name));
  return pairs;
}
std::set<Pair> provenPairs(const CertifiedResult& r) {
  std::set<Pair> pairs;
  for (const CertifiedContact& contact : r.contacts) {
    if (contact.certain) pairs.insert(pairOf(contact.body1.name, contact.body2.name));
  }
  return pairs;
}
std::set<Pair> reportedPairs(const CertifiedResult& r) {
  std::set<Pair> pairs;
  for (const CertifiedContact& contact : r.contacts) pairs.insert(pairOf(contact.body1.name, contact.body2.name));
  return pairs;
}

class Check {
 public:
  Check(const World& world, const std::vector<Asked>& asked, campaign::Case& c)
      : world_(world), asked_(asked), case_(c) {}

  void all(Random& random) {
    for (const Asked& a : asked_) {
      bracket(a);
      most(a);
      order(a);
      budget(a);
    }
    for (const Asked& a : asked_) {
      for (const Asked& b : asked_) {
        if (&a == &b || !a.question.covers(b.question)) continue;
        ordered(a, b);
        if (!b.question.covers(a.question)) continue;
        pairs(a, b);
        ignored(a, b);
        cut(a, b);
      }
    }
    for (const Asked& a : asked_) sampled(a, random);
    for (const Asked& a : asked_) proven(a);
  }

 private:
  /// An answer that is wrong could have been seen.
  void tell(const std::string& rule, bool telling = true) { case_.tally.count(rule + " told", telling); }
  void hold(const std::string& rule, bool good, const std::string& what) {
    if (!good && broken_.insert(rule).second) case_.fault(rule, what);
  }

  void bracket(const Asked& a) {
    const CertifiedResult& r = a.result;
    tell("bracket");
    bool good = world_.begin() <= r.t_lower && r.t_lower <= r.t_upper && r.t_upper <= world_.end();
    if (r.isFree()) good = good && r.t_lower == world_.end() && r.contacts.empty();
    if (r.certain) good = good && r.status == Status::contact;
    // Rounding of a trajectory's own times comes on top (manager.h).
    const double rounding = world_.isTrajectory() ? 0x1p-45 : 0;
    if (r.certain && a.request.mode != ContactMode::any) {
      good = good && r.t_upper - r.t_lower <= a.request.tolerance_time + rounding;
    }
    const double end = r.certain ? r.t_upper : r.t_lower + a.request.tolerance_time;
    for (const CertifiedContact& contact : r.contacts) {
      good =
          good && r.t_lower <= contact.t_lower && contact.t_lower <= contact.t_upper && contact.t_upper <= world_.end();
      if (contact.certain) good = good && contact.t_upper >= r.t_upper;
      if (a.request.mode == ContactMode::first) good = good && contact.t_lower <= end + rounding + 1e-12;
    }
    hold("bracket", good, describe(a));
  }

  void most(const Asked& a) {
    const auto& contacts = a.result.contacts;
    if (contacts.size() > 1) tell("most");
    bool good = contacts.size() <= a.request.max_contacts;
    if (a.request.max_contacts > 0 && a.result.status == Status::contact) good = good && !contacts.empty();
    if (world_.isPair()) good = good && contacts.size() <= 1;
    hold("most", good, describe(a));
  }

  void order(const Asked& a) {
    const auto& contacts = a.result.contacts;
    if (contacts.size() > 1) tell("order");
    bool good = reportedPairs(a.result).size() == contacts.size();
    for (std::size_t i = 1; i < contacts.size(); ++i) good = good && contacts[i - 1].t_lower <= contacts[i].t_lower;
    for (const CertifiedContact& contact : contacts) {
      if (!a.result.certain) break;
      good = good && contacts.front().certain && (!contact.certain || contacts.front().t_upper <= contact.t_upper);
    }
    hold("order", good, describe(a));
  }

  void budget(const Asked& a) {
    tell("budget", a.result.status == Status::undecided);
    hold("budget", a.result.status != Status::undecided || a.request.work_budget > 0, describe(a));
  }

  void ordered(const Asked& larger, const Asked& smaller) {
    const double upper = provenContact(world_, smaller.result), lower = provenFree(larger.result);
    if (upper < kNever && lower > world_.begin()) tell("ordered");
    hold("ordered", upper == kNever || lower <= upper, describe(larger) + " against " + describe(smaller));
  }

  void pairs(const Asked& every, const Asked& other) {
    if (every.request.mode != ContactMode::firstOfEveryPair || every.result.status == Status::undecided) return;
    const std::set<Pair> reported = reportedPairs(every.result);
    if (every.result.contacts.size() >= every.request.max_contacts && reported.size() >= every.request.max_contacts)
      return;
    for (const Pair& pair : provenPairs(other.result)) {
      tell("pairs");
      hold("pairs", reported.count(pair) > 0,
           pair.first + " " + pair.second + " of " + describe(other) + " is not in " + describe(every));
    }
  }

  void ignored(const Asked& a, const Asked& b) {
    if (&a > &b || !a.question.ignore_initial) return;
    if (a.result.status == Status::undecided || b.result.status == Status::undecided) return;
    const std::set<Pair> pairs = ignoredOf(a.result);
    tell("ignored", !pairs.empty());
    hold("ignored", pairs == ignoredOf(b.result), describe(a) + " against " + describe(b));
  }

  void cut(const Asked& a, const Asked& b) {
    const CertifiedRequest &x = a.request, &y = b.request;
    if (&a > &b || y.mode != x.mode || x.method != Method::standard || y.method != x.method || x.work_budget ||
        y.work_budget || x.tolerance_time != y.tolerance_time || x.tolerance_distance != y.tolerance_distance)
      return;
    // (Of a trajectory the pieces after the last contact that is asked for are not looked at; so a budget that is
    // enough for few contacts need not be for many.)
    tell("cut", a.result.contacts.size() > 1 && x.max_contacts != y.max_contacts);
    hold("cut", a.result.status == b.result.status && a.result.t_lower == b.result.t_lower,
         describe(a) + " against " + describe(b));
  }

  void sampled(const Asked& a, Random& random) {
    const double stop = a.result.isFree() ? world_.end() : a.result.t_lower;
    if (!(stop > world_.begin())) return;
    const std::set<Pair> ignored = ignoredOf(a.result);
    for (int i = 0; i < 6; ++i) {
      // The last moments before t_lower are the telling ones.
      double t = i < 2 || a.result.isFree() ? random.in(world_.begin(), stop)
                                            : stop - std::pow(10, random.in(-6, -1)) * (world_.end() - world_.begin());
      if (t < world_.begin()) t = world_.begin();
      const std::vector<Isometry3d> poses = world_.poses(t);
      for (const World::Watched& pair : world_.pairs()) {
        if (!(pair.scene ? a.request.check_scene : a.request.check_self) || ignored.count(pair.names)) continue;
        tell("sampled");
        const double margin = pair.margin >= 0 ? pair.margin : a.request.margin;
        const bool touches = world_.touches(pair, poses, margin);
        std::ostringstream what;
        what.precision(17);
        if (touches) what << pair.names.first << " " << pair.names.second << " touch at " << t << ", " << describe(a);
        hold("sampled", !touches, what.str());
      }
    }
  }

  /// How near a pair comes that is proven to be in contact: at t_upper, where most proofs are; else, an equation's root
  /// being anywhere in the bracket, within it. (FCL's search ends too early now and then: not nearby.)
  double nearest(const World::Watched& pair, const CertifiedContact& contact, double most) const {
    double least = world_.distance(pair, world_.poses(contact.t_upper));
    constexpr int kLooks = 400;
    const double width = std::max(contact.t_upper - contact.t_lower, 1e-5 * (world_.end() - world_.begin()));
    for (int i = 0; i < kLooks && least > most; ++i) {
      const double t = std::max(world_.begin(), contact.t_upper - width * i / kLooks);
      least = std::min(least, world_.distance(pair, world_.poses(t)));
    }
    return least;
  }

  void proven(const Asked& a) {
    for (std::size_t i = 0; i < a.result.contacts.size() && i < 3; ++i) {
      const CertifiedContact& contact = a.result.contacts[i];
      if (!contact.certain) continue;
      const Pair names = pairOf(contact.body1.name, contact.body2.name);
      const auto pair = std::find_if(world_.pairs().begin(), world_.pairs().end(),
                                     [&](const World::Watched& watched) { return watched.names == names; });
      tell("proven");
      if (pair == world_.pairs().end()) {
        hold("proven", false, names.first + " " + names.second + " is not to be checked: " + describe(a));
        continue;
      }
      const double margin = pair->margin >= 0 ? pair->margin : a.request.margin;
      // FCL's distances of curved shapes come out up to 4e-5 m too long next to contact, and 2e-4 m farther off.
      const double most = margin + (margin > 0 ? 1e-3 : 1e-4);
      const double distance = nearest(*pair, contact, most);
      std::ostringstream what;
      what << names.first << " " << names.second << " are " << distance << " m apart at their t_upper "
           << contact.t_upper << ", ";
      hold("proven", distance <= most, what.str() + describe(a));
    }
  }

  const World& world_;
  const std::vector<Asked>& asked_;
  campaign::Case& case_;
  std::set<std::string> broken_;
};

}  // namespace

std::vector<Asked> randomQueries(Random& random, int count) {
  Question question;
  question.ignore_initial = random.chance(0.5);
  question.margin = random.chance(0.5) ? 0 : std::pow(10, random.in(-6, -1));
  std::vector<Asked> queries;
  for (int i = 0; i < count; ++i) {
    if (i > 0 && random.chance(0.15)) {  // the last one again, but for what no bracket of every pair depends on
      queries.push_back(queries.back());
      queries.back().request.max_contacts = static_cast<std::size_t>(random.below(6));
      continue;
    }
    Asked a;
    a.question = question;
    if (random.chance(0.15)) (random.chance(0.5) ? a.question.check_scene : a.question.check_self) = false;
    if (random.chance(0.1)) a.question.ignore_initial = !question.ignore_initial;
    if (random.chance(0.15)) a.question.margin *= random.in(0, 2);
    CertifiedRequest& q = a.request;
    q.check_scene = a.question.check_scene;
    q.check_self = a.question.check_self;
    q.ignore_initial_contact = a.question.ignore_initial;
    q.margin = a.question.margin;
    q.mode = static_cast<ContactMode>(random.below(3));
    static const std::size_t kMost[] = {0, 1, 1, 2, 100, 100};
    q.max_contacts = kMost[random.below(6)];
    q.tolerance_time = random.chance(0.4) ? 1e-3 : random.chance(0.15) ? 0.1 : std::pow(10, random.in(-9, -3));
    q.tolerance_distance = random.chance(0.5) ? 1e-6 : std::pow(10, random.in(-9, -3));
    if (random.chance(0.25)) q.work_budget = 1 + static_cast<std::uint64_t>(std::pow(10, random.in(0, 3.5)));
    if (random.chance(0.15)) q.visibility = VisibilityMode::on;
    if (random.chance(0.3)) {
      q.method = Method::redon2004;
      q.redon.enclosure = static_cast<MotionEnclosure>(random.below(3));
      q.redon.simultaneous = random.chance(0.7);
      q.redon.newton = random.chance(0.7);
      q.redon.early_validity = random.chance(0.7);
      q.redon.in_time_order = true;
      q.redon.links_in_world = random.chance(0.3);
      if (q.mode == ContactMode::firstOfEveryPair) q.work_budget = 0;
      q.tolerance_time = std::max(q.tolerance_time, 1e-6);
    }
    queries.push_back(std::move(a));
  }
  return queries;
}

void check(const World& world, const std::vector<Asked>& asked, Random& random, campaign::Case& c) {
  Check(world, asked, c).all(random);
}

campaign::Campaign campaignOfModes() {
  campaign::Campaign all;
  all.name = "modes";
  all.look = [](campaign::Case& c) {
    Random random(c.id.seed);
    const World world(random);
    std::vector<Asked> asked = randomQueries(random, 12);
    for (Asked& a : asked) {
      if (world.isTrajectory()) a.request.tolerance_time *= world.end() - world.begin();
      c.query([&] { return world.writeQuery(a.request); });
      world.ask(a.request, a.result);
      c.tally.count("queries");
      c.tally.count("free", a.result.isFree());
      c.tally.count("certain", a.result.certain);
      c.tally.count("uncertain", a.result.status == Status::contact && !a.result.certain);
      c.tally.count("undecided", a.result.status == Status::undecided);
      if (c.words) *c.words += describe(a) + "\n";
    }
    check(world, asked, random, c);
  };
  return all;
}

}  // namespace modes
