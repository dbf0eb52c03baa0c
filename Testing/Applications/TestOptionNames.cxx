// SPDX-License-Identifier: Apache-2.0
#include "OptionNames.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

using namespace mammoray;

TEST(OptionNames, FollowTheFields)
{
  EXPECT_EQ(OptionOfField("ThicknessMm"), "--thickness");
  EXPECT_EQ(OptionOfField("SourceToDetectorMm"), "--source-to-detector");
  EXPECT_EQ(OptionOfField("AcceptUnusual"), "--accept-unusual");
  EXPECT_EQ(OptionOfField("Laterality"), "--side");
}

TEST(OptionNames, ReplaceWholeFieldsInMessages)
{
  const InputError named("ThicknessMm: expected ThicknessMmOf",
    { "ThicknessMm", "3", { "AcceptUnusual" } });
  EXPECT_EQ(Complaint(named), "--thickness: expected ThicknessMmOf; set --accept-unusual");
  const InputError key("table.json: density", { "Density", "3", { "\"unusual\": true" } });
  EXPECT_EQ(Complaint(key), "table.json: density; set \"unusual\": true");
  EXPECT_EQ(Complaint(InputError("no such file")), "no such file");
}
