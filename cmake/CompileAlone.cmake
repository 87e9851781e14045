# SPDX-License-Identifier: BSD-3-Clause
# fcl_artic_compile_alone(<source>...): sources of the present folder that have flags of their own. They take no precompiled
# header, which is made with other flags, and join no other source where sources are compiled together (CMAKE_UNITY_BUILD).
function(fcl_artic_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
