// SPDX-License-Identifier: Apache-2.0
// Pictures whose muscle and markers are known, and real mammograms.
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/Registration/Private/MammogramMask.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

using mammoray::test::RefusalOf;
using namespace mammoray;
using testing::HasSubstr;

namespace
{
constexpr double PixelMm = 0.4;
constexpr double TopMm = 80;
/// The muscle of the made-up picture: from 40 mm out at the top to 90 mm down at the chest wall.
constexpr double MuscleOut = 40;
constexpr double MuscleDown = 90;

/// An oblique view of 160 mm along the chest wall, cut off at the top as the detector does, with
/// gland in the middle, noise and, with `step` > 0, a brighter muscle at the head's end.
RegistrationTarget Oblique(int headward, double step)
{
  RegistrationTarget target;
  target.Grid.Columns = 250;
  target.Grid.Rows = static_cast<int>(2 * TopMm / PixelMm);
  target.Grid.ColumnStep = { 0, PixelMm };
  target.Grid.RowStep = { -headward * PixelMm, 0 };
  target.Grid.Origin = { headward * (TopMm - 0.5 * PixelMm), 0.5 * PixelMm };
  std::mt19937 generator(3);
  std::normal_distribution<float> noise(0.0F, 0.05F);
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      const double down = (row + 0.5) * PixelMm;
      const double out = (column + 0.5) * PixelMm;
      const double edge = out / 90 * (out / 90) + (down - 100) / 110 * ((down - 100) / 110) - 1;
      const bool breast = edge < 0;
      const bool muscle = out / MuscleOut + down / MuscleDown < 1;
      const bool gland = std::hypot(out - 45, down - 100) < 25;
      const double value = breast ? 2 + 0.6 * gland + step * muscle : 0.0;
      target.BreastMask.push_back(breast ? 1 : 0);
      target.SignedDistanceMm.push_back(static_cast<float>(80 * edge));
      target.LogAttenuation.push_back(static_cast<float>(value) + noise(generator));
    }
  }
  return target;
}

bool InMuscle(const RegistrationTarget& target, std::size_t pixel)
{
  const double down = (static_cast<double>(pixel / target.Grid.Columns) + 0.5) * PixelMm;
  const double out = (static_cast<double>(pixel % target.Grid.Columns) + 0.5) * PixelMm;
  return out / MuscleOut + down / MuscleDown < 1;
}

/// The muscle is looked for in pixels of 1 mm: 0.28 mm are enough, and take a sixteenth of the
/// time.
Mammogram EveryFourth(const Mammogram& fine)
{
  Mammogram coarse = fine;
  coarse.Pixels.clear();
  coarse.Columns = fine.Columns / 4;
  coarse.Rows = fine.Rows / 4;
  coarse.ColumnSpacingMm = 4 * fine.ColumnSpacingMm;
  coarse.RowSpacingMm = 4 * fine.RowSpacingMm;
  for (int row = 0; row < coarse.Rows; ++row)
  {
    for (int column = 0; column < coarse.Columns; ++column)
    {
      coarse.Pixels.push_back(
        fine.Pixels[static_cast<std::size_t>(4 * row) * fine.Columns + 4 * column]);
    }
  }
  return coarse;
}

void WriteMask(const std::string& path, int columns, int rows)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(columns, rows, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* values = static_cast<unsigned char*>(image->GetScalarPointer());
  std::fill_n(values, static_cast<std::size_t>(columns) * rows, 0);
  // VTK's last row is the picture's first.
  values[static_cast<std::size_t>(rows - 1) * columns + 5] = 255;
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  writer->Write();
}
}

TEST(MammogramMask, FindsAMusclesEdgeInBothBreasts)
{
  for (const int headward : { 1, -1 })
  {
    SCOPED_TRACE(headward);
    RegistrationTarget target = Oblique(headward, 0.4);
    const std::optional<PectoralEdge> edge = FindPectoralEdge(target, headward);
    ASSERT_TRUE(edge.has_value());
    // Lines are tried every 2 mm, in pixels of 1 mm: 3 mm at its ends.
    EXPECT_NEAR(edge->Head[1], MuscleOut, 3);
    EXPECT_NEAR(headward * edge->Head[0], TopMm, 1.5);
    EXPECT_NEAR(headward * edge->ChestWall[0], TopMm - MuscleDown, 6);
    EXPECT_GT(edge->Contrast, 0.3);
    ExcludePectoral(*edge, headward, target);
    std::size_t muscle = 0;
    std::size_t missed = 0;
    std::size_t lost = 0;
    for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
    {
      muscle += InMuscle(target, pixel);
      missed += InMuscle(target, pixel) && !IsExcluded(target, pixel);
      lost += !InMuscle(target, pixel) && IsExcluded(target, pixel);
    }
    // With the margin of 2 mm hardly any muscle is left; the margin and 3 mm are lost along 98 mm.
    EXPECT_LT(missed, 0.01 * muscle);
    EXPECT_LT(lost * PixelMm * PixelMm, 5 * std::hypot(MuscleOut, MuscleDown));
  }
}

TEST(MammogramMask, FindsNoMuscleWhereThereIsNone)
{
  EXPECT_FALSE(FindPectoralEdge(Oblique(1, 0), 1).has_value());
  // A darker corner is none either.
  EXPECT_FALSE(FindPectoralEdge(Oblique(1, -0.4), 1).has_value());
  // A real cranio-caudal view shows none at either end.
  const std::string path =
    test::SharedDataFolder() + "/digibreast/dicom/mg_presentation_mono2_explicitLE.dcm";
  if (!std::filesystem::exists(path))
  {
    GTEST_SKIP() << path << " is absent";
  }
  const RegistrationTarget real = PrepareTarget(ReadMammogram(path));
  EXPECT_FALSE(FindPectoralEdge(real, 1).has_value());
  EXPECT_FALSE(FindPectoralEdge(real, -1).has_value());
}

TEST(MammogramMask, ExcludesMarkersButNotABreastThatIsBrightThroughout)
{
  RegistrationTarget target = Oblique(1, 0);
  // A letter of 2 x 4 mm.
  for (int row = 200; row < 210; ++row)
  {
    for (int column = 100; column < 105; ++column)
    {
      target.LogAttenuation[static_cast<std::size_t>(row) * target.Grid.Columns + column] = 9;
    }
  }
  EXPECT_NEAR(ExcludeSaturated(target), 8, 1e-9);
  // And half a millimetre, one pixel, on each side.
  EXPECT_EQ(std::count(target.Excluded.begin(), target.Excluded.end(), 1), 7 * 12);
  EXPECT_TRUE(IsExcluded(target, 199 * 250 + 99));
  EXPECT_FALSE(IsExcluded(target, 198 * 250 + 99));

  RegistrationTarget bright = Oblique(1, 0);
  for (float& value : bright.LogAttenuation)
  {
    value = std::min(value, 2.0F);
  }
  EXPECT_EQ(ExcludeSaturated(bright), 0);
  EXPECT_TRUE(bright.Excluded.empty());
}

TEST(MammogramMask, TakesAUsersMaskWithItsFirstRowAtTheTop)
{
  const test::TemporaryFolder folder;
  RegistrationTarget target = Oblique(1, 0);
  WriteMask(folder.File("mask.png"), target.Grid.Columns, target.Grid.Rows);
  ExcludePixels(ReadMask(folder.File("mask.png"), target.Grid.Columns, target.Grid.Rows), target);
  EXPECT_EQ(std::count(target.Excluded.begin(), target.Excluded.end(), 1), 1);
  EXPECT_TRUE(IsExcluded(target, 5));
  WriteMask(folder.File("small.png"), 8, 8);
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  ExcludePixels(
                    ReadMask(folder.File("small.png"), target.Grid.Columns, target.Grid.Rows),
                    target);
                }),
    HasSubstr("small.png: expected a mask of the mammogram's 250 x 400"));
  EXPECT_THROW(
    ExcludePixels(ReadMask(folder.File("none.png"), target.Grid.Columns, target.Grid.Rows), target),
    InputError);
  folder.Write("mask.txt", "1");
  EXPECT_THROW(
    ExcludePixels(ReadMask(folder.File("mask.txt"), target.Grid.Columns, target.Grid.Rows), target),
    InputError);
}

TEST(MammogramMask, PicturesNeedWhatTheyDoNotSay)
{
  const test::TemporaryFolder folder;
  WriteMask(folder.File("a.png"), 40, 30);
  EXPECT_THAT(RefusalOf([&] { ReadMammogramPicture(folder.File("a.png"), { .View = "MLO" }); }),
    HasSubstr("pixel spacing, laterality"));
  const Mammogram read = ReadMammogramPicture(folder.File("a.png"),
    { .PixelSpacingMm = 0.1, .View = "MLO", .Laterality = 'L' });
  EXPECT_EQ(read.Columns, 40);
  EXPECT_EQ(read.Pixels[5], 255);
  EXPECT_EQ(read.Pixels[6], 0);
  EXPECT_EQ(read.ColumnSpacingMm, 0.1);
}

TEST(MammogramMask, FindsTheMuscleOfRealMammograms)
{
  struct Expected
  {
    const char* Name;
    char Laterality;
    double OutMm;
    double DownMm;
  };
  for (const Expected& expected :
    { Expected{ "sample_B1.jpg", 'R', 43, 124 }, Expected{ "sample_C4.jpg", 'L', 47, 103 } })
  {
    const std::string path = (test::SharedDataFolder() + "/monai-mammograms/") + expected.Name;
    if (!std::filesystem::exists(path))
    {
      GTEST_SKIP() << path << " is absent";
    }
    SCOPED_TRACE(expected.Name);
    const RegistrationTarget target = PrepareTarget(EveryFourth(ReadMammogramPicture(path,
      { .PixelSpacingMm = 0.07, .View = "MLO", .Laterality = expected.Laterality })));
    const int headward = expected.Laterality == 'L' ? 1 : -1;
    const std::optional<PectoralEdge> edge = FindPectoralEdge(target, headward);
    ASSERT_TRUE(edge.has_value());
    EXPECT_NEAR(edge->Head[1], expected.OutMm, 8);
    EXPECT_NEAR(headward * (edge->Head[0] - edge->ChestWall[0]), expected.DownMm, 20);
    const auto excluded = std::count(target.Excluded.begin(), target.Excluded.end(), 1);
    EXPECT_GT(excluded, 0);
  }
}
