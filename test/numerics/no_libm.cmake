# SPDX-License-Identifier: BSD-3-Clause
# Fails when an object calls a function of libm whose result rests on no promise (sin, exp, ...), outside of the target
# fcl_artic_choices, whose sources make motions from joint values, report poses, or only choose what is then proven. sqrt,
# ldexp and the rounding functions are exact or an instruction; hypot is within 1 ulp, and allowed for.
#   cmake -D NM=... -D OBJECTS=a.o|b.o -D CHOICES=c.o -P no_libm.cmake
set(inexact "a?(sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(2|10|1p)?|pow|cbrt|erfc?|[tl]gamma")
# The calls in an object, separated by blanks.
function(calls_of object result)
  execute_process(COMMAND ${NM} --undefined-only ${object} OUTPUT_VARIABLE symbols RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${NM} can't read ${object}")
  endif()
  string(REGEX MATCHALL "[ \t]U (${inexact})[fl]?(@[^\n]*)?\n" calls "${symbols}")
  string(REGEX REPLACE "[ \t\n;]*U " " " calls "${calls}")
  set(${result} "${calls}" PARENT_SCOPE)
endfunction()

string(REPLACE "|" ";" OBJECTS "${OBJECTS}")
string(REPLACE "|" ";" CHOICES "${CHOICES}")
list(FILTER OBJECTS EXCLUDE REGEX "\\.(gch|pch)$")  # CMake lists precompiled headers, too
list(FILTER CHOICES EXCLUDE REGEX "\\.(gch|pch)$")
set(faults "")
list(LENGTH OBJECTS looked_at)
foreach(object IN LISTS OBJECTS)
  calls_of(${object} calls)
  if(calls)
    string(APPEND faults "  ${object}:${calls}\n")
  endif()
endforeach()
set(elsewhere "")
foreach(object IN LISTS CHOICES)
  calls_of(${object} calls)
  string(APPEND elsewhere "${calls}")
endforeach()
message("${looked_at} objects; what makes motions, reports or chooses calls${elsewhere}")
if(looked_at LESS 8 OR NOT elsewhere MATCHES "sin")
  message(FATAL_ERROR "more objects expected, and calls of libm where they are allowed")
endif()
if(faults)
  message(FATAL_ERROR "libm in what may be a bound:\n${faults}")
endif()
