// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/PoseParameters.h"

#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

using namespace mammoray;

TEST(PoseParameters, AreInOrderAndEachMeansAnotherMember)
{
  BreastPose pose;
  std::set<std::string> names;
  for (int index = 0; index < ParameterCount; ++index)
  {
    const PoseParameter& parameter = PoseParameters[index];
    EXPECT_EQ(parameter.Index, index);
    EXPECT_TRUE(names.insert(parameter.Name).second) << parameter.Name;
    EXPECT_EQ(&FindPoseParameter(parameter.Name), &parameter);
    pose.*parameter.Value = 100 + index;
  }
  const std::vector<double> values = ValuesOf(pose);
  ASSERT_EQ(values.size(), std::size_t{ ParameterCount });
  for (int index = 0; index < ParameterCount; ++index)
  {
    EXPECT_EQ(values[index], 100 + index);
  }
  EXPECT_EQ(pose.LateralMm, 100 + LateralParameter);
  EXPECT_EQ(ValuesOf(PoseOf(values)), values);
}

TEST(PoseParameters, AreFoundByNameWithTheNearestInTheError)
{
  EXPECT_EQ(FindPoseParameter("tilt").Index, TiltParameter);
  try
  {
    FindPoseParameter("laterl");
    FAIL() << "a parameter that does not exist was found";
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), testing::HasSubstr("'laterl'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean lateral?"));
  }
  EXPECT_EQ(PoseParameterNames(" "),
    "thickness roll pitch yaw lateral anterior vertical tilt stiffness");
  EXPECT_EQ(FreePoseParameterNames(),
    (std::vector<std::string>{ "thickness", "roll", "pitch", "yaw", "lateral", "anterior",
      "vertical", "tilt" }));
}

TEST(PoseParameters, BoundsFollowTheStart)
{
  const auto expect = [](const std::string& name, double start, double lower, double upper)
  {
    const PoseParameter& parameter = FindPoseParameter(name);
    EXPECT_EQ(parameter.Lower(start), lower) << name;
    EXPECT_EQ(parameter.Upper(start), upper) << name;
  };
  expect("thickness", 60, 30, 90);
  expect("roll", 45, 15, 75);
  // Not behind the muscle, unless the search starts there.
  expect("anterior", 5, -20, 55);
  expect("anterior", -23, -23, 27);
  expect("stiffness", 1, 0.25, 4);
  expect("stiffness", 5, 0.25, 5);
}
