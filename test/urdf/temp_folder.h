// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

/// A test with a folder of its own, removed at its end.
class TempFolderTest : public testing::Test {
 protected:
  TempFolderTest() {
    std::string name = (std::filesystem::temp_directory_path() / "fcl_artic_test_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~TempFolderTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Writes a file, with its folders. @return its path.
  std::string write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file.string();
  }

  std::filesystem::path folder_;
};

/// The message of the Error that `call` throws; a failure when it throws nothing or something else.
template <class Error = std::runtime_error>
std::string messageOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "throws something else: " << error.what();
    return error.what();
  }
  ADD_FAILURE() << "throws nothing";
  return {};
}

inline void expectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}
