// SPDX-License-Identifier: BSD-3-Clause
#include "edges/first_rows.h"

#include <cstdint>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace fcl_artic::app {

void requireAllRows(const hdf5::File& file, const std::string& first, const std::string& rows) {
  const std::size_t count = file.shape(first).at(0), all = file.shape(rows).at(0);
  std::vector<std::int64_t> begin, end;
  file.read(first, 0, 1, begin);
  file.read(first, count - 1, 1, end);
  if (begin[0] == 0 && end[0] == static_cast<std::int64_t>(all)) return;
  throw std::runtime_error(fmt::format(
      "'{}': dataset '{}' goes from {} to {}, and is to go from 0 to {}, the number of rows of '{}': where each "
      "begins, and at the end where the last one ends",
      file.path(), first, begin[0], end[0], all, rows));
}

}  // namespace fcl_artic::app
