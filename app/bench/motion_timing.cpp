// SPDX-License-Identifier: BSD-3-Clause
#include "bench/motion_timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

namespace fcl_artic::app {
namespace {

constexpr std::size_t kDrawnForWanted = 20, kMaxClearances = 200, kMaxAskedAgain = 50;
constexpr double kMaxMicroseconds = 1e6;  // to ask again, for each row
constexpr double kTail = 0.999;

/// "contact (proven) at t = 0.25" or "free".
std::string textOf(const CertifiedResult& result) {
  if (result.status != Status::contact) return toString(result.status);
  return fmt::format("contact ({}) from t = {:.6g} to {:.6g}", result.certain ? "proven" : "not proven", result.t_lower,
                     result.t_upper);
}

/// Microseconds that a call takes.
template <class Call>
double timeOf(const Call& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

/// A row while it is measured.
struct Task {
  TimedRow row;
  const std::vector<MotionEnds>& motions;
  /// Asks about motion i. The answer stays where `check` looks.
  std::function<void(std::size_t i)> ask;
  /// Looks at the answer about motion i, in the first pass; not timed.
  std::function<void(std::size_t i, TimedRow& row)> check;
  std::size_t size = 0;  ///< of the motions, how many are asked about
};

/// Asks again about the slowest motions, until those that the row's last quantiles rest on were all asked again.
void askSlowestAgain(Task& task) {
  std::vector<double>& us = task.row.us;
  const auto rank = static_cast<std::size_t>(std::ceil(kTail * static_cast<double>(us.size())));
  std::vector<bool> again(us.size(), false);
  std::vector<std::size_t> order(us.size());
  std::iota(order.begin(), order.end(), 0);
  double spent = 0;
  for (std::size_t rounds = 0; rounds < us.size() && rounds < kMaxAskedAgain; ++rounds) {
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return us[a] < us[b]; });
    const auto slow = std::find_if(order.rbegin(), order.rend() - static_cast<std::ptrdiff_t>(rank - 1),
                                   [&](std::size_t i) { return !again[i]; });
    if (slow == order.rend() - static_cast<std::ptrdiff_t>(rank - 1)) return;
    again[*slow] = true;
    for (int pass = 0; pass < kPassesOfSlowest && spent < kMaxMicroseconds; ++pass) {
      // The caches hold another motion's data, as before.
      spent += timeOf([&] { task.ask((*slow + us.size() - 1) % us.size()); });
      const double time = timeOf([&] { task.ask(*slow); });
      spent += time;
      us[*slow] = std::min(us[*slow], time);
    }
  }
}

}  // namespace

DrawnMotions drawMotions(RandomMotions& random, std::size_t wanted, const Questions& questions,
                         std::vector<Contradiction>& contradictions, const std::function<void(double)>& progress) {
  DrawnMotions out;
  CertifiedResult first, any;
  const std::size_t most = kDrawnForWanted * wanted;
  while (out.drawn < most && (out.free.size() < wanted || out.contact.size() < wanted)) {
    MotionEnds ends = random.next();
    ++out.drawn;
    questions.collide(ends, ContactMode::first, first);
    questions.collide(ends, ContactMode::any, any);
    if (first.isFree() != any.isFree()) {
      contradictions.push_back({ends, fmt::format("first says {}, any says {}", textOf(first), textOf(any))});
    }
    const auto add = [&](std::vector<MotionEnds>& to, std::size_t& count) {
      ++count;
      if (to.size() >= wanted) return false;
      to.push_back(std::move(ends));
      return true;
    };
    if (first.isFree()) {
      add(out.free, out.drawn_free);
    } else if (first.t_lower <= 0) {
      add(out.touching, out.drawn_touching);
    } else if (add(out.contact, out.drawn_contact)) {
      out.proven.push_back(first.certain);
    }
    progress(static_cast<double>(out.drawn) / static_cast<double>(most));
  }
  return out;
}

double TimedRow::mean() const {
  return us.empty() ? 0 : std::accumulate(us.begin(), us.end(), 0.0) / static_cast<double>(us.size());
}

double TimedRow::quantile(double share) const {
  if (us.empty()) return 0;
  std::vector<double> sorted = us;
  const double rank = std::ceil(share * static_cast<double>(us.size()));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1;
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

std::vector<TimedRow> timeMotions(const DrawnMotions& drawn, int passes, const Questions& questions,
                                  std::vector<Contradiction>& contradictions,
                                  const std::function<void(double)>& progress, const std::string& only) {
  struct Kind {
    const char* name;
    const std::vector<MotionEnds>& motions;
    bool free;
  };
  const Kind kinds[] = {
      {"free", drawn.free, true}, {"contact", drawn.contact, false}, {"touching at the start", drawn.touching, false}};
  CertifiedResult result;
  std::optional<double> sample;
  std::vector<Task> tasks;
  const auto add = [&](Task task) {
    if (only.empty() || task.row.name() == only) tasks.push_back(std::move(task));
  };
  for (const Kind& kind : kinds) {
    for (const ContactMode mode : {ContactMode::first, ContactMode::any}) {
      const char* question = mode == ContactMode::first ? "first" : "any";
      add({{kind.name, question, {}, 0},
           kind.motions,
           [&, mode](std::size_t i) { questions.collide(kind.motions[i], mode, result); },
           [&, question](std::size_t i, TimedRow&) {
             if (result.isFree() == kind.free) return;
             contradictions.push_back({kind.motions[i], fmt::format("asked again, {} says {}; it was {}", question,
                                                                    textOf(result), kind.name)});
           },
           kind.motions.size()});
    }
  }
  add({{"free", "clearance", {}, 0},
       drawn.free,
       [&](std::size_t i) { questions.clearance(drawn.free[i]); },
       [](std::size_t, TimedRow&) {},
       std::min(kMaxClearances, drawn.free.size())});
  const auto sampled = [&](const Kind& kind, const std::function<void(std::size_t, TimedRow&)>& check) {
    add({{kind.name, "FCL, 1 %", {}, 0},
         kind.motions,
         [&](std::size_t i) { sample = questions.sampleInContact(kind.motions[i]); },
         check,
         kind.motions.size()});
  };
  if (questions.sampleInContact) {
    sampled(kinds[0], [&](std::size_t i, TimedRow&) {
      if (!sample) return;
      contradictions.push_back({drawn.free[i], fmt::format("proven free, FCL says contact at t = {:.6g}", *sample)});
    });
    sampled(kinds[1], [&](std::size_t i, TimedRow& row) { row.missed += !sample && drawn.proven[i]; });
  }

  double all = 0, done = 0;
  for (Task& task : tasks) {
    task.row.us.assign(task.size, std::numeric_limits<double>::infinity());
    all += static_cast<double>(task.size) * passes;
  }
  for (int pass = 0; pass < passes; ++pass) {
    for (Task& task : tasks) {
      for (std::size_t i = 0; i < task.size; ++i) {
        task.row.us[i] = std::min(task.row.us[i], timeOf([&] { task.ask(i); }));
        if (pass == 0) task.check(i, task.row);
        progress(++done / all);
      }
    }
  }
  for (Task& task : tasks) askSlowestAgain(task);
  std::vector<TimedRow> rows;
  for (Task& task : tasks) rows.push_back(std::move(task.row));
  return rows;
}

}  // namespace fcl_artic::app
