// SPDX-License-Identifier: BSD-3-Clause
//
// Who does which block: one process alone, one of many of a job array, or the ranks of an MPI job, which take blocks
// from one counter. MPI is a plug-in (app/mpi), so that the program itself needs none.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace fcl_artic::app {

class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const { return 0; }
  virtual int size() const { return 1; }
  /// The part of all numbers that next() gives out here.
  virtual double share() const { return 1; }
  /// The next number that nobody has taken: 0, 1, 2, ...
  virtual std::int64_t next() = 0;
  /// Adds rows that are done, of all ranks. @return the sum.
  virtual std::int64_t addDone(std::int64_t rows) = 0;
  /// Waits for all ranks.
  /// @param status  of this one. @param[out] first  of rank 0. @return the largest of all.
  virtual int finish(int status, int& first) = 0;
};

/// @param shard  "i/n", i from 1 to n: every n-th number, from i - 1 on; empty: all.
/// @return the ranks of the MPI job that has started this process, where one has and `shard` is empty.
/// @throws std::invalid_argument naming what is wrong with `shard`; std::runtime_error for an MPI job that can't be
///   joined.
std::unique_ptr<Ranks> openRanks(const std::string& shard);

}  // namespace fcl_artic::app
