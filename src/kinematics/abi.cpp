// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_artic/abi.h"

namespace fcl_artic::detail {

template <int EigenMaxAlignBytes, int EigenMallocAlreadyAligned, class EigenIndex, bool GlibcxxDebug>
const char Abi<EigenMaxAlignBytes, EigenMallocAlreadyAligned, EigenIndex,
               GlibcxxDebug>::these_compiler_flags_do_not_match_those_of_libfcl_artic__see_Install_in_its_manual = 0;

template struct Abi<EIGEN_MAX_ALIGN_BYTES, EIGEN_MALLOC_ALREADY_ALIGNED, Eigen::Index, kDebugContainers>;

}  // namespace fcl_artic::detail
