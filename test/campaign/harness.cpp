// SPDX-License-Identifier: BSD-3-Clause
#include "harness.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
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

std::string nameOf(const Campaign& campaign, const CaseId& id) {
  std::string name = campaign.name.empty() ? "case" : campaign.name;
  if (!id.family.empty()) name += "-" + id.family;
  return name + "-" + std::to_string(id.seed);
}

/// Looks at a failed case once more, so that it writes its queries, and says how they are asked again.
std::string writeQueries(const Campaign& campaign, const Failure& failure, const std::string& folder) {
  Tally unused;
  QueryFiles files(folder, nameOf(campaign, failure.id));
  Case c{failure.index, failure.id, false, unused, {}, nullptr, &files};
  lookAt(campaign, c);
  return files.lines();
}

/// Failure::words of all.
void describe(const Campaign& campaign, const std::string& folder, std::vector<Failure>& failures) {
  constexpr int kOfEachKind = 8;
  std::map<std::string, int> shown;
  for (Failure& f : failures) {
    const std::string family = f.id.family.empty() ? "" : "--class " + f.id.family + " ";
    for (const Finding& finding : f.findings) {
      if (++shown[finding.fault] > kOfEachKind) continue;
      f.words += format("case %llu, %s--replay %llu: %s: ", static_cast<unsigned long long>(f.index), family.c_str(),
                        static_cast<unsigned long long>(f.id.seed), finding.fault.c_str()) +
                 finding.text + "\n";
    }
    if (!f.words.empty() && !folder.empty()) f.words += writeQueries(campaign, f, folder);
  }
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

Options optionsOfTest(const std::string& name, std::uint64_t cases, std::uint64_t seed) {
  Options o;
  o.cases = fromEnvironment((name + "_CASES").c_str(), cases);
  o.seed = fromEnvironment((name + "_SEED").c_str(), seed);
  o.threads = 1;
  return o;
}

std::string format(const char* text, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, text);
  std::vsnprintf(line, sizeof line, text, arguments);
  va_end(arguments);
  return line;
}

std::string QueryFiles::usualFolder() {
  const char* wanted = std::getenv("FCL_ARTIC_FAILED_CASES");
  return wanted ? wanted : "failed_cases";
}

QueryFiles::QueryFiles(std::string folder, const std::string& name) : folder_(std::move(folder)), name_(name) {
  for (char& c : name_)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
}

void QueryFiles::add(const std::function<std::string()>& text) {
  ++queries_;
  try {
    const std::string query = text();
    std::filesystem::create_directories(folder_);
    const std::string file =
        (std::filesystem::path(folder_) / (name_ + "-" + std::to_string(queries_) + ".json")).string();
    if (!(std::ofstream(file, std::ios::binary) << query << std::flush))
      throw std::runtime_error("can't write " + file);
    lines_ += "  fcl_artic check --replay " + file + "\n";
  } catch (const std::exception& e) {
    const std::string line = std::string("  no replay file: ") + e.what() + "\n";
    if (lines_.find(line) == std::string::npos) lines_ += line;
  }
}

std::string QueryFiles::lines() const {
  return queries_ > 0 ? lines_ : "  no replay file: the case has asked no query\n";
}

void Case::queryWithoutFile(const std::string& reason) {
  query([&]() -> std::string { throw std::invalid_argument(reason); });
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
  std::vector<Failure> failures;
  const auto work = [&] {
    std::map<std::string, Tally> tallies;
    for (std::uint64_t i; (i = next++) < options.cases;) {
      CaseId id = campaign.number(options.seed, i);
      if (!options.family.empty()) id.family = options.family;
      Case c{i, id, options.mutants, tallies[id.family], {}};
      lookAt(campaign, c);
      if (!c.findings.empty()) {
        const std::lock_guard<std::mutex> lock(mutex);
        failures.push_back({i, id, std::move(c.findings), {}});
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
  std::sort(failures.begin(), failures.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  failures.resize(std::min<std::size_t>(failures.size(), 1000));
  describe(campaign, options.folder, failures);
  report.failures = std::move(failures);
  return report;
}

bool replay(const Campaign& campaign, const CaseId& id, const std::string& folder, std::string& words) {
  Tally tally;
  QueryFiles files(folder, nameOf(campaign, id));
  Case c{0, id, false, tally, {}, &words, folder.empty() ? nullptr : &files};
  lookAt(campaign, c);
  for (const Finding& f : c.findings) words += "FAULT " + f.fault + ": " + f.text + "\n";
  if (!folder.empty()) words += files.lines();
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
  for (const Failure& f : report.failures) out += f.words;
  return out;
}

}  // namespace campaign
