// SPDX-License-Identifier: BSD-3-Clause
#include "harness.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>

namespace campaign {
namespace {

template <class T>
const T* find(const Tally::Named<T>& all, const std::string& name) {
  for (const auto& [known, value] : all)
    if (known == name) return &value;
  return nullptr;
}

/// Looks at one case, and counts it with its faults.
void lookAt(const Campaign& campaign, Case& c) {
  c.tally.count("cases");
  try {
    campaign.look(c);
  } catch (const std::exception& e) {
    c.fault("threw", e.what());
  }
  std::map<std::string, int> seen;
  for (const Finding& f : c.findings)
    if (++seen[f.fault] == 1) c.tally.fault(f.fault);
}

int widthOf(const std::string& column) {
  return static_cast<int>(std::max<std::size_t>(column.size(), 6));
}

std::string head(const Tally& total) {
  std::string out = format("%-24s", "class");
  for (const auto& [column, n] : total.counts()) out += format(" %*s", widthOf(column), column.c_str());
  return out + " | cases with faults\n";
}

std::string row(const std::string& name, const Tally& tally, const Tally& total) {
  std::string out = format("%-24s", name.c_str());
  for (const auto& [column, n] : total.counts())
    out += format(" %*llu", widthOf(column), static_cast<unsigned long long>(tally[column]));
  out += " |";
  for (const auto& [kind, cases] : tally.faultKinds())
    out += format(" %s %llu", kind.c_str(), static_cast<unsigned long long>(cases));
  return out + (tally.faults() ? "\n" : " none\n");
}

/// Quantities and mutants.
std::string details(const Tally& tally) {
  std::string out;
  for (const auto& [name, values] : tally.notes())
    out +=
        format("%s of %zu: least %.3g, median %.3g, p95 %.3g, most %.3g\n", name.c_str(), values.size(),
               tally.quantile(name, 0), tally.quantile(name, 0.5), tally.quantile(name, 0.95), tally.quantile(name, 1));
  for (const auto& [name, m] : tally.mutants())
    out += format("spoilt on purpose, %s: %llu, of these seen %llu\n", name.c_str(),
                  static_cast<unsigned long long>(m.spoilt), static_cast<unsigned long long>(m.seen));
  return out;
}

}  // namespace

std::uint64_t fromEnvironment(const char* name, std::uint64_t usual) {
  const char* wanted = std::getenv(name);
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}

std::string format(const char* text, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, text);
  std::vsnprintf(line, sizeof line, text, arguments);
  va_end(arguments);
  return line;
}

void Tally::mutant(const std::string& name, double share, bool applied, bool seen) {
  Mutant& m = entry(mutants_, name);
  m.share = share;
  m.spoilt += applied;
  m.seen += seen;
}

void Tally::add(const Tally& other) {
  for (const auto& [name, n] : other.counts_) count(name, n);
  for (const auto& [name, values] : other.notes_) {
    std::vector<float>& own = entry(notes_, name);
    own.insert(own.end(), values.begin(), values.end());
  }
  for (const auto& [name, m] : other.mutants_) {
    Mutant& own = entry(mutants_, name);
    own = {m.share, own.spoilt + m.spoilt, own.seen + m.seen};
  }
  for (const auto& [kind, cases] : other.faults_) faults_[kind] += cases;
}

std::uint64_t Tally::operator[](const std::string& name) const {
  const std::uint64_t* n = find(counts_, name);
  return n ? *n : 0;
}

double Tally::share(const std::string& name, const std::string& of) const {
  return static_cast<double>((*this)[name]) / static_cast<double>(std::max<std::uint64_t>(1, (*this)[of]));
}

double Tally::quantile(const std::string& note, double part) const {
  const std::vector<float>* values = find(notes_, note);
  if (!values || values->empty()) return 0;
  std::vector<float> sorted = *values;
  std::sort(sorted.begin(), sorted.end());
  return static_cast<double>(sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))]);
}

std::uint64_t Tally::faults(const std::string& kind) const {
  const auto found = faults_.find(kind);
  return found == faults_.end() ? 0 : found->second;
}

std::uint64_t Tally::faults() const {
  std::uint64_t n = 0;
  for (const auto& [kind, cases] : faults_) n += cases;
  return n;
}

Report run(const Campaign& campaign, const Options& options) {
  const auto& families = campaign.families;
  if (!options.family.empty() && std::find(families.begin(), families.end(), options.family) == families.end())
    throw std::invalid_argument("the campaign has no class '" + options.family + "'");
  Report report;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  std::vector<std::pair<std::uint64_t, Failure>> failures;
  const auto work = [&] {
    std::map<std::string, Tally> tallies;
    for (std::uint64_t i; (i = next++) < options.cases;) {
      CaseId id = campaign.number(options.seed, i);
      if (!options.family.empty()) id.family = options.family;
      Case c{i, id, options.mutants, tallies[id.family], {}};
      lookAt(campaign, c);
      if (!c.findings.empty()) {
        const std::lock_guard<std::mutex> lock(mutex);
        failures.push_back({i, {id, std::move(c.findings)}});
      }
      if (options.progress) options.progress(i + 1);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (const auto& [family, tally] : tallies) report.families[family].add(tally);
  };
  const auto begin = std::chrono::steady_clock::now();
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> threads;
  for (unsigned t = options.threads > 0 ? static_cast<unsigned>(options.threads) : cores; t > 0; --t)
    threads.emplace_back(work);
  for (std::thread& t : threads) t.join();
  report.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& [family, tally] : report.families) report.total.add(tally);
  std::sort(failures.begin(), failures.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < failures.size() && i < 1000; ++i)
    report.failures.push_back(std::move(failures[i].second));
  return report;
}

bool replay(const Campaign& campaign, const CaseId& id, std::string& words) {
  Tally tally;
  Case c{0, id, false, tally, {}, &words};
  lookAt(campaign, c);
  for (const Finding& f : c.findings) words += "# FAULT " + f.fault + ": " + f.text + "\n";
  return c.findings.empty();
}

std::string toText(const std::string& name, const Tally& tally) {
  return head(tally) + row(name, tally, tally) + details(tally);
}

std::string toText(const Report& report) {
  std::string out = head(report.total);
  for (const auto& [family, tally] : report.families)
    if (!family.empty()) out += row(family, tally, report.total);
  out += row("all", report.total, report.total) + details(report.total);
  out += format("%.1f s, %.0f cases/s\n", report.elapsed_s,
                static_cast<double>(report.total["cases"]) / std::max(1e-9, report.elapsed_s));
  // The first few of each kind, as one kind can be much more frequent than a worse one.
  std::map<std::string, int> shown;
  for (const Failure& f : report.failures) {
    const std::string family = f.id.family.empty() ? "" : "--class " + f.id.family + " ";
    for (const Finding& finding : f.findings) {
      if (++shown[finding.fault] > 8) continue;
      out += format("%s--replay %llu: %s: ", family.c_str(), static_cast<unsigned long long>(f.id.seed),
                    finding.fault.c_str()) +
             finding.text + "\n";
    }
  }
  return out;
}

}  // namespace campaign
