// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <limits>
#include <type_traits>

#include "array.h"
#include "collected.h"
#include "enums.h"
#include "query/request_options.h"
#include "text/nearest_name.h"

namespace fcl_artic::python {
namespace {

// ---- values of each type, from Python and back

void read(py::handle value, const char* name, bool& out) {
  out = flagOf(value, name);
}
void read(py::handle value, const char* name, double& out) {
  out = numberOf(value, name);
}
void read(py::handle value, const char* name, std::uint64_t& out) {
  out = countOf(value, name);
}
void read(py::handle value, const char* name, int& out) {
  if (!PyLong_Check(value.ptr())) typeError(std::string(name) + " is no whole number but " + typeName(value));
  out = py::cast<int>(value);
}
void read(py::handle value, const char*, RedonOptions& out) {
  out = py::cast<RedonOptions>(value);
}
void read(py::handle value, const char*, py::object& out) {
  out = py::reinterpret_borrow<py::object>(value);
}
template <class Enum, class = std::enable_if_t<std::is_enum_v<Enum>>>
void read(py::handle value, const char* name, Enum& out) {
  out = enumOf<Enum>(value, name);
}

py::object shownAs(const py::object& value) {
  return value;
}
template <class T>
py::object shownAs(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return memberOf(value);
  } else {
    return py::cast(value);
  }
}

// The object that has an option's member: the options themselves, or the request that they hold.
constexpr auto kItself = [](auto& options) -> auto& {
  return options;
};
constexpr auto kRequest = [](auto& options) -> auto& {
  return options.request;
};

/// The option that is a member of select(T).
template <class T, class Select, class Class, class Member>
Option<T> option(const char* name, const Select& select, Member Class::*member) {
  return {name, [=](T& t, py::handle value) { read(value, name, select(t).*member); },
          [=](const T& t) { return shownAs(select(t).*member); }};
}

const std::vector<Option<RedonOptions>>& redonOptions() {
  using O = RedonOptions;
  const auto of = [](const char* name, auto member) { return option<O>(name, kItself, member); };
  static const std::vector<Option<O>> options{
      of("enclosure", &O::enclosure),           of("refinement_level", &O::refinement_level),
      of("simultaneous", &O::simultaneous),     of("newton", &O::newton),
      of("early_validity", &O::early_validity), of("in_time_order", &O::in_time_order),
      of("links_in_world", &O::links_in_world)};
  return options;
}

const std::vector<Option<Request>>& requestOptions() {
  using R = Request;
  static const std::vector<Option<R>> options = [] {
    std::vector<Option<R>> all;
    forEachRequestOption([&](const RequestOption& o, auto member) {
      all.push_back(option<R>(o.name, kRequest, member));
      all.back().help = o.help;
      if (o.name != std::string("max_contacts")) return;
      all.back().set = [set = all.back().set](R& r, py::handle value) {
        set(r, value);
        r.most_contacts_chosen = true;
      };
    });
    all.push_back(option<R>("progress", kItself, &R::progress));
    all.push_back({"request", [](R&, py::handle) {}, nullptr});  // readRequest() has begun with it
    return all;
  }();
  return options;
}

/// A search's request. Progress is kept beside it, as in Request.
template <class SearchRequest>
struct Search {
  SearchRequest request;
  py::object progress = py::none();
};

template <class SearchRequest>
SearchRequest readSearch(const std::vector<Option<Search<SearchRequest>>>& known, const py::kwargs& options,
                         py::object& progress) {
  Search<SearchRequest> asked;
  setAll(asked, known, options);
  progress = asked.progress;
  return asked.request;
}

const std::vector<Option<Search<ClearanceRequest>>>& clearanceOptions() {
  using C = ClearanceRequest;
  using A = Search<C>;
  const auto of = [](const char* name, auto member) { return option<A>(name, kRequest, member); };
  static const std::vector<Option<A>> options{of("tolerance_relative", &C::tolerance_relative),
                                              of("tolerance_distance", &C::tolerance_distance),
                                              of("most", &C::most),
                                              of("check_scene", &C::check_scene),
                                              of("check_self", &C::check_self),
                                              of("ignore_initial_contact", &C::ignore_initial_contact),
                                              of("ignored_margin", &C::ignored_margin),
                                              of("work_budget", &C::work_budget),
                                              option<A>("progress", kItself, &A::progress)};
  return options;
}

const std::vector<Option<Search<ToleranceLeftRequest>>>& toleranceLeftOptions() {
  using T = ToleranceLeftRequest;
  using A = Search<T>;
  const auto of = [](const char* name, auto member) { return option<A>(name, kRequest, member); };
  static const std::vector<Option<A>> options{of("accuracy_relative", &T::accuracy_relative),
                                              of("accuracy_factor", &T::accuracy_factor),
                                              of("most", &T::most),
                                              of("margin", &T::margin),
                                              of("added_margin", &T::added_margin),
                                              of("tolerance_time", &T::tolerance_time),
                                              of("tolerance_distance", &T::tolerance_distance),
                                              of("check_scene", &T::check_scene),
                                              of("check_self", &T::check_self),
                                              of("ignore_initial_contact", &T::ignore_initial_contact),
                                              of("work_budget", &T::work_budget),
                                              option<A>("progress", kItself, &A::progress)};
  return options;
}

/// "Name(a=1, b=2)" of the options that are not as by default.
template <class T>
std::string expression(const char* name, const T& chosen, const std::vector<Option<T>>& options) {
  const T usual{};
  std::string text;
  for (const Option<T>& option : options) {
    if (!option.get) continue;
    const py::object value = option.get(chosen);
    if (py::str(value).equal(py::str(option.get(usual)))) continue;
    const bool is_member = py::hasattr(value, "value") && py::hasattr(value, "name");
    const std::string shown = py::repr(is_member ? py::object(value.attr("value")) : value);
    text += (text.empty() ? "" : ", ") + std::string(option.name) + "=" + shown;
  }
  return std::string(name) + "(" + text + ")";
}

/// Gives a class a property for each option.
template <class T, class Class>
void bindOptions(Class& bound, const std::vector<Option<T>>& options) {
  for (const Option<T>& option : options) {
    if (!option.get) continue;
    bound.def_property(
        option.name, [get = option.get](const T& self) { return get(self); },
        [set = option.set](T& self, py::handle value) { set(self, value); }, option.help);
  }
}

/// All options by their names, for pickling.
template <class T>
py::dict stateOf(const T& chosen, const std::vector<Option<T>>& options) {
  py::dict state;
  for (const Option<T>& option : options) {
    if (option.get) state[option.name] = option.get(chosen);
  }
  return state;
}

template <class T>
T ofState(const py::dict& state, const std::vector<Option<T>>& options) {
  T out{};
  setAll(out, options, py::reinterpret_borrow<py::kwargs>(state));
  return out;
}

}  // namespace

bool flagOf(py::handle value, const char* what) {
  if (value.ptr() == Py_True) return true;
  if (value.ptr() == Py_False) return false;
  if (typeName(value) == "numpy.bool_") return PyObject_IsTrue(value.ptr()) == 1;
  typeError(std::string(what) + " is neither True nor False but " + typeName(value));
}

std::uint64_t countOf(py::handle value, const char* what) {
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index || PyBool_Check(value.ptr())) {
    PyErr_Clear();
    typeError(std::string(what) + " is no whole number but " + typeName(value));
  }
  const unsigned long long number = PyLong_AsUnsignedLongLong(index.ptr());
  if (PyErr_Occurred()) {
    PyErr_Clear();
    valueError(std::string(what) + " is " + std::string(py::str(value)) + ", not a number from 0 to 2^64 - 1");
  }
  return number;
}

void refuseKeyword(const std::string& name, const std::vector<std::string>& known) {
  typeError("there is no option '" + name + "'" + text::didYouMean(name, known));
}

void applyOptions(Request& request, const py::kwargs& options) {
  setAll(request, requestOptions(), options);
  if (!request.most_contacts_chosen) {
    const bool all = request.request.mode == ContactMode::firstOfEveryPair;
    request.request.max_contacts = all ? std::numeric_limits<std::size_t>::max() : 1;
  }
}

Request readRequest(const py::kwargs& options) {
  if (!options || options.empty()) return {};
  Request request;
  if (options.contains("request")) {
    const py::object given = options["request"];
    if (!py::isinstance<Request>(given)) typeError("request is no Request but " + typeName(given));
    request = py::cast<Request>(given);
  }
  applyOptions(request, options);
  return request;
}

ClearanceRequest readClearanceRequest(const py::kwargs& options, py::object& progress) {
  return readSearch(clearanceOptions(), options, progress);
}

ToleranceLeftRequest readToleranceLeftRequest(const py::kwargs& options, py::object& progress) {
  return readSearch(toleranceLeftOptions(), options, progress);
}

std::string text(const Request& request) {
  return expression("Request", request, requestOptions());
}

void bindRequest(py::module_& module) {
  py::class_<RedonOptions> redon(module, "RedonOptions",
                                 "Options of Method.REDON2004: each idea of the paper can be switched by itself.");
  redon
      .def(py::init([](const py::kwargs& options) {
        RedonOptions out;
        setAll(out, redonOptions(), options);
        return out;
      }))
      .def_static("as_written", &RedonOptions::asWritten,
                  "The options of the paper, without what this library adds to it.")
      .def("__repr__", [](const RedonOptions& o) { return expression("RedonOptions", o, redonOptions()); })
      .def(py::pickle([](const RedonOptions& o) { return stateOf(o, redonOptions()); },
                      [](const py::dict& state) { return ofState(state, redonOptions()); }));
  bindOptions(redon, redonOptions());

  py::class_<Request> request(module, "Request", collected<Request, true>(),
                              "What is asked of a query. Each of its options can also be given to the query itself.");
  request
      .def(py::init([](const py::kwargs& options) {
        if (options.contains("request")) typeError("Request() takes no request");
        return readRequest(options);
      }))
      .def("__repr__", [](const Request& r) { return text(r); })
      .def(py::pickle(
          [](const Request& r) { return py::make_tuple(stateOf(r, requestOptions()), r.most_contacts_chosen); },
          [](const py::tuple& state) {
            Request request = ofState(py::dict(state[0]), requestOptions());
            request.most_contacts_chosen = py::cast<bool>(state[1]);
            return request;
          }));
  bindOptions(request, requestOptions());
}

}  // namespace fcl_artic::python
