// SPDX-License-Identifier: BSD-3-Clause
// Random files of all formats, as they are written and changed, for as long as is asked for.
#include <stdlib.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "checks.h"

int main(int argc, char** argv) {
  using namespace fcl_artic::test;
  CLI::App app("Reads random mesh and point files, and files whose structure is changed.");
  int files = 1000;
  std::uint64_t seed = 1;
  std::vector<std::string> formats = writtenFormats();
  app.add_option("--files", files, "of each format");
  app.add_option("--seed", seed, "of the first file");
  app.add_option("--formats", formats, "such as stl");
  CLI11_PARSE(app, argc, argv);
  std::string folder = (std::filesystem::temp_directory_path() / "fcl_artic_meshes_XXXXXX").string();
  if (!mkdtemp(folder.data())) return 1;
  int faults = 0;
  for (const std::string& format : formats) {
    int read = 0, refused = 0;
    for (const std::string& wrong : {readsWhatIsWritten(format, files, seed, folder),
                                     survivesChanges(format, files, seed, folder, read, refused)}) {
      if (wrong.empty()) continue;
      std::printf("%s: %s\n", format.c_str(), wrong.c_str());
      ++faults;
    }
    std::printf("%s: %d files read as written; of %d changed ones %d were read, %d refused\n", format.c_str(), files,
                read + refused, read, refused);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return faults > 0;
}
