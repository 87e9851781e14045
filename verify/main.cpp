// SPDX-License-Identifier: BSD-3-Clause
// fcl_artic_verify: proves the claims of certificates again. See doc/CERTIFICATES.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "readers.h"
#include "report.h"
#include "xml.h"

namespace {

constexpr const char* kHelp =
    R"(fcl_artic_verify [options] WORLD CERTIFICATES...

Proves again what certificates claim: that along a motion no two bodies that are checked come nearer than their margin.
Uses integers and MPFR; shares nothing with the library that wrote the certificates. doc/CERTIFICATES.md says what
is claimed, and how it is proven.

  WORLD            the world's text
  CERTIFICATES     files of records

  --urdf FILE      compare the world with a URDF: frames, joints, collision geometry (shapes, STL, OBJ)
  --base POSE      where the URDF's root stands: x,y,z or x,y,z,roll,pitch,yaw (m, rad or 90deg); else, where --scene is
                   given, at the world's origin
  --srdf FILE      compare pairs that the world does not check with an SRDF
  --scene FILE     compare the obstacles with a scene: URDF, STL, OBJ; once for each file, all that there are
  --scale FACTOR   all lengths of the scenes are multiplied by it
  --package N=DIR  the folder of "package://N/" in URDF files
  --solid-meshes   meshes of these files are meant as solids; without, as surfaces or solids
  --solid NAME     those of this link or obstacle are
  --plan FILE      compare each motion with the waypoints of a plan (CSV, columns by joints' names); one for each
  --from Q, --to Q compare the motion with this one: "0, 1.57, -90deg" in the order of the URDF's joints, or
                   "NAME=VALUE ..."
  --state Q        values of what the plans have no column for, or --from and --to do not name: "NAME=VALUE ..."; of
                   others 0
  --interpolation KIND   of the plans: linear, cubic, quintic, jtc-upsampled; else by their columns, as `fcl_artic
                   certify` has it
  --compare-only   no certificates: only compare the world with the files
  --json           print everything as JSON, and each record's motion and proof
  --quiet          print no line for what is verified of all pairs to the motion's end, and none about the world
  --work N         limit of work per record, in steps of roughly 20 ns (default 2000000000)
  --help, --version

Prints what the world says beside its numbers. For each record it prints VERIFIED, and in a sentence which robot moves
how, among which obstacles, and how many pairs of bodies were checked; files are named that these are compared with. Then
come what is compared with no file, how many pairs were not checked, by reason, and what the motion says. Or it prints NOT
VERIFIED, with what could not be proven: bodies and interval of time. A claim about no pair is not verified, nor one about
a world or a motion that differs from a file.
Exit: 0 all verified, 1 something is not or the world differs from a file, 2 bad input, or no record.
)";

/// Prints what the program says, in text or as JSON: a document a line or more, one after the other.
class Printer {
 public:
  /// @param not_compared  what no file says.
  Printer(bool json, bool quiet, std::vector<std::string> not_compared)
      : json_(json), quiet_(quiet), not_compared_(std::move(not_compared)) {}

  void comparison(const char* path, const verify::Comparison& c) const {
    if (json_) {
      std::printf("{\"file\": %s, \"notes\": %s, \"different\": %s}\n", verify::quotedJson(path).c_str(),
                  verify::listAsJson(c.notes).c_str(), verify::listAsJson(c.differences).c_str());
      return;
    }
    for (const std::string& note : c.notes) line(std::string(path) + ": ", note);
    for (const std::string& what : c.differences)
      std::printf("%s: DIFFERENT: %s\n", verify::shown(path).c_str(), verify::shown(what).c_str());
  }
  void world(const char* path, const verify::World& world) const {
    const std::vector<std::string> lines = verify::linesOf(world);
    if (json_)
      std::printf("{\"world\": %s, \"says\": %s}\n", verify::quotedJson(path).c_str(),
                  verify::listAsJson(lines).c_str());
    if (json_ || quiet_) return;
    for (const std::string& text : lines) line(std::string(path) + ": ", text);
  }
  /// @param alone  it is its file's only record.
  /// @param notes  of the comparison with plans.
  void record(const verify::World& world, const char* path, std::size_t number, bool alone,
              const verify::Record& record, const verify::Verdict& verdict, const verify::Subject& subject,
              const std::vector<std::string>& notes) const {
    std::vector<std::string> lines;
    if (verdict.verified) lines = verify::linesOf(world, verify::readMotion(record.motion, world), verdict);
    lines.insert(lines.end(), notes.begin(), notes.end());
    if (json_) {
      std::string statement = "null";
      try {
        statement = verify::proofAsJson(world, record);
      } catch (const verify::BadInput&) {  // the verdict says why, too
      }
      std::printf("{\"file\": %s, \"record\": %zu, \"verdict\": %s, \"says\": %s,\n\"statement\": %s}\n",
                  verify::quotedJson(path).c_str(), number, verify::verdictAsJson(verdict).c_str(),
                  verify::listAsJson(lines).c_str(), statement.c_str());
      return;
    }
    if (quiet_ && verdict.verified && !verify::isInPart(verdict)) return;
    const std::string which = alone ? "" : ", record " + std::to_string(number);
    std::printf("%s%s: %s\n", verify::shown(path).c_str(), which.c_str(), verify::lineOf(verdict, subject).c_str());
    if (!verdict.verified) return;
    notCompared();
    if (const std::string none = verify::notChecked(verdict); !none.empty()) line("  ", "not checked: " + none);
    for (const std::string& text : lines) line("  ", text);
  }
  /// @param in_part  of those that are verified.
  void sum(std::size_t verified, std::size_t in_part, std::size_t all) const {
    if (json_) {
      std::printf("{\"verified\": %zu, \"in_part\": %zu, \"records\": %zu, \"not_compared\": %s}\n", verified, in_part,
                  all, verify::listAsJson(not_compared_).c_str());
      return;
    }
    const std::string part =
        in_part > 0 ? ", " + std::to_string(in_part) + " of them not to the motion's end or not of all pairs" : "";
    std::printf("%zu of %zu records verified%s\n", verified, all, part.c_str());
    notCompared();
  }

 private:
  void notCompared() const {
    std::string text;
    for (const std::string& what : not_compared_) text += (text.empty() ? "not compared with a file: " : ", ") + what;
    if (!text.empty()) line("  ", text);
  }
  static void line(const std::string& begin, const std::string& text) {
    std::fputs(verify::wrapped(begin, text).c_str(), stdout);
  }
  const bool json_, quiet_;
  const std::vector<std::string> not_compared_;
};

/// The options and files of a command.
struct Asked {
  bool json = false, quiet = false, compare_only = false, help = false, version = false;
  verify::Options options;
  verify::Packages packages;
  verify::Solids solids;
  double scale = 1;
  std::vector<const char*> files;
  std::vector<std::string> urdf, srdf, scenes, plans, from, to, state, interpolation, base;
};

/// @throws BadInput
Asked readCommand(int argc, char** argv) {
  Asked asked;
  const std::map<std::string, bool*> flags{{"--json", &asked.json},
                                           {"--solid-meshes", &asked.solids.all},
                                           {"--compare-only", &asked.compare_only},
                                           {"--quiet", &asked.quiet},
                                           {"--help", &asked.help},
                                           {"--version", &asked.version}};
  std::vector<std::string> packages, solids, scale, work;
  const std::map<std::string, std::vector<std::string>*> lists{{"--urdf", &asked.urdf},
                                                               {"--srdf", &asked.srdf},
                                                               {"--scene", &asked.scenes},
                                                               {"--plan", &asked.plans},
                                                               {"--from", &asked.from},
                                                               {"--to", &asked.to},
                                                               {"--state", &asked.state},
                                                               {"--package", &packages},
                                                               {"--solid", &solids},
                                                               {"--base", &asked.base},
                                                               {"--scale", &scale},
                                                               {"--work", &work},
                                                               {"--interpolation", &asked.interpolation}};
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const std::size_t equals = word.find('=');
    if (equals != std::string::npos && lists.count(word.substr(0, equals)) > 0) {
      lists.at(word.substr(0, equals))->push_back(word.substr(equals + 1));
    } else if (flags.count(word) > 0) {
      *flags.at(word) = true;
    } else if (lists.count(word) > 0) {
      if (++k == argc) throw verify::BadInput(word + " takes a value");
      lists.at(word)->push_back(argv[k]);
    } else if (word.size() > 1 && word[0] == '-') {
      throw verify::BadInput("unknown option '" + word + "' (see --help)");
    } else {
      asked.files.push_back(argv[k]);
    }
  }
  for (const std::string& both : packages) {
    const std::size_t equals = both.find('=');
    if (equals == std::string::npos) throw verify::BadInput("--package takes NAME=FOLDER");
    asked.packages[both.substr(0, equals)] = both.substr(equals + 1);
  }
  asked.solids.names.insert(solids.begin(), solids.end());
  for (const std::string& number : scale) asked.scale = verify::decimal(number);
  if (!(asked.scale > 0)) throw verify::BadInput("--scale takes a number above 0");
  for (const std::string& number : work) {
    if (number.empty() || number.size() > 18 || number.find_first_not_of("0123456789") != number.npos)
      throw verify::BadInput("--work takes a number of steps");
    asked.options.work = std::strtoull(number.c_str(), nullptr, 10);
  }
  return asked;
}

/// The fault of a command; empty: none.
std::string faultOf(const Asked& asked) {
  const bool with_files = !asked.urdf.empty() || !asked.srdf.empty() || !asked.scenes.empty(),
             with_plans = !asked.plans.empty() || !asked.from.empty();
  if (asked.compare_only && (asked.files.size() != 1 || !with_files || with_plans))
    return "--compare-only takes a world, no certificates or plans, and --urdf, --srdf or --scene";
  if (!asked.compare_only && asked.files.size() < 2) return "a world and certificates are needed (see --help)";
  if ((asked.solids.all || !asked.solids.names.empty()) && asked.urdf.empty() && asked.scenes.empty())
    return "--solid and --solid-meshes say how --urdf and --scene are meant";
  if (asked.scale != 1 && asked.scenes.empty()) return "--scale says how --scene is meant";
  if (!asked.base.empty() && asked.urdf.empty()) return "--base says how --urdf is meant";
  if (asked.from.size() != asked.to.size() || asked.from.size() > 1) return "--from and --to are given together, once";
  if (!with_plans && (!asked.state.empty() || !asked.interpolation.empty()))
    return "--state and --interpolation say how --plan is meant";
  return "";
}

/// @param robot  variables of the URDF's joints, in its order; none: no URDF is given.
std::vector<verify::Plan> readPlans(const Asked& asked, const verify::World& world,
                                    const std::vector<std::string>& robot) {
  static const std::map<std::string, verify::Interpolation> kKinds{{"linear", verify::Interpolation::linear},
                                                                   {"cubic", verify::Interpolation::cubic},
                                                                   {"quintic", verify::Interpolation::quintic},
                                                                   {"jtc-upsampled", verify::Interpolation::upsampled}};
  std::vector<verify::Plan> plans;
  for (const std::string& path : asked.plans) {
    plans.push_back(verify::readPlan(path));
    for (const std::string& kind : asked.interpolation) {
      if (kKinds.count(kind) == 0)
        throw verify::BadInput("--interpolation takes linear, cubic, quintic or jtc-upsampled");
      plans.back().interpolation = kKinds.at(kind);
    }
  }
  std::map<std::string, double> state;
  for (const std::string& text : asked.state) {
    if (text.find('=') == std::string::npos) throw verify::BadInput("--state takes NAME=VALUE");
    for (const auto& [name, value] : verify::readConfiguration(world, {}, text))
      if (!state.emplace(name, value).second)
        throw verify::BadInput("--state says twice where " + verify::inQuotes(name) + " stands");
  }
  if (!asked.from.empty()) {
    plans.push_back(verify::planBetween(world, robot, asked.from[0], asked.to[0]));
    for (const std::string& name : plans.back().columns)
      if (state.count(name) > 0)
        throw verify::BadInput("both --state and --from, --to say where " + verify::inQuotes(name) + " is");
  }
  for (verify::Plan& plan : plans) {
    plan.robot = robot;
    plan.state = state;
  }
  return plans;
}

/// The parts of the world and the motions for which no file was given.
std::vector<std::string> notCompared(const Asked& asked, const verify::World& world) {
  const auto names = [&](verify::Role role) {
    std::set<std::string> all;
    for (const verify::Body& body : world.bodies)
      if (body.role == role) all.insert(verify::inQuotes(body.name));
    std::string text;
    for (const std::string& name : all) text += (text.empty() ? "" : ", ") + name;
    return text;
  };
  std::vector<std::string> list;
  const std::string obstacles = names(verify::Role::obstacle), carried = names(verify::Role::carried);
  if (asked.urdf.empty()) list.push_back("robot (--urdf)");
  for (const auto& [reason, what] : {std::pair(verify::Reason::allowed, "allowed pairs (--srdf)"),
                                     std::pair(verify::Reason::neighbours, "neighbours (--srdf)")}) {
    const auto is = [why = reason](const auto& pair) { return pair.second.reason == why; };
    if (asked.srdf.empty() && std::any_of(world.unchecked.begin(), world.unchecked.end(), is)) list.push_back(what);
  }
  if (asked.scenes.empty() && !obstacles.empty()) list.push_back("obstacles " + obstacles + " (--scene)");
  if (!carried.empty()) list.push_back("what links carry: " + carried);
  if (asked.plans.empty() && asked.from.empty() && !asked.compare_only) list.push_back("motion (--plan)");
  return list;
}

class Run {
 public:
  Run(const Asked& asked, const verify::World& world)
      : asked_(asked), world_(world), printer_(asked.json, asked.quiet, notCompared(asked, world)) {}

  int run() {
    compare();
    printer_.world(asked_.files[0], world_);
    for (std::size_t f = 1; f < asked_.files.size(); ++f) file(asked_.files[f]);
    for (std::size_t p = 0; p < plans_.size(); ++p)
      if (!used_[p]) report(plans_[p].title, {{"no record that is verified is about it"}, {}, {}, {}});
    if (!asked_.compare_only) printer_.sum(verified_, in_part_, all_);
    return bad_ ? 2 : verified_ == all_ && same_ ? 0 : 1;
  }

 private:
  void report(const std::string& path, const verify::Comparison& comparison) {
    printer_.comparison(path.c_str(), comparison);
    same_ = same_ && comparison.differences.empty();
    for (const std::string& name : comparison.solids) solids_met_.insert(name);
  }

  void compare() {
    if (!world_.false_reason.empty()) report(asked_.files[0], {{world_.false_reason}, {}, {}, {}});
    std::vector<double> base;
    if (!asked_.scenes.empty()) base.assign(6, 0);
    for (const std::string& pose : asked_.base) base = verify::readBase(pose);
    std::vector<std::string> robot;
    for (const std::string& path : asked_.urdf) {
      const verify::Comparison comparison = verify::compareWithUrdf(world_, path, asked_.packages, asked_.solids, base);
      robot = comparison.variables;
      report(path, comparison);
    }
    plans_ = readPlans(asked_, world_, robot);
    used_.assign(plans_.size(), false);
    for (const std::string& path : asked_.srdf) report(path, verify::compareWithSrdf(world_, path));
    if (!asked_.scenes.empty())
      report("--scene", verify::compareWithScenes(world_, asked_.scenes, asked_.packages, asked_.solids, asked_.scale));
    for (const std::string& name : asked_.solids.names)
      if (solids_met_.count(name) == 0)
        report("--solid",
               {{"no link or obstacle of the files that has a mesh is " + verify::inQuotes(name)}, {}, {}, {}});
  }

  void file(const char* path) {
    const std::string bytes = verify::readFile(path);
    const std::vector<verify::Record> records = verify::splitRecords(bytes);
    if (records.empty()) throw verify::BadInput("'" + std::string(path) + "' has no record: nothing is proven");
    for (std::size_t number = 0; number < records.size(); ++number) {
      verify::Verdict verdict = verify::verifyRecord(world_, records[number], asked_.options);
      std::vector<std::string> notes;
      std::string plan;
      if (verdict.verified && !same_) {  // proven of another robot
        verdict.verified = false;
        verdict.reason = "it is proven of this world, which is not what the files say (DIFFERENT, above)";
      }
      if (verdict.verified && !plans_.empty()) plan = findPlan(records[number], verdict, notes);
      ++all_;
      verified_ += verdict.verified;
      in_part_ += verdict.verified && verify::isInPart(verdict);
      bad_ = bad_ || verdict.bad_input;
      printer_.record(world_, path, number, records.size() == 1, records[number], verdict,
                      verdict.verified ? subjectOf(records[number], plan) : verify::Subject(), notes);
    }
  }

  /// Whom a verified record is about. @param plan  of which it is the motion; empty: none is given.
  verify::Subject subjectOf(const verify::Record& record, const std::string& plan) const {
    const verify::Motion motion = verify::readMotion(record.motion, world_);
    const auto files = [](const std::vector<std::string>& paths) {
      std::string text;
      for (const std::string& path : paths) text += (text.empty() ? "'" : ", '") + path + "'";
      return text;
    };
    const auto isObstacle = [](const verify::Body& body) { return body.role == verify::Role::obstacle; };
    const auto obstacles = std::count_if(world_.bodies.begin(), world_.bodies.end(), isObstacle);
    verify::Subject subject;
    if (!asked_.urdf.empty()) subject.robot = "the robot of " + files(asked_.urdf);
    if (!plan.empty())
      subject.motion = plan == verify::kFromTo ? "straight from --from to --to" : "as '" + plan + "' says";
    if (!motion.scene)
      subject.scene = "with no regard to obstacles";
    else if (!asked_.scenes.empty())
      subject.scene = "among the obstacles of " + files(asked_.scenes);
    else if (obstacles > 0)
      subject.scene = "among this world's obstacles (" + std::to_string(obstacles) + ")";
    subject.covered = verify::coveredBy(world_) + verify::timeTaken(world_, motion);
    if (!motion.self) subject.pairs = "pairs of the robot and an obstacle";
    const auto isMargin = [](const auto& margin) { return margin.second > 0; };
    if (motion.margin > 0 || motion.added > 0 || std::any_of(world_.margins.begin(), world_.margins.end(), isMargin) ||
        std::any_of(world_.pair_margins.begin(), world_.pair_margins.end(), isMargin))
      subject.meets = "comes within its margin";
    return subject;
  }

  /// @return the title of the plan of which it is the motion, if one is.
  std::string findPlan(const verify::Record& record, verify::Verdict& verdict, std::vector<std::string>& notes) {
    const verify::Motion motion = verify::readMotion(record.motion, world_);
    std::string why, title;
    bool found = false;
    for (std::size_t p = 0; p < plans_.size(); ++p) {  // it may be that of several, which differ in their times
      const verify::Comparison c = verify::compareWithPlan(world_, motion, plans_[p]);
      if (c.differences.empty()) {
        used_[p] = true;
        if (!found) {
          notes = c.notes;
          title = plans_[p].title;
        }
        found = true;
      } else if (why.empty()) {
        why = "'" + plans_[p].title + "': " + c.differences[0];
      }
    }
    verdict.verified = found;
    if (!found) verdict.reason = "it is proven of a motion that is no plan's: " + why;
    return title;
  }

  const Asked& asked_;
  const verify::World& world_;
  std::vector<verify::Plan> plans_;
  std::vector<bool> used_;
  const Printer printer_;
  std::set<std::string> solids_met_;
  std::size_t verified_ = 0, in_part_ = 0, all_ = 0;
  bool bad_ = false, same_ = true;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    const Asked asked = readCommand(argc, argv);
    if (asked.help || asked.version) {
      std::puts(asked.version ? "fcl_artic_verify 1" : kHelp);
      return 0;
    }
    const std::string fault = faultOf(asked);
    if (!fault.empty()) throw verify::BadInput(fault);
    const verify::World world = verify::readWorld(verify::readFile(asked.files[0]));
    const int status = Run(asked, world).run();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw verify::BadInput("the output can't be written");
    return status;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fcl_artic_verify: %s\n", verify::shown(error.what()).c_str());
    return 2;
  }
}
