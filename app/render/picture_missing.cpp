// SPDX-License-Identifier: BSD-3-Clause
// Stands in for picture.cpp without the component visibility or libpng.
#include <stdexcept>

#include "picture.h"

namespace fcl_artic::render {

void requirePictures() {
  throw std::runtime_error(
      "--image: this program was built without the component visibility or libpng and can't draw pictures");
}

void writePicture(const std::string&, const Robot&, const std::vector<Scene::Obstacle>&, const JointPath&,
                  const CertifiedResult&, const PictureOptions&) {
  requirePictures();
}

}  // namespace fcl_artic::render
