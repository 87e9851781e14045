// SPDX-License-Identifier: BSD-3-Clause
//
// The harness of all campaigns: many random cases are put to the library, and judges that share nothing with it look at
// its answers.
//
//   case    is made from its class and its seed, and from nothing else: a finding names both, and `campaign --replay`
//           makes the case again. Queries of a case that fails become files, which `fcl_artic check --replay` asks
//           again.
//   way     asks the library about a case (its method, its mode, stage 2, another call).
//   judge   looks at the answers and reports each fault by Case::fault().
//   mutant  is a fault put into an answer on purpose; the judge has to see it, or it would see no other.
//
// A campaign is a function that draws one case, asks, judges and counts. The harness numbers the cases, shares them
// among threads, adds the counts up, prints how many cases hit what, and runs a single case again.
//
//   A new way of asking   one function that changes the request: a `Way` in arms.h, for the scenes of arms.
//   A new judge           one function that takes the answers: a `Judge` in arms.h.
//   A new mutant          one row of a list of `Mutant`s: checks.cpp and pairs/pair_campaign.cpp have one each.
//   A new kind of scene   one `Campaign`, and a row in main.cpp: pairs, modes and urdf have one each.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace campaign {

/// The number that the environment gives by this name, else the usual one. Tests read their numbers of cases and seeds
/// by this, and nothing else.
std::uint64_t fromEnvironment(const char* name, std::uint64_t usual);

/// The text that printf() makes.
std::string format(const char* text, ...) __attribute__((format(printf, 1, 2)));

/// Counts by name, printed in the order in which they were first named.
class Tally {
 public:
  struct Mutant {
    double share = 1;  ///< of the spoilt answers that a judge must see, at least
    std::uint64_t spoilt = 0, seen = 0;
  };

  void count(const std::string& name, std::uint64_t by = 1) { entry(counts_, name) += by; }
  /// A quantity of one case; printed by its quantiles.
  void note(const std::string& name, double value) { entry(notes_, name).push_back(static_cast<float>(value)); }
  void fault(const std::string& kind) { ++faults_[kind]; }
  /// @param applied  the answer was spoilt: the mutant applies to it.
  void mutant(const std::string& name, double share, bool applied, bool seen);
  void add(const Tally& other);

  std::uint64_t operator[](const std::string& name) const;
  double share(const std::string& name, const std::string& of = "cases") const;
  double quantile(const std::string& note, double part) const;
  /// Cases with a fault of this kind.
  std::uint64_t faults(const std::string& kind) const;
  std::uint64_t faults() const;

  template <class T>
  using Named = std::vector<std::pair<std::string, T>>;
  const Named<std::uint64_t>& counts() const { return counts_; }
  const Named<std::vector<float>>& notes() const { return notes_; }
  const Named<Mutant>& mutants() const { return mutants_; }
  const std::map<std::string, std::uint64_t>& faultKinds() const { return faults_; }

 private:
  template <class T>
  static T& entry(Named<T>& all, const std::string& name) {
    for (auto& [known, value] : all)
      if (known == name) return value;
    return all.emplace_back(name, T()).second;
  }

  Named<std::uint64_t> counts_;
  Named<std::vector<float>> notes_;
  Named<Mutant> mutants_;
  std::map<std::string, std::uint64_t> faults_;
};

struct Finding {
  std::string fault;  ///< its kind: each is counted by itself and has to be 0
  std::string text;
};

/// Makes the case: nothing else does.
struct CaseId {
  std::string family;  ///< its class; empty where a campaign has none
  std::uint64_t seed = 0;
};

/// Queries as files, which `fcl_artic check --replay` asks again.
class QueryFiles {
 public:
  /// Where the environment says (FCL_ARTIC_FAILED_CASES), else below the present folder.
  static std::string usualFolder();
  /// @param folder  is made where there is something to write.
  /// @param name    begins the files' names; a sign that no name should have becomes "_".
  QueryFiles(std::string folder, const std::string& name);

  /// Writes a query to a file of its own.
  /// @param text  returns what ArticulatedCollisionManager::writeQuery() does, or throws why there is none.
  void add(const std::function<std::string()>& text);
  /// A line for each query: how it is asked again, or why it can't be (each reason once).
  std::string lines() const;

 private:
  std::string folder_, name_, lines_;
  int queries_ = 0;
};

/// Why no file holds the query of two bodies.
inline constexpr char kTwoBodies[] = "two bodies are no query of a robot's manager";

struct Options {
  std::uint64_t cases = 0;
  std::uint64_t seed = 1;
  int threads = 0;       ///< 0: one for each core
  std::string family;    ///< only this class; empty: all, in their shares
  bool mutants = false;  ///< besides, spoils a copy of each answer by each mutant, and counts what the judge sees
  std::function<void(std::uint64_t done)> progress;  ///< called by any thread
  std::string folder = QueryFiles::usualFolder();    ///< gets the queries of cases that fail; empty: none
};

/// Options of a test that runs on one thread. The variables <name>_CASES and <name>_SEED of the
/// environment ask for more cases and for others.
Options optionsOfTest(const std::string& name, std::uint64_t cases, std::uint64_t seed = 1);

/// One case, while its campaign looks at it.
struct Case {
  std::uint64_t index;
  CaseId id;
  bool mutants;
  Tally& tally;
  std::vector<Finding> findings;
  std::string* words = nullptr;  ///< takes a description, where the case is replayed
  QueryFiles* files = nullptr;   ///< takes the queries, where the case has failed

  /// A query that is about to be asked; `text` as QueryFiles::add() has it.
  void query(const std::function<std::string()>& text) {
    if (files) files->add(text);
  }
  /// A query that no file can hold.
  void queryWithoutFile(const std::string& reason);
  void fault(const std::string& kind, const std::string& text) { findings.push_back({kind, text}); }
};

struct Campaign {
  std::vector<std::string> families;
  /// Names case `index` of the campaign of this seed. Default: seeds that follow one another.
  std::function<CaseId(std::uint64_t seed, std::uint64_t index)> number = [](std::uint64_t seed, std::uint64_t index) {
    return CaseId{{}, seed + index};
  };
  /// Draws the case, asks, judges and counts. An exception is a fault. Called by several threads, and once more for a
  /// case that has failed, so that it writes its queries.
  std::function<void(Case&)> look;
  std::string name;  ///< begins the names of files
};

struct Failure {
  std::uint64_t index = 0;
  CaseId id;
  std::vector<Finding> findings;
  /// How the case and its queries come back. Of the first few of each kind, as one kind can be much more frequent than
  /// a worse one.
  std::string words;
};

struct Report {
  std::map<std::string, Tally> families;
  Tally total;
  std::vector<Failure> failures;  ///< in the order of the cases, at most 1,000
  double elapsed_s = 0;
};

/// @throws std::invalid_argument for an unknown class.
Report run(const Campaign& campaign, const Options& options);
/// One case again, with a description of it.
/// @param folder  gets its queries; empty: none
/// @return whether it is without fault.
bool replay(const Campaign& campaign, const CaseId& id, const std::string& folder, std::string& words);
/// The counts of each class and of all, the mutants, and the first findings of each kind.
std::string toText(const Report& report);
/// The same of a single tally, of that name.
std::string toText(const std::string& name, const Tally& tally);

/// A fault put into answers on purpose.
template <class Subject, class Answer>
struct Mutant {
  const char* name;
  double share;  ///< of the spoilt answers that a judge must see, at least
  /// Spoils the answer where the fault applies to it; returns whether it did.
  bool (*spoil)(const Subject& subject, Answer& answer);
};

/// Spoils a copy of the answer by each mutant, and counts those that the judge sees.
/// @param judge  judge(answer) returns its findings.
template <class Subject, class Answer, class Judge>
void tryMutants(const std::vector<Mutant<Subject, Answer>>& mutants, const Subject& subject, const Answer& answer,
                const Judge& judge, Case& c) {
  if (!c.mutants) return;
  for (const Mutant<Subject, Answer>& mutant : mutants) {
    Answer spoilt = answer;
    const bool applied = mutant.spoil(subject, spoilt);
    c.tally.mutant(mutant.name, mutant.share, applied, applied && !judge(spoilt).empty());
  }
}

}  // namespace campaign
