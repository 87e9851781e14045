# SPDX-License-Identifier: BSD-3-Clause
# Debian's cross compiler for 64-bit ARM, with Debian's arm64 packages unpacked in a folder (scripts/test-arm64 makes it),
# and qemu's user mode to run what is built.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

set(FCL_ARTIC_SYSROOT "" CACHE PATH "Folder with Debian's arm64 packages unpacked")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES FCL_ARTIC_SYSROOT)
if(NOT EXISTS "${FCL_ARTIC_SYSROOT}/usr/include/fcl")
  message(FATAL_ERROR "FCL_ARTIC_SYSROOT='${FCL_ARTIC_SYSROOT}' has no usr/include/fcl: scripts/test-arm64 --setup makes "
    "such a folder, build/arm64-root, which the preset arm64 names")
endif()
get_filename_component(CMAKE_SYSROOT "${FCL_ARTIC_SYSROOT}" ABSOLUTE)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${CMAKE_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR}
  "${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/lib/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig")
find_program(FCL_ARTIC_QEMU NAMES qemu-aarch64-static qemu-aarch64)
if(FCL_ARTIC_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${FCL_ARTIC_QEMU} -L ${CMAKE_SYSROOT})
endif()
