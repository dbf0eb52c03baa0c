// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"

#include <gtest/gtest.h>

#include <limits>

using namespace mammoray;
using test::NotRefused;
using test::RefusalOf;

TEST(ValidRange, NamesRangeValueFieldAndRemedies)
{
  const auto check = [](double value)
  {
    return RefusalOf(
      [value] {
        CheckValidRange(ValidRanges::Thickness, value, "m.dcm", { "ThicknessMm", "AcceptUnusual" });
      });
  };
  for (const double usual : { 5.0, 50.0, 150.0 })
  {
    EXPECT_EQ(check(usual), NotRefused) << usual;
  }
  EXPECT_EQ(check(0.05),
    "m.dcm: expected a compressed thickness from 5 to 150 mm, found 0.05; set ThicknessMm or "
    "AcceptUnusual");
  try
  {
    CheckValidRange(ValidRanges::Thickness, 0.05, "m.dcm");
    FAIL() << "accepted";
  }
  catch (const InputError& error)
  {
    EXPECT_EQ(error.Field().Name, "ThicknessMm");
    EXPECT_EQ(error.Field().Value, "0.05");
    EXPECT_EQ(error.Field().Remedies, std::vector<std::string>{ "AcceptUnusual" });
  }
  for (const double unusual : { 4.99, 151.0, 1e9, -50.0, std::numeric_limits<double>::quiet_NaN() })
  {
    EXPECT_NE(check(unusual), NotRefused) << unusual;
  }
}

TEST(ValidRange, LooksAtEachOfThree)
{
  const auto check = [](const Vector3& spacing)
  {
    return RefusalOf([&spacing] { CheckValidRange(ValidRanges::VoxelSpacing, spacing, "v.nrrd"); });
  };
  EXPECT_EQ(check({ 1, 0.05, 10 }), NotRefused);
  EXPECT_EQ(check({ 1, 1, 3200 }),
    "v.nrrd: expected a voxel spacing from 0.05 to 10 mm, found 3200 (in um?); set AcceptUnusual");
}
