# SPDX-License-Identifier: BSD-3-Clause
# Makes a C++ file of the page's files:  cmake -D SOURCE=folder -D OUT=page_parts.cpp -P embed.cmake
set(code "// Made by embed.cmake.\n#include \"page_parts.h\"\n\nnamespace fcl_artic::app::page_parts {\n")
foreach(part kPage=page.html kStyle=page.css kViewer=viewer.js)
  string(REPLACE "=" ";" part "${part}")
  list(GET part 0 name)
  list(GET part 1 file)
  file(READ "${SOURCE}/${file}" text)
  string(APPEND code "\nconst std::string_view ${name} = R\"embedded(${text})embedded\";\n")
endforeach()
string(APPEND code "\n}  // namespace fcl_artic::app::page_parts\n")
file(WRITE "${OUT}" "${code}")
