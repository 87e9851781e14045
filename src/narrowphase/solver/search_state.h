// SPDX-License-Identifier: BSD-3-Clause
//
// All parts of the solver share this: the query at hand, motions, and the known bounds of the first contact.
#pragma once

#include "narrowphase/solver/contact_list.h"
#include "narrowphase/solver/relative_motion.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

struct SearchState {
  Task task;
  SweptFrames frames{task};
  RelativeMotions motions{task, frames};
  Horizon horizon{task};
  ContactList contacts{task, horizon};

  /// A new query: nothing is known.
  void begin(const Problem& problem, const Query& query) {
    task.begin(problem, query);
    frames.begin();
    motions.begin();
    horizon.begin();
    contacts.begin();
  }
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
