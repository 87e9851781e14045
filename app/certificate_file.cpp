// SPDX-License-Identifier: BSD-3-Clause
#include "certificate_file.h"

#include <fmt/format.h>

#include "files/files.h"

namespace fcl_artic::app {

std::string CertificateFile::add(const Certificate& certificate) {
  if (!certificate) return "no certificate: " + certificate.missing;
  records_ += certificate.record();
  world_ = certificate.world;
  return fmt::format("certificate of {} bytes in {}, its world in {}; fcl_artic_verify {} {} proves it again",
                     certificate.proof.size(), path_, worldPath(), worldPath(), path_);
}

void CertificateFile::write() const {
  if (!world_) return;
  files::write(worldPath(), *world_);
  files::write(path_, records_);
}

}  // namespace fcl_artic::app
