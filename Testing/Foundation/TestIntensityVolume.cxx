// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Foundation/Volumes.h"

#include <gmock/gmock.h>

#include <cmath>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

double LinearField(const Vector3& point)
{
  return 3 + 2 * point[0] - point[1] + 0.5 * point[2];
}

IntensityVolume LinearVolume()
{
  IntensityVolume volume;
  volume.Size = { 5, 4, 3 };
  volume.Origin = { 1, 2, 3 };
  volume.Spacing = { 0.5, 1, 2 };
  for (int k = 0; k < 3; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      for (int i = 0; i < 5; ++i)
      {
        volume.Voxels.push_back(static_cast<float>(LinearField(volume.PointAt(i, j, k))));
      }
    }
  }
  return volume;
}

TEST(IntensityVolume, InterpolatesALinearFieldExactly)
{
  const IntensityVolume volume = LinearVolume();
  for (const Vector3& index :
    { Vector3{ 0, 0, 0 }, Vector3{ 1.25, 2.5, 0.75 }, Vector3{ 4, 3, 2 } })
  {
    const Vector3 point = volume.PointAt(index[0], index[1], index[2]);
    ASSERT_TRUE(volume.ValueAt(point));
    EXPECT_NEAR(*volume.ValueAt(point), LinearField(point), 1e-6); // floats of size 10
  }
}

TEST(IntensityVolume, IsEmptyBeyondHalfAVoxel)
{
  const IntensityVolume volume = LinearVolume();
  // In the outer half of a voxel: as at its centre.
  EXPECT_EQ(volume.ValueAt(volume.PointAt(-0.4, 1, 1)), volume.ValueAt(volume.PointAt(0, 1, 1)));
  EXPECT_FALSE(volume.ValueAt(volume.PointAt(-0.6, 1, 1)));
  EXPECT_FALSE(volume.ValueAt(volume.PointAt(1, 3.6, 1)));
  EXPECT_FALSE(volume.ValueAt({ 1, 2, NAN }));
}

TEST(IntensityVolume, ValidateNamesTheVoxelThatIsNotFinite)
{
  IntensityVolume volume = LinearVolume();
  EXPECT_NO_THROW(volume.Validate("MRI"));
  volume.Voxels[volume.Index(4, 2, 1)] = INFINITY;
  EXPECT_THAT(RefusalOf([&] { volume.Validate("MRI"); }),
    test::Mentions("MRI", "(4, 2, 1)", "inf"));
}
}
