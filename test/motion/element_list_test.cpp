// SPDX-License-Identifier: BSD-3-Clause
#include "motion/element_list.h"

#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace fcl_artic {
namespace element_list_test {
namespace {

using List = ElementList<int, 2>;

std::vector<int> values(const List& list) {
  return {list.begin(), list.end()};
}

TEST(ElementListTest, BehavesAsAVectorOnBothSidesOfItsRoom) {
  for (std::size_t n = 0; n < 7; ++n) {
    std::vector<int> expected(n);
    std::iota(expected.begin(), expected.end(), 1);
    List list;
    for (int i : expected) list.push_back(i);
    EXPECT_EQ(values(list), expected);
    EXPECT_EQ(list.size(), n);
    EXPECT_EQ(list.empty(), n == 0);
    EXPECT_EQ(std::vector<int>(list.rbegin(), list.rend()), std::vector<int>(expected.rbegin(), expected.rend()));
    EXPECT_THROW(list.at(n), std::out_of_range);

    for (std::size_t m = 0; m < 7; ++m) {  // what a list held before does not show
      List other;
      other.resize(m);
      other = list;
      EXPECT_EQ(values(other), expected);
      std::vector<int> resized = expected;
      resized.resize(m);
      other.resize(m);
      EXPECT_EQ(values(other), resized);
      other.emplace_back() = 9;
      resized.push_back(9);
      EXPECT_EQ(values(other), resized);
      EXPECT_EQ(values(list), expected) << "a copy shares nothing";
    }
    const List copy(list);
    const List& self = list;
    list = self;
    EXPECT_EQ(values(list), expected);
    EXPECT_EQ(values(copy), expected);
  }
}

TEST(ElementListTest, ElementsInPlaceLieWithinTheList) {
  List list = {1, 2};
  const auto* begin = reinterpret_cast<const char*>(&list);
  const auto* first = reinterpret_cast<const char*>(&list[0]);
  EXPECT_TRUE(first >= begin && first < begin + sizeof list);
  list.push_back(3);
  first = reinterpret_cast<const char*>(&list[0]);
  EXPECT_FALSE(first >= begin && first < begin + sizeof list);
}

}  // namespace
}  // namespace element_list_test
}  // namespace fcl_artic
