# SPDX-License-Identifier: BSD-3-Clause
# Every proof rests on IEEE 754 arithmetic. Flags that let the compiler reorder or approximate it, or that start the
# program with subnormals flushed to zero, are refused wherever they come from; the engine's sources refuse the same
# by __FAST_MATH__.

get_directory_property(fcl_artic_flags COMPILE_OPTIONS)
get_directory_property(fcl_artic_link_flags LINK_OPTIONS)
list(APPEND fcl_artic_flags ${fcl_artic_link_flags} "${CMAKE_CXX_FLAGS}" "${CMAKE_SHARED_LINKER_FLAGS}"
  "${CMAKE_EXE_LINKER_FLAGS}")
foreach(config IN LISTS CMAKE_BUILD_TYPE CMAKE_CONFIGURATION_TYPES)
  string(TOUPPER "${config}" config)
  list(APPEND fcl_artic_flags "${CMAKE_CXX_FLAGS_${config}}")
endforeach()
string(REPLACE " " ";" fcl_artic_flags "${fcl_artic_flags}")

foreach(flag IN LISTS fcl_artic_flags)
  if(flag MATCHES "^-(Ofast|ffast-math|funsafe-math-optimizations|fassociative-math|freciprocal-math|ffinite-math-only|fno-signed-zeros|fsingle-precision-constant|mdaz-ftz|mfpmath=(387|both|sse[,+]387|387[,+]sse))$")
    message(FATAL_ERROR
      "fcl_artic can't be built with ${flag}: its answers are proofs in IEEE 754 arithmetic, and ${flag} breaks them. "
      "Remove it from CMAKE_CXX_FLAGS, CXXFLAGS or add_compile_options().")
  endif()
endforeach()
