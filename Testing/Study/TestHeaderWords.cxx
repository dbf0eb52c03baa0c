// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderWords.h"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

namespace
{
using namespace mammoray;

/// The expressions of a row: split at each '|' outside parentheses.
std::vector<std::string> ExpressionsOf(const HeaderVocabularyRow& row)
{
  std::vector<std::string> expressions(1);
  int depth = 0;
  for (const char letter : PatternOf(row))
  {
    depth += letter == '(' ? 1 : letter == ')' ? -1 : 0;
    if (letter == '|' && depth == 0)
    {
      expressions.emplace_back();
    }
    else
    {
      expressions.back() += letter;
    }
  }
  return expressions;
}

class HeaderVocabularyRows : public ::testing::TestWithParam<std::size_t>
{
};

TEST_P(HeaderVocabularyRows, RecogniseTheirExamples)
{
  const HeaderVocabularyRow& row = HeaderVocabulary().at(GetParam());
  const std::vector<std::string> expressions = ExpressionsOf(row);
  std::istringstream examples(row.Examples);
  std::size_t number = 0;
  for (std::string example; std::getline(examples, example, ',') && number < expressions.size();
       ++number)
  {
    const std::string words = PlainWords(example);
    const std::regex whole("(?:^| )(" + expressions[number] + ")(?= |$)");
    EXPECT_TRUE(std::regex_search(words, whole)) << expressions[number] << " in " << words;
    EXPECT_NE(FindMeaning(words, row.Meaning), "") << expressions[number] << " in " << words;
  }
  EXPECT_EQ(number, expressions.size()) << "an example for each expression of " << row.Words;
  EXPECT_TRUE(examples.eof()) << "an expression for each example of " << row.Words;
}

INSTANTIATE_TEST_SUITE_P(All, HeaderVocabularyRows,
  ::testing::Range(std::size_t{ 0 }, HeaderVocabulary().size()));

TEST(HeaderWords, AreLowerCaseWithOneBlankBetweenThem)
{
  EXPECT_EQ(HeaderWords("t1_fl3d_TRA--spair (pre)"), "t1 fl3d tra spair pre ");
  EXPECT_EQ(HeaderWords("  Ax T1 FS +C"), "ax t1 fs +c");
  EXPECT_EQ(HeaderWords("^_*"), "");
  EXPECT_EQ(HeaderWords(""), "");
  // Letters beyond ASCII stay, in whatever encoding.
  EXPECT_EQ(HeaderWords("SP\xc3\x84T"), "sp\xc3\x84t");
}

TEST(HeaderWords, AccentsOfUtf8AndLatin1ArePlain)
{
  EXPECT_EQ(PlainWords("SP\xc3\x84T"), "spat");
  EXPECT_EQ(PlainWords("SP\xc4T"), "spat");
  EXPECT_EQ(PlainWords("apr\xe8s"), "apres");
  EXPECT_EQ(PlainWords("Sustracci\xc3\xb3n"), "sustraccion");
  // Other letters stay as they are.
  EXPECT_EQ(PlainWords("\xd0\xb0 t1 \xe3\x81\x82"), "\xd0\xb0 t1 \xe3\x81\x82");
}

TEST(HeaderWords, AreFoundWholeAndTheFirstInTheTextCounts)
{
  EXPECT_EQ(FindMeaning(PlainWords("T1 post late"), HeaderMeaning::AfterContrast), "post");
  EXPECT_EQ(FindMeaning(PlainWords("T1 late post"), HeaderMeaning::AfterContrast), "late");
  EXPECT_EQ(FindMeaning(PlainWords("T1 pre contrast"), HeaderMeaning::BeforeContrast),
    "pre contrast");
  EXPECT_EQ(FindMeaning(PlainWords("T1 spread"), HeaderMeaning::BeforeContrast), "");
  EXPECT_EQ(FindMeaning(PlainWords("dixon fat sat"), HeaderMeaning::DixonFat), "");
  EXPECT_EQ(FindMeaning("", HeaderMeaning::Localizer), "");
  EXPECT_EQ(FindMeaning(PlainWords("t1_fs."), HeaderMeaning::FatSuppressed), "fs"); // at the end
}

TEST(HeaderWords, NameOneSideOrNone)
{
  EXPECT_EQ(SideInWords("sag t1 left"), 'L');
  EXPECT_EQ(SideInWords("mama derecha"), 'R');
  EXPECT_EQ(SideInWords("left and right"), '?');
  EXPECT_EQ(SideInWords("l cc"), '?');
  EXPECT_EQ(SideInWords("l cc", true), 'L');
  EXPECT_EQ(SideInWords("rmlo", true), 'R');
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
