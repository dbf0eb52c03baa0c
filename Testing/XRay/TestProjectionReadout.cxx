// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Private/ProjectionReadout.h"

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
}
