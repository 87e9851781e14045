# SPDX-License-Identifier: BSD-3-Clause
# Writes packages/fcl_artic.spdx: what the binaries are made of, with versions as Debian has them and licences (SPDX 2.3).
# A row: name, licence, Debian's package, and whether it is linked (DYNAMIC_LINK) or compiled in (CONTAINS).
set(rows
  "FCL|BSD-3-Clause|libfcl-dev|DYNAMIC_LINK" "libccd|BSD-3-Clause|libccd-dev|DYNAMIC_LINK"
  "OctoMap|BSD-3-Clause|liboctomap-dev|DYNAMIC_LINK" "Eigen|MPL-2.0|libeigen3-dev|CONTAINS"
  "oneTBB|Apache-2.0|libtbb-dev|DYNAMIC_LINK" "urdfdom|BSD-3-Clause|liburdfdom-dev|DYNAMIC_LINK"
  "Assimp|BSD-3-Clause|libassimp-dev|DYNAMIC_LINK" "TinyXML-2|Zlib|libtinyxml2-dev|DYNAMIC_LINK"
  "OMPL|BSD-3-Clause|libompl-dev|DYNAMIC_LINK" "CLI11|BSD-3-Clause|libcli11-dev|CONTAINS"
  "JSON for Modern C++|MIT|nlohmann-json3-dev|CONTAINS" "fmt|MIT|libfmt-dev|DYNAMIC_LINK"
  "libpng|libpng-2.0|libpng-dev|DYNAMIC_LINK" "yaml-cpp|MIT|libyaml-cpp-dev|DYNAMIC_LINK"
  "HDF5|BSD-3-Clause|libhdf5-dev|DYNAMIC_LINK" "Open MPI|BSD-3-Clause|libopenmpi-dev|DYNAMIC_LINK"
  "zlib|Zlib|zlib1g-dev|DYNAMIC_LINK" "pybind11|BSD-3-Clause|pybind11-dev|CONTAINS"
  "GMP|LGPL-3.0-or-later OR GPL-2.0-or-later|libgmp-dev|DYNAMIC_LINK"
  "MPFR|LGPL-3.0-or-later|libmpfr-dev|DYNAMIC_LINK"
  "OCaml|LGPL-2.1-only WITH OCaml-LGPL-linking-exception|ocaml-nox|CONTAINS"
  "Zarith|LGPL-2.0-only WITH OCaml-LGPL-linking-exception|libzarith-ocaml-dev|CONTAINS")
string(TIMESTAMP now "%Y-%m-%dT%H:%M:%SZ" UTC)
set(sbom "SPDXVersion: SPDX-2.3
DataLicense: CC0-1.0
SPDXID: SPDXRef-DOCUMENT
DocumentName: fcl_artic-${PROJECT_VERSION}
DocumentNamespace: https://fcl_artic.example.org/spdx/${PROJECT_VERSION}
Creator: Tool: cmake/packages/Sbom.cmake
Created: ${now}

PackageName: fcl_artic
SPDXID: SPDXRef-fcl-artic
PackageVersion: ${PROJECT_VERSION}
PackageDownloadLocation: NOASSERTION
FilesAnalyzed: false
PackageLicenseConcluded: BSD-3-Clause
PackageLicenseDeclared: BSD-3-Clause
PackageCopyrightText: 2026 the fcl_artic authors
Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-fcl-artic
")
foreach(row IN LISTS rows)
  string(REPLACE "|" ";" row "${row}")
  list(GET row 0 name)
  list(GET row 1 licence)
  list(GET row 2 package)
  list(GET row 3 relationship)
  execute_process(COMMAND dpkg-query -W "-f=\${Version}" ${package} OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
  string(APPEND sbom "
PackageName: ${name}
SPDXID: SPDXRef-${package}
PackageVersion: ${version}
PackageDownloadLocation: NOASSERTION
FilesAnalyzed: false
PackageLicenseConcluded: ${licence}
PackageLicenseDeclared: ${licence}
PackageCopyrightText: NOASSERTION
Relationship: SPDXRef-fcl-artic ${relationship} SPDXRef-${package}
")
endforeach()
file(WRITE "${PROJECT_BINARY_DIR}/packages/fcl_artic.spdx" "${sbom}")
