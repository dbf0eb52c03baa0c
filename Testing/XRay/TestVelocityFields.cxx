// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Private/VelocityFields.h"

#include <gmock/gmock.h>

namespace
{
using namespace mammoray;

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
