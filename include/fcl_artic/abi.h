// SPDX-License-Identifier: BSD-3-Clause
//
// A program whose compiler flags lay out or free Eigen's matrices otherwise than the library does is not linked.
#pragma once

#if __cplusplus < 201703L
#error "fcl_artic needs C++17: compile with -std=c++17 or later"
#endif

#include <Eigen/Core>

#include "fcl_artic/export.h"

namespace fcl_artic::detail {

#ifdef _GLIBCXX_DEBUG
inline constexpr bool kDebugContainers = true;
#else
inline constexpr bool kDebugContainers = false;
#endif

/// Names all that a program and the library must agree on:
/// - the alignment of Eigen's matrices (`-mavx`, `-march=native` and EIGEN_DONT_ALIGN change it),
/// - who frees them (`-fsanitize=address` changes it unless EIGEN_MALLOC_ALREADY_ALIGNED is defined as 1),
/// - the type of Eigen's indices (EIGEN_DEFAULT_DENSE_INDEX_TYPE),
/// - _GLIBCXX_DEBUG.
///
/// The library defines the member for its own flags alone. With others the linker ends with its name.
template <int EigenMaxAlignBytes, int EigenMallocAlreadyAligned, class EigenIndex, bool GlibcxxDebug>
struct Abi {
  // NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): what the linker shows
  static const char these_compiler_flags_do_not_match_those_of_libfcl_artic__see_Install_in_its_manual;
};

using ThisAbi = Abi<EIGEN_MAX_ALIGN_BYTES, EIGEN_MALLOC_ALREADY_ALIGNED, Eigen::Index, kDebugContainers>;
extern template struct FCL_ARTIC_EXPORT
    Abi<EIGEN_MAX_ALIGN_BYTES, EIGEN_MALLOC_ALREADY_ALIGNED, Eigen::Index, kDebugContainers>;

namespace {
[[gnu::used]] const char* const kThisAbi =
    &ThisAbi::these_compiler_flags_do_not_match_those_of_libfcl_artic__see_Install_in_its_manual;
}

}  // namespace fcl_artic::detail
