// SPDX-License-Identifier: BSD-3-Clause
//
// Margins in place of a request's: as the caller sets them, by names of bodies; and as queries read them, by pairs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/margins.h"
#include "model/problem.h"

namespace fcl_artic {

/// Margins of bodies and of pairs of bodies, m. A pair's own counts, else the larger one of its bodies'.
class NamedMargins {
 public:
  /// @throws std::invalid_argument: margin negative or not finite.
  void set(const std::string& body, double margin);
  void set(const std::string& a, const std::string& b, double margin);
  void clear();
  /// Forgets those of other names than these.
  void keep(const std::function<bool(const std::string& body)>& isKept);

  bool empty() const { return of_body_.empty() && of_pair_.empty(); }
  double ofBody(const std::string& name) const;  ///< -1: none of its own
  /// The margin of two bodies: their pair's own, else the larger one of theirs; -1: none.
  double of(const std::string& a, const std::string& b) const;
  /// By names, the lesser one first.
  const std::map<std::pair<std::string, std::string>, double>& ofPairs() const { return of_pair_; }

 private:
  std::map<std::string, double> of_body_;
  std::map<std::pair<std::string, std::string>, double> of_pair_;
};

/// The same as queries want it.
class PairMargins {
 public:
  /// @param problem  its bodies and pairs.
  /// @param nameOf  a body of the problem.
  static PairMargins of(const NamedMargins& margins, const engine::Problem& problem,
                        const std::function<const std::string&(std::int32_t body)>& nameOf);

  /// Puts them in a query's margins. They stay here.
  /// @throws std::invalid_argument: the largest of them and what the query adds have no finite sum.
  void putInto(engine::Margins& margins) const;
  /// The margin that a link pair has in queries which ask for none.
  double ofLinkPair(std::size_t link_pair) const { return link_.empty() ? 0 : std::max(0.0, link_[link_pair]); }

 private:
  std::vector<double> scene_, link_;  ///< of scene pairs and link pairs, -1: not their own; empty: none has its own
  double largest_ = 0;                ///< of them all
};

}  // namespace fcl_artic
