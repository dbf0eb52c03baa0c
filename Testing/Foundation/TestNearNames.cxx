// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/NearNames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(NearNames, AreThoseAFewLettersAway)
{
  const std::vector<std::string> known{ "adipose", "glandular", "muscle", "skin" };
  EXPECT_THAT(NearNames("adipos", known), ElementsAre("adipose"));
  EXPECT_THAT(NearNames("Muskle", known), ElementsAre("muscle"));
  EXPECT_THAT(NearNames("gland", known), ElementsAre("glandular"));
  EXPECT_THAT(NearNames("butter", known), IsEmpty());
}

TEST(NearNames, NearestComeFirst)
{
  EXPECT_THAT(NearNames("water", { "waters of lethe", "watery", "water" }, 2),
    ElementsAre("water", "watery"));
}

TEST(NearNames, MessagesSuggestOrList)
{
  EXPECT_EQ(SuggestNames("skim", { "skin", "bone" }), "did you mean skin?");
  EXPECT_EQ(SuggestNames("xyz", { "skin", "bone" }), "known are skin, bone");
  EXPECT_EQ(SuggestNames("xyz", {}), "known are none");
}
