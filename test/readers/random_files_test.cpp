// SPDX-License-Identifier: BSD-3-Clause
// FCL_ARTIC_FILES says how many files of each format are written and read; a few hundred unless it is set.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>

#include "harness.h"

namespace random_files_test {

using namespace fcl_artic::test;

class RandomFiles : public testing::TestWithParam<std::string> {
 protected:
  RandomFiles() {
    folder_ = (std::filesystem::temp_directory_path() / "fcl_artic_test_XXXXXX").string();
    if (!mkdtemp(folder_.data())) ADD_FAILURE() << "no folder";
  }
  ~RandomFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string folder_;
};

TEST_P(RandomFiles, AreReadAsTheyAreWritten) {
  const char* asked = std::getenv("FCL_ARTIC_FILES");
  const int files = asked ? std::atoi(asked) : 200;
  ASSERT_GT(files, 0);
  for (const FileFormat& format : fileFormats()) {
    if (format.name != GetParam()) continue;
    const Findings found = readRandomFiles(format, files, asked ? 1000000 : 1, folder_);
    EXPECT_EQ(found.wrong, "");
    std::printf("%s: %d files; of %d of changed structure %d were read, %d refused\n", format.name.c_str(), files,
                found.changed_read + found.changed_refused, found.changed_read, found.changed_refused);
    EXPECT_GE(found.changed_refused, files / 5);
    EXPECT_GE(found.faults.size(), 3 + format.faults.size()) << "some fault never made a difference";
    for (const auto& [name, pattern] : format.faults)
      EXPECT_EQ(found.faults.count(name), 1u) << name << " never made a difference";
    for (const auto& [name, seen] : found.faults) {
      if (asked) std::printf("  a reader that %s: seen in %d of %d\n", name.c_str(), seen.seen, seen.files);
      EXPECT_GE(seen.files, files / 40) << name;
      // Files may hold the same without what a reader passes over, as a turn by 0 or the place of a node without
      // geometry.
      EXPECT_GE(seen.seen, seen.of_file ? seen.files / 8 : seen.files) << name;
    }
  }
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const FileFormat& format : fileFormats()) all.push_back(format.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Formats, RandomFiles, testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = c == '.' || c == '/' ? '_' : c;
  return name;
});

}  // namespace random_files_test
