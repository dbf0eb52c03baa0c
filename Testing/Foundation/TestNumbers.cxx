// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Numbers.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

using namespace mammoray;

namespace
{
constexpr double None = std::numeric_limits<double>::quiet_NaN();

double Read(std::string_view text)
{
  double value = 0;
  return ToNumber(text, value) ? value : None;
}

double ReadPadded(std::string_view text)
{
  double value = 0;
  return ToPaddedNumber(text, value) ? value : None;
}
}

TEST(Numbers, AreTheWholeText)
{
  EXPECT_EQ(Read("-1.5e3"), -1500);
  for (const char* none : { "", " 1", "1 ", "+1", "1,5", "1x", "0x1p3", "1e400", "--1" })
  {
    EXPECT_TRUE(std::isnan(Read(none))) << none;
  }
}

TEST(Numbers, MayHaveBlanksAndAPlusBeforeThem)
{
  EXPECT_EQ(ReadPadded("-1.5e3"), -1500);
  EXPECT_EQ(ReadPadded(" \t0.25"), 0.25);
  EXPECT_EQ(ReadPadded("+7"), 7);
  EXPECT_EQ(ReadPadded(" -7"), -7);
  for (const char* none : { "", " ", "+", "+-1", "++1", "+ 1", "1 ", "1,5" })
  {
    EXPECT_TRUE(std::isnan(ReadPadded(none))) << none;
  }
}

// A program that our libraries are part of may have set its user's: "1.5" is one and a half there.
TEST(Numbers, HavePointsWhateverTheLocale)
{
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* locale : { "de_DE.UTF-8", "fr_FR.UTF-8", "C" })
  {
    if (std::setlocale(LC_NUMERIC, locale))
    {
      EXPECT_EQ(ReadPadded("1.5"), 1.5) << locale;
    }
  }
  std::setlocale(LC_NUMERIC, before.c_str());
}

TEST(Numbers, LinesEndAsTheyDoOnAnySystem)
{
  for (const std::string end : { "\n", "\r\n", "\r" })
  {
    for (const bool isEnded : { true, false })
    {
      std::istringstream text("a" + end + end + "b c" + (isEnded ? end : ""));
      std::vector<std::string> lines;
      for (std::string line; ReadLine(text, line);)
      {
        lines.push_back(line);
      }
      EXPECT_EQ(lines, (std::vector<std::string>{ "a", "", "b c" }));
    }
  }
}
