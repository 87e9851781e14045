// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace verify {
namespace {

std::string decimal(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// "WHAT: ITEM, ITEM, ...", where there is an item.
void addList(std::vector<std::string>& lines, const std::string& what, const std::vector<std::string>& items) {
  if (items.empty()) return;
  std::string line = what + ": ";
  for (std::size_t k = 0; k < items.size(); ++k) line += (k > 0 ? ", " : "") + items[k];
  lines.push_back(line);
}

/// A number in a smaller unit where that is the same but for rounding, as 0.3 deg; else with all of its digits.
/// @param unit  of `value`. @param part  of it, `count` of which make up a unit.
std::string inUnit(double value, const char* unit, const char* part, double count) {
  for (int digits = 1; digits <= 6; ++digits) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value * count);
    const double read = std::strtod(text, nullptr);
    if (std::fabs(read / count - value) <= std::ldexp(value, -50)) return text + std::string(" ") + part;
  }
  return decimal(value) + " " + unit;
}
std::string angleText(double rad) {
  return inUnit(rad, "rad", "deg", 180 / 3.14159265358979323846);
}
std::string lengthText(double metres) {
  return inUnit(metres, "m", "mm", 1000);
}
std::string poseText(const PoseTolerance& t) {
  if (t.angle == 0) return lengthText(t.length);
  return t.length == 0 ? angleText(t.angle) : lengthText(t.length) + " and " + angleText(t.angle);
}

/// With as few digits as mean this very number.
std::string shortest(double x) {
  char text[40];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    if (std::strtod(text, nullptr) == x) break;
  }
  return text;
}
std::string speedText(const Speed& of) {
  return "at up to " + shortest(of.speed) + " m/s from " + shortest(of.since) + " s on";
}

/// How far variables may be from the motion, in words, of those that have a tolerance, and "0" of those that have none
/// but move a body that is no obstacle.
std::vector<std::pair<std::string, std::string>> variablesWithin(const World& world) {
  std::vector<char> turns(world.variables.size(), 0), slides = turns, robot = turns;
  std::vector<char> carries(world.frames.size(), 0);  // a body that is no obstacle, here or below
  for (const Body& body : world.bodies)
    if (body.role != Role::obstacle) carries[static_cast<std::size_t>(body.frame)] = 1;
  for (std::size_t f = world.frames.size(); f-- > 1;) {
    const Frame& frame = world.frames[f];
    if (carries[f]) carries[static_cast<std::size_t>(frame.parent)] = 1;
    for (const Element& e : frame.elements) {
      const auto v = static_cast<std::size_t>(e.variable);
      (e.kind == Element::slide ? slides : turns)[v] = 1;
      robot[v] = robot[v] || carries[f];
    }
  }
  std::vector<std::pair<std::string, std::string>> list;
  for (std::size_t v = 0; v < world.variables.size(); ++v) {
    const int number = static_cast<int>(v);
    const std::string name = inQuotes(world.variables[v]);
    const auto one = world.variable_tolerances.find(number), rotation = world.rotation_tolerances.find(number);
    const auto vector = world.vector_tolerances.find(number);
    bool of_vector = false;
    for (const auto& [first, t] : world.vector_tolerances)
      of_vector = of_vector || (number >= first && number < first + t.count);
    if (one != world.variable_tolerances.end())
      list.emplace_back(name, turns[v] && slides[v] ? decimal(one->second) + " rad and m"
                              : turns[v]            ? angleText(one->second)
                                                    : lengthText(one->second));
    if (vector != world.vector_tolerances.end())
      list.emplace_back("the slides from " + name + " on", lengthText(vector->second.length));
    if (rotation != world.rotation_tolerances.end())
      list.emplace_back("the rotation " + name, angleText(rotation->second));
    if (one == world.variable_tolerances.end() && rotation == world.rotation_tolerances.end() && !of_vector && robot[v])
      list.emplace_back(name, "0");
  }
  return list;
}

/// The nearest frame above a body that moves; 0: it stands still.
int carrierOf(const World& world, int frame) {
  while (frame > 0 && world.frames[static_cast<std::size_t>(frame)].elements.empty())
    frame = world.frames[static_cast<std::size_t>(frame)].parent;
  return frame;
}

/// For people. (Tolerances and speeds may move what is `still`; its name in JSON stays all the same.)
std::string wordsFor(Reason reason) {
  return reason == Reason::still ? "no motion between them" : nameOf(reason);
}

std::string startOrGoal(const World& world, const Piece& piece, const double* until) {
  std::string line;
  for (std::size_t v = 0; v < world.variables.size(); ++v) {
    double value = 0;
    if (const auto q = piece.polynomials.find(static_cast<int>(v)); q != piece.polynomials.end())
      for (std::size_t k = until ? q->second.size() : 1; k-- > 0;) value = value * (until ? *until : 0) + q->second[k];
    line += (v > 0 ? ", " : " ") + inQuotes(world.variables[v]) + " " + decimal(value);
  }
  for (const auto& [variable, numbers] : piece.orientations) {
    line += ", " + inQuotes(world.variables[static_cast<std::size_t>(variable)]) + " turns what is turned by";
    for (const double x : numbers) line += " " + decimal(x);
  }
  return line;
}

}  // namespace

std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many.empty() ? one + "s" : many);
}

std::string timeTaken(const World& world, const Motion& motion) {
  return world.speeds.empty() ? "" : "in at most " + shortest(motion.pieces.back().clock[1]) + " s, ";
}

std::vector<std::string> linesOf(const World& world) {
  std::vector<std::string> lines;
  for (const Role role : {Role::link, Role::carried, Role::obstacle}) {
    std::map<std::string, int> names;
    std::size_t count = 0;
    for (const Body& body : world.bodies)
      if (body.role == role) ++names[body.name], ++count;
    std::vector<std::string> items;
    for (const auto& [name, n] : names)
      items.push_back(inQuotes(name) + (n > 1 ? " (" + std::to_string(n) + " bodies)" : ""));
    addList(lines, counted(count, "body", "bodies") + " of role " + nameOf(role), items);
  }
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const Body& body = world.bodies[b];
    const int carrier = carrierOf(world, body.frame);
    const std::string who = world.describe(static_cast<int>(b));
    const std::string frame = inQuotes(world.frames[static_cast<std::size_t>(body.frame)].name);
    if (body.role == Role::obstacle && carrier > 0)
      lines.push_back(who + " moves with the frame " + inQuotes(world.frames[static_cast<std::size_t>(carrier)].name));
    if (body.role == Role::carried) lines.push_back(who + " is carried by the frame " + frame);
  }
  for (const Reason reason : {Reason::still, Reason::neighbours, Reason::allowed, Reason::touch_link}) {
    std::vector<std::string> pairs;
    const auto strays = [&](int name) { return world.body_tolerances.count(name) + world.speeds.count(name) > 0; };
    for (const auto& [pair, listed] : world.unchecked) {
      if (listed.reason != reason) continue;
      const bool give = !world.frame_tolerances.empty() || strays(pair.first) || strays(pair.second);
      pairs.push_back(inQuotes(world.names[static_cast<std::size_t>(pair.first)]) + " and " +
                      inQuotes(world.names[static_cast<std::size_t>(pair.second)]) +
                      (reason == Reason::still && give ? " (but tolerances or speeds may move them)" : ""));
    }
    addList(lines, "not checked, " + wordsFor(reason), pairs);
  }
  std::vector<std::string> margins;
  for (const auto& [name, margin] : world.margins)
    margins.push_back(inQuotes(world.names[static_cast<std::size_t>(name)]) + " " + decimal(margin) + " m");
  for (const auto& [pair, margin] : world.pair_margins)
    margins.push_back(inQuotes(world.names[static_cast<std::size_t>(pair.first)]) + " and " +
                      inQuotes(world.names[static_cast<std::size_t>(pair.second)]) + " " + decimal(margin) + " m");
  addList(lines, "margins of their own", margins);
  std::vector<std::string> tolerances;
  for (const auto& [name, within] : variablesWithin(world)) tolerances.push_back(name + " " + within);
  if (world.gives) addList(lines, "tolerances about the motion", tolerances);
  const auto pose = [](const std::string& name, const PoseTolerance& t) {
    return name + " within " + poseText(t) +
           (t.angle != 0 ? " about " + decimal(t.pivot[0]) + " " + decimal(t.pivot[1]) + " " + decimal(t.pivot[2])
                         : "");
  };
  std::vector<std::string> frames, bodies;
  for (const auto& [frame, t] : world.frame_tolerances)
    frames.push_back(pose(inQuotes(world.frames[static_cast<std::size_t>(frame)].name), t));
  for (const auto& [name, t] : world.body_tolerances)
    bodies.push_back(pose(inQuotes(world.names[static_cast<std::size_t>(name)]), t));
  addList(lines, "tolerances of frames", frames);
  addList(lines, "tolerances of bodies", bodies);
  std::vector<std::string> speeds;
  for (const auto& [name, of] : world.speeds)
    speeds.push_back(inQuotes(world.names[static_cast<std::size_t>(name)]) + " " + speedText(of));
  addList(lines, "bodies that may move by themselves", speeds);
  return lines;
}

/// "for every path within 0.3 deg of it, base 'base' within 2 mm, "
static std::string withinTolerances(const World& world) {
  const auto variables = variablesWithin(world);
  std::map<std::string, std::size_t> counts;
  std::string most;  // the tolerance that most variables have
  for (const auto& [name, within] : variables)
    if (within != "0" && (++counts[within] > counts[most] || most.empty())) most = within;
  std::string text;
  if (!most.empty()) {
    std::string others;
    for (const auto& [name, within] : variables)
      if (within != most) others += (others.empty() ? " (" : ", ") + name + " " + within;
    text = "for every path within " + most + " of it" + others + (others.empty() ? "" : ")");
  }
  const auto add = [&](const std::string& who, const PoseTolerance& t) {
    text += (text.empty() ? "with " : ", ") + who + " within " + poseText(t);
  };
  for (const auto& [frame, t] : world.frame_tolerances)
    add((carrierOf(world, frame) == 0 ? "base " : "frame ") +
            inQuotes(world.frames[static_cast<std::size_t>(frame)].name),
        t);
  for (const auto& [name, t] : world.body_tolerances) add(inQuotes(world.names[static_cast<std::size_t>(name)]), t);
  return text + ", ";
}

std::string coveredBy(const World& world) {
  std::string ways;
  for (const auto& [name, of] : world.speeds)
    ways += (ways.empty() ? "for every way of " : " and of ") + inQuotes(world.names[static_cast<std::size_t>(name)]) +
            " " + speedText(of);
  if (!ways.empty()) ways += ", ";
  return world.gives ? withinTolerances(world) + ways : ways;
}

std::vector<std::string> linesOf(const World& world, const Motion& motion, const Verdict& verdict) {
  std::vector<std::string> lines;
  lines.push_back(std::string("checked: ") + (motion.self ? "links with links" : "") +
                  (motion.self && motion.scene ? ", " : "") + (motion.scene ? "links with obstacles" : ""));
  lines.push_back("margin: " + decimal(motion.margin) + " m" +
                  (world.margins.empty() && world.pair_margins.empty() ? "" : ", of what has none of its own") +
                  (motion.added == 0 ? "" : ", and " + decimal(motion.added) + " m added to every margin"));
  const std::size_t last = motion.pieces.size() - 1;
  const auto ofPiece = [&](std::size_t piece) { return last > 0 ? " of piece " + std::to_string(piece) : ""; };
  lines.push_back("start, t = 0" + ofPiece(0) + ":" + startOrGoal(world, motion.pieces.front(), nullptr));
  lines.push_back("goal, t = " + decimal(motion.until) + ofPiece(last) + ":" +
                  startOrGoal(world, motion.pieces.back(), &motion.until));
  if (motion.duration != 0) lines.push_back("duration: " + decimal(motion.duration) + " s, which no proof uses");
  if (!world.speeds.empty())
    lines.push_back("clock, by which bodies move by themselves: 0 s at the start, " +
                    shortest(motion.pieces.back().clock[1]) + " s at t = 1" + ofPiece(last));
  if (last > 0) {
    char jump[20];
    std::snprintf(jump, sizeof jump, "%.2g", verdict.jump);
    lines.push_back(std::to_string(last + 1) + " pieces: each begins where the one before ends, within " + jump +
                    " rad or m");
  }
  for (std::size_t k = 0; k <= last; ++k)
    for (const auto& [pair, until] : motion.pieces[k].ignored)
      lines.push_back("ignored until t = " + decimal(until) + ofPiece(k) +
                      (until >= (k == last ? motion.until : 1) ? ", the end of its claim: " : ": ") +
                      world.describe(pair.first) + " and " + world.describe(pair.second));
  return lines;
}

bool isInPart(const Verdict& v) {
  return v.until < 1 || v.late > 0 || v.not_checked[static_cast<int>(Reason::scope)] > 0 ||
         v.not_checked[static_cast<int>(Reason::ignored)] > 0;
}

std::string lineOf(const Verdict& v, const Subject& s) {
  if (!v.verified) return "NOT VERIFIED: " + shown(v.reason);
  std::string line = s.robot + " moves " + s.motion + " " + s.scene + ", and ";
  if (v.until < 1) line += "until t = " + decimal(v.until) + " of piece " + std::to_string(v.pieces - 1) + " ";
  line += s.covered + "none of " + std::to_string(v.checked) + " " + s.pairs;
  if (v.late > 0) line += " (" + std::to_string(v.late) + " of them ignored up to a time)";
  line += " " + s.meets + ".";
  if (v.contact) line += (v.near ? " WITHIN THEIR MARGIN: " : " CONTACT of ") + v.contact_text + ".";
  return "VERIFIED: " + shown(line);
}

std::string notChecked(const Verdict& v) {
  std::string text;
  for (int k = 0; k < kReasons; ++k)
    if (v.not_checked[k] > 0)
      text += (text.empty() ? "" : ", ") + std::to_string(v.not_checked[k]) + " " + wordsFor(static_cast<Reason>(k));
  return text;
}

std::string wrapped(const std::string& begin, std::string_view text) {
  const std::string safe = shown(text);
  std::string all, line = shown(begin);
  std::size_t end = safe.find(": ");  // the list's heading stays whole
  for (std::size_t at = 0; at < safe.size(); at = end) {
    end = safe.find(", ", end);
    const bool last = end == safe.npos;
    end = last ? safe.size() : end + 2;
    const std::string item = safe.substr(at, end - at);
    if (at > 0 && line.size() + item.size() > (last ? 120 : 121)) {  // without the space at the end
      all += line.substr(0, line.size() - 1) + "\n";
      line = "    ";
    }
    line += item;
  }
  return all + line + "\n";
}

std::string shown(std::string_view text) {
  std::string safe;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    char escape[8];
    const bool verdict = text.substr(k, 8) == "VERIFIED";
    std::snprintf(escape, sizeof escape, byte < 32 || byte > 126 || verdict ? "\\x%02x" : "%c", byte);
    safe += escape;
  }
  return safe;
}

std::string listAsJson(const std::vector<std::string>& lines) {
  std::string s = "[";
  for (std::size_t k = 0; k < lines.size(); ++k) s += (k > 0 ? ",\n  " : "\n  ") + quotedJson(lines[k]);
  return s + "]";
}

std::string verdictAsJson(const Verdict& v) {
  std::string s = std::string("{\"verified\": ") + (v.verified ? "true" : "false");
  if (!v.verified) return s + ", \"reason\": " + quotedJson(v.reason) + "}";
  s += ", \"pairs\": " + std::to_string(v.checked) + ", \"ignored_up_to_a_time\": " + std::to_string(v.late) +
       ", \"pieces\": " + std::to_string(v.pieces) + ", \"until\": " + decimal(v.until) + ", \"not_checked\": {";
  const char* before = "";
  for (int k = 0; k < kReasons; ++k) {
    s += before + quotedJson(nameOf(static_cast<Reason>(k))) + ": " + std::to_string(v.not_checked[k]);
    before = ", ";
  }
  s += "}";
  if (v.contact) s += (v.near ? ", \"within_margin\": " : ", \"contact\": ") + quotedJson(v.contact_text);
  return s + "}";
}

}  // namespace verify
