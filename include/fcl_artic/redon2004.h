// SPDX-License-Identifier: BSD-3-Clause
//
// Switches of the paper's method, for whoever compares it (CertifiedRequest::method, redon). No other query needs them.
#pragma once

namespace fcl_artic {

/// How Method::redon2004 bounds a link's motion X(t) over a time interval T with middle tm.
enum class MotionEnclosure {
  intervalChain,  ///< Products of interval matrices down the chain, as in the paper.
  meanValue,      ///< The mean value form X(tm) + X'(T) (T - tm).
  taylor,         ///< A quadratic in time with a bounded remainder.
};

/// Options of Method::redon2004: each idea of the paper can be switched by itself (doc/REDON2004.md). The defaults are
/// the fastest that are known; RedonOptions::asWritten() are the paper's. The promise is the same for all of them.
struct RedonOptions {
  /// The options with which Method::redon2004 is the paper's, without what this library adds to it.
  static RedonOptions asWritten();

  /// How a link's motion is bounded over a time interval. The paper's is MotionEnclosure::intervalChain.
  MotionEnclosure enclosure = MotionEnclosure::meanValue;
  /// Refinement level: a link's bounds are computed on 2^level parts of the motion (Section 5.1.1). -1: chosen by the
  /// link's motion; 0: the motion undivided. From -1 to 6; queries throw std::invalid_argument for other values.
  int refinement_level = -1;
  /// True: all equations are solved together, one list per time interval (Section 5.2.2). False: each by itself.
  bool simultaneous = true;
  /// Whether interval Newton, eq. (18), narrows the time intervals.
  bool newton = true;
  /// True: every interval tests whether the features of an equation can touch. False: only the last one, as in the
  /// paper.
  bool early_validity = true;
  /// True: boxes and equations are processed together, sub-interval after sub-interval up to the first contact. False:
  /// all boxes over the whole motion first, as in the paper.
  bool in_time_order = true;
  /// How the boxes of two links are bounded. False: B's motion seen from A, by the joints between them. True: both
  /// motions in the world, by the maximum of the links' refinement levels, as in the paper (Section 5.1.1).
  bool links_in_world = false;
};

inline RedonOptions RedonOptions::asWritten() {
  RedonOptions options;
  options.enclosure = MotionEnclosure::intervalChain;
  options.early_validity = options.in_time_order = false;
  options.links_in_world = true;
  return options;
}

}  // namespace fcl_artic
