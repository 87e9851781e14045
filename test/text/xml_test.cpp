// SPDX-License-Identifier: BSD-3-Clause
#include "text/xml.h"

#include <gtest/gtest.h>

namespace xml_test {

namespace {

using fcl_artic::text::xmlText;

TEST(XmlText, LeavesNoMark) {
  EXPECT_EQ(xmlText("a < b && \"c\" > 'd'"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; 'd'");
  EXPECT_EQ(xmlText("grün"), "grün");
  EXPECT_EQ(xmlText(""), "");
}

}  // namespace

}  // namespace xml_test
