// SPDX-License-Identifier: BSD-3-Clause
#include "certification.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "elapsed.h"
#include "exit_status.h"
#include "files/files.h"
#include "pair_options.h"
#include "plans/write.h"
#include "progress.h"
#include "query_options.h"

namespace fcl_artic::app {
namespace {

namespace fs = std::filesystem;

/// @param[out] notes  gets a line about what of a folder is no plan.
std::vector<std::string> filesOf(const std::string& path, std::vector<std::string>& notes) {
  std::error_code none;
  if (!fs::is_directory(path, none)) return {path};
  std::vector<std::string> files, others;
  for (const auto& entry : fs::directory_iterator(path)) {
    const bool plan = !entry.is_directory() && plans::hasPlanEnding(entry.path().string());
    const std::string name = entry.path().filename().string();
    plan ? files.push_back(entry.path().string()) : others.push_back(entry.is_directory() ? name + "/" : name);
  }
  std::sort(others.begin(), others.end());
  constexpr std::size_t kShown = 5;
  std::string shown;
  for (std::size_t i = 0; i < std::min(kShown, others.size()); ++i) shown += (i ? ", " : "") + others[i];
  if (others.size() > kShown) shown += fmt::format(" and {} more", others.size() - kShown);
  if (!others.empty())
    notes.push_back(fmt::format("'{}': passed over, as folders or without a plan's ending: {}", path, shown));
  if (files.empty()) throw std::invalid_argument(fmt::format("'{}': no file of this folder has a plan's ending", path));
  std::sort(files.begin(), files.end());
  return files;
}

void readFile(const KinematicTree& tree, const std::string& file, const std::optional<plans::Format>& format,
              const plans::ColumnOptions& columns, std::vector<CertifiedPlan>& out) {
  try {
    const plans::Format kind = format ? *format : plans::formatOf(file);
    for (plans::Plan& plan : plans::parsePlans(tree, files::read(file == "-" ? "/dev/stdin" : file), kind, columns)) {
      CertifiedPlan& one = out.emplace_back();
      one.file = file;
      one.plan = std::move(plan);
    }
  } catch (const std::exception& error) {
    CertifiedPlan& one = out.emplace_back();
    one.file = file;
    one.plan.error = error.what();
  }
}

// How far the clearance of a mended plan is looked at: beyond what was asked for, but not all the way.
constexpr double kClearanceShown = 4, kLeastShown = 0.01;  // the latter in m

NamePair namesOf(const BodyRef& a, const BodyRef& b) {
  return std::minmax(a.name, b.name);
}

MendPairs mendPairsOf(const ArticulatedCollisionManager& manager, const CertifiedPlan& plan,
                      const MendOptions& mending) {
  MendPairs pairs;
  for (const auto& [a, b] : plan.result.ignored_initial_contacts) pairs.ignored.insert(namesOf(a, b));
  CertifiedRequest near;
  static_cast<Scope&>(near) = mending.request;
  near.margin = mending.request.margin + mending.clearance;
  near.mode = ContactMode::firstOfEveryPair;
  near.max_contacts = std::numeric_limits<std::int32_t>::max();
  for (const Eigen::VectorXd& q : {plan.motion->waypoints.front(), plan.motion->waypoints.back()}) {
    for (const CertifiedContact& contact : manager.collide(q, near).contacts) {
      const NamePair names = namesOf(contact.body1, contact.body2);
      if (pairs.ignored.count(names) == 0) pairs.near.insert(names);
    }
  }
  return pairs;
}

}  // namespace

std::string CertifiedPlan::title() const {
  return plan.name.empty() ? file : file + " " + plan.name;
}

int CertifiedPlan::ownExitStatus() const {
  if (!error.empty()) return kExitError;
  return worseExit(app::exitStatus(result), line ? line->exitStatus() : kExitFree);
}

int CertifiedPlan::exitStatus() const {
  return as_mended ? as_mended->exitStatus() : ownExitStatus();
}

std::vector<CertifiedPlan> readPlans(const KinematicTree& tree, const std::vector<std::string>& paths,
                                     const std::optional<plans::Format>& format, const plans::ColumnOptions& columns,
                                     std::vector<std::string>& notes) {
  std::error_code none;
  for (const std::string& path : paths) {
    if (format || fs::is_directory(path, none) || plans::hasPlanEnding(path)) continue;
    throw std::invalid_argument(fmt::format(
        "'{}' is no plan by its ending: if it is one, --format says what it is; each scene has a --scene of its own",
        path));
  }
  std::vector<CertifiedPlan> out;
  for (const std::string& path : paths) {
    for (const std::string& file : filesOf(path, notes)) readFile(tree, file, format, columns, out);
  }
  return out;
}

void certify(const ArticulatedCollisionManager& manager, const CertifyOptions& options, CertifiedPlan& plan) {
  plan.notes = plans::notesOf(plan.plan, options.motion.degrees);
  try {
    plan.motion = plans::toMotion(manager.tree(), plan.plan, options.motion);
    plan.notes = plan.motion->notes;
    if (manager.hasSpeeds()) plans::requireClock(*plan.motion);
    plans::requireCarried(manager.tree(), plan.plan, options.attached, "--attach says what that is");
    const auto begin = Clock::now();
    manager.continuousCollide(plan.motion->trajectory, options.request, plan.result);
    plan.us = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
    const CertifiedContact* first = plan.result.first();
    if (first && plan.result.t_lower <= plan.motion->trajectory.beginTime()) {
      plan.notes.insert(plan.notes.begin(), startHint(*first));
    }
    if (options.line) plan.line = askToolLine(manager.tree(), plan.motion->trajectory, *options.line);
    if (options.clearance) {
      plan.clearance = manager.clearance(plan.motion->trajectory, clearanceOf(*options.clearance, options.request));
    }
  } catch (const std::exception& error) {
    plan.error = error.what();
    plan.motion.reset();
  }
}

void certify(const ArticulatedCollisionManager& manager, const CertifyOptions& options,
             std::vector<CertifiedPlan>& plans) {
  const auto wanted = static_cast<std::size_t>(options.threads > 0 ? options.threads
                                                                   : std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t done = 0;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < plans.size();) {
      certify(manager, options, plans[i]);
      const std::lock_guard<std::mutex> lock(mutex);
      if (++done == plans.size()) changed.notify_one();
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < std::min(wanted, plans.size()); ++i) threads.emplace_back(work);
  {
    ProgressBar bar;
    std::unique_lock<std::mutex> lock(mutex);
    while (!changed.wait_for(lock, std::chrono::milliseconds(100), [&] { return done == plans.size(); })) {
      bar.show(static_cast<double>(done) / static_cast<double>(plans.size()));
    }
  }
  for (std::thread& thread : threads) thread.join();
}

void mendAll(const std::shared_ptr<const ArticulatedCollisionManager>& manager, const CertifyOptions& options,
             const MendOptions& mending, std::vector<CertifiedPlan>& plans, const ManagerForMending& managerFor) {
  std::map<MendPairs, std::shared_ptr<const ArticulatedCollisionManager>> managers{{{}, manager}};
  std::vector<CertifiedPlan*> touching;
  for (CertifiedPlan& plan : plans) {
    if (plan.error.empty() && plan.result.status == Status::contact) touching.push_back(&plan);
  }
  ProgressBar bar;
  double done = 0;
  for (CertifiedPlan* plan : touching) {
    try {
      const MendPairs pairs = managerFor ? mendPairsOf(*manager, *plan, mending) : MendPairs();
      std::shared_ptr<const ArticulatedCollisionManager>& own = managers[pairs];
      if (!own) own = managerFor(pairs, mending.request.margin);
      plan->mended = mend(own, *plan->motion, options.motion.turns, mending);
      plan->mended->plan.name = plan->plan.name;
      const std::string written = plans::writePlans({plan->mended->plan}, plans::Format::json);
      auto again = std::make_shared<CertifiedPlan>();
      again->file = plan->file;
      again->plan = plans::parsePlans(manager->tree(), written, plans::Format::json).at(0);
      CertifyOptions straight = options;
      straight.motion.interpolation = plans::Interpolation::linear;
      straight.motion.joints.clear();  // it names all joints, and their values
      straight.motion.state.clear();
      straight.motion.degrees = false;              // it is in rad
      straight.motion.turns = plans::Turns::given;  // its steps are what was proven
      if (!straight.clearance) {
        straight.clearance.emplace();
        straight.clearance->most = kClearanceShown * (mending.request.margin + mending.clearance) + kLeastShown;
      }
      certify(*manager, straight, *again);
      plan->as_mended = again;
    } catch (const std::runtime_error& error) {
      plan->not_mended = error.what();
    }
    bar.show(++done / static_cast<double>(touching.size()));
  }
}

}  // namespace fcl_artic::app
