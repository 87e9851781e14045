# SPDX-License-Identifier: BSD-3-Clause
# What is installed beside the program: headers, libraries, CMake package with its components, pkg-config files,
# licence and data. Each component has an export set of its own, so that the package knows what it has. What is installed
# together with what (COMPONENT): library, development, program, mpi, python, documentation.
include(CMakePackageConfigHelpers)
set(fcl_artic_cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/fcl_artic")

function(fcl_artic_install_library target)
  install(TARGETS ${target} EXPORT ${target}Targets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
  install(EXPORT ${target}Targets NAMESPACE fcl_artic:: DESTINATION "${fcl_artic_cmake_dir}" COMPONENT development)
endfunction()
fcl_artic_install_library(fcl_artic)
set(absent_headers)
foreach(component urdf ompl visibility pinocchio tesseract)
  if(TARGET fcl_artic_${component})
    fcl_artic_install_library(fcl_artic_${component})
  else()
    list(APPEND absent_headers PATTERN ${component} EXCLUDE)
  endif()
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/fcl_artic" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development
  ${absent_headers})
foreach(component Ompl Pinocchio Tesseract)  # what finds the library of each
  string(TOLOWER ${component} target)
  if(TARGET fcl_artic_${target})
    install(FILES "${PROJECT_SOURCE_DIR}/cmake/FclArtic${component}.cmake" DESTINATION "${fcl_artic_cmake_dir}"
      COMPONENT development)
  endif()
endforeach()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/fcl_articConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/fcl_articConfig.cmake" INSTALL_DESTINATION "${fcl_artic_cmake_dir}")
# Before 1.0 a new minor version may break callers.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/fcl_articConfigVersion.cmake" COMPATIBILITY SameMajorVersion)
install(FILES "${PROJECT_BINARY_DIR}/fcl_articConfig.cmake" "${PROJECT_BINARY_DIR}/fcl_articConfigVersion.cmake"
  DESTINATION "${fcl_artic_cmake_dir}" COMPONENT development)

# Relative to the .pc file, so that a moved tree works; absolute install folders stay as they are.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
  set(fcl_artic_pc_prefix "${CMAKE_INSTALL_PREFIX}")
  set(fcl_artic_pc_libdir "${CMAKE_INSTALL_FULL_LIBDIR}")
  set(fcl_artic_pc_includedir "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
else()
  file(RELATIVE_PATH fcl_artic_up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  set(fcl_artic_pc_prefix "\${pcfiledir}/${fcl_artic_up}")
  string(REGEX REPLACE "/$" "" fcl_artic_pc_prefix "${fcl_artic_pc_prefix}")
  set(fcl_artic_pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
  set(fcl_artic_pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()
set(fcl_artic_pc_definitions "")
if(FCL_ARTIC_INTERFACE_DEFINITIONS)
  set(fcl_artic_pc_definitions " -D${FCL_ARTIC_INTERFACE_DEFINITIONS}")
endif()
configure_file("${PROJECT_SOURCE_DIR}/cmake/fcl_artic.pc.in" "${PROJECT_BINARY_DIR}/fcl_artic.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/fcl_artic.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
  COMPONENT development)
if(TARGET fcl_artic_urdf)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/fcl_artic_urdf.pc.in" "${PROJECT_BINARY_DIR}/fcl_artic_urdf.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/fcl_artic_urdf.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
    COMPONENT development)
endif()
if(TARGET fcl_artic_visibility)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/fcl_artic_visibility.pc.in" "${PROJECT_BINARY_DIR}/fcl_artic_visibility.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/fcl_artic_visibility.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
    COMPONENT development)
endif()
if(TARGET fcl_artic_ompl)
  set(fcl_artic_pc_ompl_target fcl_artic::ompl_library)
  if(TARGET ompl::ompl)
    set(fcl_artic_pc_ompl_target ompl::ompl)
  endif()
  get_target_property(fcl_artic_pc_ompl_include ${fcl_artic_pc_ompl_target} INTERFACE_INCLUDE_DIRECTORIES)
  list(GET fcl_artic_pc_ompl_include 0 fcl_artic_pc_ompl_include)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/fcl_artic_ompl.pc.in" "${PROJECT_BINARY_DIR}/fcl_artic_ompl.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/fcl_artic_ompl.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
    COMPONENT development)
endif()

install(DIRECTORY "${PROJECT_SOURCE_DIR}/data/puma560" DESTINATION "${CMAKE_INSTALL_DATADIR}/fcl_artic" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/data/pipes.obj" DESTINATION "${CMAKE_INSTALL_DATADIR}/fcl_artic" COMPONENT program)
install(FILES "${PROJECT_SOURCE_DIR}/package.xml" DESTINATION "${CMAKE_INSTALL_DATADIR}/fcl_artic" COMPONENT development)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
  DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT documentation)
# What the README and the pages it names link to, as it lies in the repository.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/doc" "${PROJECT_SOURCE_DIR}/example" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  COMPONENT documentation PATTERN man EXCLUDE PATTERN manual EXCLUDE PATTERN CMakeLists.txt EXCLUDE)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/doc/manual" DESTINATION "${CMAKE_INSTALL_DOCDIR}/doc" COMPONENT documentation
  FILES_MATCHING PATTERN "*.md")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/python/example" DESTINATION "${CMAKE_INSTALL_DOCDIR}/python"
  COMPONENT documentation)
foreach(folder data bench)
  install(FILES "${PROJECT_SOURCE_DIR}/${folder}/README.md" DESTINATION "${CMAKE_INSTALL_DOCDIR}/${folder}"
    COMPONENT documentation)
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/bench/results" DESTINATION "${CMAKE_INSTALL_DOCDIR}/bench"
  COMPONENT documentation)
