// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "meshes/readers.h"
#include "writers.h"

namespace fcl_artic::test {

/// Reads a mesh by the reader of its name's ending.
meshes::TriangleSoup readWritten(const WrittenFile& file, const meshes::Source& source);

/// Writes and reads random files of a format. @return what is wrong with the first one that is not read as it was
/// written, or that is refused; empty: nothing.
std::string readsWhatIsWritten(const std::string& format, int files, std::uint64_t seed, const std::string& folder);

/// Changes the structure of random files, by lines, words, elements and entries: removes, doubles, moves, replaces; and
/// reads them. @return what is wrong: an error that does not name the file, numbers of vertices that aren't there, a
/// coordinate that is not finite; empty: nothing. @param[out] read, refused  how many files.
std::string survivesChanges(const std::string& format, int files, std::uint64_t seed, const std::string& folder,
                            int& read, int& refused);

}  // namespace fcl_artic::test
