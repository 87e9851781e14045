# SPDX-License-Identifier: BSD-3-Clause
# Run by ctest: cmake -DCASE=... -DSOURCE=<repository> -DBUILD=<build folder> -DWORK=<scratch folder> ... -P test.cmake
cmake_policy(VERSION 3.22)
set(stage "${BUILD}/stage")

# Runs a command; `EXPECT_FAILURE` turns what is right round. Its whole output is left in `output`.
function(run)
  cmake_parse_arguments(arg "EXPECT_FAILURE" "" "COMMAND" ${ARGN})
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  list(JOIN arg_COMMAND " " line)
  message(STATUS "${line}\n${out}")
  if(arg_EXPECT_FAILURE AND status EQUAL 0)
    message(FATAL_ERROR "this should have failed: ${line}")
  elseif(NOT arg_EXPECT_FAILURE AND NOT status EQUAL 0)
    message(FATAL_ERROR "status ${status}: ${line}")
  endif()
  string(REGEX REPLACE "[ \n]+" " " out "${out}")
  set(output "${out}" PARENT_SCOPE)
endfunction()

function(expect_output text)
  string(FIND "${output}" "${text}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "the output lacks '${text}'")
  endif()
endfunction()

file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
set(configure "${CMAKE_COMMAND}" -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_BUILD_TYPE=Release")

if(CASE STREQUAL "install")
  # What all other cases use has been moved after it was installed.
  file(REMOVE_RECURSE "${stage}" "${WORK}/first")
  run(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/first")
  file(RENAME "${WORK}/first" "${stage}")
  foreach(file IN ITEMS include/fcl_artic/fcl_artic.h share/fcl_artic/puma560/puma560.urdf share/fcl_artic/pipes.obj
          share/fcl_artic/package.xml share/doc/fcl_artic/LICENSE)
    if(NOT EXISTS "${stage}/${file}")
      message(FATAL_ERROR "not installed: ${file}")
    endif()
  endforeach()
  # No link of an installed page dangles.
  file(GLOB_RECURSE pages "${stage}/share/doc/fcl_artic/*.md")
  set(links 0)
  foreach(page IN LISTS pages)
    file(READ "${page}" text)
    string(REPLACE "](" "@(" text "${text}")  # a list's items must not hold brackets
    string(REGEX MATCHALL "@\\([^)#:]+\\)" found "${text}")
    get_filename_component(folder "${page}" DIRECTORY)
    foreach(link IN LISTS found)
      string(REGEX REPLACE "^..(.*).$" "\\1" target "${link}")
      math(EXPR links "${links} + 1")
      if(NOT EXISTS "${folder}/${target}")
        message(FATAL_ERROR "${page}: links to ${target}, which is not installed")
      endif()
    endforeach()
  endforeach()
  if(links LESS 15)
    message(FATAL_ERROR "only ${links} links in the installed pages: not what is meant")
  endif()
  if(WITH_APP)
    if(NOT EXISTS "${stage}/share/man/man1/fcl_artic.1")
      message(FATAL_ERROR "the man page is not installed")
    endif()
    run(COMMAND "${stage}/bin/fcl_artic" --version)
    expect_output("${VERSION}")
  endif()

elseif(CASE STREQUAL "cmake")
  string(REPLACE "|" ";" prefixes "${stage}|${PREFIXES}")  # where pinocchio and tesseract are found
  run(COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${prefixes}" "-DWITH_URDF=${WITH_URDF}"
      "-DWITH_OMPL=${WITH_OMPL}" "-DWITH_VISIBILITY=${WITH_VISIBILITY}" "-DWITH_PINOCCHIO=${WITH_PINOCCHIO}"
      "-DWITH_TESSERACT=${WITH_TESSERACT}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
      -S "${SOURCE}/test/consumer" -B "${WORK}/build")
  run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/build")
  run(COMMAND "${WORK}/build/core")
  if(NOT CXX_FLAGS MATCHES "-fsanitize")  # a user looks for faults in a program of his own
    run(COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${stage}" -DWITH_URDF=OFF "-DCMAKE_CXX_FLAGS=${CXX_FLAGS} -fsanitize=address"
        -S "${SOURCE}/test/consumer" -B "${WORK}/sanitized")
    run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/sanitized" --target core)
    run(COMMAND "${WORK}/sanitized/core")
  endif()
  run(COMMAND "${WORK}/build/dropin_fcl")
  run(COMMAND "${WORK}/build/dropin_fcl_artic")
  if(WITH_URDF)
    run(COMMAND "${WORK}/build/robot" "${stage}/share/fcl_artic")
  endif()
  if(WITH_OMPL)
    run(COMMAND "${WORK}/build/planner" "${stage}/share/fcl_artic")
  endif()
  if(WITH_VISIBILITY)
    run(COMMAND "${WORK}/build/culler")
  endif()
  if(WITH_PINOCCHIO)
    run(COMMAND "${WORK}/build/from_pinocchio")
    expect_output("hand and post")
  endif()
  if(WITH_TESSERACT)
    run(COMMAND "${WORK}/build/from_tesseract")
    expect_output("hand/0 and post/0")
  endif()
  if(WITH_URDF)  # the project that the manual shows
    file(COPY "${SOURCE}/doc/manual/snippets/project/CMakeLists.txt" DESTINATION "${WORK}/project")
    file(COPY_FILE "${SOURCE}/example/first_check.cpp" "${WORK}/project/main.cpp")
    run(COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${stage}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
        -S "${WORK}/project" -B "${WORK}/project/build")
    run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/project/build")
    run(COMMAND "${CMAKE_COMMAND}" -E chdir "${SOURCE}" "${WORK}/project/build/my_checker")
    expect_output("wrist_roll and pipes")
  endif()

elseif(CASE STREQUAL "missing_component")
  file(WRITE "${WORK}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.22)\nproject(needs_more LANGUAGES CXX)\n"
    "find_package(fcl_artic REQUIRED COMPONENTS no_such_component)\n")
  run(EXPECT_FAILURE COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${stage}" -S "${WORK}" -B "${WORK}/build")
  expect_output("was built without the component 'no_such_component'")
  if(NOT WITH_PINOCCHIO)  # header-only: installed all the same
    file(WRITE "${WORK}/library/CMakeLists.txt" "cmake_minimum_required(VERSION 3.22)\nproject(needs_more LANGUAGES CXX)\n"
      "find_package(fcl_artic REQUIRED COMPONENTS pinocchio)\n")
    run(EXPECT_FAILURE COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${stage}" -S "${WORK}/library" -B "${WORK}/library/build")
    expect_output("'pinocchio' needs pinocchio with coal, which is not found")
  endif()

elseif(CASE STREQUAL "pkg_config")
  set(ENV{PKG_CONFIG_PATH} "${stage}/${LIBDIR}/pkgconfig")
  set(packages fcl_artic)
  if(WITH_URDF)
    list(APPEND packages fcl_artic_urdf)
  endif()
  if(WITH_OMPL)
    list(APPEND packages fcl_artic_ompl)
  endif()
  if(WITH_VISIBILITY)
    list(APPEND packages fcl_artic_visibility)
  endif()
  foreach(package IN LISTS packages)
    execute_process(COMMAND pkg-config --modversion ${package} OUTPUT_VARIABLE version
      OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    if(NOT version STREQUAL VERSION)
      message(FATAL_ERROR "${package}.pc gives version '${version}', not ${VERSION}")
    endif()
    execute_process(COMMAND pkg-config --cflags --libs ${package} OUTPUT_VARIABLE flags
      OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    separate_arguments(flags UNIX_COMMAND "${CXX_FLAGS} ${flags}")
    if(package STREQUAL "fcl_artic")
      set(program core)
    elseif(package STREQUAL "fcl_artic_ompl")
      set(program planner)
    elseif(package STREQUAL "fcl_artic_visibility")
      set(program culler)
    else()
      set(program robot)
    endif()
    if(package STREQUAL "fcl_artic" AND NOT CXX_FLAGS MATCHES "-fsanitize")
      run(COMMAND "${CXX}" -std=c++17 -fsanitize=address "${SOURCE}/test/consumer/core.cpp" -o "${WORK}/sanitized" ${flags})
      run(COMMAND "${CMAKE_COMMAND}" -E env "LD_LIBRARY_PATH=${stage}/${LIBDIR}" "${WORK}/sanitized")
    endif()
    # Flags come last, as a user may have them: they are not to take C++17 away.
    run(COMMAND "${CXX}" -std=c++17 "${SOURCE}/test/consumer/${program}.cpp" -o "${WORK}/${program}" ${flags})
    run(COMMAND "${CMAKE_COMMAND}" -E env "LD_LIBRARY_PATH=${stage}/${LIBDIR}" "${WORK}/${program}"
        "${stage}/share/fcl_artic")
  endforeach()

elseif(CASE STREQUAL "subproject")
  # The parent says nothing, static, or shared and its own build type.
  set(configure "${CMAKE_COMMAND}" -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
    "-DFCL_ARTIC_SOURCE=${SOURCE}" -S "${SOURCE}/test/subproject")
  set(ENV{CMAKE_BUILD_TYPE} "")
  run(COMMAND ${configure} -B "${WORK}/silent")
  expect_output("fcl_artic is a SHARED_LIBRARY")
  run(COMMAND ${configure} -B "${WORK}/static" -DBUILD_SHARED_LIBS=OFF -DCMAKE_BUILD_TYPE=Debug)
  expect_output("fcl_artic is a STATIC_LIBRARY")
  run(COMMAND ${configure} -B "${WORK}/shared" -DBUILD_SHARED_LIBS=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo)
  expect_output("fcl_artic is a SHARED_LIBRARY")

elseif(CASE STREQUAL "static")
  # The whole of it as static libraries, used as installed.
  run(COMMAND ${configure} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" -DBUILD_SHARED_LIBS=OFF -DFCL_ARTIC_BUILD_TESTS=OFF
      -DFCL_ARTIC_BUILD_BENCH=OFF -DFCL_ARTIC_BUILD_EXAMPLES=OFF -S "${SOURCE}" -B "${WORK}/library")
  run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/library")
  run(COMMAND "${CMAKE_COMMAND}" --install "${WORK}/library" --prefix "${WORK}/stage")
  run(COMMAND ${configure} "-DCMAKE_PREFIX_PATH=${WORK}/stage" "-DWITH_URDF=${WITH_URDF}" "-DWITH_OMPL=${WITH_OMPL}"
      "-DWITH_VISIBILITY=${WITH_VISIBILITY}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
      -S "${SOURCE}/test/consumer" -B "${WORK}/build")
  run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/build")
  run(COMMAND "${WORK}/build/core")
  foreach(program robot planner culler)
    if(EXISTS "${WORK}/build/${program}")
      run(COMMAND "${WORK}/build/${program}" "${WORK}/stage/share/fcl_artic")
    endif()
  endforeach()
  file(GLOB core "${WORK}/stage/${LIBDIR}/libfcl_artic.*")
  if(NOT core STREQUAL "${WORK}/stage/${LIBDIR}/libfcl_artic.a")
    message(FATAL_ERROR "not a static library: ${core}")
  endif()

elseif(CASE STREQUAL "within")
  # As part of a project that takes it in by add_subdirectory or by FetchContent: built, linked and run.
  foreach(way IN ITEMS add_subdirectory FetchContent)
    file(WRITE "${WORK}/${way}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.22)\nproject(parent LANGUAGES CXX)\n")
    if(way STREQUAL "FetchContent")
      file(APPEND "${WORK}/${way}/CMakeLists.txt" "include(FetchContent)\n"
        "FetchContent_Declare(fcl_artic SOURCE_DIR \"${SOURCE}\")\nFetchContent_MakeAvailable(fcl_artic)\n")
    else()
      file(APPEND "${WORK}/${way}/CMakeLists.txt" "add_subdirectory(\"${SOURCE}\" fcl_artic)\n")
    endif()
    file(APPEND "${WORK}/${way}/CMakeLists.txt" "add_executable(core \"${SOURCE}/test/consumer/core.cpp\")\n"
      "target_link_libraries(core PRIVATE fcl_artic::fcl_artic)\n")
    run(COMMAND ${configure} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" -S "${WORK}/${way}" -B "${WORK}/${way}/build")
    run(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/${way}/build" --target core)
    run(COMMAND "${WORK}/${way}/build/core")
  endforeach()

elseif(CASE STREQUAL "wheel")
  # pip builds a wheel without a network; in a fresh environment it is imported, asked, and removed without a trace.
  run(COMMAND "${PYTHON}" -m venv --system-site-packages "${WORK}/env")
  file(GLOB_RECURSE before "${WORK}/env/*")
  run(COMMAND "${WORK}/env/bin/python" -m pip install --no-index "${SOURCE}")
  run(COMMAND "${CMAKE_COMMAND}" -E env --unset=PYTHONPATH "${CMAKE_COMMAND}" -E chdir "${SOURCE}"
      "${WORK}/env/bin/python" -B -c "import fcl_artic
robot = fcl_artic.load_urdf('data/puma560/puma560.urdf')
print(fcl_artic.__file__, fcl_artic.World(robot).check([0] * 6, [0.1] * 6))")
  expect_output("${WORK}/env/")
  expect_output("free: proven")
  run(COMMAND "${WORK}/env/bin/python" -m pip uninstall -y fcl_artic)
  file(GLOB_RECURSE after "${WORK}/env/*")
  list(FILTER after EXCLUDE REGEX "/__pycache__/")
  list(FILTER before EXCLUDE REGEX "/__pycache__/")
  if(NOT after STREQUAL before)
    list(REMOVE_ITEM after ${before})
    message(FATAL_ERROR "left by pip uninstall: ${after}")
  endif()

elseif(CASE STREQUAL "ros")
  # package.xml says what scripts/setup installs, in rosdep's names, and the project's version.
  set(names eigen=libeigen3-dev libfcl-dev=libfcl-dev libccd-dev=libccd-dev liboctomap-dev=liboctomap-dev tbb=libtbb-dev
    liburdfdom-dev=liburdfdom-dev liburdfdom-headers-dev=liburdfdom-headers-dev
    libconsole-bridge-dev=libconsole-bridge-dev assimp=libassimp-dev
    tinyxml2=libtinyxml2-dev ompl=libompl-dev opengl=libgl-dev libosmesa6-dev=libosmesa6-dev cli11=libcli11-dev
    nlohmann-json-dev=nlohmann-json3-dev fmt=libfmt-dev libpng-dev=libpng-dev yaml-cpp=libyaml-cpp-dev hdf5=libhdf5-dev mpi=libopenmpi-dev zlib=zlib1g-dev libgmp=libgmp-dev mpfr=libmpfr-dev
    pybind11-dev=pybind11-dev python3-dev=python3-dev python3-numpy=python3-numpy gtest=libgtest-dev
    benchmark=libbenchmark-dev boost=libboost-graph-dev python3-pytest=python3-pytest python3-mypy=mypy python3-networkx=python3-networkx python3-tqdm=python3-tqdm
    doxygen=doxygen python3-sphinx=python3-sphinx python3-breathe=python3-breathe cmake=cmake pkg-config=pkg-config)
  file(READ "${SOURCE}/package.xml" xml)
  if(NOT xml MATCHES "<version>${VERSION}</version>")
    message(FATAL_ERROR "package.xml has another version than ${VERSION}")
  endif()
  string(REGEX MATCHALL "depend>[a-z0-9-]+</" keys "${xml}")
  list(TRANSFORM keys REPLACE "depend>(.*)</" "\\1")
  file(READ "${SOURCE}/scripts/setup" setup)
  string(REGEX REPLACE "#[^\n]*" "" setup "${setup}")
  string(REGEX MATCHALL "_packages=\\([^)]*\\)" setup "${setup}")
  string(REGEX MATCHALL "[a-z0-9.+-]+" installed "${setup}")
  set(covered)
  foreach(key IN LISTS keys)
    set(package)
    foreach(name IN LISTS names)
      if(name MATCHES "^${key}=(.*)$")
        set(package ${CMAKE_MATCH_1})
      endif()
    endforeach()
    if(NOT package OR NOT package IN_LIST installed)
      message(FATAL_ERROR "package.xml asks for ${key}, which scripts/setup does not install")
    endif()
    list(APPEND covered ${package})
  endforeach()
  list(FILTER installed INCLUDE REGEX "-dev$")
  # Of Debian's packages only; coming with opengl; of the proven checker only.
  list(REMOVE_ITEM installed dpkg-dev libegl-dev libzarith-ocaml-dev)
  foreach(package IN LISTS installed)
    if(NOT package IN_LIST covered)
      message(FATAL_ERROR "package.xml lacks ${package}, which scripts/setup installs")
    endif()
  endforeach()

elseif(CASE STREQUAL "fast_math")
  foreach(flag IN ITEMS -ffast-math -Ofast -funsafe-math-optimizations)
    run(EXPECT_FAILURE COMMAND ${configure} "-DCMAKE_CXX_FLAGS=-g ${flag}" -S "${SOURCE}" -B "${WORK}/build")
    expect_output("fcl_artic can't be built with ${flag}")
  endforeach()

elseif(CASE STREQUAL "readme")
  file(READ "${SOURCE}/README.md" readme)
  file(READ "${SOURCE}/example/first_check.cpp" example)
  string(REGEX REPLACE "^[^\n]*SPDX[^\n]*\n" "" example "${example}")
  string(FIND "${readme}" "```cpp\n${example}```" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "README.md doesn't show example/first_check.cpp as it is")
  endif()

else()
  message(FATAL_ERROR "unknown case '${CASE}'")
endif()
