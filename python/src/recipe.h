// SPDX-License-Identifier: BSD-3-Clause
//
// How an object was made, to make it again in another process, bit by bit the same. (Its own numbers are rounded, so
// they would not give the same bits.)
#pragma once

#include <string>
#include <utility>

#include "errors.h"

namespace fcl_artic::python {

/// A static member of a class, a member of an object or a function of the package, and what it was called with. To be
/// handled with the GIL held.
class Recipe {
 public:
  Recipe() = default;
  /// @param owner  the class or object; null: the class of what is made; None: the package.
  /// @param arguments  copied, so that the caller may change his arrays.
  Recipe(std::string maker, const py::tuple& arguments, py::object owner = {})
      : maker_(std::move(maker)),
        arguments_(py::module_::import("copy").attr("deepcopy")(arguments)),
        owner_(std::move(owner)) {}

  /// A recipe of arguments that nobody changes: they are kept as they are.
  static Recipe ofFixed(std::string maker, py::tuple arguments) {
    Recipe recipe;
    recipe.maker_ = std::move(maker);
    recipe.arguments_ = std::move(arguments);
    return recipe;
  }

  /// For Python's garbage collector.
  int visit(visitproc visit, void* arg) const {
    Py_VISIT(arguments_.ptr());
    Py_VISIT(owner_.ptr());
    return 0;
  }

  /// The answer to pickle's question how an object is made.
  /// @throws py::type_error if nothing is known.
  py::tuple reduced(const py::object& self) const {
    if (maker_.empty()) typeError("this " + typeName(self) + " cannot be pickled");
    const py::object owner = owner_ ? owner_ : py::object(py::type::of(self));
    return py::make_tuple(py::module_::import("fcl_artic._pickle").attr("made"),
                          py::make_tuple(owner, maker_, arguments_));
  }

 private:
  std::string maker_;
  py::object arguments_, owner_;
};

}  // namespace fcl_artic::python
