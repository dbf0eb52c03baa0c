// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(SpellingSuggestions, AreThoseAFewLettersAway)
{
  const std::vector<std::string> known{ "adipose", "glandular", "muscle", "skin" };
  EXPECT_THAT(SpellingSuggestions("adipos", known), ElementsAre("adipose"));
  EXPECT_THAT(SpellingSuggestions("Muskle", known), ElementsAre("muscle"));
  EXPECT_THAT(SpellingSuggestions("gland", known), ElementsAre("glandular"));
  EXPECT_THAT(SpellingSuggestions("butter", known), IsEmpty());
  EXPECT_THAT(SpellingSuggestions("cortical bone", { "Bone, Cortical (ICRP)", "Bone, Compact" }),
    ElementsAre("Bone, Cortical (ICRP)"));
}

TEST(SpellingSuggestions, NearestComeFirst)
{
  EXPECT_THAT(SpellingSuggestions("water", { "waters of lethe", "watery", "water" }, 2),
    ElementsAre("water", "watery"));
  EXPECT_THAT(SpellingSuggestions("FE", { "PE", "Fe", "F" }), ElementsAre("Fe"));
}

TEST(SpellingSuggestions, MessagesSuggestOrList)
{
  EXPECT_EQ(SpellingHint("skim", { "skin", "bone" }), "did you mean skin?");
  EXPECT_EQ(SpellingHint("xyz", { "skin", "bone" }), "known are skin, bone");
  EXPECT_EQ(SpellingHint("xyz", {}), "known are none");
}
