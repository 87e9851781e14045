// SPDX-License-Identifier: BSD-3-Clause
//
// Times every query of a set by itself, and keeps medians as rows of a report. Google Benchmark runs and filters the
// rows and writes its own output; it has no medians over queries, so the times are taken here and given to it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "fcl_artic/result.h"

namespace fcl_artic::bench {

/// Answer of one query: contact time in [0, 1], or kFree.
using Answer = double;

struct Row {
  std::string scene, set, method;
  double size = 0;  ///< what grows, in a series of growth
  std::size_t queries = 0, hits = 0;
  int passes = 0;
  double median_us = 0, mean_us = 0, p95_us = 0, max_us = 0;
  double mean_toc = 0;                                    ///< over the hits
  std::uint64_t hash = 0;                                 ///< of the bits of all answers, in order
  std::vector<std::pair<std::string, double>> per_query;  ///< mean work counters
};

/// Adds the share of one query to the row's mean counters.
void addCounters(Row& row, const QueryStatistics& statistics);

struct Measured {
  Row row;
  std::vector<Answer> answers;
  std::vector<double> us;  ///< least time of each query
};

/// Runs all queries in order, `passes` times at least and 20 ms at least, and keeps the least time of each.
/// @param query  answers query i.
/// @throws std::runtime_error when an answer differs from one pass to the next.
Measured measure(std::size_t queries, int passes, const std::function<Answer(std::size_t)>& query);

/// The same for several ways of answering, by turns: two passes of the one, then of the next, so that a machine that is
/// slow for a while is slow for all of them. (Two, as the first finds caches that another way has filled.)
std::vector<Measured> measureInTurns(std::size_t queries, int passes,
                                     const std::vector<std::function<Answer(std::size_t)>>& ways);

/// Computes the row's figures from answers and times.
void summarise(Measured& measured);

/// What a program was given on the command line and collects.
class Report {
 public:
  /// @param program  names the files of results.
  explicit Report(std::string program) : program_(std::move(program)) {}

  /// Adds a row that Google Benchmark will run.
  void add(const std::string& scene, const std::string& set, const std::string& method, std::function<Measured()> run);
  /// Runs what the filter leaves.
  void run();
  /// Prints the table and, with --results, writes PROGRAM.txt.
  /// @return exit status: 1 when a row failed or a file can't be written.
  int finish() const;
  /// Writes one more file of results, beside the others; nothing without --results.
  void write(const std::string& file, const std::string& content) const;

  std::string results_folder;  ///< with the machine's name, made on demand; empty: no files
  /// Adds a row that was put together from others.
  void addRow(Row row) { rows_.push_back(std::move(row)); }
  const std::vector<Row>& rows() const { return rows_; }
  void note(const std::string& line) { notes_.push_back(line); }
  std::string table() const;

 private:
  std::string program_;
  std::vector<Row> rows_;
  std::vector<std::string> notes_;
  bool failed_ = false;
};

/// Processor, compiler, flags and load, in one line.
std::string circumstances();

/// "amd-epyc-zen4", or the CPU's model name in lower case with dashes.
std::string machineName();

}  // namespace fcl_artic::bench
