// SPDX-License-Identifier: Apache-2.0
// A synthetic mammogram, written and read, is a target whose gantry is where it was.
#include "DescribedProjection.h"
#include "Files.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

using namespace mammoray;
using test::Describe;
using test::TemporaryFolder;

TEST(SyntheticTarget, FindsTheGantryAgain)
{
  // Half a disc at the chest wall, 20 mm in radius, in air.
  const TemporaryFolder folder;
  constexpr int Columns = 150;
  constexpr int Rows = 200;
  std::vector<float> values;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      values.push_back(std::hypot(0.2 * column, 0.3 * (row - 100)) < 20 ? 2.0f : 0.0f);
    }
  }
  for (const auto& [roll, side] :
    { std::pair{ 0.0, 'L' }, { 0.0, 'R' }, { -50.0, 'L' }, { 50.0, 'R' }, { 90.0, 'R' } })
  {
    for (const auto intent :
      { Mammogram::Intent::ForPresentation, Mammogram::Intent::ForProcessing })
    {
      Mammogram mammogram = Describe(roll, side, Columns, Rows);
      SetPixels(mammogram, values, intent);
      const std::string path = folder.File("image.dcm");
      WriteMammogram(mammogram, { .Derivation = "Synthetic" }, path);
      const RegistrationTarget target = PrepareTarget(ReadMammogram(path));
      // The columns run along the gantry's y, the rows against its x, as Describe has them.
      EXPECT_THAT(target.Grid.ColumnStep,
        testing::Pointwise(testing::DoubleNear(1e-9), { 0.0, 0.2 }))
        << roll << side;
      EXPECT_THAT(target.Grid.RowStep, testing::Pointwise(testing::DoubleNear(1e-9), { -0.3, 0.0 }))
        << roll << side;
      EXPECT_EQ(target.Warnings, std::vector<std::string>{}) << roll << side;
    }
  }
}
