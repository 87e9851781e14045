// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fcl_artic::plans {

/// A file of an archive.
struct ZipEntry {
  std::string name, content;
};

/// The files of a zip archive, stored or deflated, in its order. Their check sums are compared.
/// @throws std::invalid_argument for what is none, is cut short, or needs what is not read (encryption, archives of
///   several volumes or over 4 GB, other compression); that this build has no zlib.
std::vector<ZipEntry> unzip(std::string_view content);

}  // namespace fcl_artic::plans
