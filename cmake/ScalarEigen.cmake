# SPDX-License-Identifier: BSD-3-Clause
# fcl_artic_scalar_eigen(TARGET): Eigen's products without vector instructions in TARGET's own sources. Vectorized, they
# fuse multiplication and addition where the processor can, and sum up in another order: what is made at set-up, and
# answers with it, would have other bits on another processor or with other flags. (`-ffp-contract=off` says nothing of
# instructions that are called by name.) Alignment stays as everybody else's, who share Eigen's types with TARGET.
include(CheckCXXSourceCompiles)
include(CMakePushCheckState)

function(fcl_artic_scalar_eigen target)
  cmake_push_check_state(RESET)
  set(CMAKE_REQUIRED_LIBRARIES Eigen3::Eigen)
  foreach(bytes 16 32 64)
    check_cxx_source_compiles("#include <Eigen/Core>
      static_assert(EIGEN_MAX_STATIC_ALIGN_BYTES == ${bytes} && EIGEN_MAX_ALIGN_BYTES == ${bytes}, \"\");
      int main() {}" FCL_ARTIC_EIGEN_ALIGNS_TO_${bytes})
    if(FCL_ARTIC_EIGEN_ALIGNS_TO_${bytes})
      target_compile_definitions(${target} PRIVATE EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=${bytes}
        EIGEN_MAX_STATIC_ALIGN_BYTES=${bytes})
      set(found TRUE)
      break()
    endif()
  endforeach()
  if(NOT found)
    message(STATUS "fcl_artic: Eigen's alignment is unknown, ${target} takes Eigen's vector instructions: bits of answers "
      "may be other ones than elsewhere")
  endif()
  cmake_pop_check_state()
endfunction()
