// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <limits>
#include <sstream>

#include "array.h"
#include "enums.h"
#include "text/nearest_name.h"

namespace fcl_artic::python {
namespace {

const std::vector<Option<RedonOptions>>& redonOptions() {
  using O = RedonOptions;
  static const std::vector<Option<O>> options{
      {"enclosure", [](O& o, py::handle v) { o.enclosure = enumOf<MotionEnclosure>(v, "enclosure"); }},
      {"refinement_level",
       [](O& o, py::handle v) {
         if (!PyLong_Check(v.ptr())) typeError("refinement_level is no whole number but " + typeName(v));
         o.refinement_level = py::cast<int>(v);
       }},
      {"simultaneous", [](O& o, py::handle v) { o.simultaneous = flagOf(v, "simultaneous"); }},
      {"newton", [](O& o, py::handle v) { o.newton = flagOf(v, "newton"); }},
      {"early_validity", [](O& o, py::handle v) { o.early_validity = flagOf(v, "early_validity"); }},
      {"in_time_order", [](O& o, py::handle v) { o.in_time_order = flagOf(v, "in_time_order"); }},
      {"links_in_world", [](O& o, py::handle v) { o.links_in_world = flagOf(v, "links_in_world"); }}};
  return options;
}

const std::vector<Option<Request>>& requestOptions() {
  using R = Request;
  static const std::vector<Option<R>> options{
      {"mode", [](R& r, py::handle v) { r.request.mode = enumOf<ContactMode>(v, "mode"); }},
      {"max_contacts",
       [](R& r, py::handle v) {
         r.request.max_contacts = countOf(v, "max_contacts");
         r.most_contacts_chosen = true;
       }},
      {"tolerance_time", [](R& r, py::handle v) { r.request.tolerance_time = numberOf(v, "tolerance_time"); }},
      {"tolerance_distance",
       [](R& r, py::handle v) { r.request.tolerance_distance = numberOf(v, "tolerance_distance"); }},
      {"margin", [](R& r, py::handle v) { r.request.margin = numberOf(v, "margin"); }},
      {"added_margin", [](R& r, py::handle v) { r.request.added_margin = numberOf(v, "added_margin"); }},
      {"check_scene", [](R& r, py::handle v) { r.request.check_scene = flagOf(v, "check_scene"); }},
      {"check_self", [](R& r, py::handle v) { r.request.check_self = flagOf(v, "check_self"); }},
      {"ignore_initial_contact",
       [](R& r, py::handle v) { r.request.ignore_initial_contact = flagOf(v, "ignore_initial_contact"); }},
      {"certificate", [](R& r, py::handle v) { r.request.certificate = flagOf(v, "certificate"); }},
      {"visibility", [](R& r, py::handle v) { r.request.visibility = enumOf<VisibilityMode>(v, "visibility"); }},
      {"method", [](R& r, py::handle v) { r.request.method = enumOf<Method>(v, "method"); }},
      {"redon", [](R& r, py::handle v) { r.request.redon = py::cast<RedonOptions>(v); }},
      {"work_budget", [](R& r, py::handle v) { r.request.work_budget = countOf(v, "work_budget"); }},
      {"measure_times", [](R& r, py::handle v) { r.request.measure_times = flagOf(v, "measure_times"); }},
      {"progress", [](R& r, py::handle v) { r.progress = py::reinterpret_borrow<py::object>(v); }},
      {"request", [](R&, py::handle) {}}};  // readRequest() has begun with it
  return options;
}

struct Asked {
  ClearanceRequest request;
  py::object progress = py::none();
};

const std::vector<Option<Asked>>& clearanceOptions() {
  using A = Asked;
  static const std::vector<Option<A>> options{
      {"tolerance_relative",
       [](A& a, py::handle v) { a.request.tolerance_relative = numberOf(v, "tolerance_relative"); }},
      {"tolerance_distance",
       [](A& a, py::handle v) { a.request.tolerance_distance = numberOf(v, "tolerance_distance"); }},
      {"most", [](A& a, py::handle v) { a.request.most = numberOf(v, "most"); }},
      {"check_scene", [](A& a, py::handle v) { a.request.check_scene = flagOf(v, "check_scene"); }},
      {"check_self", [](A& a, py::handle v) { a.request.check_self = flagOf(v, "check_self"); }},
      {"work_budget", [](A& a, py::handle v) { a.request.work_budget = countOf(v, "work_budget"); }},
      {"progress", [](A& a, py::handle v) { a.progress = py::reinterpret_borrow<py::object>(v); }}};
  return options;
}

/// The options' values, each as Python has it, by name.
py::dict valuesOf(const Request& r) {
  const CertifiedRequest& c = r.request;
  py::dict values;
  values["mode"] = memberOf(c.mode);
  values["max_contacts"] = c.max_contacts;
  values["tolerance_time"] = c.tolerance_time;
  values["tolerance_distance"] = c.tolerance_distance;
  values["margin"] = c.margin;
  values["added_margin"] = c.added_margin;
  values["check_scene"] = c.check_scene;
  values["check_self"] = c.check_self;
  values["ignore_initial_contact"] = c.ignore_initial_contact;
  values["certificate"] = c.certificate;
  values["visibility"] = memberOf(c.visibility);
  values["method"] = memberOf(c.method);
  values["redon"] = py::cast(c.redon);
  values["work_budget"] = c.work_budget;
  values["measure_times"] = c.measure_times;
  values["progress"] = r.progress;
  return values;
}

py::dict valuesOf(const RedonOptions& o) {
  py::dict values;
  values["enclosure"] = memberOf(o.enclosure);
  values["refinement_level"] = o.refinement_level;
  values["simultaneous"] = o.simultaneous;
  values["newton"] = o.newton;
  values["early_validity"] = o.early_validity;
  values["in_time_order"] = o.in_time_order;
  values["links_in_world"] = o.links_in_world;
  return values;
}

/// "Name(a=1, b=2)" of the values that are not those of `usual`.
std::string expression(const char* name, const py::dict& values, const py::dict& usual) {
  std::string text;
  for (const auto& [key, value] : values) {
    if (py::str(value).equal(py::str(usual[key]))) continue;
    const bool is_member = py::hasattr(value, "value") && py::hasattr(value, "name");
    const std::string shown = py::repr(is_member ? value.attr("value") : py::reinterpret_borrow<py::object>(value));
    text += (text.empty() ? "" : ", ") + std::string(py::str(key)) + "=" + shown;
  }
  return std::string(name) + "(" + text + ")";
}

/// Gives a class a property for each option.
template <class T, class Class>
void bindOptions(Class& bound, const std::vector<Option<T>>& options) {
  for (const Option<T>& option : options) {
    if (std::string(option.name) == "request") continue;
    bound.def_property(
        option.name, [name = option.name](const T& self) { return py::object(valuesOf(self)[name]); },
        [set = option.set](T& self, py::handle value) { set(self, value); });
  }
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
  Asked asked;
  setAll(asked, clearanceOptions(), options);
  progress = asked.progress;
  return asked.request;
}

std::string text(const Request& request) {
  return expression("Request", valuesOf(request), valuesOf(Request{}));
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
      .def("__repr__",
           [](const RedonOptions& o) { return expression("RedonOptions", valuesOf(o), valuesOf(RedonOptions{})); });
  bindOptions(redon, redonOptions());

  py::class_<Request> request(module, "Request",
                              "What is asked of a query. Each of its options can also be given to the query itself.");
  request
      .def(py::init([](const py::kwargs& options) {
        if (options.contains("request")) typeError("Request() takes no request");
        return readRequest(options);
      }))
      .def("__repr__", [](const Request& r) { return text(r); });
  bindOptions(request, requestOptions());
}

}  // namespace fcl_artic::python
