// SPDX-License-Identifier: BSD-3-Clause
#include "lines.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "configuration.h"
#include "exit_status.h"
#include "files/files.h"
#include "motions.h"
#include "plans/document.h"
#include "report/report.h"

namespace fcl_artic::app {
namespace {

using Json = nlohmann::ordered_json;

/// A question: a straight motion, or waypoints.
struct Question {  // NOLINT(bugprone-exception-escape): moving it throws nothing
  Json id;
  std::optional<JointMotion> motion;
  std::optional<JointTrajectory> trajectory;
  std::vector<std::string> notes;
};

/// A number with all of its digits, or a text such as "90deg".
std::string wordOf(const Json& value, const std::string& what) {
  if (value.is_number()) return fmt::format("{:.17g}", value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  throw std::invalid_argument(
      fmt::format("{}: {} is neither a number nor a text such as \"90deg\"", what, value.dump()));
}

/// @param value  a list of all joint values, or an object from names to values.
/// @param state  as parseConfiguration() takes it.
Eigen::VectorXd toConfiguration(const KinematicTree& tree, const Json& value, const std::string& what,
                                const std::map<std::string, double>& state) {
  std::vector<std::string> words;
  if (value.is_array()) {
    for (const Json& one : value) words.push_back(wordOf(one, what));
  } else if (value.is_object()) {
    for (const auto& [name, one] : value.items()) words.push_back(name + "=" + wordOf(one, what));
  } else {
    throw std::invalid_argument(
        fmt::format("{}: {} is neither a list of joint values nor an object of them by name", what, value.dump()));
  }
  return parseConfiguration(tree, words, what, state);
}

/// The value of one of two keys, of which one must be there.
const Json& oneOf(const Json& line, const char* key, const char* other) {
  if (line.contains(key) && line.contains(other)) {
    throw std::invalid_argument(fmt::format("has both '{}' and '{}'", key, other));
  }
  if (line.contains(key)) return line.at(key);
  if (line.contains(other)) return line.at(other);
  throw std::invalid_argument(fmt::format("has neither '{}' nor '{}'", key, other));
}

void requireKeys(const Json& line) {
  static constexpr const char* kKeys[] = {"id", "from", "to", "start", "goal", "waypoints", "times"};
  for (const auto& [key, value] : line.items()) {
    if (std::find(std::begin(kKeys), std::end(kKeys), key) != std::end(kKeys)) continue;
    throw std::invalid_argument(
        fmt::format("has '{}', which is not read; it may have id, from and to (or start and "
                    "goal), or waypoints and times",
                    key));
  }
  for (const char* key : {"from", "to", "start", "goal"}) {
    if (line.contains("waypoints") && line.contains(key)) {
      throw std::invalid_argument(fmt::format("has both 'waypoints' and '{}'", key));
    }
  }
  if (line.contains("times") && !line.contains("waypoints")) throw std::invalid_argument("has times, but no waypoints");
}

/// Waypoints of all joints.
plans::Plan toPlan(const KinematicTree& tree, const Json& line, const std::map<std::string, double>& state) {
  plans::Plan plan;
  const auto add = [&](const Eigen::VectorXd& q) { plan.positions.emplace_back(q.data(), q.data() + q.size()); };
  if (!line.contains("waypoints")) {
    add(toConfiguration(tree, oneOf(line, "from", "start"), "from", state));
    add(toConfiguration(tree, oneOf(line, "to", "goal"), "to", state));
    return plan;
  }
  const Json& given = line.at("waypoints");
  if (!given.is_array() || given.size() < 2) throw std::invalid_argument("waypoints: a list of two or more is needed");
  for (std::size_t k = 0; k < given.size(); ++k) {
    add(toConfiguration(tree, given[k], fmt::format("waypoint {}", k), state));
  }
  if (line.contains("times")) {
    const Json& times = line.at("times");
    const bool numbers =
        times.is_array() && std::all_of(times.begin(), times.end(), [](const Json& t) { return t.is_number(); });
    if (!numbers || times.size() != given.size()) {
      throw std::invalid_argument(fmt::format("times: {} numbers are needed, one for each waypoint", given.size()));
    }
    plan.times = times.get<std::vector<double>>();
  }
  return plan;
}

/// @param[out] out  its id is there even if this throws, where the line has one.
void read(const KinematicTree& tree, const std::string& text, const LinesOptions& options, Question& out) {
  const Json line = plans::parseJson(text);
  if (!line.is_object()) throw std::invalid_argument("is no JSON object, as {\"from\": [...], \"to\": [...]}");
  if (line.contains("id")) out.id = line.at("id");
  requireKeys(line);
  const plans::Plan plan = toPlan(tree, line, options.motion.state);
  plans::MotionOptions motion = options.motion;
  motion.state.clear();  // it is in the plan
  if (line.contains("waypoints") || !isOfTwoEnds(motion.interpolation)) {
    plans::PlanMotion made = toMotion(tree, plan, motion);
    out.notes = std::move(made.notes);
    out.trajectory = std::move(made.trajectory);
    return;
  }
  const auto end = [&](std::size_t k) -> Eigen::VectorXd {
    const std::vector<double>& values = plan.positions[k];
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  out.motion = motionBetween(tree, end(0), end(1), motion);
  for (const std::size_t k : {0, 1}) {
    for (const std::string& note : tree.limitNotes(end(k))) out.notes.push_back((k == 0 ? "from: " : "to: ") + note);
  }
}

class Answers {
 public:
  Answers(const ArticulatedCollisionManager& manager, const CertifiedRequest& request, const LinesOptions& options,
          CertificateFile& certificates)
      : manager_(manager), request_(request), options_(options), certificates_(certificates) {}

  void answer(std::size_t number, const std::string& text) {
    if (text.find_first_not_of(" \t\r") == std::string::npos) return;
    ++asked_;
    Question question;
    Json out = {{"line", number}};
    try {
      read(manager_.tree(), text, options_, question);
      if (!question.id.is_null()) out["id"] = question.id;
      out.update(solve(question));
    } catch (const std::exception& error) {
      if (!question.id.is_null()) out["id"] = question.id;
      out.update({{"status", "error"}, {"error", fmt::format("line {}: {}", number, error.what())}});
      exit_ = kExitError;
    }
    // Not the reader's fault if a text is cut within a character.
    fmt::print("{}\n", out.dump(-1, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
  }

  std::size_t asked() const { return asked_; }
  int exitStatus() const { return exit_; }

 private:
  Json solve(const Question& question) {
    if (question.trajectory) {
      manager_.continuousCollide(*question.trajectory, request_, result_);
    } else {
      manager_.continuousCollide(*question.motion, request_, result_);
    }
    exit_ = worseExit(exit_, app::exitStatus(result_));
    const double begin = question.trajectory ? question.trajectory->beginTime() : 0,
                 end = question.trajectory ? question.trajectory->endTime() : 1;
    const auto configuration = [&](double t) {
      return question.trajectory ? question.trajectory->configuration(t) : question.motion->configuration(t);
    };
    const Json all =
        jsonReport({manager_.tree(), request_, result_, question.notes, configuration, begin, end, nullptr});
    Json out;
    for (const char* key : {"status", "t_lower", "t_upper", "certain", "contacts", "nothing_checked"})
      out[key] = all.at(key);
    for (const char* key : kExceptions) out[key] = all.at(key);
    if (result_.status != Status::free) out["q_at_t_lower"] = all.at("q_at_t_lower");
    if (all.contains("certificate")) out["certificate"] = all.at("certificate");
    if (!all.at("visibility").is_null()) out["visibility"] = all.at("visibility");
    if (!question.notes.empty()) out["notes"] = question.notes;
    if (result_.certificate) certificates_.add(*result_.certificate);
    return out;
  }

  const ArticulatedCollisionManager& manager_;
  const CertifiedRequest& request_;
  const LinesOptions& options_;
  CertificateFile& certificates_;
  CertifiedResult result_;
  std::size_t asked_ = 0;
  int exit_ = kExitFree;  ///< of the worst answer
};

}  // namespace

int checkLines(const ArticulatedCollisionManager& manager, const CertifiedRequest& request, const LinesOptions& options,
               CertificateFile& certificates) {
  Answers answers(manager, request, options, certificates);
  const bool standard_input = options.path == "-";
  std::istringstream file(standard_input ? std::string() : files::read(options.path));
  std::istream& in = standard_input ? std::cin : file;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) answers.answer(number, line);
  const std::string name = standard_input ? "standard input" : "'" + options.path + "'";
  if (in.bad()) throw std::runtime_error(name + ": cannot be read to its end");
  if (answers.asked() == 0) throw std::invalid_argument("--lines: " + name + " has no line to answer");
  return answers.exitStatus();
}

}  // namespace fcl_artic::app
