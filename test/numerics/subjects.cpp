// SPDX-License-Identifier: BSD-3-Clause
#include "subject.h"

#include "narrowphase/engine.h"

namespace fcl_artic {
namespace numerics_test {

std::vector<const Subject*> subjects() {
  std::vector<const Subject*> all = {&kSubjectPortable};
#ifdef __x86_64__
  for (const Subject* s : {&kSubjectSse2, &kSubjectAvx2, &kSubjectAvx512}) {
    if (engine::engineNamed(s->name)) all.push_back(s);
  }
#endif
  return all;
}

}  // namespace numerics_test
}  // namespace fcl_artic
