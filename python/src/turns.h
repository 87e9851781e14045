// SPDX-License-Identifier: BSD-3-Clause
//
// Which thread may do what in the library, without Python's lock (the GIL). Managers are changed by one thread or asked
// by many, in the order in which they come; a process is forked when no other thread is within the library.
//
// Questions ask back: a callback may ask the same manager or others. Such a question does not stand in line after
// changes that wait: these wait for the question that it is part of. So no thread that holds a turn waits for a thread
// that stands in line, and all threads come to their end.
//
// Nothing here is called with the GIL unless its comment says so: a thread that holds the GIL waits for nobody.
#pragma once

#include <list>
#include <vector>

namespace fcl_artic::python {

class Turns {
 public:
  Turns() = default;
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

 private:
  friend class Turn;
  void refresh() const;
  bool hasChangeBefore(std::list<bool>::const_iterator place) const;

  // Under the one mutex of all.
  mutable std::list<bool> line_;  ///< who waits, the first comer first; true: with a change
  mutable int askers_ = 0;
  mutable bool changing_ = false;
  mutable unsigned process_ = 0;  ///< number of the process, counted by forks, that the above is of
};

/// The doings of a thread in the library.
struct Doings {
  std::vector<const Turns*> asks, changes;
  int depth = 0;  ///< of scopes in the library; 0: it is outside
  int calls = 0;  ///< of the module's functions, this thread's and those of the one that it works for

  static Doings& here();
};

/// While it lives, the calling thread does a part of the work in the library of the thread that has made it.
class PartOf {
 public:
  explicit PartOf(const Doings& doings);
  ~PartOf();
  PartOf(const PartOf&) = delete;
  PartOf& operator=(const PartOf&) = delete;
};

/// Work in the library that is about no manager.
class InLibrary {
 public:
  /// @throws what Python raises while this waits for a fork, KeyboardInterrupt above all.
  InLibrary();
  ~InLibrary();
  InLibrary(const InLibrary&) = delete;
  InLibrary& operator=(const InLibrary&) = delete;
};

/// A turn at one manager, or at two that are asked together.
class Turn {
 public:
  enum Kind { asks, changes };
  /// Waits until it is this thread's turn.
  /// @param also  asked together with the first; null: none.
  /// @throws std::runtime_error where it would wait for this thread itself: in a callback of a query, for a change; in
  ///   one of a change, for anything. Also throws what Python raises meanwhile, KeyboardInterrupt above all, and
  ///   std::runtime_error once the interpreter ends.
  Turn(Kind kind, const Turns& of, const Turns* also = nullptr);
  ~Turn();
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  /// The change is done, and now this thread asks: no other change comes between.
  void ask();

 private:
  Kind kind_;
  std::vector<const Turns*> of_;  ///< that this thread has no turn at yet
};

/// A call of a function of the module; functions.cpp makes one of each. When a script ends, Python takes daemon threads
/// away wherever they want the GIL, by unwinding their frames. If an object of Python's is let go of there, without the
/// GIL, the process ends with an error. So the end of the script tells calls to stop, and waits for them. A thread that
/// begins another call then sleeps until the process is gone, unless it is within a call. With the GIL.
class Call {
 public:
  Call();
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// Whether the calls that run are to stop.
  static bool shallStop();
};
/// Makes the end of a script wait so. With the GIL.
void watchEnd();

/// Makes fork() wait until no other thread is within the library, and the child begin with no thread but its own. A
/// fork in a callback does not wait. With the GIL.
void watchForks();

}  // namespace fcl_artic::python
