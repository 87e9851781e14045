# SPDX-License-Identifier: BSD-3-Clause
# Finds pinocchio with its collision support, which is coal, for this build and for those that use the component
# `pinocchio`. Sets fcl_artic_pinocchio_library_FOUND.
if(NOT TARGET pinocchio::pinocchio)
  find_package(pinocchio QUIET)
endif()
set(fcl_artic_pinocchio_library_FOUND FALSE)
if(TARGET pinocchio::pinocchio AND TARGET coal::coal)
  set(fcl_artic_pinocchio_library_FOUND TRUE)
endif()
