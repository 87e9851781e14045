// SPDX-License-Identifier: BSD-3-Clause
//
// The answers of `certify --edges` as columns of a table: a row for each scene and edge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fcl_artic/result.h"
#include "hdf5/hdf5.h"

namespace fcl_artic::app {

/// Motions that are asked at once: memory does not grow with blocks.
constexpr std::size_t kMotionsAtOnce = 4096;

/// The answer in a row of the table. 0 is never one: bytes that a disk or a program fills in mean nothing.
enum class RowStatus : std::int8_t {
  missing = 0,    ///< not computed
  free = 1,       ///< proven free
  contact = 2,    ///< a contact, proven where `certain`
  undecided = 3,  ///< the work budget ran out
  refused = 4     ///< no motion of the robot: a value that is not finite or is beyond its joint's limits
};
constexpr std::int8_t kNumRowStatuses = 5;
const char* toString(RowStatus status);

/// Rows of the table.
struct Columns {
  std::vector<std::int8_t> status;  ///< RowStatus
  /// Times of the motion, [0, 1] of an edge; of a trajectory its own. -1 in rows that are refused.
  std::vector<double> t_lower, t_upper;
  std::vector<std::int8_t> certain;  ///< 1: the contact is proven; else 0
  /// Bodies of the first contact: a link, and another link or an obstacle; -1: none. Links are numbered as the file's
  /// attribute `links` names them, obstacles those of --scene first, then the scene's own in its order.
  std::vector<std::int32_t> link, other_link, obstacle;
  /// The pairs that `free` leaves out: numbers of CertifiedResult::ignored_initial_contacts, of never_apart_pairs among
  /// them, and of unproven_allowed_pairs.
  std::vector<std::int32_t> ignored_initial, never_apart, unproven_allowed;
  std::vector<std::int64_t> certificate;  ///< place of the row's record in the block's file of certificates; -1: none

  std::size_t size() const { return status.size(); }
  /// All rows missing. @param certificates  whether there is that column.
  void assign(std::size_t rows, bool certificates);
};

/// Calls f(name, type, column) for each column that the rows have.
template <class C, class F>
void forEachColumn(C& columns, const F& f) {
  f("status", hdf5::Type::int8, columns.status);
  f("t_lower", hdf5::Type::float64, columns.t_lower);
  f("t_upper", hdf5::Type::float64, columns.t_upper);
  f("certain", hdf5::Type::int8, columns.certain);
  f("link", hdf5::Type::int32, columns.link);
  f("other_link", hdf5::Type::int32, columns.other_link);
  f("obstacle", hdf5::Type::int32, columns.obstacle);
  f("ignored_initial", hdf5::Type::int32, columns.ignored_initial);
  f("never_apart", hdf5::Type::int32, columns.never_apart);
  f("unproven_allowed", hdf5::Type::int32, columns.unproven_allowed);
  if (columns.certificate.size() == columns.size()) f("certificate", hdf5::Type::int64, columns.certificate);
}

/// Writes an answer to a row, but for its certificate.
/// @param numberOf  the number of an obstacle, of its BodyRef.
template <class F>
void putRow(const CertifiedResult& result, const F& numberOf, std::size_t row, Columns& rows) {
  const RowStatus status = result.status == Status::free      ? RowStatus::free
                           : result.status == Status::contact ? RowStatus::contact
                                                              : RowStatus::undecided;
  rows.status[row] = static_cast<std::int8_t>(status);
  rows.t_lower[row] = result.t_lower;
  rows.t_upper[row] = result.t_upper;
  rows.certain[row] = result.status == Status::contact && result.certain;
  rows.ignored_initial[row] = static_cast<std::int32_t>(result.ignored_initial_contacts.size());
  rows.never_apart[row] = static_cast<std::int32_t>(result.never_apart_pairs);
  rows.unproven_allowed[row] = static_cast<std::int32_t>(result.unproven_allowed_pairs);
  const CertifiedContact* const contact = result.first();
  if (!contact) return;
  for (const BodyRef* body : {&contact->body1, &contact->body2}) {
    if (body->link < 0) {
      rows.obstacle[row] = numberOf(*body);
    } else {
      (rows.link[row] < 0 ? rows.link : rows.other_link)[row] = body->link;
    }
  }
}

/// SHA-256 of all numbers, in hexadecimal digits: equal for equal rows, however a file holds them.
std::string hashOf(const Columns& columns);

/// Rows of each status.
struct Counts {
  std::uint64_t of[kNumRowStatuses] = {};
  std::uint64_t uncertain = 0;  ///< contacts that are not proven
  /// Free rows that leave something out: initial contacts that end, pairs that never come apart, allowed pairs.
  std::uint64_t with_ignored = 0, with_never_apart = 0, with_unproven = 0;
  void add(const Columns& columns);
  void add(const Counts& other);
  std::uint64_t rows() const;
  std::uint64_t operator[](RowStatus status) const { return of[static_cast<std::int8_t>(status)]; }
};

}  // namespace fcl_artic::app
