// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "checks.h"

namespace random_files_test {

using namespace fcl_artic::test;

/// A folder for what files name, removed at the end.
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
  EXPECT_EQ(readsWhatIsWritten(GetParam(), 200, 1, folder_), "");
}

TEST_P(RandomFiles, OfChangedStructureAreReadOrRefused) {
  int read = 0, refused = 0;
  EXPECT_EQ(survivesChanges(GetParam(), 400, 1, folder_, read, refused), "");
  EXPECT_GE(read, 20);
  EXPECT_GE(refused, 100);
}

INSTANTIATE_TEST_SUITE_P(Formats, RandomFiles, testing::ValuesIn(writtenFormats()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = c == '.' ? '_' : c;
  return name;
});

}  // namespace random_files_test
