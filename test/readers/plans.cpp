// SPDX-License-Identifier: BSD-3-Clause
// Plans: one of random joints, times and rates, in all formats and layouts.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "harness.h"
#include "plans/motion.h"
#include "plans/plan.h"

namespace fcl_artic::test {
namespace {

const std::vector<std::string> kJoints{"hinge", "rail", "wheel"};

KinematicTree armOfPlans() {
  KinematicTree tree("arm");
  for (const char* link : {"base", "a", "b", "c"}) tree.addLink(link);
  tree.addJoint(Joint::revolute("hinge", "base", "a", Eigen::Vector3d::UnitZ()));
  tree.addJoint(Joint::prismatic("rail", "a", "b", Eigen::Vector3d::UnitX()));
  tree.addJoint(Joint::continuous("wheel", "b", "c", Eigen::Vector3d::UnitZ()));
  return tree;
}

/// A number that all formats have, and the double nearest to it by the C library.
struct PlanNumber {
  std::string text;
  double value;
};
struct PlanText {
  std::vector<std::size_t> order;                                             ///< of the columns: numbers of joints
  std::vector<std::vector<PlanNumber>> positions, velocities, accelerations;  ///< by column
  std::vector<long> seconds, nanoseconds;                                     ///< none: not timed
  bool timed() const { return !seconds.empty(); }
  std::string name(std::size_t column) const { return kJoints[order[column]]; }
};

class PlanWriter {
 public:
  PlanWriter(Random& random, std::string format) : random_(random), format_(std::move(format)) {}

  RandomFile write() {
    const bool may_be_timed = format_ != "path" && format_ != "npy";
    const bool named = format_ != "path" && format_ != "npy" && below(random_, 4) > 0;
    PlanText plan;
    plan.order = {0, 1, 2};
    if (named) std::shuffle(plan.order.begin(), plan.order.end(), random_);
    const bool timed = may_be_timed && coin(random_), velocities = timed && named && coin(random_),
               accelerations = velocities && coin(random_);
    long second = 0;
    for (int k = 0, rows = 2 + below(random_, 6); k < rows; ++k) {
      plan.positions.push_back(row());
      if (velocities) plan.velocities.push_back(row());
      if (accelerations) plan.accelerations.push_back(row());
      if (!timed) continue;
      plan.seconds.push_back(second += 1 + below(random_, 3));
      plan.nanoseconds.push_back(below(random_, 1000000000));
    }
    RandomFile file;
    file.name = "written." + format_;
    const auto doubleOf = [&](std::size_t k) {
      return static_cast<double>(plan.seconds[k]) + 1e-9 * static_cast<double>(plan.nanoseconds[k]);
    };
    message_ = format_ != "csv" && named && timed && coin(random_);
    file.content = format_ == "csv"                                 ? csv(plan, named)
                   : format_ == "path"                              ? path(plan)
                   : format_ == "npy"                               ? npy(plan)
                   : format_ == "yaml" && message_ && coin(random_) ? block(plan)
                                                                    : document(plan, named);
    if (format_ == "yaml" || format_ == "jsonl") file.content += "\n";
    for (std::size_t k = 0; k < plan.positions.size(); ++k) {
      const auto add = [&](const char* what, const std::vector<std::vector<PlanNumber>>& rows) {
        if (rows.empty()) return;
        Item item{what, std::vector<double>(3)};
        for (std::size_t c = 0; c < 3; ++c) item.numbers[plan.order[c]] = rows[k][c].value;
        file.reading.push_back(item);
      };
      const double time = !timed     ? static_cast<double>(k)
                          : message_ ? doubleOf(k)
                                     : std::strtod(timeText(plan, k).c_str(), nullptr);
      file.reading.push_back({"time", {time}});
      add("position", plan.positions);
      add("velocity", plan.velocities);
      add("acceleration", plan.accelerations);
    }
    return file;
  }

 private:
  std::vector<PlanNumber> row() {
    std::vector<PlanNumber> out;
    for (int c = 0; c < 3; ++c) {
      char text[40];
      const double x = randomNumber(random_, -3, 3) + (coin(random_) ? randomNumber(random_, 0, 1) * 1e-7 : 0);
      std::snprintf(text, sizeof text, coin(random_) ? "%.*g" : "%.*e", 1 + below(random_, 17), x);
      out.push_back({text, std::strtod(text, nullptr)});
    }
    return out;
  }
  static std::string timeText(const PlanText& plan, std::size_t k) {
    char text[40];
    std::snprintf(text, sizeof text, "%ld.%09ld", plan.seconds[k], plan.nanoseconds[k]);
    return text;
  }
  std::string blank() { return oneOf<std::string>(random_, {"", "", " ", "  "}); }

  std::string csv(const PlanText& plan, bool named) {
    const std::string end = coin(random_) ? "\n" : "\r\n";
    const std::string between = oneOf<std::string>(random_, {",", ", ", ";", "\t", " "});
    const std::string quote = between[0] == ',' && coin(random_) ? "\"" : "";
    const auto pause = [&] {
      return below(random_, 6) == 0 ? oneOf<std::string>(random_, {"# a note", "", "  "}) + end : std::string();
    };
    std::string out = below(random_, 4) == 0 ? "\xEF\xBB\xBF" : "", head;
    const auto cell = [&](std::string& line, const std::string& text) {
      line += (line.empty() ? "" : between) + quote + text + quote;
    };
    if (plan.timed()) cell(head, oneOf<std::string>(random_, {"time", "t", "time_from_start"}));
    const std::string numbered = oneOf<std::string>(random_, {"q1", "joint_1", "j0", "actual_q_0"});
    const auto names = [&](const std::vector<std::vector<PlanNumber>>& rows, const std::string& ending) {
      for (std::size_t c = 0; c < 3 && !rows.empty(); ++c) {
        std::string name = plan.name(c);
        if (!named) {
          name = numbered;
          name.back() = static_cast<char>(name.back() + static_cast<char>(c));
        }
        cell(head, name + ending);
      }
    };
    names(plan.positions, "");
    names(plan.velocities, coin(random_) ? "/velocity" : "_vel");
    names(plan.accelerations, coin(random_) ? ".acceleration" : "_acc");
    const int kind = named ? below(random_, 3) : below(random_, 2);
    if (kind != 0 || named) out += (named && kind == 0 ? "# " : pause()) + head + end;
    for (std::size_t k = 0; k < plan.positions.size(); ++k) {
      std::string line;
      if (plan.timed()) cell(line, timeText(plan, k));
      for (const auto* rows : {&plan.positions, &plan.velocities, &plan.accelerations}) {
        for (std::size_t c = 0; c < 3 && !rows->empty(); ++c) cell(line, (*rows)[k][c].text);
      }
      out += line + end;
      if (k > 0 || kind != 0) out += pause();
    }
    return out;
  }

  std::string list(const std::vector<PlanNumber>& row) {
    std::string out = "[";
    for (const PlanNumber& d : row) out += (out.size() > 1 ? ", " : "") + d.text;
    return out + "]";
  }
  std::string object(const PlanText& plan, const std::vector<PlanNumber>& row) {
    std::vector<std::string> entries;
    for (std::size_t c = 0; c < 3; ++c) entries.push_back("\"" + plan.name(c) + "\": " + row[c].text);
    std::shuffle(entries.begin(), entries.end(), random_);
    return "{" + entries[0] + ", " + entries[1] + ", " + entries[2] + "}";
  }
  std::string trajectory(const PlanText& plan) {
    std::string out = "{\"joint_names\": [\"" + plan.name(0) + "\", \"" + plan.name(1) + "\", \"" + plan.name(2) +
                      "\"], \"points\": [";
    for (std::size_t k = 0; k < plan.positions.size(); ++k) {
      std::vector<std::string> entries{"\"positions\": " + list(plan.positions[k]),
                                       "\"time_from_start\": " + duration(plan, k)};
      if (!plan.velocities.empty()) entries.push_back("\"velocities\": " + list(plan.velocities[k]));
      if (!plan.accelerations.empty()) entries.push_back("\"accelerations\": " + list(plan.accelerations[k]));
      std::shuffle(entries.begin(), entries.end(), random_);
      out += k > 0 ? ", {" : "{";
      for (std::size_t e = 0; e < entries.size(); ++e) out += (e > 0 ? ", " : "") + entries[e];
      out += "}";
    }
    return out + "]}";
  }
  std::string duration(const PlanText& plan, std::size_t k) {
    const std::string s = std::to_string(plan.seconds[k]), n = std::to_string(plan.nanoseconds[k]);
    return coin(random_) ? "{\"sec\": " + s + ", \"nanosec\": " + n + "}"
                         : "{\"nsecs\": " + n + ", \"secs\": " + s + "}";
  }
  std::string document(const PlanText& plan, bool named) {
    if (message_) {
      const std::string inner = trajectory(plan);
      switch (below(random_, 4)) {
        case 0:
          return inner;
        case 1:
          return "{\"joint_trajectory\": " + inner +
                 ", \"multi_dof_joint_trajectory\": {\"joint_names\": [], \"points\": []}}";
        case 2:
          return "{\"model_id\": \"arm\", \"trajectory\": [{\"joint_trajectory\": " + inner + "}]}";
        default:
          return "{\"goal\": {\"trajectory\": " + inner + ", \"goal_tolerance\": []}}";
      }
    }
    const bool objects = named && coin(random_);
    std::vector<std::string> entries;
    const auto rows = [&](const char* key, const std::vector<std::vector<PlanNumber>>& of) {
      if (of.empty()) return;
      std::string text = std::string("\"") + key + "\": [";
      for (std::size_t k = 0; k < of.size(); ++k)
        text += (k > 0 ? ", " : "") + (objects ? object(plan, of[k]) : list(of[k]));
      entries.push_back(text + "]");
    };
    rows("waypoints", plan.positions);
    rows("velocities", plan.velocities);
    rows("accelerations", plan.accelerations);
    if (named && !objects)
      entries.push_back("\"joints\": [\"" + plan.name(0) + "\", \"" + plan.name(1) + "\", \"" + plan.name(2) + "\"]");
    if (plan.timed()) {
      std::string text = "\"times\": [";
      for (std::size_t k = 0; k < plan.seconds.size(); ++k) text += (k > 0 ? ", " : "") + timeText(plan, k);
      entries.push_back(text + "]");
    }
    std::shuffle(entries.begin(), entries.end(), random_);
    std::string out = "{";
    for (std::size_t e = 0; e < entries.size(); ++e) out += (e > 0 ? ", " : "") + entries[e];
    out += "}";
    return coin(random_) ? "{\"plans\": [" + out + "]}" : out;
  }

  /// As `ros2 topic echo` prints a trajectory.
  std::string block(const PlanText& plan) {
    std::string out = "header:\n  frame_id: ''\njoint_names:\n";
    for (std::size_t c = 0; c < 3; ++c) out += "- " + plan.name(c) + "\n";
    out += "points:\n";
    for (std::size_t k = 0; k < plan.positions.size(); ++k) {
      const auto rows = [&](const char* key, const std::vector<PlanNumber>& row) {
        out += std::string(key) + ":\n";
        for (const PlanNumber& d : row) out += "  - " + d.text + "\n";
      };
      rows("- positions", plan.positions[k]);
      if (!plan.velocities.empty()) rows("  velocities", plan.velocities[k]);
      if (!plan.accelerations.empty()) rows("  accelerations", plan.accelerations[k]);
      out += "  time_from_start:\n    sec: " + std::to_string(plan.seconds[k]) +
             "\n    nanosec: " + std::to_string(plan.nanoseconds[k]) + "\n";
    }
    return out + (coin(random_) ? "---\n" : "");
  }

  std::string path(const PlanText& plan) {
    const int kind = below(random_, 3);
    std::string out = kind == 0 ? "" : "Geometric path with " + std::to_string(plan.positions.size()) + " states\n";
    for (const auto& row : plan.positions) {
      if (kind == 0) out += row[0].text + " " + row[1].text + " " + row[2].text + " \n";
      if (kind == 1) out += "RealVectorState [" + row[0].text + " " + row[1].text + " " + row[2].text + "]\n";
      if (kind == 2) {
        out += "Compound state [\nSO2State [" + row[0].text + "]\nCompound state [\nRealVectorState [" + row[1].text +
               "]\n]\nSO2State [" + row[2].text + "]\n]\n";
      }
    }
    return out + (coin(random_) ? "\n" : "");
  }

  /// Changes the numbers to what the type holds.
  std::string npy(PlanText& plan) {
    const std::string type = oneOf<std::string>(random_, {"<f8", ">f8", "<f4", "=f8", ">i2", "|i1", "<i8"});
    const bool fortran = coin(random_), swap = type[0] == '>';
    const std::size_t rows = plan.positions.size();
    std::string body;
    for (std::size_t i = 0; i < 3 * rows; ++i) {
      PlanNumber& d = fortran ? plan.positions[i % rows][i / rows] : plan.positions[i / 3][i % 3];
      const auto add = [&](auto value) {
        d.value = static_cast<double>(value);
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        if (swap) std::reverse(bytes, bytes + sizeof value);
        body.append(bytes, sizeof value);
      };
      if (type.substr(1) == "f8") add(d.value);
      if (type.substr(1) == "f4") add(static_cast<float>(d.value));
      if (type.substr(1) == "i1") add(static_cast<signed char>(d.value));
      if (type.substr(1) == "i2") add(static_cast<short>(d.value));
      if (type.substr(1) == "i8") add(static_cast<long>(d.value));
    }
    std::string header = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': (" +
                         std::to_string(rows) + ", 3), }";
    header.resize(118, ' ');
    return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + body;
  }

  Random& random_;
  const std::string format_;
  bool message_ = false;
};

Reading readPlan(const RandomFile& file, const std::string&) {
  using namespace plans;
  const KinematicTree tree = armOfPlans();
  const Plan plan = parsePlans(tree, file.content, formatOf(file.name)).at(0);
  MotionOptions options;
  options.turns = Turns::given;
  options.ignore_limits = true;
  const PlanMotion motion = toMotion(tree, plan, options);
  Reading out;
  for (std::size_t k = 0; k < motion.times.size(); ++k) {
    out.push_back({"time", {motion.times[k]}});
    out.push_back({"position", {motion.waypoints[k][0], motion.waypoints[k][1], motion.waypoints[k][2]}});
    const auto add = [&](const char* what, const Plan::Rows& rows) {
      if (rows.empty()) return;
      Item item{what, std::vector<double>(3)};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = std::find(kJoints.begin(), kJoints.end(), motion.joints.at(c));
        item.numbers.at(static_cast<std::size_t>(at - kJoints.begin())) = rows.at(k).at(c);
      }
      out.push_back(item);
    };
    add("velocity", plan.velocities);
    add("acceleration", plan.accelerations);
  }
  return out;
}

}  // namespace

void addPlanFormats(std::vector<FileFormat>& formats) {
  const std::vector<std::pair<std::string, std::string>> of_documents{
      {"forgets the joints", ",? ?\"joints\": \\[[^\\]]*\\]"}, {"forgets the times", ",? ?\"times\": \\[[^\\]]*\\]"}};
  for (const char* name : {"csv", "json", "jsonl", "yaml", "path", "npy"}) {
    const std::string format = name;
    const bool is_document = format[0] == 'j' || format[0] == 'y';
    formats.push_back({format, [format](Random& random) { return PlanWriter(random, format).write(); }, readPlan,
                       is_document ? of_documents : FileFormat().faults, false});
  }
}

}  // namespace fcl_artic::test
