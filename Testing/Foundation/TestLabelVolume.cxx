// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Volumes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

using mammoray::test::RefusalOf;
using namespace mammoray;

namespace
{
LabelVolume ObliqueVolume()
{
  LabelVolume volume;
  volume.Size = { 3, 4, 5 };
  volume.Origin = { 10, -20, 30 };
  volume.Spacing = { 0.5, 1.5, 2.0 };
  volume.Direction = { { { 0.6, 0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, 1 } } };
  volume.Voxels.resize(60);
  for (std::size_t index = 0; index < volume.Voxels.size(); ++index)
  {
    volume.Voxels[index] = static_cast<std::uint16_t>(index % 7);
  }
  return volume;
}

}

TEST(LabelVolume, ObliqueIndexAndPointAreInverse)
{
  const LabelVolume volume = ObliqueVolume();
  for (int k = 0; k < 5; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int i = 0; i < 3; ++i)
      {
        const Vector3 point = volume.PointAt(i, j, k);
        const Vector3 index = volume.ContinuousIndex(point);
        // 1e-12: a few double operations on numbers of size 40.
        EXPECT_NEAR(index[0], i, 1e-12);
        EXPECT_NEAR(index[1], j, 1e-12);
        EXPECT_NEAR(index[2], k, 1e-12);
        EXPECT_EQ(volume.LabelAt(point), volume.Voxels[volume.Index(i, j, k)]);
      }
    }
  }
  EXPECT_EQ(volume.LabelAt({ 1000, 0, 0 }), 0);
  EXPECT_EQ(volume.LabelAt({ std::numeric_limits<double>::quiet_NaN(), 0, 0 }), 0);
}

TEST(LabelVolume, ValidateNamesWhatIsWrong)
{
  LabelVolume volume = ObliqueVolume();
  EXPECT_NO_THROW(volume.Validate("volume"));
  volume.Spacing[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(RefusalOf([&] { volume.Validate("v.nrrd"); }),
    testing::AllOf(testing::HasSubstr("v.nrrd"), testing::HasSubstr("spacing along axis 1")));
  volume = ObliqueVolume();
  volume.Direction[0] = { 1, 0, 0 };
  EXPECT_THAT(RefusalOf([&] { volume.Validate("v"); }), testing::HasSubstr("orthonormal"));
  volume = ObliqueVolume();
  volume.Voxels.pop_back();
  EXPECT_THAT(RefusalOf([&] { volume.Validate("v"); }), test::Mentions("60", "59"));
}
