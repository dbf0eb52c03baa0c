// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace mammoray;
using test::ReadFile;

namespace
{
constexpr int Width = 60;
constexpr int Depth = 50;
constexpr int Height = 50;

class SegmentCommand : public test::CommandTest
{
protected:
  /// A raw NRRD of floats, 2 mm voxels, LPS.
  std::string WriteMri(const std::string& name, float (*valueAt)(int, int, int)) const
  {
    std::string bytes =
      "NRRD0004\ntype: float\ndimension: 3\nspace: lps\nsizes: " + std::to_string(Width) + " " +
      std::to_string(Depth) + " " + std::to_string(Height) +
      "\nspace directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (-60,-50,-50)\n"
      "endian: little\nencoding: raw\n\n";
    for (int k = 0; k < Height; ++k)
    {
      for (int j = 0; j < Depth; ++j)
      {
        for (int i = 0; i < Width; ++i)
        {
          const float value = valueAt(i, j, k);
          bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
        }
      }
    }
    return this->Folder.Write(name, bytes);
  }

  /// Half a ball of fat with a ball of gland before muscle; the front is -y.
  static float Breast(int i, int j, int k)
  {
    const double x = i - 29.5;
    const double z = k - 24.5;
    const double toCentre = std::sqrt(x * x + (j - 34.0) * (j - 34.0) + z * z);
    const double toGland = std::sqrt(x * x + (j - 20.0) * (j - 20.0) + z * z);
    const float noise = static_cast<float>((7 * i + 11 * j + 13 * k) % 10);
    return noise +
      (j >= 36                       ? 350.0f
          : toGland < 6              ? 400.0f
          : j >= 31 || toCentre < 23 ? 1000.0f
                                     : 0.0f);
  }

  std::string Labels = this->Folder.File("labels.nii.gz");
};
}

TEST_F(SegmentCommand, MakesLabelsThatMeshTakes)
{
  const std::string picture = this->Folder.File("slices.png");
  const std::string mri = this->WriteMri("mri.nrrd", Breast);
  const std::string arguments = "segment --image " + mri + " -o " + this->Labels +
    " --label-spacing 0 --picture " + picture + " --config " +
    this->Folder.Write("skin.json", R"({ "skin-thickness": 2 })");
  ASSERT_EQ(this->Run(arguments), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output,
    testing::AllOf(testing::HasSubstr("gland"), testing::HasSubstr("1 breast;")));
  EXPECT_THAT(ReadFile(picture), testing::StartsWith("\x89PNG"));
  const LabelVolume labels = ReadLabelFile(this->Labels);
  EXPECT_EQ(labels.Size, (std::array<int, 3>{ Width, Depth, Height }));
  EXPECT_EQ(labels.Origin, (Vector3{ -60, -50, -50 }));
  EXPECT_EQ(labels.Voxels[labels.Index(30, 20, 25)], 2);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 28, 25)], 1);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 12, 25)], 3);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 40, 25)], 4);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 4, 25)], 0);
  // The ball of gland, 905 voxels, to the fifth that a voxel's half all over its surface is.
  EXPECT_NEAR(static_cast<double>(labels.CountLabels().at(2)), 905, 181);

  EXPECT_EQ(labels.Names.at(4), "chest-wall");
  EXPECT_THAT(ReadFile(this->Folder.File("labels.txt")), testing::HasSubstr("\"chest-wall\""));

  EXPECT_EQ(this->Run(arguments), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--overwrite"));
  std::filesystem::remove(this->Labels);
  this->ExpectRefused(arguments, "labels.txt");
  ASSERT_EQ(this->Run(arguments + " --overwrite"), 0) << this->Errors;
  const std::string mesh = this->Folder.File("mesh.vtu");
  const int status = this->Run("mesh --labels " + this->Labels +
    " --materials segment --facet-size 6 --cell-size 8 -o " + mesh);
  if (status == 1 && this->Errors.find("no Meshing module") != std::string::npos)
  {
    GTEST_SKIP() << this->Errors;
  }
  ASSERT_EQ(status, 0) << this->Errors;
  EXPECT_EQ(this->Run("mesh --check " + mesh), 0) << this->Errors;
}

TEST_F(SegmentCommand, TakesBothImagesOfASession)
{
  const std::string plain = this->WriteMri("plain.nrrd", Breast);
  // Fat becomes dark, gland and muscle are what is left.
  const std::string suppressed = this->WriteMri("suppressed.nrrd",
    [](int i, int j, int k)
    {
      const float value = Breast(i, j, k);
      return value > 900 ? 0.2f * value : value > 300 ? 1.5f * value : value;
    });
  const std::string segments = this->Folder.File("labels.seg.nrrd");
  const std::string arguments =
    "segment --image " + plain + " -o " + segments + " --label-spacing 0 --suppressed-image ";
  ASSERT_EQ(this->Run(arguments + suppressed), 0) << this->Errors;
  const LabelVolume labels = ReadLabelFile(segments);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 20, 25)], 2);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 28, 25)], 1);
  EXPECT_EQ(labels.Voxels[labels.Index(30, 40, 25)], 4);
  EXPECT_NEAR(static_cast<double>(labels.CountLabels().at(2)), 905, 181);
  EXPECT_EQ(labels.Names.at(2), "gland");
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("labels.txt")));
  this->ExpectRefused(arguments + this->Folder.File("absent") + " --overwrite", "no such file");
}

TEST_F(SegmentCommand, RefusesInOneLine)
{
  const std::string mri = this->WriteMri("mri.nrrd", Breast);
  const std::string output = " -o " + this->Labels;
  const std::string constant = this->WriteMri("constant.nrrd", [](int, int, int) { return 3.0f; });
  const std::string holed =
    this->WriteMri("nan.nrrd", [](int i, int, int) { return i == 5 ? std::nanf("") : 1.0f; });
  this->ExpectRefused("segment --image " + this->Folder.File("absent") + output, "no such file");
  this->ExpectRefused("segment --image " + this->Folder.Write("empty.nrrd", "") + output,
    "an empty file");
  this->ExpectRefused("segment --image " + constant + output, "the intensity 3 everywhere");
  this->ExpectRefused("segment --image " + holed + output, "voxel (5, 0, 0) holds nan");
  this->ExpectRefused("segment --image " + mri + " -o labels.vtu", ".nrrd, .mha or .nii.gz");
  this->ExpectRefused("segment --image " + mri + output + " --picture a.jpg", ".png");
  this->ExpectRefused("segment --image " + mri + output + " --orientation LPX", "orientation");
  this->ExpectRefused("segment --image " + mri + output + " --side left", "expected two breasts");
  const std::string withSettings = "segment --image " + mri + output + " --config ";
  this->ExpectRefused(withSettings +
      this->Folder.Write("skin.json", R"({ "skin-thickness": 0.5 })"),
    "at least the voxel spacing");
  this->ExpectRefused(withSettings + this->Folder.Write("classes.json", R"({ "classes": 7 })"),
    "classes");
  EXPECT_FALSE(std::filesystem::exists(this->Labels));
  EXPECT_EQ(this->Run("segment --image " + mri + output + " --side top"), 2);
  EXPECT_EQ(this->Run("segment " + output), 2);
}
