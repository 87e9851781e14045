# SPDX-License-Identifier: BSD-3-Clause
# Fails where a source that is compiled for every processor speaks to one: intrinsics, their headers and types, and
# instructions may stand in files named for a processor only, and only a few files may ask which processor it is.
#   cmake -D SOURCE_DIR=... -P processors.cmake
cmake_policy(VERSION 3.25)
set(of_one_processor
  "^src/(numerics/(register|pair)|interval/(ends|processor))_(sse2|avx2|avx512|x86_64|neon|aarch64)\\.h$|^test/numerics/control_bits\\.h$")
set(asks "^src/(numerics/(instruction_sets\\.(h|cpp)|(baseline_isa|lanes|pair)\\.h)|interval/rounding\\.h)$")
set(speaks "intrin\\.h>|arm_neon\\.h|_mm[0-9]*_|__m(128|256|512)|float64x2_t|asm[a-z ]*[(]\"[a-z]|__builtin_ia32")
set(question "__x86_64__|__aarch64__|__SSE2__|__AVX|__ARM|__builtin_cpu_supports")

file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/src/*.h ${SOURCE_DIR}/src/*.cpp ${SOURCE_DIR}/src/*.inl
  ${SOURCE_DIR}/include/*.h ${SOURCE_DIR}/app/*.h ${SOURCE_DIR}/app/*.cpp ${SOURCE_DIR}/data/*.h ${SOURCE_DIR}/data/*.cpp
  ${SOURCE_DIR}/test/*.h ${SOURCE_DIR}/test/*.cpp ${SOURCE_DIR}/test/*.inl ${SOURCE_DIR}/bench/*.h ${SOURCE_DIR}/bench/*.cpp
  ${SOURCE_DIR}/python/*.h ${SOURCE_DIR}/python/*.cpp ${SOURCE_DIR}/verify/*.h ${SOURCE_DIR}/verify/*.cpp)
set(faults)
set(named 0)
set(asking 0)
foreach(file IN LISTS files)
  if(file MATCHES "${of_one_processor}")
    math(EXPR named "${named} + 1")
    continue()
  endif()
  file(STRINGS ${SOURCE_DIR}/${file} lines REGEX "${speaks}")
  foreach(line IN LISTS lines)
    string(APPEND faults "  ${file} speaks to one processor: ${line}\n")
  endforeach()
  if(file MATCHES "${asks}")
    math(EXPR asking "${asking} + 1")
    continue()
  endif()
  file(STRINGS ${SOURCE_DIR}/${file} lines REGEX "${question}")
  foreach(line IN LISTS lines)
    string(APPEND faults "  ${file} asks which processor it is: ${line}\n")
  endforeach()
endforeach()
list(LENGTH files count)
if(count LESS 400 OR named LESS 9 OR asking LESS 5)
  string(APPEND faults "  only ${count} files, ${named} for one processor and ${asking} that ask were seen\n")
endif()
if(faults)
  message(FATAL_ERROR "what depends on the processor stands outside the files named for it:\n${faults}")
endif()
message("${count} files: ${named} are for one processor, ${asking} ask which one it is, the others do neither")
