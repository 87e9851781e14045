// SPDX-License-Identifier: BSD-3-Clause
// Where the files are that a URDF names.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace verify {

/// Folders of "package://NAME/", by name.
using Packages = std::map<std::string, std::string>;

/// Looks for packages as `fcl_artic check` does. A folder that is given comes first. Without one, packages are found by
/// folder name and by package.xml: at and above the URDF, below ROS_PACKAGE_PATH, in share/ of AMENT_PREFIX_PATH.
class FileFinder {
 public:
  FileFinder(const std::string& urdf, const Packages& packages);
  /// The path of a file that the URDF names: "package://", "file://", or a path from the URDF's folder on.
  /// @throws BadInput
  std::string find(const std::string& name);

 private:
  const std::vector<std::filesystem::path>& foldersOf(const std::string& package);

  const std::filesystem::path folder_;
  const Packages& packages_;
  std::map<std::string, std::vector<std::filesystem::path>> found_;
};

}  // namespace verify
