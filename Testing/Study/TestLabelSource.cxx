// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/LabelSource.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
class LabelSourceTest : public testing::Test
{
protected:
  void SetUp() override
  {
    this->Volume.Size = { 8, 8, 8 };
    this->Volume.Voxels.assign(512, 0);
    for (int k = 2; k < 6; ++k)
    {
      for (int j = 2; j < 6; ++j)
      {
        for (int i = 2; i < 6; ++i)
        {
          this->Volume.Voxels[this->Volume.Index(i, j, k)] = 10;
        }
      }
    }
    this->Table.Name = "test";
    this->Table.Materials = { { "air" }, { "fat" }, { .Name = "skin", .Thin = true } };
    this->Table.MaterialOfLabel = { { 0, 0 }, { 10, 1 } };
    this->Source.Path = this->Folder.File("labels.nrrd");
    WriteLabelVolume(this->Volume, this->Source.Path);
  }

  std::string Message() const
  {
    try
    {
      ReadMaterials(this->Source, this->Table);
    }
    catch (const InputError& error)
    {
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
    return "no InputError";
  }

  test::TemporaryFolder Folder;
  LabelVolume Volume;
  MaterialTable Table;
  LabelSource Source;
};
}

TEST_F(LabelSourceTest, CropsResamplesAndAddsSkin)
{
  EXPECT_EQ(ReadMaterials(this->Source, this->Table).CountLabels().at(1), 64u);
  this->Source.Crop = { "4:", ":", ":5" };
  LabelVolume volume = ReadMaterials(this->Source, this->Table);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 4, 8, 6 }));
  EXPECT_EQ(volume.CountLabels().at(1), 32u);
  // The cut along i and the volume's end along k have no skin: 2 x 4 x 4 lose three sides.
  this->Source.Skin = "1";
  volume = ReadMaterials(this->Source, this->Table);
  EXPECT_EQ(volume.CountLabels().at(1), 1u * 2 * 3);
  EXPECT_EQ(volume.CountLabels().at(2), 32u - 6);
  // After resampling, so that a thin skin is possible: half the voxels' size, two layers.
  this->Source.SpacingMm = 0.5;
  volume = ReadMaterials(this->Source, this->Table);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 8, 16, 12 }));
  EXPECT_EQ(volume.CountLabels().at(1), 8u * 6);
  this->Source.OnlyCoarsen = true;
  EXPECT_EQ(ReadMaterials(this->Source, this->Table).Size[0], 4);
}

TEST_F(LabelSourceTest, CutSidesGetNoSkin)
{
  this->Source.Skin = "1";
  // 4 x 4 x 4 with air all around keep 2 x 2 x 2; each side that was cut one layer more.
  EXPECT_EQ(ReadMaterials(this->Source, this->Table).CountLabels().at(1), 8u);
  this->Source.CutSides = { "j+" };
  LabelVolume volume = ReadMaterials(this->Source, this->Table);
  EXPECT_EQ(volume.CountLabels().at(1), 2u * 3 * 2);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 8, 6, 8 }));
  EXPECT_EQ(volume.Voxels[volume.Index(3, 5, 3)], 1);
  EXPECT_EQ(volume.Voxels[volume.Index(3, 2, 3)], 2);
  this->Source.CutSides = { "j+", "i-" };
  volume = ReadMaterials(this->Source, this->Table);
  EXPECT_EQ(volume.CountLabels().at(1), 3u * 3 * 2);
  EXPECT_EQ(volume.Voxels[volume.Index(0, 5, 3)], 1);
  EXPECT_EQ(volume.Origin[0], 2);
}

TEST_F(LabelSourceTest, VoxelsOfNoPatientAreTakenOnlyWhenTold)
{
  this->Volume.Spacing = { 1, 1, 3200 }; // um read as mm
  WriteLabelVolume(this->Volume, this->Source.Path);
  EXPECT_THAT(this->Message(),
    HasSubstr(
      "expected a voxel spacing from 0.05 to 10 mm, found 3200 (in um?); set AcceptUnusual"));
  this->Source.AcceptUnusual = true;
  EXPECT_EQ(ReadMaterials(this->Source, this->Table).Spacing[2], 3200);
}

TEST_F(LabelSourceTest, RefusesInOneLine)
{
  for (const char* side : { "", "j", "x+", "P", "j+-" })
  {
    this->Source.CutSides = { side };
    EXPECT_THAT(this->Message(), HasSubstr("expected i-, i+, j-, j+, k- or k+, found '"));
  }
  this->Source.CutSides.clear();
  this->Source.Crop = { "0:8", ":", ":" };
  EXPECT_THAT(this->Message(),
    testing::AllOf(HasSubstr("crop 0:8 0:7 0:7"), HasSubstr("voxels 0:7 0:7 0:7")));
  this->Source.Crop = { "5:4", ":", ":" };
  EXPECT_THAT(this->Message(), HasSubstr("crop 5:4 0:7 0:7"));
  for (const std::vector<std::string>& crop :
    { std::vector<std::string>{ "1", ":", ":" }, { "1:x", ":", ":" }, { "1:2:3", ":", ":" },
      { "1.5:2", ":", ":" }, { ":", ":" }, { "99999999999:", ":", ":" } })
  {
    this->Source.Crop = crop;
    EXPECT_THAT(this->Message(), HasSubstr("crop: expected FIRST:LAST"));
  }
  this->Source.Crop = { "0:1", "0:1", "0:1" };
  EXPECT_THAT(this->Message(), HasSubstr("found only air"));
  this->Source.Crop.clear();
  this->Source.Skin = "thick";
  EXPECT_THAT(this->Message(), HasSubstr("skin: expected THICKNESS"));
  this->Source.Skin = "0.5";
  EXPECT_THAT(this->Message(), HasSubstr("skin of 0.5 mm: expected at least the voxel spacing, 1"));
  this->Source.Skin = "1=leather";
  EXPECT_THAT(this->Message(), HasSubstr("unknown material 'leather'"));
  this->Table.Materials[2].Thin = false;
  this->Source.Skin = "1";
  EXPECT_THAT(this->Message(), HasSubstr("has 0 thin materials"));
  this->Volume.Voxels[3] = 11;
  WriteLabelVolume(this->Volume, this->Source.Path);
  EXPECT_THAT(this->Message(),
    HasSubstr("label 11 (1 voxels) is not in the material table 'test'"));
}
