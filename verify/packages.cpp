// SPDX-License-Identifier: BSD-3-Clause
#include "packages.h"

#include <algorithm>
#include <cstdlib>

#include "xml.h"

namespace verify {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 12, kMostFolders = 100000;  // a link may lead in a circle

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

class Folders {
 public:
  explicit Folders(const std::string& package) : package_(package) {}
  std::vector<fs::path> found;

  void add(const fs::path& folder) {
    std::error_code error;
    if (fs::is_directory(folder, error) && std::find(found.begin(), found.end(), folder) == found.end())
      found.push_back(folder);
  }
  void searchAt(const fs::path& folder) {
    if (folder.filename() == package_ || packageName((folder / "package.xml").string()) == package_) add(folder);
    add(folder / package_);
  }
  /// A folder and those below it: not within packages, nor where a file says that there are none.
  void searchBelow(const fs::path& folder, int depth = kDeepest) {
    if (--left_ < 0) return;
    const std::string name = packageName((folder / "package.xml").string());
    if (name == package_ || (name.empty() && folder.filename() == package_)) add(folder);
    if (!name.empty() || depth == 0) return;
    for (const char* stop : {"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE", "rospack_nosubdirs"})
      if (isThere(folder / stop)) return;
    std::error_code error;
    std::vector<fs::path> below;
    for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && it != end; it.increment(error)) {
      std::error_code ignored;
      if (it->path().filename().string()[0] != '.' && it->is_directory(ignored)) below.push_back(it->path());
    }
    std::sort(below.begin(), below.end());  // a folder lists its files in any order
    for (const fs::path& next : below) searchBelow(next, depth - 1);
  }

 private:
  const std::string& package_;
  int left_ = kMostFolders;
};

/// file:///PATH or file://localhost/PATH, with %20 and the like decoded.
std::string fileOfUrl(const std::string& url) {
  std::string path = url.substr(7), decoded;
  if (path.rfind("localhost/", 0) == 0) path.erase(0, 9);
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (path[k] != '%') {
      decoded += path[k];
      continue;
    }
    const std::string digits = path.substr(k + 1, 2);
    if (digits.size() != 2 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos || digits == "00")
      throw BadInput("'" + url + "': a % stands before two hexadecimal digits");
    decoded += static_cast<char>(std::stoi(digits, nullptr, 16));
    k += 2;
  }
  if (decoded.empty() || decoded[0] != '/') throw BadInput("'" + url + "' has no absolute path");
  return decoded;
}

/// The same folder, by a path whose parents can be read off it: only the disk knows the folder above a symbolic link.
fs::path withoutDots(const fs::path& folder) {
  std::error_code error;
  const fs::path there = fs::canonical(folder, error);
  return error || std::find(folder.begin(), folder.end(), "..") == folder.end() ? folder.lexically_normal() : there;
}

/// Paths of an environment variable, separated by colons.
std::vector<fs::path> listed(const char* variable) {
  std::vector<fs::path> paths;
  const char* const value = std::getenv(variable);
  const std::string text = value == nullptr ? "" : value;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(':', at), text.size());
    if (end > at) paths.emplace_back(text.substr(at, end - at));
    at = end + 1;
  }
  return paths;
}

}  // namespace

FileFinder::FileFinder(const std::string& urdf, const Packages& packages)
    : folder_(fs::absolute(urdf).parent_path()), packages_(packages) {}

std::string FileFinder::find(const std::string& name) {
  const std::string package = "package://";
  if (name.rfind("file://", 0) == 0) return fileOfUrl(name);
  if (name.rfind(package, 0) != 0) {
    if (name.find("://") != std::string::npos) throw BadInput("'" + name + "' is neither file:// nor package://");
    return (folder_ / name).string();
  }
  const std::size_t begin = std::min(name.find_first_not_of('/', package.size()), name.size()),
                    slash = name.find('/', begin), file = name.find_first_not_of('/', slash);
  if (file == std::string::npos) throw BadInput("'" + name + "' names no file");
  const std::string of = name.substr(begin, slash - begin), rest = name.substr(file);
  for (const fs::path& folder : foldersOf(of))
    if (isThere(folder / rest)) return (folder / rest).string();
  if (packages_.count(of) > 0) throw BadInput("'" + name + "' is not in '" + packages_.at(of) + "'");
  throw BadInput("'" + name + "' is not found; name the package's folder: --package " + of + "=FOLDER");
}

const std::vector<fs::path>& FileFinder::foldersOf(const std::string& package) {
  const auto [entry, is_new] = found_.try_emplace(package);
  if (!is_new) return entry->second;
  Folders folders(package);
  const auto given = packages_.find(package);
  if (given != packages_.end()) return entry->second = {given->second};
  for (fs::path up = withoutDots(folder_);; up = up.parent_path()) {
    folders.searchAt(up);
    if (up == up.parent_path()) break;
  }
  for (const fs::path& folder : listed("ROS_PACKAGE_PATH")) folders.searchBelow(folder);
  for (const fs::path& prefix : listed("AMENT_PREFIX_PATH")) folders.add(prefix / "share" / package);
  return entry->second = std::move(folders.found);
}

}  // namespace verify
