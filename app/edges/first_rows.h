// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "hdf5/hdf5.h"

namespace fcl_artic::app {

/// Rows that are read at once: memory does not grow with files.
constexpr std::size_t kRowsAtOnce = 1 << 16;

/// Requires that a column of first rows (of trajectories or scenes) leaves out no row: a scene with an obstacle less
/// could be called free.
/// @param first  the dataset of first rows, and at its end the number of all: not empty.
/// @param rows  the dataset that it divides.
/// @throws std::runtime_error naming the file.
void requireAllRows(const hdf5::File& file, const std::string& first, const std::string& rows);

}  // namespace fcl_artic::app
