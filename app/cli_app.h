// SPDX-License-Identifier: BSD-3-Clause
// CLI11's type of a command line, declared for headers of verbs: a source that only adds verbs need not compile CLI11.
#pragma once

namespace CLI {
class App;
}
