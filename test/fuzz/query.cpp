// SPDX-License-Identifier: BSD-3-Clause
// Queries as text: what is read is answered within its bounds, and written as text that is read as the same.
#include <algorithm>

#include "fcl_artic/query_text.h"
#include "fuzz.h"

using namespace fcl_artic;

static std::string written(const RecordedQuery& query) {
  return query.trajectory ? query.manager.writeQuery(*query.trajectory, query.request)
                          : query.manager.writeQuery(*query.motion, query.request);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::optional<RecordedQuery> query;
  try {
    query = readQuery({reinterpret_cast<const char*>(data), size});
  } catch (const std::invalid_argument&) {
    return 0;
  }
  std::string text;
  try {
    text = written(*query);
  } catch (const std::invalid_argument&) {  // it says why
    return 0;
  }
  if (written(readQuery(text)) != text) fuzz::fault("a query that is written and read becomes another one");
  query->request.work_budget = 2000;
  query->request.certificate = false;
  const double begin = query->trajectory ? query->trajectory->beginTime() : 0;
  const double end = query->trajectory ? query->trajectory->endTime() : 1;
  try {
    const CertifiedResult result = query->ask();
    if (!(result.t_lower >= begin && result.t_lower <= end)) fuzz::fault("t_lower is outside the motion");
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
