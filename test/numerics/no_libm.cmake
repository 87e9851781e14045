# SPDX-License-Identifier: BSD-3-Clause
# Fails when an object calls a function of libm whose result rests on no promise (sin, exp, ...), outside of those that
# make motions, report poses or only choose what is then proven. sqrt, ldexp and the rounding functions are exact or an
# instruction; hypot is within 1 ulp, and allowed for.
string(REPLACE "|" ";" OBJECTS "${OBJECTS}")
set(others
  kinematics/                      # makes motions from joint values; poses for reports
  fcl/fcl_motion          # makes motions from FCL's
  fcl/fcl_link_motion     # gives FCL poses
  tables/contact_grid tables/bring_together  # guesses, proven afterwards
  certificate/moving_world          # hints for a verifier
  query/link_pairs                  # configurations to try
  geometry/outer_hull geometry/line_swept_sphere geometry/inner_balls  # directions and sizes to try
  visibility/adversary)            # where to look
set(inexact "a?(sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(2|10|1p)?|pow|cbrt|erfc?|[tl]gamma")
set(faults "")
set(looked_at 0)
set(libm_elsewhere 0)
foreach(object IN LISTS OBJECTS)
  execute_process(COMMAND ${NM} --undefined-only ${object} OUTPUT_VARIABLE symbols RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${NM} can't read ${object}")
  endif()
  string(REGEX MATCHALL "[ \t]U (${inexact})[fl]?(@[^\n]*)?\n" calls "${symbols}")
  math(EXPR looked_at "${looked_at} + 1")
  if(NOT calls)
    continue()
  endif()
  set(allowed FALSE)
  foreach(part IN LISTS others)
    if(object MATCHES "/src/${part}|/${part}" )
      set(allowed TRUE)
    endif()
  endforeach()
  if(allowed)
    math(EXPR libm_elsewhere "${libm_elsewhere} + 1")
  else()
    string(REGEX REPLACE "[ \t\n;]*U " " " calls "${calls}")
    string(APPEND faults "  ${object}:${calls}\n")
  endif()
endforeach()
message("${looked_at} objects, ${libm_elsewhere} of them make motions, report or guess by libm")
if(looked_at LESS 30 OR libm_elsewhere EQUAL 0)
  message(FATAL_ERROR "more objects expected, and calls of libm where they are allowed")
endif()
if(faults)
  message(FATAL_ERROR "libm in what may be a bound:\n${faults}")
endif()
