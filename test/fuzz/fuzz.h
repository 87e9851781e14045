// SPDX-License-Identifier: BSD-3-Clause
// Shared by the fuzz targets. A target is a file with LLVMFuzzerTestOneInput(); libFuzzer runs it with inputs of its
// own, replay.cpp with those of the corpus. Wrong input may throw what the headers document; all else is a fault.
#pragma once

#include <stdlib.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include "fcl_artic/fcl_artic.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fcl_artic::fuzz {

/// A truth is broken: ends the process, as a crash does.
[[noreturn]] inline void fault(const std::string& what) {
  std::fprintf(stderr, "fuzz: %s\n", what.c_str());
  std::abort();
}

/// A folder for this process's input files, removed at its end.
class Folder {
 public:
  static Folder& instance() {
    static Folder folder;
    return folder;
  }
  /// Writes a file. @return its path.
  std::string write(const std::string& name, const std::string& content) {
    const std::string path = path_ + "/" + name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

 private:
  Folder() {
    path_ = (std::filesystem::temp_directory_path() / "fcl_artic_fuzz_XXXXXX").string();
    if (!mkdtemp(path_.data())) fault("no folder can be made in the system's temporary one");
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string path_;
};

/// Runs a loader. @return false: it refused the file, with an error that names it.
template <typename F>
bool loads(const std::string& path, F&& load) {
  try {
    load();
    return true;
  } catch (const std::runtime_error& error) {
    const std::string name = std::filesystem::path(path).filename();
    if (std::string(error.what()).find(name) == std::string::npos)
      fault("the error does not name the file: " + std::string(error.what()));
    return false;
  }
}

/// Queries what was loaded: small requests, and only what the manager accepts.
inline void query(ArticulatedCollisionManager& manager) {
  const KinematicTree& tree = manager.tree();
  try {
    manager.setup();
    Eigen::VectorXd q0 = tree.neutralConfiguration(), q1 = q0;
    for (int v = 0; v < tree.dof(); ++v) {
      if (tree.quaternionVariable(tree.variableJoint(v)) < 0) q1[v] = 0.5;
    }
    CertifiedRequest request;
    request.work_budget = 2000;
    CertifiedResult result;
    manager.continuousCollide(JointMotion::linear(tree, q0, q1), request, result);
    if (!(result.t_lower >= 0 && result.t_lower <= 1)) fault("t_lower is outside [0, 1]");
    if (result.status == Status::contact && result.contacts.empty()) fault("a contact without a contact");
  } catch (const std::invalid_argument&) {
  }
}

/// Numbers and choices out of the input's bytes; zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return size_ == 0; }
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  /// From 0 to `count` - 1.
  int below(int count) { return byte() % count; }
  bool coin() { return byte() & 1; }
  std::uint64_t word() {
    std::uint64_t all = 0;
    for (int k = 0; k < 8; ++k) all = all << 8 | byte();
    return all;
  }
  /// Mostly in [-2, 2], in steps of 1/64; sometimes hostile, sometimes any double.
  double number() {
    static const double kHostile[] = {0,
                                      -0.0,
                                      std::numeric_limits<double>::quiet_NaN(),
                                      std::numeric_limits<double>::infinity(),
                                      -std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::denorm_min(),
                                      -1e-310,
                                      std::numeric_limits<double>::min(),
                                      std::numeric_limits<double>::max(),
                                      -std::numeric_limits<double>::max(),
                                      1e-40,
                                      1e-17,
                                      1e-9,
                                      1e5,
                                      -1e5,
                                      100001,
                                      1e9,
                                      -1.0000001e9,
                                      1e18,
                                      1e154,
                                      3.141592653589793,
                                      -1.5707963267948966,
                                      6.283185307179586,
                                      1 + 1e-15};
    const int kind = below(16);
    if (kind < 13) return (static_cast<int>(byte()) - 128) / 64.0;
    if (kind < 15)
      return kHostile[static_cast<std::size_t>(below(static_cast<int>(sizeof kHostile / sizeof *kHostile)))];
    const std::uint64_t bits = word();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  Eigen::Vector3d vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  /// A turn and a shift; now and then no rigid transform at all.
  Eigen::Isometry3d pose() {
    Eigen::Isometry3d M = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d turn = vector();
    if (turn.allFinite() && turn.norm() > 0 && turn.norm() < 1e6) {
      M.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    } else if (coin()) {
      M.linear().row(0) = turn;
    }
    M.translation() = vector();
    return M;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace fcl_artic::fuzz
