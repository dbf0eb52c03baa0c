// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderWords.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

TEST(HeaderWords, AreLowerCaseWithOneBlankBetweenThem)
{
  EXPECT_EQ(HeaderWords("t1_fl3d_TRA--spair (pre)"), "t1 fl3d tra spair pre ");
  EXPECT_EQ(HeaderWords("  Ax T1 FS +C"), "ax t1 fs +c");
  EXPECT_EQ(HeaderWords("^_*"), "");
  EXPECT_EQ(HeaderWords(""), "");
  // Letters beyond ASCII stay, in whatever encoding.
  EXPECT_EQ(HeaderWords("SP\xc3\x84T"), "sp\xc3\x84t");
}

TEST(HeaderWords, AreFoundWhole)
{
  const std::string words = HeaderWords("Ax T1_FS post-2");
  EXPECT_EQ(FindWords(words, "fs"), "fs");
  EXPECT_EQ(FindWords(words, "t1|post"), "t1"); // the first in the text
  EXPECT_EQ(FindWords(words, "post ?\\d"), "post 2");
  EXPECT_EQ(FindWords(words, "pos"), "");
  EXPECT_EQ(FindWords(words, "x"), "");
  EXPECT_EQ(FindWords("", "fs"), "");
  EXPECT_EQ(FindWords(HeaderWords("fs."), "fs"), "fs"); // at the end
}

TEST(HeaderValues, AreFoundWholeAndInPart)
{
  const std::vector<std::string> values{ "DERIVED", "PRIMARY", "MIP_SAG", "W" };
  EXPECT_EQ(FindValue(values, { "W", "PRIMARY" }), "PRIMARY"); // the first of the header's
  EXPECT_EQ(FindValue(values, { "MIP" }), "");
  EXPECT_EQ(FindPart(values, { "MIP" }), "MIP_SAG");
  EXPECT_EQ(FindPart(values, { "SUB" }), "");
  EXPECT_EQ(FindValue({}, { "W" }), "");
}
}
