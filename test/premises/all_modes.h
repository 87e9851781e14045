// SPDX-License-Identifier: BSD-3-Clause
//
// An entry of the library in all four rounding modes, beside what it says in the usual one; and the caller finds his
// mode again.
#pragma once

#include <cfenv>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "control_bits.h"
#include "fcl_artic/result.h"

namespace fcl_artic {
namespace premises_test {

/// The answer of an entry.
struct Said {
  std::ostringstream words;     ///< to be the same
  std::vector<double> numbers;  ///< to be the same but for rounding and tolerances

  void add(double x) { numbers.push_back(x); }
  template <class M>
  void addAll(const M& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) add(matrix.derived().coeff(i % matrix.rows(), i / matrix.rows()));
  }
  void add(const Eigen::Isometry3d& M) { addAll(M.matrix()); }
  /// Verdict and bracket; of a contact that is not certain t_upper is 1.
  void add(const Bracket& b) {
    words << b.status << " certain " << b.certain << "; ";
    add(b.t_lower);
  }
};

/// Sums of numbers of some metres; brackets are 1e-6 wide, and their lower ends that far before the contact.
constexpr double kNear = 3e-6;

/// @param near  how far numbers may be off, as a part of 1 + |x|.
inline void expectSameInAllModes(const std::string& name, const std::function<void(Said&)>& entry,
                                 double near = kNear) {
  Said usual;
  entry(usual);
  for (const int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    Said said;
    std::string thrown;
    std::fesetround(mode);
    const auto before = numerics_test::controlBits();
    try {
      entry(said);
    } catch (const std::exception& e) {
      thrown = e.what();
    }
    const auto after = numerics_test::controlBits();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(thrown, "") << name << " in mode " << mode;
    EXPECT_EQ(after, before) << name << " in mode " << mode;
    EXPECT_EQ(said.words.str(), usual.words.str()) << name << " in mode " << mode;
    ASSERT_EQ(said.numbers.size(), usual.numbers.size()) << name << " in mode " << mode;
    for (std::size_t i = 0; i < usual.numbers.size(); ++i) {
      if (said.numbers[i] == usual.numbers[i]) continue;  // infinities, too
      EXPECT_NEAR(said.numbers[i], usual.numbers[i], near * (1 + std::abs(usual.numbers[i])))
          << name << " in mode " << mode << ", number " << i;
    }
  }
}

}  // namespace premises_test
}  // namespace fcl_artic
