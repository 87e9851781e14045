# SPDX-License-Identifier: BSD-3-Clause
# Ends configuration for a big-endian processor. (src/numerics/instruction_sets.h says the same to other build systems.)
if(CMAKE_CXX_BYTE_ORDER STREQUAL BIG_ENDIAN)
  message(FATAL_ERROR "fcl_artic: ${CMAKE_SYSTEM_PROCESSOR} is big-endian; fcl_artic needs a little-endian processor: it "
    "reads binary files and packs numbers in that order, and nobody has tried another one")
endif()
