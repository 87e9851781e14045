// SPDX-License-Identifier: BSD-3-Clause
//
// Contacts of this query, the initial ones that are ignored, and the gate through which every proof of contact comes.
#pragma once

#include "narrowphase/solver/horizon.h"
#include "narrowphase/solver/task.h"
#include "numerics/buffer.h"

namespace fcl_artic {
namespace FCL_ARTIC_ISA {

using engine::Ignored;
using engine::LeafContact;

/// A contact of these pieces; all else is left to the caller.
inline LeafContact contactOf(const Problem& problem, PairId pair, int piece_a, int piece_b) {
  const PairParts bodies = problem.parts(pair);
  LeafContact contact = {};
  contact.pair = pair;
  contact.body_a = bodies.a;
  contact.body_b = bodies.b;
  contact.piece_a = piece_a;
  contact.piece_b = piece_b;
  return contact;
}

class ContactList : PartOfSolver {
 public:
  ContactList(Task& task, Horizon& horizon) : PartOfSolver(task), horizon_(horizon) {}

  void begin() {
    contacts_.clear();
    ignored_.clear();
    watching_ = !query().ignore_initial;
  }

  /// Whether it is known from when on each pair is watched. If initial contacts are to be ignored, no contact counts
  /// before that is known.
  bool watching() const { return watching_; }
  void ignore(PairId pair, double watch_from) {
    const PairParts bodies = problem().parts(pair);
    ignored_.push({pair, bodies.a, bodies.b, watch_from});
  }
  bool isIgnored(PairId pair) const { return find(pair) != nullptr; }
  /// All initial contacts that are to be ignored are known.
  void beginWatching() { watching_ = true; }
  /// Time from which a pair is watched: 0 but for ignored initial contacts.
  double watchFrom(PairId pair) const {
    const Ignored* ignored = find(pair);
    return ignored ? ignored->watch_from : 0;
  }

  /// Takes the proof that a pair is in contact at time t, whoever has proven it: all proofs come through here.
  /// @return false if that contact does not count: it is to be ignored, or it is not known yet which ones are.
  bool takeProof(PairId pair, double t) {
    FCL_ARTIC_ASSERT(t >= 0 && t <= 1);
    if (!watching_ || t < watchFrom(pair)) return false;
    horizon_.closeAt(t);
    horizon_.joinUpper(t);
    return true;
  }
  /// Records a contact proven at one time, where any will do: it ends the search. Point and normal are left to the
  /// caller.
  /// @return null if the contact does not count (takeProof()).
  LeafContact* record(PairId pair, int piece_a, int piece_b, double t) {
    if (!takeProof(pair, t)) return nullptr;
    LeafContact& contact = grow(pair, piece_a, piece_b);
    contact.certain = true;
    contact.t_lower = watchFrom(pair);  // what was ignored before is no part of this contact
    contact.t = contact.t_upper = t;
    horizon_.joinLower(contact.t_lower);
    return &contact;
  }
  /// A new contact of these pieces; all else is left to the caller.
  LeafContact& grow(PairId pair, int piece_a, int piece_b) {
    return contacts_.grow() = contactOf(problem(), pair, piece_a, piece_b);
  }
  void push(const LeafContact& contact) { contacts_.push(contact); }

  int size() const { return contacts_.size(); }
  const LeafContact* data() const { return contacts_.data(); }
  const Ignored* ignored() const { return ignored_.data(); }
  int numIgnored() const { return ignored_.size(); }

  /// Orders the contacts from number `begin` on by comesBefore(). Keeps those with t_lower <= t, of each pair the first
  /// one, and Query::max_contacts at most. A kept contact takes the least t_lower of its pair's: before that none of
  /// the pair's pieces touch.
  void order(int begin, double t) {
    int kept = begin;
    for (int i = begin; i < contacts_.size(); ++i) {
      if (contacts_[i].t_lower <= t) contacts_[kept++] = contacts_[i];
    }
    int end = begin;
    while (end < kept && end - begin < query().max_contacts) {  // a few pairs: selection sort
      int best = end;
      for (int i = end + 1; i < kept; ++i) {
        if (engine::comesBefore(contacts_[i], contacts_[best])) best = i;
      }
      LeafContact first = contacts_[best];
      contacts_[best] = contacts_[end];
      int others = end + 1;
      for (int i = end + 1; i < kept; ++i) {
        if (contacts_[i].pair != first.pair) {
          contacts_[others++] = contacts_[i];
        } else {
          first.t_lower = min(first.t_lower, contacts_[i].t_lower);
        }
      }
      contacts_[end++] = first;
      kept = others;
    }
    contacts_.truncate(end);
  }

 private:
  const Ignored* find(PairId pair) const {
    for (int i = 0; i < ignored_.size(); ++i) {
      if (ignored_[i].pair == pair) return &ignored_[i];
    }
    return nullptr;
  }

  Horizon& horizon_;
  Buffer<LeafContact> contacts_;
  Buffer<Ignored> ignored_;
  bool watching_ = true;
};

}  // namespace FCL_ARTIC_ISA
}  // namespace fcl_artic
