// SPDX-License-Identifier: BSD-3-Clause
//
// Many motions at once: rows of two arrays, read where they lie, and answers written into arrays. Each row is read once
// and copied into its motion. So an answer is about the numbers that were read, whatever becomes of the array.
#include <pybind11/stl.h>

#include <atomic>
#include <thread>
#include <unordered_map>

#include "options.h"
#include "result.h"
#include "watch.h"
#include "world.h"

namespace fcl_artic::python {
namespace {

using Statuses = py::array_t<std::int8_t>;
using Indices = py::array_t<std::int32_t>;

/// The answers for N motions, one row each.
struct Answers {
  Statuses status;                                         ///< (N,)
  Doubles t_lower, t_upper;                                ///< (N,)
  py::array_t<bool> certain;                               ///< (N,)
  Indices pair;                                            ///< (N, 2) indices of `bodies`; -1: none
  Doubles point, normal;                                   ///< (N, 3); not a number where there is no contact
  Indices ignored_initial, never_apart, unproven_allowed;  ///< (N,)
  std::vector<std::string> bodies;
};

/// Where answers are written, without the GIL.
struct Columns {
  explicit Columns(Answers& a)
      : status(a.status.mutable_data()),
        t_lower(a.t_lower.mutable_data()),
        t_upper(a.t_upper.mutable_data()),
        point(a.point.mutable_data()),
        normal(a.normal.mutable_data()),
        certain(a.certain.mutable_data()),
        pair(a.pair.mutable_data()),
        ignored_initial(a.ignored_initial.mutable_data()),
        never_apart(a.never_apart.mutable_data()),
        unproven_allowed(a.unproven_allowed.mutable_data()) {}
  std::int8_t* status;
  double *t_lower, *t_upper, *point, *normal;
  bool* certain;
  std::int32_t *pair, *ignored_initial, *never_apart, *unproven_allowed;
};

/// Answers that claim nothing: those of motions that an ended query has left out.
Answers claimNothing(py::ssize_t n) {
  Answers a{Statuses(n),
            Doubles(n),
            Doubles(n),
            py::array_t<bool>(n),
            Indices({n, py::ssize_t{2}}),
            Doubles({n, py::ssize_t{3}}),
            Doubles({n, py::ssize_t{3}}),
            Indices(n),
            Indices(n),
            Indices(n),
            {}};
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::fill_n(a.status.mutable_data(), n, static_cast<std::int8_t>(Status::undecided));
  std::fill_n(a.t_lower.mutable_data(), n, 0.0);
  std::fill_n(a.t_upper.mutable_data(), n, 1.0);
  std::fill_n(a.certain.mutable_data(), n, false);
  std::fill_n(a.pair.mutable_data(), 2 * n, -1);
  std::fill_n(a.point.mutable_data(), 3 * n, none);
  std::fill_n(a.normal.mutable_data(), 3 * n, none);
  std::fill_n(a.ignored_initial.mutable_data(), n, 0);
  std::fill_n(a.never_apart.mutable_data(), n, 0);
  std::fill_n(a.unproven_allowed.mutable_data(), n, 0);
  return a;
}

/// Hands motions out to threads, in blocks, and writes their answers.
class Batch {
 public:
  Batch(const World& world, Rows q0, Rows q1, const CertifiedRequest& request, Answers& answers, Watch& watch)
      : tree_(*world.tree()), q0_(q0), q1_(q1), request_(request), out_(answers), watch_(watch) {
    for (std::size_t i = 0; i < answers.bodies.size(); ++i) {
      index_.emplace(answers.bodies[i], static_cast<std::int32_t>(i));
    }
  }

  /// @param threads  at least 1; this thread is one of them, and the one that asks Python now and then.
  void run(const ArticulatedCollisionManager& manager, int threads) {
    block_ = std::clamp<Eigen::Index>(q0_.rows() / (64 * threads), 1, 16);
    std::vector<std::thread> others;
    running_ = threads - 1;
    for (int i = 1; i < threads; ++i) {
      others.emplace_back([&, doings = Doings::here()] {
        const PartOf part(doings);  // a callback is within the query here, too
        work(manager, [this](double) { return !stop_.load(std::memory_order_relaxed); });
        --running_;
      });
    }
    work(manager, [this](double) { return ask(); });
    // The last motions of the others may take long; Python is asked meanwhile.
    while (running_.load() > 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      ask();
    }
    for (std::thread& thread : others) thread.join();
    if (failed_ < q0_.rows()) throw std::invalid_argument("motion " + std::to_string(failed_) + ": " + reason_);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  bool ask() {
    const double fraction = static_cast<double>(done_.load(std::memory_order_relaxed)) /
                            static_cast<double>(std::max<Eigen::Index>(q0_.rows(), 1));
    if (!watch_.goOn(std::min(fraction, 1.0))) stop_ = true;
    return !stop_.load(std::memory_order_relaxed);
  }

  template <class GoOn>
  void work(const ArticulatedCollisionManager& manager, const GoOn& goOn) {
    CertifiedRequest request = request_;
    request.progress = goOn;
    CertifiedResult result;
    Eigen::VectorXd q0, q1;
    for (;;) {
      const Eigen::Index begin = next_.fetch_add(block_), end = std::min(begin + block_, q0_.rows());
      if (begin >= q0_.rows()) break;
      for (Eigen::Index i = begin; i < end; ++i) {
        if (!goOn(0)) break;
        try {
          q0 = q0_.row(i).transpose();
          q1 = q1_.row(i).transpose();
          manager.continuousCollide(JointMotion::linear(tree_, q0, q1), request, result);
        } catch (const std::invalid_argument& problem) {
          fail(i, problem.what());
          break;
        } catch (...) {
          const std::lock_guard<std::mutex> lock(mutex_);
          if (!error_) error_ = std::current_exception();
          stop_ = true;
          break;
        }
        write(i, result);
        done_.fetch_add(1, std::memory_order_relaxed);
      }
      if (stop_) break;
    }
  }

  void fail(Eigen::Index i, const std::string& reason) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
    if (i >= failed_) return;
    failed_ = i;
    reason_ = reason;
  }

  void write(Eigen::Index i, const CertifiedResult& result) {
    out_.status[i] = static_cast<std::int8_t>(result.status);
    out_.t_lower[i] = result.t_lower;
    out_.t_upper[i] = result.t_upper;
    out_.certain[i] = result.certain;
    out_.ignored_initial[i] = static_cast<std::int32_t>(result.ignored_initial_contacts.size());
    out_.never_apart[i] = static_cast<std::int32_t>(result.never_apart_pairs);
    out_.unproven_allowed[i] = static_cast<std::int32_t>(result.unproven_allowed_pairs);
    const CertifiedContact* c = result.first();
    if (!c) return;
    out_.pair[2 * i] = indexOf(c->body1.name);
    out_.pair[2 * i + 1] = indexOf(c->body2.name);
    Eigen::Map<Eigen::Vector3d>(out_.point + 3 * i) = c->point;
    Eigen::Map<Eigen::Vector3d>(out_.normal + 3 * i) = c->normal;
  }
  std::int32_t indexOf(const std::string& name) const {
    const auto at = index_.find(name);
    return at == index_.end() ? -1 : at->second;
  }

  const KinematicTree& tree_;
  const Rows q0_, q1_;
  const CertifiedRequest& request_;
  const Columns out_;
  Watch& watch_;
  std::unordered_map<std::string, std::int32_t> index_;
  Eigen::Index block_ = 1;
  std::atomic<Eigen::Index> next_{0}, done_{0};
  std::atomic<int> running_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  Eigen::Index failed_ = std::numeric_limits<Eigen::Index>::max();
  std::string reason_;
  std::exception_ptr error_;
};

Answers checkMany(const World& world, py::handle q0, py::handle q1, int threads, const py::kwargs& options) {
  Request request = readRequest(options);
  if (request.request.certificate) typeError("check_many() has no place for certificates; ask check() for them");
  if (threads < 0) valueError("threads is " + std::to_string(threads) + ", not 0 or more");
  const Matrix from = matrixOf(q0, "q0", world.tree()->dof()), to = matrixOf(q1, "q1", world.tree()->dof());
  if (from.array.shape(0) != to.array.shape(0)) {
    valueError("q0 has " + std::to_string(from.array.shape(0)) + " rows, q1 has " + std::to_string(to.array.shape(0)));
  }
  const py::ssize_t n = from.array.shape(0);
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  const int most = threads == 0 ? static_cast<int>(all) : threads;
  const int used = static_cast<int>(std::clamp<py::ssize_t>(n, 1, most));
  Answers answers = claimNothing(n);
  Watch watch(std::move(request.progress));
  world.manager().ask([&](const ArticulatedCollisionManager& manager) {
    if (manager.hasSpeeds()) {
      throw std::invalid_argument(
          "check_many(): an object moves by itself (set_object_speed()), and each motion is asked as if the object "
          "were "
          "at its place: ask check() about a whole trajectory with its times");
    }
    answers.bodies = world.names();  // now that nothing changes
    Batch(world, from.rows(), to.rows(), request.request, answers, watch).run(manager, used);
  });
  watch.finish();
  return answers;
}

py::object isStatus(const Answers& a, Status status) {
  return a.status.attr("__eq__")(static_cast<int>(status));
}

py::object pairNames(const Answers& a, py::ssize_t i) {
  const py::ssize_t n = a.pair.shape(0);
  if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " answers");
  const std::int32_t* pair = a.pair.data() + 2 * (i < 0 ? i + n : i);
  if (pair[0] < 0) return py::none();
  return py::make_tuple(a.bodies[static_cast<std::size_t>(pair[0])], a.bodies[static_cast<std::size_t>(pair[1])]);
}

}  // namespace

void bindBatch(py::module_& module, py::class_<World>& world) {
  py::class_<Answers>(module, "Answers", "The answers for many motions, in arrays with a row for each.")
      .def_readonly("status", &Answers::status)
      .def_readonly("t_lower", &Answers::t_lower)
      .def_readonly("t_upper", &Answers::t_upper)
      .def_readonly("certain", &Answers::certain)
      .def_readonly("pair", &Answers::pair)
      .def_readonly("point", &Answers::point)
      .def_readonly("normal", &Answers::normal)
      .def_readonly("ignored_initial_contacts", &Answers::ignored_initial)
      .def_readonly("never_apart_pairs", &Answers::never_apart)
      .def_readonly("unproven_allowed_pairs", &Answers::unproven_allowed)
      .def_readonly("bodies", &Answers::bodies)
      .def_property_readonly("free", [](const Answers& a) { return isStatus(a, Status::free); })
      .def_property_readonly("contact", [](const Answers& a) { return isStatus(a, Status::contact); })
      .def_property_readonly("undecided", [](const Answers& a) { return isStatus(a, Status::undecided); })
      .def("pair_names", &pairNames, "Names of the bodies of answer i's first contact; None if it has none.",
           py::arg("i"))
      .def("__len__", [](const Answers& a) { return a.status.shape(0); })
      .def("__bool__",
           [](const Answers&) -> bool {
             typeError("answers are neither true nor false: ask for answers.free.all(), or another of their arrays");
           })
      .def("__repr__",
           [](const Answers& a) {
             const auto count = [&](Status s) { return isStatus(a, s).attr("sum")(); };
             py::ssize_t excepted = 0;
             for (py::ssize_t i = 0; i < a.status.shape(0); ++i) {
               excepted += a.status.data()[i] == static_cast<std::int8_t>(Status::free) &&
                           (a.ignored_initial.data()[i] > 0 || a.unproven_allowed.data()[i] > 0);
             }
             const std::string but = excepted > 0 ? " (" + std::to_string(excepted) + " but for some pairs)" : "";
             return py::str("<Answers: {} free{}, {} in contact, {} undecided>")
                 .format(count(Status::free), but, count(Status::contact), count(Status::undecided));
           })
      .def(py::pickle(
          [](const Answers& a) {
            return py::make_tuple(a.status, a.t_lower, a.t_upper, a.certain, a.pair, a.point, a.normal,
                                  a.ignored_initial, a.never_apart, a.unproven_allowed, a.bodies);
          },
          [](const py::tuple& s) {
            return Answers{py::object(s[0]),
                           py::object(s[1]),
                           py::object(s[2]),
                           py::object(s[3]),
                           py::object(s[4]),
                           py::object(s[5]),
                           py::object(s[6]),
                           py::object(s[7]),
                           py::object(s[8]),
                           py::object(s[9]),
                           py::cast<std::vector<std::string>>(s[10])};
          }));
  world.def(
      "check_many", &checkMany,
      "Asks check() of many straight motions: from each row of q0 (N, n) to the same row of q1, on `threads`\n"
      "threads (0: all processors). C-contiguous float64 arrays are read in place; do not write to them meanwhile.",
      py::arg("q0"), py::arg("q1"), py::arg("threads") = 0);
}

}  // namespace fcl_artic::python
