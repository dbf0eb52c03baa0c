// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderWords.h"
#include "mammoray/Study/Private/SeriesWords.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

class SeriesVocabularyRow : public ::testing::TestWithParam<std::size_t>
{
};

TEST_P(SeriesVocabularyRow, RecognisesItsExample)
{
  const SeriesWord& row = SeriesVocabulary().at(GetParam());
  const std::string words = PlainWords(row.Example);
  EXPECT_NE(FindWords(words, PatternOf(row).c_str()), "") << row.Pattern << " in " << words;
  EXPECT_NE(FindMeaning(words, row.Meaning), "") << row.Pattern << " in " << words;
}

INSTANTIATE_TEST_SUITE_P(All, SeriesVocabularyRow,
  ::testing::Range(std::size_t{ 0 }, SeriesVocabulary().size()));

TEST(SeriesWords, AccentsOfUtf8AndLatin1ArePlain)
{
  EXPECT_EQ(PlainWords("SP\xc3\x84T"), "spat");
  EXPECT_EQ(PlainWords("SP\xc4T"), "spat");
  EXPECT_EQ(PlainWords("apr\xe8s"), "apres");
  EXPECT_EQ(PlainWords("Sustracci\xc3\xb3n"), "sustraccion");
  // Other letters stay as they are.
  EXPECT_EQ(PlainWords("\xd0\xb0 t1 \xe3\x81\x82"), "\xd0\xb0 t1 \xe3\x81\x82");
}

TEST(SeriesWords, TheFirstInTheTextCounts)
{
  EXPECT_EQ(FindMeaning(PlainWords("T1 post late"), SeriesMeaning::AfterContrast), "post");
  EXPECT_EQ(FindMeaning(PlainWords("T1 pre contrast"), SeriesMeaning::BeforeContrast),
    "pre contrast");
  EXPECT_EQ(FindMeaning(PlainWords("dixon fat sat"), SeriesMeaning::DixonFat), "");
  EXPECT_EQ(FindMeaning("", SeriesMeaning::Localizer), "");
}
}
