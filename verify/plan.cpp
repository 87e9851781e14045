// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "readers.h"
#include "report.h"
#include "xml.h"

namespace verify {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
constexpr const char* kHowPlansAreMade =
    "; its plans have a column for each variable, as `fcl_artic certify --out FILE.csv` writes them";

std::string shortDecimal(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// Words of a text, separated by any of these.
std::vector<std::string> wordsOf(const std::string& text, const char* separators) {
  std::vector<std::string> words;
  for (std::size_t at = text.find_first_not_of(separators), end; at != text.npos;
       at = text.find_first_not_of(separators, end)) {
    end = std::min(text.find_first_of(separators, at), text.size());
    words.push_back(text.substr(at, end - at));
  }
  return words;
}

/// A number, or an angle as 90deg.
double numberOf(std::string word) {
  const bool degrees = word.size() > 3 && word.substr(word.size() - 3) == "deg";
  if (degrees) word.resize(word.size() - 3);
  const double number = decimal(word);
  return degrees ? number * kRadiansPerDegree : number;
}

/// Fields of a line, separated by commas; blanks and quotes around them are no part of them.
std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    const std::string field = line.substr(at, end - at);
    const std::size_t begin = std::min(field.find_first_not_of(" \t\r\""), field.size());
    fields.push_back(field.substr(begin, field.find_last_not_of(" \t\r\"") + 1 - begin));
    if (end == line.size()) return fields;
    at = end + 1;
  }
}

/// Which column of a plan says what.
struct Columns {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t time = kNone;
  struct Of {
    std::size_t position = kNone, velocity = kNone, acceleration = kNone;
  };
  std::map<std::string, Of> variables;
  bool velocities = false, accelerations = false;  // there are any
};

Columns columnsOf(const World& world, const Plan& plan) {
  static const char* const kVelocity[] = {"/velocity", ".velocity", "_velocity", "_vel"};
  static const char* const kAcceleration[] = {"/acceleration", ".acceleration", "_acceleration", "_acc"};
  const std::set<std::string> known(world.variables.begin(), world.variables.end());
  if (known.size() < world.variables.size()) throw BadInput("the world has two variables of one name");
  Columns columns;
  const auto set = [&](std::size_t& column, std::size_t k) {
    if (column != Columns::kNone)
      throw BadInput("'" + plan.title + "': two columns say what " + inQuotes(plan.columns[k]) + " does");
    column = k;
    return true;
  };
  /// Whether column k is about one of these variables, or time.
  const auto isOf = [&](const std::set<std::string>& names, std::size_t k) {
    const std::string& name = plan.columns[k];
    const auto without = [&](const char* const(&endings)[4]) {
      for (const std::string ending : endings) {
        const std::size_t left = name.size() - std::min(ending.size(), name.size());
        if (name.substr(left) == ending && names.count(name.substr(0, left)) > 0) return name.substr(0, left);
      }
      return std::string();
    };
    if (names.count(name) > 0) return set(columns.variables[name].position, k);
    if (name == "time" || name == "t" || name == "time_from_start") return set(columns.time, k);
    const std::string v = without(kVelocity), a = without(kAcceleration);
    columns.velocities = columns.velocities || !v.empty();
    if (!v.empty()) return set(columns.variables[v].velocity, k);
    columns.accelerations = columns.accelerations || !a.empty();
    return !a.empty() && set(columns.variables[a].acceleration, k);
  };
  // The robot's variables come first, so that no name that a world adds changes what a column means.
  const std::set<std::string> robot = plan.robot.empty() ? known : std::set(plan.robot.begin(), plan.robot.end());
  for (std::size_t k = 0; k < plan.columns.size(); ++k)
    if (!isOf(robot, k) && !isOf(known, k))
      throw BadInput("'" + plan.title + "': the column " + inQuotes(plan.columns[k]) + " is no variable of the world" +
                     kHowPlansAreMade);
  for (const auto& [name, of] : columns.variables)
    if (of.position == Columns::kNone || (columns.velocities && of.velocity == Columns::kNone) ||
        (columns.accelerations && of.acceleration == Columns::kNone))
      throw BadInput("'" + plan.title + "': " + inQuotes(name) +
                     " has not all of the columns of position, velocity and acceleration that others have");
  for (const auto& [name, value] : plan.state)
    if (known.count(name) == 0) throw BadInput("the world has no variable " + inQuotes(name));
  if (columns.accelerations && !columns.velocities)
    throw BadInput("'" + plan.title + "' has accelerations and no velocities");
  return columns;
}

Interpolation interpolationOf(const Plan& plan, const Columns& columns) {
  Interpolation kind = plan.interpolation;
  if (kind == Interpolation::upsampled && !columns.velocities) return kind;
  if (kind == Interpolation::automatic || kind == Interpolation::upsampled)
    kind = columns.accelerations ? Interpolation::quintic
           : columns.velocities  ? Interpolation::cubic
                                 : Interpolation::linear;
  const bool lacks = (kind != Interpolation::linear && (!columns.velocities || columns.time == Columns::kNone)) ||
                     (kind == Interpolation::quintic && !columns.accelerations);
  if (lacks) throw BadInput("'" + plan.title + "' has not the times, velocities and accelerations of such a spline");
  return kind;
}

class PlanComparison {
 public:
  PlanComparison(const World& world, const Motion& motion, const Plan& plan)
      : world_(world),
        motion_(motion),
        plan_(plan),
        columns_(columnsOf(world, plan)),
        kind_(interpolationOf(plan, columns_)) {}

  Comparison run() {
    count();
    for (std::size_t k = 1; columns_.time != Columns::kNone && k < plan_.rows.size(); ++k)
      if (!(time(k) > time(k - 1))) different("its time does not increase at waypoint " + std::to_string(k));
    if (!world_.speeds.empty()) clock();
    for (std::size_t v = 0; v < world_.variables.size(); ++v) variable(v);
    if (result_.differences.empty()) note();
    return std::move(result_);
  }

 private:
  using Long = long double;

  /// The time of a waypoint: the file's, or the waypoint's number.
  double time(std::size_t k) const {
    return columns_.time == Columns::kNone ? static_cast<double>(k) : plan_.rows[k][columns_.time];
  }
  void different(const std::string& what) {
    if (result_.differences.size() < 1000) result_.differences.push_back(what);
  }

  void count() {
    const std::size_t pieces = motion_.pieces.size(), all = plan_.rows.size() - 1;
    if (pieces > all)
      different("the motion has " + counted(pieces, "piece") + ", the plan " + std::to_string(all));
    else if (pieces < all && motion_.until >= 1)
      different("the motion ends at waypoint " + std::to_string(pieces) + " of " + std::to_string(all));
  }

  /// The plan is nowhere later than the motion's clock: bodies that move by themselves get no farther. Between
  /// waypoints both times go linearly along the same curve. A difference of doubles is the rounded one and an error, a
  /// double, too.
  void clock() {
    if (columns_.time == Columns::kNone)
      return different("it has no times, and bodies move by themselves for as long as it takes");
    for (std::size_t k = 0; k < std::min(motion_.pieces.size(), plan_.rows.size() - 1); ++k) {
      const double most = motion_.pieces[k].clock[1], a = time(k + 1), b = time(0), elapsed = a - b;
      const double taken = a - elapsed, error = (a - (elapsed + taken)) + (taken - b);
      if (elapsed < most || (elapsed == most && error <= 0)) continue;
      return different("it is at waypoint " + std::to_string(k + 1) + " after " + shortDecimal(elapsed) +
                       " s, by the motion's clock after " + shortDecimal(most) +
                       " s: bodies that move by themselves get farther");
    }
  }

  /// Coefficients of a variable in a piece, without zeros at the end but for the first.
  std::vector<double> coefficients(std::size_t piece, std::size_t v) const {
    const auto& all = motion_.pieces[piece].polynomials;
    const auto q = all.find(static_cast<int>(v));
    if (q == all.end()) return {0};
    std::vector<double> c = q->second;
    while (c.size() > 1 && c.back() == 0) c.pop_back();
    return c;
  }

  void variable(std::size_t v) {
    if (!world_.moves[v]) return;
    const std::string& name = world_.variables[v];
    const auto wrong = [&](std::size_t piece, const std::string& what) {
      different(inQuotes(name) + " " + what + " piece " + std::to_string(piece) + " of the motion");
    };
    if (turns(v)) return different(inQuotes(name) + " turns by three variables, which are not compared with plans");
    const auto column = columns_.variables.find(name);
    if (column == columns_.variables.end()) return standing(v);
    const Columns::Of& of = column->second;
    const std::size_t pieces = std::min(motion_.pieces.size(), plan_.rows.size() - 1);
    const Rest rest = kind_ == Interpolation::upsampled ? fromRestToRest(of.position) : Rest();
    for (std::size_t k = 0; k < pieces; ++k) {
      const std::vector<double> c = coefficients(k, v);
      const double from = plan_.rows[k][of.position], to = plan_.rows[k + 1][of.position];
      if (c[0] != from) return wrong(k, "is not at waypoint " + std::to_string(k) + " at the beginning of");
      if (kind_ == Interpolation::upsampled) {
        if (!isSpline(c, smooth(rest, of.position, k)))
          return wrong(k, "does not go by the smooth spline from rest to rest in");
      } else if (kind_ != Interpolation::linear) {
        if (!isSpline(c, byVelocities(of, k))) return wrong(k, "does not go as the plan's velocities say in");
      } else if (c.size() > 2) {
        return wrong(k, "does not go straight in");
      } else if ((c.size() > 1 ? c[1] : 0) != to - from) {
        return wrong(k, "does not go to waypoint " + std::to_string(k + 1) + " in");
      }
    }
  }

  /// Whether an obstacle goes elsewhere in some piece.
  bool obstaclesMove() const {
    std::vector<char> goes(world_.variables.size(), 0), moves(world_.frames.size(), 0);
    for (std::size_t k = 0; k < motion_.pieces.size(); ++k)
      for (const auto& q : motion_.pieces[k].polynomials) {
        const auto v = static_cast<std::size_t>(q.first);
        goes[v] = goes[v] || coefficients(k, v).size() > 1;
      }
    for (std::size_t f = 1; f < world_.frames.size(); ++f) {  // parents first
      moves[f] = moves[static_cast<std::size_t>(world_.frames[f].parent)];
      for (const Element& e : world_.frames[f].elements)
        moves[f] = moves[f] || goes[static_cast<std::size_t>(e.variable)];
    }
    return std::any_of(world_.bodies.begin(), world_.bodies.end(), [&](const Body& body) {
      return body.role == Role::obstacle && moves[static_cast<std::size_t>(body.frame)];
    });
  }

  /// Whether it is one of the three of a `rotate`.
  bool turns(std::size_t v) const {
    for (std::size_t k = v < 2 ? 0 : v - 2; k <= v; ++k)
      if (world_.turns[k]) return true;
    return false;
  }

  void standing(std::size_t v) {
    const std::string& name = world_.variables[v];
    const auto given = plan_.state.find(name);
    const double value = given == plan_.state.end() ? 0 : given->second;
    for (std::size_t k = 0; k < motion_.pieces.size(); ++k) {
      const std::vector<double> c = coefficients(k, v);
      if (c.size() > 1) return different(inQuotes(name) + " moves, and the plan has no column for it");
      if (c[0] != value)
        return different(inQuotes(name) + " stands at " + shortDecimal(c[0]) + ", not at " + shortDecimal(value) +
                         ": the plan has no column for it, so 0, or as --state says");
    }
    standing_ += (standing_.empty() ? "" : ", ") + inQuotes(name) + " " + shortDecimal(value);
  }

  /// Coefficients of a piece, and the size by which a writer's rounding of them is measured.
  struct Spline {
    Long c[6] = {}, size = 0;
  };

  // With s = (t - t_k) / h the only polynomials of these degrees that have the waypoints' values, velocities v and
  // accelerations a at both ends: q0 + h v0 s + (3 d - 2 h v0 - h v1) s^2 + (h v0 + h v1 - 2 d) s^3, d = q1 - q0, and
  // likewise of degree 5. A writer rounds their coefficients: by less than 2^-41 of the largest of |q|, h |v|, h^2 |a|
  // (doc/NUMERICS.md, section 12: 2e-13).
  Spline byVelocities(const Columns::Of& of, std::size_t k) const {
    const std::vector<double>&from = plan_.rows[k], &to = plan_.rows[k + 1];
    const Long h = static_cast<Long>(time(k + 1)) - time(k), d = static_cast<Long>(to[of.position]) - from[of.position];
    const Long v0 = h * from[of.velocity], v1 = h * to[of.velocity];
    Spline out;
    Long a0 = 0, a1 = 0, *e = out.c;
    e[0] = from[of.position];
    e[1] = v0;
    e[2] = 3 * d - 2 * v0 - v1;
    e[3] = v0 + v1 - 2 * d;
    if (kind_ == Interpolation::quintic) {
      a0 = h * h * from[of.acceleration];
      a1 = h * h * to[of.acceleration];
      e[2] = a0 / 2;
      e[3] = 10 * d - 6 * v0 - 4 * v1 - (3 * a0 - a1) / 2;
      e[4] = -15 * d + 8 * v0 + 7 * v1 + (3 * a0) / 2 - a1;
      e[5] = 6 * d - 3 * (v0 + v1) - (a0 - a1) / 2;
    }
    out.size = std::max({std::fabs(e[0]), std::fabs(static_cast<Long>(to[of.position])), std::fabs(v0), std::fabs(v1),
                         std::fabs(a0), std::fabs(a1)});
    return out;
  }

  /// The spline of cubics through the waypoints that is at rest at its first and last one: its second derivatives at
  /// the waypoints. And the largest slope from one waypoint to the next.
  struct Rest {
    std::vector<Long> bend;
    Long slope = 0;
  };

  // Between waypoints k and k + 1, h apart, with the slope s between them and the second derivatives m and n there,
  // such a cubic leaves with the velocity s - h (2 m + n) / 6 and arrives with s + h (m + 2 n) / 6. At each waypoint it
  // leaves as it arrives, g being the step before:
  //   g m_{k-1} + 2 (g + h) m_k + h m_{k+1} = 6 (s_k - s_{k-1}),
  // with g = 0 and s_{-1} = 0 at the first one, and likewise at the last. Twice as much stands on the diagonal as
  // beside it: elimination needs no pivots, and nothing grows (long doubles have 11 bits more than the writer's).
  Rest fromRestToRest(std::size_t column) const {
    const std::size_t n = plan_.rows.size();
    Rest rest;
    rest.bend.resize(n);
    std::vector<Long> over(n);  // what is left beside a diagonal of 1
    Long before = 0, arrives = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const bool last = k + 1 == n;
      const Long after = last ? 0 : static_cast<Long>(time(k + 1)) - time(k);
      const Long leaves = last ? 0 : (static_cast<Long>(plan_.rows[k + 1][column]) - plan_.rows[k][column]) / after;
      const Long pivot = 2 * (before + after) - (k > 0 ? before * over[k - 1] : 0);
      rest.bend[k] = (6 * (leaves - arrives) - (k > 0 ? before * rest.bend[k - 1] : 0)) / pivot;
      over[k] = after / pivot;
      rest.slope = std::max(rest.slope, std::fabs(leaves));
      before = after;
      arrives = leaves;
    }
    for (std::size_t k = n - 1; k-- > 0;) rest.bend[k] -= over[k] * rest.bend[k + 1];
    return rest;
  }

  // A writer rounds as above, from velocities that it finds by a like elimination: these are off by less than 2^-44 of
  // the plan's largest slope (doc/NUMERICS.md, section 12).
  Spline smooth(const Rest& rest, std::size_t column, std::size_t k) const {
    const Long from = plan_.rows[k][column], to = plan_.rows[k + 1][column];
    const Long h = static_cast<Long>(time(k + 1)) - time(k), m = h * h * rest.bend[k], n = h * h * rest.bend[k + 1];
    Spline out;
    out.c[0] = from;
    out.c[1] = to - from - (2 * m + n) / 6;
    out.c[2] = m / 2;
    out.c[3] = (n - m) / 6;
    out.size = std::max({std::fabs(from), std::fabs(to), h * rest.slope});
    return out;
  }

  static bool isSpline(const std::vector<double>& c, const Spline& e) {
    for (std::size_t i = 0; i < 6; ++i)
      if (!(std::fabs((i < c.size() ? c[i] : 0) - e.c[i]) <= std::ldexp(e.size, -41))) return false;
    return true;
  }

  void note() {
    const std::size_t pieces = motion_.pieces.size();
    std::string text = "the motion is that of '" + plan_.title + "': waypoints 0 to " + std::to_string(pieces);
    if (pieces < plan_.rows.size() - 1) text += " of " + std::to_string(plan_.rows.size() - 1);
    if (motion_.until < 1) text += ", up to the time that the claim ends";
    text += kind_ == Interpolation::linear      ? ", straight from one to the next"
            : kind_ == Interpolation::cubic     ? ", cubic splines"
            : kind_ == Interpolation::upsampled ? ", one smooth spline from rest to rest"
                                                : ", splines of degree 5";
    result_.notes.push_back(text);
    if (!standing_.empty()) result_.notes.push_back("not in the plan, standing still: " + standing_);
    const double length = columns_.time == Columns::kNone ? motion_.duration : time(plan_.rows.size() - 1) - time(0);
    const bool retimed = motion_.duration != 0 && pieces == plan_.rows.size() - 1 && motion_.until == 1 &&
                         std::fabs(length - motion_.duration) > 1e-9 * std::fabs(motion_.duration);
    if (retimed)
      result_.notes.push_back("the plan is retimed: it takes " + shortDecimal(length) +
                              " s, the certificate's motion " + shortDecimal(motion_.duration) + " s");
    if (!world_.speeds.empty())
      result_.notes.push_back(
          "bodies move by themselves: this is proven of timings that are nowhere later than its clock");
    else
      result_.notes.push_back(
          obstaclesMove()
              ? "obstacles move, too: this is proven of one timing, in which they are where the plan has them"
          : kind_ == Interpolation::linear
              ? "nothing else moves: this is proven of every timing of these straight lines"
              : "nothing else moves: this is proven of every timing of these very curves "
                "(splines of other times differ)");
  }

  const World& world_;
  const Motion& motion_;
  const Plan& plan_;
  const Columns columns_;
  const Interpolation kind_;
  std::string standing_;
  Comparison result_;
};

}  // namespace

Plan readPlan(const std::string& path) {
  Plan plan;
  plan.title = path;
  std::string text = readFile(path);
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);  // a byte order mark
  if (text.empty() || text.back() != '\n')
    throw BadInput("'" + path + "': the last line has no line end: the file may be cut short");
  std::size_t number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r\"");
    if (first == line.npos || line[first] == '#') continue;
    const std::vector<std::string> fields = fieldsOf(line);
    const std::string where = "'" + path + "', line " + std::to_string(number) + ": ";
    if (plan.columns.empty()) {
      plan.columns = fields;
      continue;
    }
    if (fields.size() != plan.columns.size()) throw BadInput(where + "it has another number of columns than the first");
    std::vector<double>& row = plan.rows.emplace_back();
    try {
      for (const std::string& field : fields) row.push_back(decimal(field));
    } catch (const BadInput& error) {
      throw BadInput(where + error.what());
    }
  }
  if (plan.rows.size() < 2) throw BadInput("'" + path + "' has not two waypoints");
  return plan;
}

std::map<std::string, double> readConfiguration(const World& world, const std::vector<std::string>& order,
                                                const std::string& text) {
  std::map<std::string, double> values;
  const std::vector<std::string> words = wordsOf(text, ", \t\r\n");
  const bool named = !words.empty() && words[0].find('=') != std::string::npos;
  if (!named && words.size() != order.size())
    throw BadInput("'" + text + "' has " + counted(words.size(), "value") + " for " +
                   counted(order.size(), "variable"));
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    if ((equals != std::string::npos) != named)
      throw BadInput("'" + text + "': either all values carry a name or none does");
    const std::string name = named ? words[k].substr(0, equals) : order[k];
    const double value = numberOf(named ? words[k].substr(equals + 1) : words[k]);
    if (std::find(world.variables.begin(), world.variables.end(), name) == world.variables.end())
      throw BadInput("the world has no variable " + inQuotes(name));
    if (!values.emplace(name, value).second) throw BadInput("'" + text + "': " + inQuotes(name) + " is given twice");
  }
  return values;
}

std::vector<double> readBase(const std::string& text) {
  const std::vector<std::string> fields = fieldsOf(text);
  if (fields.size() != 3 && fields.size() != 6)
    throw BadInput("'" + text + "' is no pose x,y,z or x,y,z,roll,pitch,yaw");
  std::vector<double> base;
  for (const std::string& field : fields) base.push_back(base.size() < 3 ? decimal(field) : numberOf(field));
  base.resize(6, 0);
  return base;
}

Plan planBetween(const World& world, const std::vector<std::string>& robot, const std::string& from,
                 const std::string& to) {
  Plan plan;
  plan.title = kFromTo;
  plan.interpolation = Interpolation::linear;
  plan.robot = robot;
  const std::vector<std::string>& order = robot.empty() ? world.variables : robot;
  std::map<std::string, double> ends[2] = {readConfiguration(world, order, from), readConfiguration(world, order, to)};
  std::map<std::string, double> either = ends[0];
  either.insert(ends[1].begin(), ends[1].end());
  plan.rows.resize(2);
  for (const auto& [name, unused] : either) {
    plan.columns.push_back(name);
    for (std::size_t k = 0; k < 2; ++k) plan.rows[k].push_back(ends[k][name]);  // 0 where only the other end names it
  }
  return plan;
}

Comparison compareWithPlan(const World& world, const Motion& motion, const Plan& plan) {
  return PlanComparison(world, motion, plan).run();
}

}  // namespace verify
