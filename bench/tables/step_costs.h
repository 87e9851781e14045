// SPDX-License-Identifier: BSD-3-Clause
//
// Shared by `table1` and `ideas`: mean times and counts of steps, tables as text and as CSV.
#pragma once

#include <string>
#include <vector>

#include "fcl_artic/manager.h"
#include "random.h"

namespace fcl_artic::app {

/// Means over queries, us and counts; those of a query are of its fastest run.
struct StepCosts {
  double bvh = 0, exact = 0, total = 0;
  double solving = 0;  ///< part of `exact`: the equations
  double sv = 0;       ///< stage 2; below 0: it is off
  double sv_pairs = 0, sv_culled = 0;
  double box_tests = 0, leaf_pairs = 0, equations = 0, intervals = 0, evaluations = 0, steps = 0;
  double median = 0, p95 = 0;  ///< of totals
  std::size_t undecided = 0;   ///< queries that ended by their budget
};

/// @param[in,out] differ  grows by the queries whose verdict is the other one than `contact` says.
StepCosts measureSteps(const ArticulatedCollisionManager& manager, const std::vector<JointMotion>& motions,
                       CertifiedRequest request, int passes, bool contact, std::size_t& differ);

/// At least four digits, as few characters as that takes: 0.0123, 1.2346, 12.35, 123.5, 1235.
std::string fourDigits(double x);

/// A column's name in the text and in the CSV.
struct Column {
  std::string title, key;
};
struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;  ///< a cell per column; empty: nothing is known
};
/// The table in parts, one below the other, so that lines stay within 80 columns; each begins with the first `names`
/// columns. Rows without a cell in a part are left out of it.
std::string textOf(const Table& table, std::size_t names);
std::string csvOf(const Table& table);

}  // namespace fcl_artic::app
