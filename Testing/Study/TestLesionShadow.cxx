// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "SqueezedBox.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/LesionShadow.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
/// A ball of label 3 and radius 5 mm in voxels of 0.5 mm.
LabelVolume Ball(const Vector3& centre)
{
  LabelVolume volume;
  volume.Size = { 25, 25, 25 };
  volume.Spacing = { 0.5, 0.5, 0.5 };
  volume.Origin = centre - Vector3{ 6, 6, 6 };
  for (int k = 0; k < 25; ++k)
  {
    for (int j = 0; j < 25; ++j)
    {
      for (int i = 0; i < 25; ++i)
      {
        volume.Voxels.push_back(Norm(volume.PointAt(i, j, k) - centre) < 5 ? 3 : 0);
      }
    }
  }
  return volume;
}

class ShadowInBox : public test::SqueezedBox
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    this->test::SqueezedBox::SetUp();
    this->Projector = MakeProjector();
  }
  std::unique_ptr<PathLengthProjector> Projector;
};
}

TEST_F(ShadowInBox, ASqueezedBallCastsItsEllipse)
{
  const Vector3 centre{ 10, 25, 0 };
  const LesionShadow shadow = ProjectLesion(*this->Breast, Ball(centre), 3, *this->Projector);
  EXPECT_NEAR(shadow.VolumeMm3, 4.0 / 3 * std::numbers::pi * 125, 15); // the voxels' stairs
  EXPECT_LT(Norm(shadow.Centre - centre), 1e-9);
  EXPECT_EQ(shadow.ShareOutside, 0);
  // Half axes 6.25 and 5 mm, 12 mm above the receptor; pixels of 2 mm count whole or not at all.
  const double magnification = 650.0 / 638;
  EXPECT_NEAR(shadow.AreaMm2, std::numbers::pi * 6.25 * 5 * magnification * magnification, 12);
  EXPECT_NEAR(shadow.LargestThicknessMm, 5, 0.3);
  EXPECT_EQ(4 * std::count(shadow.Shadow.begin(), shadow.Shadow.end(), 1),
    std::lround(shadow.AreaMm2));
  ASSERT_EQ(shadow.Outlines.size(), 1u);
  EXPECT_EQ(shadow.Outlines[0].front(), shadow.Outlines[0].back());
}

TEST_F(ShadowInBox, RefusesWhatIsNotInTheBreast)
{
  const auto refusal = [&](const LabelVolume& lesions, int label)
  {
    try
    {
      ProjectLesion(*this->Breast, lesions, label, *this->Projector);
    }
    catch (const InputError& error)
    {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_THAT(refusal(Ball({ 10, 25, 0 }), 4), HasSubstr("expected voxels of label 4, found none"));
  EXPECT_THAT(refusal(Ball({ 300, 25, 0 }), 3), HasSubstr("expected label 3 in the breast"));
}

TEST(FindLesions, MeasuresEachLabel)
{
  LabelVolume volume;
  volume.Size = { 4, 3, 2 };
  volume.Spacing = { 1, 2, 3 };
  volume.Origin = { 10, 0, -5 };
  volume.Voxels.assign(24, 0);
  EXPECT_THAT(FindLesions(volume), ::testing::IsEmpty());
  volume.Voxels[volume.Index(0, 0, 0)] = 7;
  volume.Voxels[volume.Index(3, 2, 1)] = 7;
  volume.Voxels[volume.Index(1, 1, 0)] = 2;
  const std::vector<Lesion> lesions = FindLesions(volume);
  ASSERT_EQ(lesions.size(), 2u);
  EXPECT_EQ(lesions[0].Label, 2);
  EXPECT_EQ(lesions[0].VolumeMm3, 6);
  EXPECT_EQ(lesions[0].Centre, (Vector3{ 11, 2, -5 }));
  EXPECT_EQ(lesions[1].Label, 7);
  EXPECT_EQ(lesions[1].VolumeMm3, 12);
  EXPECT_EQ(lesions[1].Centre, (Vector3{ 11.5, 2, -3.5 }));
}

TEST(FindLesions, AreReadFromFilesThatHoldSome)
{
  const test::TemporaryFolder folder;
  LabelVolume volume;
  volume.Size = { 2, 2, 2 };
  volume.Voxels.assign(8, 0);
  const std::string path = folder.File("lesions.nrrd");
  WriteLabelVolume(volume, path);
  EXPECT_THAT(test::RefusalOf([&] { ReadLesions(path); }),
    HasSubstr("lesions.nrrd: expected voxels that are not 0, found none"));
  volume.Voxels[5] = 1;
  WriteLabelVolume(volume, path);
  EXPECT_EQ(ReadLesions(path).Voxels, volume.Voxels);
}
