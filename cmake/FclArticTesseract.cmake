# SPDX-License-Identifier: BSD-3-Clause
# Finds the parts of tesseract that the component `tesseract` is made of, for this build and for those that use it. Sets
# fcl_artic_tesseract_library_FOUND.
if(NOT TARGET tesseract::collision OR NOT TARGET tesseract::scene_graph)
  find_package(tesseract QUIET COMPONENTS common geometry scene_graph collision)
endif()
set(fcl_artic_tesseract_library_FOUND FALSE)
if(TARGET tesseract::collision AND TARGET tesseract::scene_graph)
  set(fcl_artic_tesseract_library_FOUND TRUE)
endif()
