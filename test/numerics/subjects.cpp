// SPDX-License-Identifier: BSD-3-Clause
#include "subject.h"

#include "numerics/instruction_sets.h"

namespace fcl_artic {
namespace numerics_test {

std::vector<const Subject*> subjects() {
  std::vector<const Subject*> all;
#define FCL_ARTIC_ONE(set, Set) &kSubject##Set,
  for (const Subject* s : {FCL_ARTIC_INSTRUCTION_SETS(FCL_ARTIC_ONE)}) {
    if (processorRuns(s->name)) all.push_back(s);
  }
#undef FCL_ARTIC_ONE
  return all;
}

}  // namespace numerics_test
}  // namespace fcl_artic
