# SPDX-License-Identifier: BSD-3-Clause
# fcl_artic_directed_rounding(<source>...): sources of the present folder that compute under RoundUpward
# (src/interval/rounding.h). The operations of Interval need no flag; what else the source computes with doubles is kept
# from being folded, fused or reordered as far as the compiler can be told.
function(fcl_artic_directed_rounding)
  foreach(source IN LISTS ARGN)
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS -frounding-math -ffp-contract=off -fno-fast-math)
  endforeach()
endfunction()
