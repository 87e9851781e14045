// SPDX-License-Identifier: BSD-3-Clause
//
// Certificates of answers in files: FILE, a record for each answer that has a proof, and FILE.world, what they are
// about.
#pragma once

#include <memory>
#include <string>

#include "fcl_artic/certificate.h"

namespace fcl_artic::app {

class CertificateFile {
 public:
  /// @param path  FILE; empty: nobody wants one.
  explicit CertificateFile(std::string path) : path_(std::move(path)) {}
  bool wanted() const { return !path_.empty(); }
  std::string worldPath() const { return path_ + ".world"; }

  /// Adds an answer's certificate, if it has a proof.
  /// @return why it has none, as one line for the user; empty: it has one.
  std::string add(const Certificate& certificate);
  /// Writes both files, or none if nothing was added. (removeEarlierOutputs() has removed files of an earlier run.)
  /// @param files  arguments of fcl_artic_verify that say which files the claim is about, each after a space.
  /// @return one line for the user: counts and sizes of what was written; empty if nothing was.
  /// @throws std::runtime_error naming the file.
  std::string write(const std::string& files = "") const;

 private:
  std::string path_, records_;
  std::size_t count_ = 0;
  std::shared_ptr<const std::string> world_;
};

}  // namespace fcl_artic::app
