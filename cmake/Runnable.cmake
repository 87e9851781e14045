# SPDX-License-Identifier: BSD-3-Clause
# fcl_artic_command(<target> <variable>): what a shell or a test runs as the program that the target builds, as a generator
# expression: the program itself; in a cross build a script that starts it in the emulator (CMAKE_CROSSCOMPILING_EMULATOR).
function(fcl_artic_command target variable)
  set(program "$<TARGET_FILE:${target}>")
  if(CMAKE_CROSSCOMPILING AND CMAKE_CROSSCOMPILING_EMULATOR)
    set(script ${CMAKE_CURRENT_BINARY_DIR}/emulated_${target})
    list(JOIN CMAKE_CROSSCOMPILING_EMULATOR "' '" emulator)
    file(GENERATE OUTPUT ${script} CONTENT "#!/bin/sh\nexec '${emulator}' '${program}' \"$@\"\n"
      FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
    set(program ${script})
  endif()
  set(${variable} ${program} PARENT_SCOPE)
endfunction()
