# SPDX-License-Identifier: BSD-3-Clause
# Run by CPack on the installed trees, before they are packed: what Debian wants compressed is.
find_program(gzip gzip REQUIRED)
file(GLOB_RECURSE files "${CPACK_TEMPORARY_DIRECTORY}/*")
list(FILTER files INCLUDE REGEX "/man/man1/[^/]*\\.1$|/doc/[^/]*/changelog(\\.Debian)?$")
foreach(file IN LISTS files)
  execute_process(COMMAND "${gzip}" -9nf "${file}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
