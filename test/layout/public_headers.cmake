# SPDX-License-Identifier: BSD-3-Clause
# Fails where a public header does not compile in a user's project of another C++ standard, compiler or set of warnings:
# all of
# them in one source, in each standard, with conversions that may change a value or a sign as errors (that each compiles by
# itself is headers_alone.cmake's). Headers of others are system headers.
#   cmake -D SOURCE_DIR=... -D COMPILER=... -D STANDARDS=17|20|... -D PARTS=...|... -D SYSTEM_INCLUDES=...|... -D WORK=... -P ...
cmake_policy(VERSION 3.25)
foreach(list STANDARDS PARTS SYSTEM_INCLUDES)
  string(REPLACE "|" ";" ${list} "${${list}}")
endforeach()
set(flags -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror -I${SOURCE_DIR}/include)
foreach(folder IN LISTS SYSTEM_INCLUDES)
  list(APPEND flags -isystem ${folder})
endforeach()
list(TRANSFORM PARTS PREPEND ${SOURCE_DIR}/)
file(GLOB headers RELATIVE ${SOURCE_DIR}/include ${PARTS})
list(LENGTH headers count)
if(count LESS 20)
  message(FATAL_ERROR "only ${count} public headers were found")
endif()
set(text "")
foreach(header IN LISTS headers)
  string(APPEND text "#include <${header}>\n")
endforeach()
file(MAKE_DIRECTORY ${WORK})
file(WRITE ${WORK}/all.cpp "${text}")
foreach(standard IN LISTS STANDARDS)
  execute_process(COMMAND ${COMPILER} -std=${standard} ${flags} ${WORK}/all.cpp RESULT_VARIABLE status ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${COMPILER} -std=${standard}:\n${said}")
  endif()
  message("${COMPILER} -std=${standard}: ${count} public headers without a warning")
endforeach()
