# SPDX-License-Identifier: BSD-3-Clause
# FCL_ARTIC_DIRECTED_ROUNDING: flags for a target whose sources compute under RoundUpward (src/interval/rounding.h);
# fcl_artic_directed_rounding(<source>...) gives them to sources of the present folder. The operations of Interval need no
# flag; the flags keep what else the source computes with doubles from being folded, fused or reordered.
set(FCL_ARTIC_DIRECTED_ROUNDING -frounding-math -ffp-contract=off -fno-fast-math)
function(fcl_artic_directed_rounding)
  foreach(source IN LISTS ARGN)
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS ${FCL_ARTIC_DIRECTED_ROUNDING})
  endforeach()
  fcl_artic_compile_alone(${ARGN})
endfunction()
