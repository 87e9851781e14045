# SPDX-License-Identifier: BSD-3-Clause
# The instruction sets for which batches and engines are compiled, one source each, and the compiler's flags for them.
# Which of them a processor has is asked at run time: src/numerics/instruction_sets.h, which lists the same names.
#   FCL_ARTIC_INSTRUCTION_SETS      names, the baseline's flags being the compiler's own
#   FCL_ARTIC_ENGINES               those of them that have an engine
#   FCL_ARTIC_WIDER_SETS            those of them that take flags, FCL_ARTIC_ENGINE_FLAGS_<set>, FCL_ARTIC_BATCH_FLAGS_<set>
include(CheckCXXSymbolExists)
option(FCL_ARTIC_PORTABLE "Use no processor's own instructions: one engine in plain C++, rounding modes by <cfenv>" OFF)
option(FCL_ARTIC_WIDE_ENGINES "Compile engines also for instructions beyond the processor's baseline (AVX2, AVX-512)" ON)

include(RefuseBigEndian)
check_cxx_symbol_exists(__x86_64__ cstddef FCL_ARTIC_X86_64)
check_cxx_symbol_exists(__aarch64__ cstddef FCL_ARTIC_AARCH64)

set(FCL_ARTIC_WIDER_SETS)
if(FCL_ARTIC_PORTABLE)
  set(FCL_ARTIC_INSTRUCTION_SETS portable)
  add_compile_definitions(FCL_ARTIC_PORTABLE)
elseif(FCL_ARTIC_X86_64 AND NOT FCL_ARTIC_WIDE_ENGINES)
  set(FCL_ARTIC_INSTRUCTION_SETS portable sse2)
  add_compile_definitions(FCL_ARTIC_BASELINE_ONLY)
elseif(FCL_ARTIC_X86_64)
  set(FCL_ARTIC_INSTRUCTION_SETS portable sse2 avx2 avx512)
  set(FCL_ARTIC_WIDER_SETS avx2 avx512)
  set(FCL_ARTIC_ENGINE_FLAGS_avx2 -mavx2 -mfma)
  set(FCL_ARTIC_BATCH_FLAGS_avx2 -mavx2)
  set(FCL_ARTIC_ENGINE_FLAGS_avx512 -mavx512f -mavx512dq -mavx512vl -mfma -mprefer-vector-width=512)
  set(FCL_ARTIC_BATCH_FLAGS_avx512 -mavx512f -mavx512dq)
  # Unoptimised, inline functions of shared headers stay functions, and the linker might keep a wide engine's for everybody.
  foreach(set IN LISTS FCL_ARTIC_WIDER_SETS)
    list(APPEND FCL_ARTIC_ENGINE_FLAGS_${set} "$<$<CONFIG:Debug>:-O1>")
  endforeach()
elseif(FCL_ARTIC_AARCH64)
  set(FCL_ARTIC_INSTRUCTION_SETS portable neon)
else()
  set(FCL_ARTIC_INSTRUCTION_SETS portable)
endif()
# The portable engine is for processors without another one, and for the preset `portable`.
set(FCL_ARTIC_ENGINES ${FCL_ARTIC_INSTRUCTION_SETS})
if(NOT FCL_ARTIC_ENGINES STREQUAL portable)
  list(REMOVE_ITEM FCL_ARTIC_ENGINES portable)
endif()
# Where every processor has FMA, g++ fuses a * b + c unless told otherwise: not in proofs, nor in tests and benchmarks,
# which draw the same scenes everywhere then. (x86-64's baseline has none; the core library says so for itself.)
if(NOT FCL_ARTIC_X86_64)
  add_compile_options(-ffp-contract=off)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)  # in its own header
  foreach(kind ENGINE BATCH)
    list(APPEND FCL_ARTIC_${kind}_FLAGS_avx512 -Wno-maybe-uninitialized -Wno-uninitialized)
  endforeach()
endif()
