// SPDX-License-Identifier: BSD-3-Clause
// Files of a test, in a folder of its own, and a robot with its world.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "../readers.h"
#include "worlds.h"

namespace verify::test {

class VerifyFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (std::filesystem::temp_directory_path() / "fcl_artic_verify_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& content) {
    std::filesystem::create_directories(std::filesystem::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name, std::ios::binary) << content;
    return folder_ + "/" + name;
  }
  Comparison compare(const std::string& world, const std::string& urdf) {
    const World read = readWorld(world);
    return compareWithUrdf(read, write("robot.urdf", urdf), {{"elsewhere", folder_ + "/deep"}});
  }
  /// "same", the first difference, or why they are not compared.
  std::string said(const std::string& world, const std::string& urdf) {
    const World read = readWorld(world);
    const std::string path = write("robot.urdf", urdf);
    try {
      const Comparison c = compareWithUrdf(read, path, {{"elsewhere", folder_ + "/deep"}});
      return c.differences.empty() ? "same" : c.differences[0];
    } catch (const BadInput& error) {
      return error.what();
    }
  }
  std::string folder_;
};

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

}  // namespace verify::test
