// SPDX-License-Identifier: BSD-3-Clause
#include "proof.h"
namespace verify {
std::string proofAsJson(const World&, const Record&) { return "{}"; }
}
