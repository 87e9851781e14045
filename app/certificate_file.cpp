// SPDX-License-Identifier: BSD-3-Clause
#include "certificate_file.h"

#include <fmt/format.h>

#include "files/files.h"
#include "text/counted.h"
#include "world.h"

namespace fcl_artic::app {

std::string CertificateFile::add(const Certificate& certificate) {
  if (!certificate) return "no certificate: " + certificate.missing;
  records_ += certificate.record();
  ++count_;
  world_ = certificate.world;
  return "";
}

std::string CertificateFile::write(const std::string& files) const {
  if (!world_) return "";
  files::writeTogether({{worldPath(), *world_}, {path_, records_}});  // records name their world's hash
  return fmt::format("{}, {} bytes, in {}, what {} about, {} bytes, in {}; fcl_artic_verify {} {}{} proves {} again",
                     text::counted(count_, "certificate"), records_.size(), path_, count_ == 1 ? "it is" : "they are",
                     world_->size(), worldPath(), shellWord(worldPath()), shellWord(path_), files,
                     count_ == 1 ? "it" : "them");
}

}  // namespace fcl_artic::app
