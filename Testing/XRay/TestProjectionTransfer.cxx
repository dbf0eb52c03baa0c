// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Private/ProjectionTransfer.h"

#include <gmock/gmock.h>

namespace
{
using namespace mammoray;

PathLengthImage EmptyImage(int columns, int rows, int materials)
{
  PathLengthImage image;
  image.Columns = columns;
  image.Rows = rows;
  image.Materials = materials;
  return image;
}

TEST(ReadLengths, StripsGiveTheImageReadAtOnce)
{
  // 2 x 3 pixels in air and two materials; what the device leaves for air is not looked at.
  const std::vector<float> lengths{ -1, -1, -1, -1, -1, -1, 10, 11, 12, 13, 14, 15, 20, 21, 22, 23,
    24, 25 };
  const std::vector<std::uint32_t> failures{ 0, 1, 0, 4, 0, 4 };
  PathLengthImage whole = EmptyImage(2, 3, 3);
  EXPECT_THAT(ReadLengths({ lengths.data(), failures.data() }, { 0, 6 }, 2, whole),
    testing::ElementsAre(3, 5)); // none of 2 x 2 samples is left
  EXPECT_THAT(whole.Inconsistent, testing::ElementsAre(0, 1, 0, 1, 0, 1));
  EXPECT_THAT(std::vector<float>(whole.Material(0), whole.Material(1)), testing::Each(0.0f));
  EXPECT_THAT(std::vector<float>(whole.Material(2), whole.Material(2) + 6),
    testing::ElementsAre(20, 21, 22, 23, 24, 25));

  PathLengthImage strips = EmptyImage(2, 3, 3);
  const std::vector<float> first{ -1, -1, -1, -1, 10, 11, 12, 13, 20, 21, 22, 23 };
  const std::vector<float> second{ -1, -1, 14, 15, 24, 25 };
  EXPECT_THAT(ReadLengths({ first.data(), failures.data() }, { 0, 4 }, 2, strips),
    testing::ElementsAre(3));
  EXPECT_THAT(ReadLengths({ second.data(), failures.data() + 4 }, { 4, 2 }, 2, strips),
    testing::ElementsAre(5));
  EXPECT_EQ(strips.Lengths, whole.Lengths);
  EXPECT_EQ(strips.Inconsistent, whole.Inconsistent);
}

TEST(FillFromNeighbours, TakesTheMeanRingByRing)
{
  // A hole of 3 x 3 pixels in a plane that rises from column to column: its border takes the mean
  // of neighbours on its sides, its middle the mean of the border.
  constexpr int columns = 5;
  std::vector<float> planes(2 * 25);
  std::vector<std::size_t> holes;
  for (int pixel = 0; pixel < 25; ++pixel)
  {
    planes[static_cast<std::size_t>(pixel)] = static_cast<float>(pixel % columns);
    planes[static_cast<std::size_t>(25 + pixel)] = 7;
  }
  for (const std::size_t pixel : { 6, 7, 8, 11, 12, 13, 16, 17, 18 })
  {
    planes[pixel] = planes[25 + pixel] = -100;
    holes.push_back(pixel);
  }
  FillFromNeighbours(planes, columns, 5, holes);
  EXPECT_FLOAT_EQ(planes[7], 2);    // columns 1 to 3 of the row above
  EXPECT_FLOAT_EQ(planes[11], 0);   // column 0 beside it
  EXPECT_FLOAT_EQ(planes[6], 0.6f); // columns 0, 1, 2 above and 0, 0 beside
  EXPECT_FLOAT_EQ(planes[12], 2);   // by symmetry
  EXPECT_THAT(std::vector<float>(planes.begin() + 25, planes.end()), testing::Each(7.0f));
}

TEST(FillFromNeighbours, LeavesAnImageWithoutAnyTrustedRay)
{
  std::vector<float> planes{ 0, 0, 0, 0 };
  FillFromNeighbours(planes, 2, 2, { 0, 1, 2, 3 });
  EXPECT_THAT(planes, testing::Each(0.0f));
}

TEST(VelocityFields, PassesAreAsEvenAsCanBe)
{
  for (int fields = 1; fields < 40; ++fields)
  {
    for (int most = 1; most <= MostFieldsPerPass; ++most)
    {
      const int perPass = FieldsPerPass(fields, most);
      EXPECT_LE(perPass, most);
      // No more passes than with the most, and none could do with fewer fields each.
      const int passes = (fields + most - 1) / most;
      EXPECT_GE(perPass * passes, fields);
      EXPECT_LT((perPass - 1) * passes, fields);
    }
  }
}

TEST(VelocityFields, ABatchIsWrittenPointByPointTimesItsFactors)
{
  // Three fields of two points; the batch has the last two.
  const VectorFields velocities({ 9, 9, 9, 9, 9, 9, 1, 2, 3, 4, 5, 6, -1, -2, -3, -4, -5, -6 }, 6);
  FieldBatch batch{ 1, 2 };
  batch.Factor[1] = 10;
  std::vector<float> written(12);
  WriteVelocities(velocities, batch, written.data());
  EXPECT_THAT(written, testing::ElementsAre(1, 2, 3, -10, -20, -30, 4, 5, 6, -40, -50, -60));
  EXPECT_DOUBLE_EQ(LargestSpeed(velocities[1]), std::sqrt(16 + 25 + 36));
}

TEST(VelocityFields, RatesOfStripsAndBatchesEndInTheirPlaces)
{
  // Two fields, air and one material, 2 x 2 pixels: field by field, row by row.
  XRayDetector detector;
  detector.Columns = detector.Rows = 2;
  PathLengthDerivatives derivatives;
  PrepareDerivatives(detector, 2, 2, derivatives);
  for (int field = 0; field < 2; ++field)
  {
    for (std::size_t row = 0; row < 2; ++row)
    {
      FieldBatch batch{ field, 1 };
      batch.Unit[0] = 0.5;
      const float value = static_cast<float>(100 * field) + 10 * static_cast<float>(row);
      const std::vector<float> rates{ -1, -1, value, value + 2 };
      ReadRates(rates.data(), batch, { 2 * row, 2 }, derivatives);
    }
  }
  EXPECT_THAT(derivatives.Lengths,
    testing::ElementsAre(0, 0, 0, 0, 0, 1, 5, 6, 0, 0, 0, 0, 50, 51, 55, 56));
  EXPECT_EQ(derivatives.Of(1, 1)[3], 56);
}
}
