// SPDX-License-Identifier: BSD-3-Clause
#include "enums.h"

#include <vector>

#include "text/nearest_name.h"

namespace fcl_artic::python {

py::list enumMembers(const char* name) {
  return py::list(py::module_::import("fcl_artic._enums").attr(name));
}

int enumValue(const py::list& members, py::handle value, const char* what) {
  int index = 0;
  for (const py::handle member : members) {
    if (member.is(value)) return index;
    ++index;
  }
  if (!py::isinstance<py::str>(value)) {
    typeError(std::string(what) + " is no " + typeName(members[0]) + " but " + typeName(value));
  }
  const std::string text = py::str(value);
  std::vector<std::string> texts;
  for (const py::handle member : members) texts.push_back(py::str(member.attr("value")));
  std::string all;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i] == text) return static_cast<int>(i);
    all += (i == 0 ? "'" : ", '") + texts[i] + "'";
  }
  valueError(std::string(what) + " is '" + text + "', which is none of " + all + text::didYouMean(text, texts));
}

}  // namespace fcl_artic::python
