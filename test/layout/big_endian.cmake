# SPDX-License-Identifier: BSD-3-Clause
# A big-endian processor is refused in words, by CMake and by the compiler:
#   cmake -D SOURCE_DIR=... -D COMPILER=... -P big_endian.cmake
cmake_policy(VERSION 3.25)
set(source ${SOURCE_DIR}/src/numerics/instruction_sets.cpp)
set(refuse ${SOURCE_DIR}/cmake/RefuseBigEndian.cmake)
foreach(order LITTLE BIG)
  execute_process(COMMAND ${CMAKE_COMMAND} -D CMAKE_CXX_BYTE_ORDER=${order}_ENDIAN -D CMAKE_SYSTEM_PROCESSOR=s390x
    -P ${refuse} RESULT_VARIABLE cmake_${order} ERROR_VARIABLE cmake_said_${order})
  execute_process(COMMAND ${COMPILER} -std=c++17 -fsyntax-only -I${SOURCE_DIR}/src -U__BYTE_ORDER__
    -D__BYTE_ORDER__=__ORDER_${order}_ENDIAN__ ${source} RESULT_VARIABLE cxx_${order} ERROR_VARIABLE cxx_said_${order})
endforeach()
foreach(tool cmake cxx)
  if(NOT ${tool}_LITTLE EQUAL 0)
    message(FATAL_ERROR "${tool} refuses a little-endian processor:\n${${tool}_said_LITTLE}")
  endif()
  if(${tool}_BIG EQUAL 0 OR NOT ${tool}_said_BIG MATCHES "big-endian")
    message(FATAL_ERROR "${tool} does not refuse a big-endian processor by that word: ${${tool}_BIG}\n${${tool}_said_BIG}")
  endif()
endforeach()
message("a big-endian processor is refused by CMake and by the compiler")
