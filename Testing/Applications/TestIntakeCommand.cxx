// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "MadeUpStudy.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using namespace mammoray::test;
using testing::HasSubstr;

namespace
{
using IntakeCommand = CommandTest;
}

TEST_F(IntakeCommand, SaysWhatIsTakenAndWhy)
{
  MadeUpStudy study;
  study.AddSlices(MadeUpMr("1.2.5", "t1_fl3d_tra_spair_pre"));
  study.Add(MadeUpMammogram("L", "CC"));
  study.Add(MadeUpMammogram("R", "CC"));
  const std::string json = this->Folder.File("study.json");
  ASSERT_EQ(this->Run("intake " + study.Folder() + " --side left --json " + json), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, HasSubstr("taken: T1 with fat suppression"));
  EXPECT_THAT(this->Output, HasSubstr("left out: the right breast"));
  EXPECT_EQ(this->Errors,
    "warning: no MLO of the left breast: one view alone leaves the depth along its rays open\n");
  const nlohmann::json read = nlohmann::json::parse(ReadFile(json));
  EXPECT_EQ(read.at("taken").at("fat_suppressed"), "1.2.5");
  EXPECT_EQ(read.at("taken").at("position"), "prone");

  // What there is is listed even where it cannot be registered.
  this->ExpectRefusedAfterListing("intake " + study.Folder(), "left CC, right CC");
  EXPECT_THAT(this->Output, HasSubstr("mammograms: 2"));
  this->ExpectRefused("intake " + study.Folder() + " --side left --json " + json, "--overwrite");
  this->ExpectRefused("intake " + this->Folder.File("nowhere"), "found nothing there");
  EXPECT_EQ(this->Run("intake " + study.Folder() + " --side up"), 2);
  EXPECT_EQ(this->Run("intake"), 2);
}
