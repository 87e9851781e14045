// SPDX-License-Identifier: BSD-3-Clause
#include "edges/columns.h"

#include "certificate/sha256.h"

namespace fcl_artic::app {

const char* toString(RowStatus status) {
  switch (status) {
    case RowStatus::missing:
      return "missing";
    case RowStatus::free:
      return "free";
    case RowStatus::contact:
      return "contact";
    case RowStatus::undecided:
      return "undecided";
    case RowStatus::refused:
      return "refused";
  }
  return "missing";
}

void Columns::assign(std::size_t rows, bool certificates) {
  status.assign(rows, static_cast<std::int8_t>(RowStatus::missing));
  t_lower.assign(rows, -1);
  t_upper.assign(rows, -1);
  certain.assign(rows, 0);
  for (auto* bodies : {&link, &other_link, &obstacle}) bodies->assign(rows, -1);
  for (auto* exceptions : {&ignored_initial, &never_apart, &unproven_allowed}) exceptions->assign(rows, 0);
  certificate.assign(certificates ? rows : 0, -1);
}

std::string hashOf(const Columns& columns) {
  std::string hashes;
  forEachColumn(columns, [&](const char* name, hdf5::Type, const auto& values) {
    const auto* const bytes = reinterpret_cast<const char*>(values.data());
    hashes += name + (' ' + certificate::sha256Text({bytes, values.size() * sizeof values[0]})) + '\n';
  });
  return certificate::sha256Text(hashes);
}

void Counts::add(const Columns& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ++of[columns.status[i]];
    const auto status = static_cast<RowStatus>(columns.status[i]);
    uncertain += status == RowStatus::contact && !columns.certain[i];
    if (status != RowStatus::free) continue;
    with_ignored += columns.ignored_initial[i] > columns.never_apart[i];
    with_never_apart += columns.never_apart[i] > 0;
    with_unproven += columns.unproven_allowed[i] > 0;
  }
}

void Counts::add(const Counts& other) {
  for (std::int8_t s = 0; s < kNumRowStatuses; ++s) of[s] += other.of[s];
  uncertain += other.uncertain;
  with_ignored += other.with_ignored;
  with_never_apart += other.with_never_apart;
  with_unproven += other.with_unproven;
}

std::uint64_t Counts::rows() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : of) sum += n;
  return sum;
}

}  // namespace fcl_artic::app
