// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <zlib.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

using namespace mammoray;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

namespace
{
const std::string Shared = test::SharedDataFolder();
const std::string Victre = test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";

#define SKIP_WITHOUT(path)                                                                         \
  if (!std::filesystem::exists(path))                                                              \
  GTEST_SKIP() << "absent: " << (path)

/**
 * A half ball of radius R centred on the middle of the chest-wall edge, compressed to a lens that
 * holds mu * path = 3 at most; the left breast seen from above: chest wall at the left, lateral
 * side up.
 */
constexpr int Columns = 300;
constexpr int Rows = 400;
constexpr double Spacing = 0.2;
constexpr double Radius = 30;

double RadiusAt(int column, int row)
{
  return std::hypot((column + 0.5) * Spacing, (row - 0.5 * (Rows - 1)) * Spacing);
}

double LensAttenuation(double radius)
{
  return radius < Radius ? 3 * std::sqrt(1 - radius * radius / (Radius * Radius)) : 0;
}

Mammogram Lens()
{
  Mammogram mammogram;
  mammogram.Columns = Columns;
  mammogram.Rows = Rows;
  mammogram.ColumnSpacingMm = Spacing;
  mammogram.RowSpacingMm = Spacing;
  mammogram.PresentationIntent = Mammogram::Intent::ForProcessing;
  mammogram.IntensityRelationship = Mammogram::Relationship::Linear;
  mammogram.IntensitySign = 1;
  mammogram.InvertedForDisplay = true;
  mammogram.BitsStored = 14;
  mammogram.View = "CC";
  mammogram.Laterality = 'L';
  mammogram.RowDirection = "A";
  mammogram.ColumnDirection = "R";
  std::mt19937 generator(1);
  std::normal_distribution<double> noise;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      const double quanta = 4000 * std::exp(-LensAttenuation(RadiusAt(column, row)));
      mammogram.Pixels.push_back(
        static_cast<float>(3 * (quanta + std::sqrt(quanta) * noise(generator))));
    }
  }
  return mammogram;
}

/// Largest difference of the signed distance from that of the circle, over the whole picture.
double WorstDistanceError(const RegistrationTarget& target)
{
  double worst = 0;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      const double expected = RadiusAt(column, row) - Radius;
      const double found =
        target.SignedDistanceMm[static_cast<std::size_t>(row) * Columns + column];
      worst = std::max(worst, std::abs(found - expected));
    }
  }
  return worst;
}

/// The picture with columns reversed.
std::vector<float> Mirrored(std::vector<float> pixels)
{
  for (int row = 0; row < Rows; ++row)
  {
    const auto first = pixels.begin() + static_cast<std::ptrdiff_t>(row) * Columns;
    std::reverse(first, first + Columns);
  }
  return pixels;
}

std::vector<double> At(const RegistrationTarget& target, int column, int row)
{
  return { target.Grid.Origin[0] + column * target.Grid.ColumnStep[0] +
      row * target.Grid.RowStep[0],
    target.Grid.Origin[1] + column * target.Grid.ColumnStep[1] + row * target.Grid.RowStep[1] };
}

void ExpectAt(const RegistrationTarget& target, int column, int row, double x, double y)
{
  const std::vector<double> found = At(target, column, row);
  EXPECT_NEAR(found[0], x, 1e-9);
  EXPECT_NEAR(found[1], y, 1e-9);
}
}

TEST(TargetPreparation, FindsTheOutlineOfALens)
{
  const RegistrationTarget target = PrepareTarget(Lens());
  EXPECT_THAT(target.Warnings, IsEmpty());
  // Half a pixel (0.1 mm) by the pixel grid, half as much again by noise at the edge.
  EXPECT_LT(WorstDistanceError(target), 0.15);
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    ASSERT_EQ(target.BreastMask[pixel] != 0, target.SignedDistanceMm[pixel] < 0);
  }
}

/// Mean of what the log attenuation differs from the lens', but for its edge.
double MeanAttenuationError(const RegistrationTarget& target)
{
  double sum = 0;
  int count = 0;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      const double radius = RadiusAt(column, row);
      if (radius < Radius - 1 || radius > Radius + 1)
      {
        sum += target.LogAttenuation[static_cast<std::size_t>(row) * Columns + column] -
          LensAttenuation(radius);
        ++count;
      }
    }
  }
  return sum / count;
}

/// The picture times `gain(depth, along)`, mm from the chest wall and from the middle.
template <class Gain>
Mammogram Exposed(Mammogram mammogram, Gain gain)
{
  for (int row = 0; row < mammogram.Rows; ++row)
  {
    for (int column = 0; column < mammogram.Columns; ++column)
    {
      mammogram.Pixels[static_cast<std::size_t>(row) * mammogram.Columns + column] *=
        static_cast<float>(gain((column + 0.5) * mammogram.ColumnSpacingMm,
          (row - 0.5 * (mammogram.Rows - 1)) * mammogram.RowSpacingMm));
    }
  }
  return mammogram;
}

TEST(TargetPreparation, LogAttenuationIsExactForLinearImages)
{
  // -ln of a noisy count is larger by 1 / (2 quanta) on average: 0.0013 to 0.0025 behind the lens.
  EXPECT_NEAR(MeanAttenuationError(PrepareTarget(Lens())), 0.0005, 0.001);
}

TEST(TargetPreparation, HeelAndInverseSquareAreNoBreast)
{
  // A source 150 mm above the chest wall's edge: cos^3, 18 % less at the far corner; a heel of as
  // much over the picture's 60 mm, either way round.
  for (const double heel : { 0.18, -0.18 })
  {
    const RegistrationTarget target = PrepareTarget(Exposed(Lens(),
      [heel](double depth, double along)
      {
        return std::pow(1 + (depth * depth + along * along) / (150 * 150), -1.5) *
          (1 - heel * depth / 60);
      }));
    EXPECT_LT(WorstDistanceError(target), 0.15) << heel;
    // A polynomial of second degree in place of these, and its way under the lens: 1 % of what the
    // lens absorbs.
    EXPECT_NEAR(MeanAttenuationError(target), 0, 0.03) << heel;
  }
}

TEST(TargetPreparation, ScatterBesideTheBreastIsNoAir)
{
  // A tenth of the primary beside the breast, falling to 1/e over 15 mm; behind the breast half as
  // much as its own primary.
  Mammogram scattered = Lens();
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      const double radius = RadiusAt(column, row);
      scattered.Pixels[static_cast<std::size_t>(row) * Columns + column] +=
        static_cast<float>(3 * 4000 * 0.1 * std::exp(-std::max(0.0, radius - Radius) / 15));
    }
  }
  // The edge's threshold, 3 % of the contrast, is met where 0.2 mm more of the rim are absorbed.
  EXPECT_LT(WorstDistanceError(PrepareTarget(scattered)), 0.35);
}

TEST(TargetPreparation, MarkersHolesFramesAndPaddingAreNotOutline)
{
  Mammogram mammogram = Lens();
  const auto fill = [&](int column0, int column1, int row0, int row1, float value)
  {
    for (int row = row0; row < row1; ++row)
    {
      std::fill(mammogram.Pixels.begin() + row * Columns + column0,
        mammogram.Pixels.begin() + row * Columns + column1, value);
    }
  };
  fill(220, 280, 20, 50, 300.0F);            // a lead marker beside the breast
  fill(60, 70, 190, 200, 12000.0F);          // a hole
  fill(0, 3, 0, Rows, 12000.0F);             // columns that were not exposed, at the chest wall
  fill(0, Columns, Rows - 3, Rows, 1.0F);    // a frame
  fill(Columns - 20, Columns, 0, Rows, NAN); // padding
  EXPECT_LT(WorstDistanceError(PrepareTarget(mammogram)), 0.15);
}

TEST(TargetPreparation, CoarsePixelsAreOutlinedBetweenTheirCentres)
{
  // Every fifth pixel of the lens: 1 mm.
  const Mammogram fine = Lens();
  Mammogram coarse = fine;
  coarse.Columns /= 5;
  coarse.Rows /= 5;
  coarse.ColumnSpacingMm *= 5;
  coarse.RowSpacingMm *= 5;
  coarse.Pixels.clear();
  for (int row = 2; row < Rows; row += 5)
  {
    for (int column = 2; column < Columns; column += 5)
    {
      coarse.Pixels.push_back(fine.Pixels[static_cast<std::size_t>(row) * Columns + column]);
    }
  }
  const RegistrationTarget target = PrepareTarget(coarse);
  double worst = 0;
  double mean = 0;
  for (int row = 0; row < coarse.Rows; ++row)
  {
    for (int column = 0; column < coarse.Columns; ++column)
    {
      const double expected = RadiusAt(2 + 5 * column, 2 + 5 * row) - Radius;
      const double error =
        target.SignedDistanceMm[static_cast<std::size_t>(row) * coarse.Columns + column] - expected;
      worst = std::max(worst, std::abs(error));
      mean += error / static_cast<double>(coarse.Columns * coarse.Rows);
    }
  }
  // Linear interpolation towards the pixel of air next to the edge moves the outline out by up to
  // one.
  EXPECT_LT(worst, 1.0);
  EXPECT_LT(std::abs(mean), 0.6);
}

TEST(TargetPreparation, DirectionsFollowTheHeader)
{
  Mammogram mammogram = Lens();
  const double halfHeight = 0.5 * (Rows - 1) * Spacing;
  const double depth = (Columns - 0.5) * Spacing;
  // Left breast, row to anterior, column to the right: up is the patient's left, x = +.
  ExpectAt(PrepareTarget(mammogram), 0, 0, halfHeight, 0.5 * Spacing);

  // Hung as a right breast: chest wall at the right, columns run to the patient's left.
  const std::vector<float> pixels = mammogram.Pixels;
  mammogram.Pixels = Mirrored(pixels);
  mammogram.RowDirection = "P";
  mammogram.ColumnDirection = "L";
  mammogram.Laterality = 'R';
  ExpectAt(PrepareTarget(mammogram), 0, 0, -halfHeight, depth);
  ExpectAt(PrepareTarget(mammogram), Columns - 1, Rows - 1, halfHeight, 0.5 * Spacing);

  // Oblique views: +x leads to the head for the left breast, to the feet for the right one.
  mammogram.View = "MLO";
  for (const char* down : { "F", "FL" })
  {
    mammogram.ColumnDirection = down;
    ExpectAt(PrepareTarget(mammogram), Columns - 1, 0, -halfHeight, 0.5 * Spacing);
  }
  mammogram.Pixels = pixels;
  mammogram.RowDirection = "A";
  mammogram.Laterality = 'L';
  for (const char* down : { "F", "FR" })
  {
    mammogram.ColumnDirection = down;
    ExpectAt(PrepareTarget(mammogram), 0, 0, halfHeight, 0.5 * Spacing);
  }
  EXPECT_THAT(PrepareTarget(mammogram).Warnings, IsEmpty());
}

TEST(TargetPreparation, TurnedPicturesKeepTheirDirections)
{
  const Mammogram upright = Lens();
  Mammogram turned = upright;
  std::swap(turned.Columns, turned.Rows);
  turned.RowDirection = "R";
  turned.ColumnDirection = "A";
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      turned.Pixels[static_cast<std::size_t>(column) * Rows + row] =
        upright.Pixels[static_cast<std::size_t>(row) * Columns + column];
    }
  }
  const RegistrationTarget a = PrepareTarget(upright);
  const RegistrationTarget b = PrepareTarget(turned);
  EXPECT_EQ(At(a, 17, 23), At(b, 23, 17));
  EXPECT_THAT(b.Warnings, IsEmpty());
}

TEST(TargetPreparation, SaysWhatItAssumesWithoutAHeader)
{
  Mammogram mammogram = Lens();
  const RegistrationTarget told = PrepareTarget(mammogram);
  mammogram.RowDirection.clear();
  mammogram.ColumnDirection.clear();
  mammogram.Laterality = '?';
  const RegistrationTarget guessed = PrepareTarget(mammogram);
  // As hung: the left breast with its chest wall at the left and the lateral side up.
  EXPECT_EQ(guessed.Grid.Origin, told.Grid.Origin);
  EXPECT_EQ(guessed.Grid.RowStep, told.Grid.RowStep);
  EXPECT_THAT(guessed.Warnings, SizeIs(3));
  EXPECT_THAT(guessed.Warnings, Contains(HasSubstr("left edge of the picture")));

  mammogram.Pixels = Mirrored(mammogram.Pixels);
  const RegistrationTarget right = PrepareTarget(mammogram);
  EXPECT_THAT(right.Warnings, Contains(HasSubstr("taken as the right one")));
  ExpectAt(right, Columns - 1, Rows - 1, 0.5 * (Rows - 1) * Spacing, 0.5 * Spacing);

  mammogram.RowDirection = "A"; // contradicts the picture
  EXPECT_THAT(PrepareTarget(mammogram).Disagreements,
    Contains(HasSubstr("touches the right edge most")));
}

TEST(TargetPreparation, RefusesAPictureThatCutsTheBreastOff)
{
  // The lens is 30 mm deep and 60 mm wide; columns are in front of each other, 0.2 mm each.
  const auto cut = [](int columns, int firstRow, int rows)
  {
    Mammogram whole = Lens();
    Mammogram part = whole;
    part.Columns = columns;
    part.Rows = rows;
    part.Pixels.clear();
    for (int row = firstRow; row < firstRow + rows; ++row)
    {
      const auto begin = whole.Pixels.begin() + static_cast<std::ptrdiff_t>(row) * Columns;
      part.Pixels.insert(part.Pixels.end(), begin, begin + columns);
    }
    return part;
  };
  // At 24 mm the lens is 36 mm wide, at 29 mm 15.
  EXPECT_THAT(test::RefusalOf([&] { PrepareTarget(cut(120, 0, Rows)); }),
    HasSubstr("cut off at its front: 36 mm"));
  EXPECT_THAT(PrepareTarget(cut(145, 0, Rows)).Warnings, IsEmpty());
  // 18 mm to either side of the middle the lens is 24 mm deep.
  EXPECT_THAT(PrepareTarget(cut(Columns, 110, 180)).Disagreements,
    ElementsAre(HasSubstr("both ends along the chest wall, over 24 and 24 mm")));
}

TEST(TargetPreparation, LeavesOutAStripAlongTheChestWall)
{
  const RegistrationTarget target = PrepareTarget(Lens(), { .ChestWallMarginMm = 10 });
  EXPECT_EQ(target.OutlineFromMm, 10);
  EXPECT_EQ(CoarsenTo(target, 1).OutlineFromMm, 10);
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    ASSERT_EQ(IsExcluded(target, pixel), pixel % Columns < 50) << "at " << pixel;
  }
  // Its middle is that of what is compared: one arm along the chest wall does not count.
  RegistrationTarget armed = target;
  for (int column = 0; column < 40; ++column)
  {
    armed.BreastMask[static_cast<std::size_t>(column)] = 1;
  }
  EXPECT_NEAR(ChestWallCentre(armed)[0], 0, 1e-9);
  armed.OutlineFromMm = 0;
  EXPECT_GT(std::abs(ChestWallCentre(armed)[0]), 4);
  EXPECT_THROW(PrepareTarget(Lens(), { .ChestWallMarginMm = -1 }), InputError);
  EXPECT_THROW(PrepareTarget(Lens(), { .ChestWallMarginMm = NAN }), InputError);
}

TEST(TargetPreparation, WhatIsMadeToBeLookedAtIsShownRight)
{
  // A display curve without logarithm, bright in the breast; its noise is that of raw data.
  Mammogram shown = Lens();
  shown.PresentationIntent = Mammogram::Intent::ForPresentation;
  shown.IntensityRelationship = Mammogram::Relationship::Unknown;
  shown.InvertedForDisplay = false;
  for (float& pixel : shown.Pixels)
  {
    pixel = 16000.0F - pixel;
  }
  shown.IntensitySign = -1;
  const RegistrationTarget right = PrepareTarget(shown);
  EXPECT_THAT(right.Warnings, IsEmpty());
  shown.IntensitySign = 1; // more X-ray where it is bright: the breast would be a hole
  const RegistrationTarget contradicted = PrepareTarget(shown);
  EXPECT_EQ(contradicted.BreastMask, right.BreastMask);
  EXPECT_THAT(contradicted.Disagreements,
    ElementsAre(HasSubstr("contradicts"), HasSubstr("as in raw data")));
}

TEST(TargetPreparation, NoiseTellsRawDataFromWhatIsMadeToBeLookedAt)
{
  EXPECT_THAT(PrepareTarget(Lens()).Disagreements, IsEmpty());
  // Raw data called For Presentation.
  Mammogram raw = Lens();
  raw.PresentationIntent = Mammogram::Intent::ForPresentation;
  EXPECT_THAT(PrepareTarget(raw).Disagreements, ElementsAre(HasSubstr("as in raw data")));
  // Its detector saturated in the air.
  for (float& pixel : raw.Pixels)
  {
    pixel = std::min(pixel, 9000.0F);
  }
  EXPECT_THAT(PrepareTarget(raw).Disagreements, ElementsAre(HasSubstr("as in raw data")));
  // The logarithm, bright in the breast.
  Mammogram shown = Lens();
  shown.InvertedForDisplay = false;
  shown.PresentationIntent = Mammogram::Intent::ForPresentation;
  shown.IntensityRelationship = Mammogram::Relationship::Logarithmic;
  shown.IntensitySign = -1;
  for (float& pixel : shown.Pixels)
  {
    pixel = std::round(1000.0F * std::log(16000.0F / std::max(pixel, 1.0F)));
  }
  EXPECT_THAT(PrepareTarget(shown).Disagreements, IsEmpty());
  // The same called For Processing and linear in what is missing of the intensity.
  shown.PresentationIntent = Mammogram::Intent::ForProcessing;
  shown.IntensityRelationship = Mammogram::Relationship::Linear;
  shown.IntensitySign = -1;
  EXPECT_THAT(PrepareTarget(shown).Disagreements, ElementsAre(HasSubstr("made to be looked at")));
  // Nothing to measure in a picture without noise.
  Mammogram smooth = Lens();
  smooth.PresentationIntent = Mammogram::Intent::ForPresentation;
  for (int row = 0; row < Rows; ++row)
  {
    for (int column = 0; column < Columns; ++column)
    {
      smooth.Pixels[static_cast<std::size_t>(row) * Columns + column] = std::round(
        12000.0F * static_cast<float>(std::exp(-LensAttenuation(RadiusAt(column, row)))));
    }
  }
  EXPECT_THAT(PrepareTarget(smooth).Disagreements, IsEmpty());
}

TEST(TargetPreparation, RefusesPicturesWithoutBreastOrAir)
{
  Mammogram mammogram = Lens();
  std::fill(mammogram.Pixels.begin(), mammogram.Pixels.end(), 12000.0F);
  EXPECT_THROW(PrepareTarget(mammogram), InputError);
  std::fill(mammogram.Pixels.begin(), mammogram.Pixels.end(), NAN);
  EXPECT_THROW(PrepareTarget(mammogram), InputError);
  mammogram.Pixels.pop_back();
  EXPECT_THROW(PrepareTarget(mammogram), InputError);
}

TEST(TargetPreparation, PlacesThePhantomsMammogramWhereItsMakersSay)
{
  SKIP_WITHOUT(Victre);
  const RegistrationTarget target = PrepareTarget(ReadMammogram(Victre));
  EXPECT_THAT(target.Warnings, IsEmpty());
  for (const int row : { 0, 500, 1079 })
  {
    for (const int column : { 0, 719 })
    {
      ExpectAt(target, column, row, (539.5 - row) * 0.1, (column + 0.5) * 0.1);
    }
  }
  // 418010 pixels' rays meet tissue of the compressed label volume.
  const long inside = std::accumulate(target.BreastMask.begin(), target.BreastMask.end(), 0L);
  EXPECT_NEAR(static_cast<double>(inside), 418010, 0.005 * 418010);
}

TEST(TargetPreparation, MasksThePhantomsBreastAsItsLabelVolumeDoes)
{
  const std::string folder = Shared + "/victre-pipeline-phantom-1/";
  SKIP_WITHOUT(folder);
  constexpr int Size[3] = { 331, 539, 258 };
  std::vector<unsigned char> labels(std::size_t{ 331 } * 539 * 258);
  const gzFile file = gzopen((folder + "pc_1_crop.raw.gz").c_str(), "rb");
  ASSERT_TRUE(file);
  const int bytesRead = gzread(file, labels.data(), static_cast<unsigned>(labels.size()));
  gzclose(file);
  ASSERT_EQ(static_cast<std::size_t>(bytesRead), labels.size());
  const auto tissue = [&](double x, double y, double z)
  {
    // The folder's README: gantry from volume coordinates; label 0 is air, 50 the paddles.
    const long i = std::lround(y / 0.2);
    const long j = std::lround((x + 7.4466 + 46.4534) / 0.2);
    const long k = std::lround((z - 1.0) / 0.2);
    if (i < 0 || i >= Size[0] || j < 0 || j >= Size[1] || k < 0 || k >= Size[2])
    {
      return false;
    }
    const unsigned char label = labels[(k * std::size_t{ 539 } + j) * 331 + i];
    return label != 0 && label != 50;
  };
  for (const char* name : { "processing", "presentation" })
  {
    const RegistrationTarget target =
      PrepareTarget(ReadMammogram(folder + "mammogram/victre1_lcc_" + name + ".dcm"));
    EXPECT_THAT(target.Warnings, IsEmpty());
    double both = 0;
    double sum = 0;
    for (int row = 0; row < target.Grid.Rows; row += 2)
    {
      for (int column = 0; column < target.Grid.Columns; column += 2)
      {
        const std::vector<double> pixel = At(target, column, row);
        bool met = false;
        for (double z = 1.0; z < 52.6 && !met; z += 0.2)
        {
          const double scale = (650 - z) / 650; // the source is at (0, 0, 650)
          met = tissue(scale * pixel[0], scale * pixel[1], z);
        }
        const bool found =
          target.BreastMask[static_cast<std::size_t>(row) * target.Grid.Columns + column] != 0;
        both += met && found;
        sum += met + found;
      }
    }
    // An outline good to half a pixel over 250 mm gives 0.998.
    EXPECT_GT(2 * both / sum, 0.997) << name;
  }
}

TEST(TargetPreparation, BothKindsOfOneMammogramAgree)
{
  const std::string folder = Shared + "/digibreast/dicom/";
  SKIP_WITHOUT(folder);
  const RegistrationTarget shown =
    PrepareTarget(ReadMammogram(folder + "mg_presentation_mono2_explicitLE.dcm"));
  const RegistrationTarget raw =
    PrepareTarget(ReadMammogram(folder + "mg_processing_mono1_explicitLE.dcm"));
  EXPECT_EQ(shown.BreastMask, raw.BreastMask);
  EXPECT_EQ(shown.LogAttenuation, raw.LogAttenuation); // inverted, logarithmic by its header
  EXPECT_THAT(raw.Warnings, Contains(HasSubstr("logarithmic")));
}

TEST(TargetPreparation, ThinPartsAreNoBreast)
{
  Mammogram bars = Lens();
  for (std::size_t pixel = 0; pixel < bars.Pixels.size(); ++pixel)
  {
    // Bars of 1 mm, half of TargetOptions::ThinnestFeatureMm.
    const std::size_t place = pixel % Columns % 100;
    bars.Pixels[pixel] = place >= 50 && place < 55 ? 1000.0F : 10000.0F;
  }
  EXPECT_THAT(test::RefusalOf([&] { PrepareTarget(bars); }),
    HasSubstr("nothing brighter than the air"));
}
