# SPDX-License-Identifier: BSD-3-Clause
# Debian packages, by CPack (preset and script `package`):  cmake --build build/package --target package
# They need a build of their own, as paths below /usr are Debian's: where libraries and Python packages lie, no RPATH.
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr" OR NOT BUILD_SHARED_LIBS)
  message(FATAL_ERROR "FCL_ARTIC_PACKAGES wants CMAKE_INSTALL_PREFIX=/usr and shared libraries, as the preset `package` sets them")
endif()
foreach(target fcl_artic_urdf fcl_artic_visibility fcl_artic_ompl fcl_artic_program fcl_artic_mpi fcl_artic_verify
    fcl_artic_prove fcl_artic_python)
  if(NOT TARGET ${target})
    message(FATAL_ERROR "FCL_ARTIC_PACKAGES: ${target} is not built; scripts/setup installs what it needs")
  endif()
endforeach()

set(fcl_artic_library_package libfcl-artic${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${fcl_artic_library_package})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libfcl-artic-dev)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME fcl-artic)
set(CPACK_DEBIAN_PROVER_PACKAGE_NAME fcl-artic-prove)
set(CPACK_DEBIAN_MPI_PACKAGE_NAME fcl-artic-mpi)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-fcl-artic)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME fcl-artic-doc)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL library development program prover mpi python documentation)
set(CPACK_PACKAGE_NAME fcl-artic)
set(CPACK_PACKAGE_VENDOR "the fcl_artic authors")
set(CPACK_PACKAGE_CONTACT "The fcl_artic maintainers <fcl_artic@example.org>")  # as in package.xml
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_DEBUGINFO_PACKAGE OFF)
set(fcl_artic_same_version "= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# What each says of itself, and what it needs beyond the libraries that dpkg-shlibdeps finds.
function(fcl_artic_describe component title text)
  set(CPACK_COMPONENT_${component}_DESCRIPTION "certified continuous collision detection (${title})
Given a robot (URDF and meshes) and a motion of all its joints, fcl_artic says
what touches first, where and when, or proves that nothing does. It samples
nothing, so that no thin obstacle is stepped over.

${text}" PARENT_SCOPE)
endfunction()
fcl_artic_describe(LIBRARY "libraries" "This package has the libraries.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
# Who links the libraries depends on this package; ld.so's cache is renewed. (CPack's own shlibs leave components out.)
set(fcl_artic_shlibs)
foreach(part "" _urdf _visibility _ompl)
  string(APPEND fcl_artic_shlibs "libfcl_artic${part} ${PROJECT_VERSION_MAJOR} "
    "${fcl_artic_library_package} (>= ${PROJECT_VERSION})\n")
endforeach()
file(WRITE "${PROJECT_BINARY_DIR}/packages/shlibs" "${fcl_artic_shlibs}")
file(WRITE "${PROJECT_BINARY_DIR}/packages/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA
  "${PROJECT_BINARY_DIR}/packages/shlibs;${PROJECT_BINARY_DIR}/packages/triggers")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "libosmesa6 | libegl1")  # looked for when it runs, for pictures

fcl_artic_describe(DEVELOPMENT "headers" "This package has headers, CMake package and pkg-config files.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "${fcl_artic_library_package} (${fcl_artic_same_version}), libfcl-dev, libccd-dev, liboctomap-dev, libeigen3-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libompl-dev")  # for the component ompl
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "fcl-artic-doc")

fcl_artic_describe(PROGRAM "program" "This package has the program fcl_artic, the verifier fcl_artic_verify, which
proves answers again without any of the library's code, and a robot and a
scene to try them on.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${fcl_artic_library_package} (${fcl_artic_same_version})")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "fcl-artic-doc, fcl-artic-mpi")

fcl_artic_describe(PROVER "proven checker" "This package has the program fcl_artic_prove, which checks certificates by a
checker that is proven in Coq. It needs none of the other packages.")
set(CPACK_DEBIAN_PROVER_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROVER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROVER_PACKAGE_SUGGESTS "fcl-artic, fcl-artic-doc")

fcl_artic_describe(MPI "MPI" "This package has the program's plug-in for MPI, with which the ranks of a job
certify many motions in many scenes together.")
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "fcl-artic (${fcl_artic_same_version}), openmpi-bin")

fcl_artic_describe(PYTHON "Python" "This package has the Python module fcl_artic.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
get_directory_property(Python_VERSION_MINOR DIRECTORY "${PROJECT_SOURCE_DIR}/python" DEFINITION Python_VERSION_MINOR)
math(EXPR fcl_artic_next_python "${Python_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "${fcl_artic_library_package} (${fcl_artic_same_version}), python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${fcl_artic_next_python}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "fcl-artic-doc")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/packages/postinst;${CMAKE_CURRENT_LIST_DIR}/packages/prerm")

fcl_artic_describe(DOCUMENTATION "manual" "This package has the manual, the proofs, and examples.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)

# dpkg-shlibdeps looks for our own libraries where they are built; what they stand for is said above.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src" "${PROJECT_BINARY_DIR}/src/adapters/urdf"
  "${PROJECT_BINARY_DIR}/src/adapters/ompl" "${PROJECT_BINARY_DIR}/src/visibility")

# Each package says under which licences it comes and what changed.
string(TIMESTAMP fcl_artic_date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where that is set
configure_file("${CMAKE_CURRENT_LIST_DIR}/packages/changelog.in" "${PROJECT_BINARY_DIR}/packages/changelog.Debian" @ONLY)
configure_file("${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${PROJECT_BINARY_DIR}/packages/changelog" COPYONLY)
include("${CMAKE_CURRENT_LIST_DIR}/packages/Sbom.cmake")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} key)
  set(folder "${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_DEBIAN_${key}_PACKAGE_NAME}")
  install(FILES "${CMAKE_CURRENT_LIST_DIR}/packages/copyright" "${PROJECT_BINARY_DIR}/packages/changelog.Debian"
    "${PROJECT_BINARY_DIR}/packages/changelog" DESTINATION "${folder}" COMPONENT ${component})
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/packages/fcl_artic.spdx"
  DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/doc/${fcl_artic_library_package}" COMPONENT library)
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/packages/tidy_tree.cmake")
include(CPack)
