// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Segmentation/BreastSegmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <random>

using namespace mammoray;

namespace
{
constexpr int Tissues = 5;

int Label(TissueLabel label)
{
  return static_cast<int>(label);
}

/// The shipped phantom with the labels of the segmentation.
const LabelVolume& Phantom()
{
  static const LabelVolume tissues = []
  {
    LabelVolume volume = ReadLabelVolume(test::DataFolder() + "/victre-phantom-1/labels.nrrd");
    const std::map<int, TissueLabel> tissueOf = { { 0, TissueLabel::Air }, { 1, TissueLabel::Fat },
      { 2, TissueLabel::Skin }, { 33, TissueLabel::Skin }, { 40, TissueLabel::ChestWall } };
    for (std::uint16_t& voxel : volume.Voxels)
    {
      const auto found = tissueOf.find(voxel);
      voxel =
        static_cast<std::uint16_t>(found == tissueOf.end() ? TissueLabel::Gland : found->second);
    }
    return volume;
  }();
  return tissues;
}

/// A voxel of the MRI is a block of 2 x 2 x 4 of the phantom's: 0.8 x 0.8 x 1.6 mm.
constexpr std::array<int, 3> Block{ 2, 2, 4 };

struct Scan
{
  /// Largest over smallest sensitivity of the coil, about.
  double Bias = 2.5;
  /// Standard deviation of both channels, fat being 1000 at a sensitivity of 1.
  double Noise = 20;
  bool FatSuppressed = false;
};

/**
 * What an MRI of the labels looks like: intensities of T1, without fat suppression or with,
 * averaged over the blocks (partial volume), a coil whose sensitivity falls from the front to the
 * chest, and the noise of a magnitude image (Rician).
 */
IntensityVolume MakeMri(const LabelVolume& tissues, const Scan& scan)
{
  const double intensityOf[Tissues] = { 0, scan.FatSuppressed ? 150.0 : 1000.0, 420, 350, 380 };
  IntensityVolume image;
  static_cast<VolumeGrid&>(image) = tissues;
  for (int a = 0; a < 3; ++a)
  {
    image.Size[a] = tissues.Size[a] / Block[a];
    image.Spacing[a] = tissues.Spacing[a] * Block[a];
  }
  image.Origin = tissues.PointAt(0.5 * (Block[0] - 1), 0.5 * (Block[1] - 1), 0.5 * (Block[2] - 1));
  std::mt19937 generator(7);
  std::normal_distribution<double> noise(0, scan.Noise);
  for (int k = 0; k < image.Size[2]; ++k)
  {
    for (int j = 0; j < image.Size[1]; ++j)
    {
      for (int i = 0; i < image.Size[0]; ++i)
      {
        double sum = 0;
        for (int n = 0; n < Block[0] * Block[1] * Block[2]; ++n)
        {
          const int label = tissues.Voxels[tissues.Index(Block[0] * i + n % Block[0],
            Block[1] * j + n / Block[0] % Block[1], Block[2] * k + n / Block[0] / Block[1])];
          sum += intensityOf[label];
        }
        // +x is the front.
        const double depth = static_cast<double>(i) / image.Size[0];
        const double across = static_cast<double>(j) / image.Size[1] - 0.5;
        const double sensitivity =
          std::pow(scan.Bias, depth - 1 + 0.5 * across * across) * (1 + 0.1 * std::sin(3 * across));
        const double signal = sensitivity * sum / (Block[0] * Block[1] * Block[2]);
        image.Voxels.push_back(
          static_cast<float>(std::hypot(signal + noise(generator), noise(generator))));
      }
    }
  }
  return image;
}

SegmentationOptions PhantomOptions()
{
  SegmentationOptions options;
  options.Axes = AnatomicalAxes::FromCode("ALS");
  options.SpacingMm = 0.8;
  // The phantom's own: two voxels of 0.4 mm along the axes, up to 1.4 mm across its stairs.
  options.SkinThicknessMm = 1.1;
  return options;
}

/// Twice the common voxels over the sum of both, by label; truth at the centres of the result's.
std::array<double, Tissues> DiceOf(const LabelVolume& found, const LabelVolume& truth)
{
  std::array<double, Tissues> both{};
  std::array<double, Tissues> sum{};
  std::size_t voxel = 0;
  for (int k = 0; k < found.Size[2]; ++k)
  {
    for (int j = 0; j < found.Size[1]; ++j)
    {
      for (int i = 0; i < found.Size[0]; ++i, ++voxel)
      {
        const int a = found.Voxels[voxel];
        const int b = truth.LabelAt(found.PointAt(i, j, k));
        both[static_cast<std::size_t>(a)] += a == b ? 2 : 0;
        sum[static_cast<std::size_t>(a)] += 1;
        sum[static_cast<std::size_t>(b)] += 1;
      }
    }
  }
  std::array<double, Tissues> dice{};
  for (std::size_t label = 0; label < Tissues; ++label)
  {
    dice[label] = both[label] / sum[label];
  }
  return dice;
}

/// Whole breast (fat, gland, skin) against everything labelled in a slice of the truth.
double BreastDice(const LabelVolume& found, const LabelVolume& truth, int slice)
{
  std::size_t both = 0;
  std::size_t sum = 0;
  for (int j = 0; j < truth.Size[1]; ++j)
  {
    for (int i = 0; i < truth.Size[0]; ++i)
    {
      const int label = found.LabelAt(truth.PointAt(i, j, slice));
      const bool isTrue = truth.Voxels[truth.Index(i, j, slice)] != 0;
      const bool isFound =
        label != Label(TissueLabel::Air) && label != Label(TissueLabel::ChestWall);
      both += isTrue && isFound ? 2 : 0;
      sum += (isTrue ? 1 : 0) + (isFound ? 1 : 0);
    }
  }
  return static_cast<double>(both) / static_cast<double>(sum);
}

struct GlandAgreement
{
  double Dice = 0;
  /// The part of what was found that lies within 3 mm (4 pixels) of the truth.
  double NearTruth = 0;
};

GlandAgreement CompareGland(const LabelVolume& found, const LabelVolume& truth, int slice,
  int trueLabel)
{
  const auto isTrue = [&](int i, int j)
  {
    return i >= 0 && j >= 0 && i < truth.Size[0] && j < truth.Size[1] &&
      truth.Voxels[truth.Index(i, j, slice)] == trueLabel;
  };
  std::size_t both = 0;
  std::size_t manual = 0;
  std::size_t gland = 0;
  std::size_t near = 0;
  for (int j = 0; j < truth.Size[1]; ++j)
  {
    for (int i = 0; i < truth.Size[0]; ++i)
    {
      const bool isGland = found.LabelAt(truth.PointAt(i, j, slice)) == Label(TissueLabel::Gland);
      bool close = false;
      for (int n = 0; isGland && n < 81; ++n)
      {
        close = close || isTrue(i + n % 9 - 4, j + n / 9 - 4);
      }
      both += isGland && isTrue(i, j) ? 1 : 0;
      manual += isTrue(i, j) ? 1 : 0;
      gland += isGland ? 1 : 0;
      near += close ? 1 : 0;
    }
  }
  return { 2.0 * static_cast<double>(both) / static_cast<double>(manual + gland),
    static_cast<double>(near) / static_cast<double>(gland) };
}

/// The message of the refusal, one line.
std::string MessageOf(const IntensityVolume& image, const SegmentationOptions& options = {})
{
  try
  {
    SegmentBreast(image, options);
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    return error.what();
  }
  return "no InputError";
}

IntensityVolume Constant(std::array<int, 3> size, float value)
{
  IntensityVolume image;
  image.Size = size;
  image.Voxels.assign(static_cast<std::size_t>(size[0]) * size[1] * size[2], value);
  return image;
}
}

TEST(BreastSegmentation, FindsTheTissuesOfAPhantom)
{
  const SegmentationResult result = SegmentBreast(MakeMri(Phantom(), {}), PhantomOptions());
  const std::array<double, Tissues> dice = DiceOf(result.Labels, Phantom());
  EXPECT_EQ(result.Breasts, 1);
  // Measured: 0.992, 0.915, 0.882, 0.676, 0.933. Half a voxel of error all over the surface costs
  // the two voxels of skin a quarter, and gland of strands a few voxels wide a tenth.
  EXPECT_GT(dice[Label(TissueLabel::Air)], 0.985);
  EXPECT_GT(dice[Label(TissueLabel::Fat)], 0.89);
  EXPECT_GT(dice[Label(TissueLabel::Gland)], 0.85);
  EXPECT_GT(dice[Label(TissueLabel::Skin)], 0.63);
  EXPECT_GT(dice[Label(TissueLabel::ChestWall)], 0.91);
}

TEST(BreastSegmentation, FindsTheTissuesWhereFatIsSuppressed)
{
  const IntensityVolume image = MakeMri(Phantom(), { .FatSuppressed = true });
  const SegmentationResult result = SegmentBreast(image, PhantomOptions());
  EXPECT_EQ(result.Contrast, FatContrast::FatDark);
  const std::array<double, Tissues> dice = DiceOf(result.Labels, Phantom());
  // Measured: 0.987, 0.893, 0.902, 0.638, 0.938; limits as above, fat's noise being 13 % of it.
  EXPECT_GT(dice[Label(TissueLabel::Air)], 0.98);
  EXPECT_GT(dice[Label(TissueLabel::Fat)], 0.87);
  EXPECT_GT(dice[Label(TissueLabel::Gland)], 0.87);
  EXPECT_GT(dice[Label(TissueLabel::Skin)], 0.60);
  EXPECT_GT(dice[Label(TissueLabel::ChestWall)], 0.91);
  const SegmentationResult both = SegmentBreast(MakeMri(Phantom(), {}), image, PhantomOptions());
  EXPECT_EQ(both.Contrast, FatContrast::FatBright);
  const std::array<double, Tissues> diceOfBoth = DiceOf(both.Labels, Phantom());
  // Measured: 0.913: better than either alone. The wall's Dice, 0.937, is limited by what lies
  // behind it, which is wall here and air in the phantom.
  EXPECT_GT(diceOfBoth[Label(TissueLabel::Gland)], dice[Label(TissueLabel::Gland)]);
  EXPECT_GT(diceOfBoth[Label(TissueLabel::ChestWall)], 0.93);
}

TEST(BreastSegmentation, AnEvenImageNeedsNoCorrection)
{
  SegmentationOptions options = PhantomOptions();
  options.CorrectBias = false;
  const SegmentationResult result =
    SegmentBreast(MakeMri(Phantom(), { .Bias = 1, .Noise = 5 }), options);
  const std::array<double, Tissues> dice = DiceOf(result.Labels, Phantom());
  // Measured: 0.916, 0.896, 0.921; limits as above.
  EXPECT_GT(dice[Label(TissueLabel::Fat)], 0.89);
  EXPECT_GT(dice[Label(TissueLabel::Gland)], 0.87);
  EXPECT_GT(dice[Label(TissueLabel::ChestWall)], 0.90);
  // Between the scan's muscle, 0.38, and the gland that lies against it, 0.42, over fat's level:
  // up to 8 % below that of fat alone, as there is hardly a cube of 2 mm without a ligament.
  EXPECT_NEAR(result.MuscleLevel, 0.41, 0.035);
}

TEST(BreastSegmentation, ThePlaceOfTheAxesDoesNotMatter)
{
  // The same scan, its axes in another order and direction in a turned frame.
  const IntensityVolume image = MakeMri(Phantom(), {});
  IntensityVolume turned;
  turned.Size = { image.Size[2], image.Size[0], image.Size[1] };
  turned.Spacing = { image.Spacing[2], image.Spacing[0], image.Spacing[1] };
  turned.Direction = { { { 0, 0, -1 }, { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 } } };
  turned.Origin = { 1, 2, 3 };
  turned.Voxels.resize(image.Voxels.size());
  for (int k = 0; k < image.Size[2]; ++k)
  {
    for (int j = 0; j < image.Size[1]; ++j)
    {
      for (int i = 0; i < image.Size[0]; ++i)
      {
        turned.Voxels[turned.Index(image.Size[2] - 1 - k, i, j)] =
          image.Voxels[image.Index(i, j, k)];
      }
    }
  }
  SegmentationOptions options = PhantomOptions();
  options.SpacingMm = 0;
  options.SkinThicknessMm = 1.6; // a voxel
  const LabelVolume straight = SegmentBreast(image, options).Labels;
  // (i, j, k) = (superior reversed, anterior, left) of the first.
  options.Axes.Anterior = { 0.8, 0.6, 0 };
  options.Axes.Left = { -0.6, 0.8, 0 };
  options.Axes.Superior = { 0, 0, 1 };
  const LabelVolume found = SegmentBreast(turned, options).Labels;
  EXPECT_EQ(found.Size, turned.Size);
  EXPECT_EQ(found.Direction, turned.Direction);
  for (int a = 0; a < 3; ++a)
  {
    EXPECT_NEAR(found.Origin[a], turned.Origin[a], 1e-9);
  }
  std::size_t different = 0;
  for (int k = 0; k < image.Size[2]; ++k)
  {
    for (int j = 0; j < image.Size[1]; ++j)
    {
      for (int i = 0; i < image.Size[0]; ++i)
      {
        different += straight.Voxels[straight.Index(i, j, k)] !=
          found.Voxels[found.Index(image.Size[2] - 1 - k, i, j)];
      }
    }
  }
  EXPECT_EQ(different, 0u);
}

TEST(BreastSegmentation, OneSideOfTwoBreasts)
{
  // The phantom beside its mirror image: +y is the left.
  const LabelVolume& one = Phantom();
  LabelVolume two = one;
  two.Size[1] = 2 * one.Size[1];
  two.Voxels.assign(2 * one.Voxels.size(), 0);
  for (int k = 0; k < one.Size[2]; ++k)
  {
    for (int j = 0; j < one.Size[1]; ++j)
    {
      for (int i = 0; i < one.Size[0]; ++i)
      {
        const std::uint16_t label = one.Voxels[one.Index(i, j, k)];
        two.Voxels[two.Index(i, j, k)] = label;
        two.Voxels[two.Index(i, two.Size[1] - 1 - j, k)] = label;
      }
    }
  }
  const IntensityVolume image = MakeMri(two, {});
  SegmentationOptions options = PhantomOptions();
  options.SpacingMm = 1.6;
  options.SkinThicknessMm = 1.6;
  const SegmentationResult both = SegmentBreast(image, options);
  EXPECT_EQ(both.Breasts, 2);
  options.Side = BreastSide::Left;
  const LabelVolume left = SegmentBreast(image, options).Labels;
  options.Side = BreastSide::Right;
  const LabelVolume right = SegmentBreast(image, options).Labels;
  const double middle = two.PointAt(0, 0.5 * (two.Size[1] - 1), 0)[1];
  std::size_t voxel = 0;
  for (int k = 0; k < left.Size[2]; ++k)
  {
    for (int j = 0; j < left.Size[1]; ++j)
    {
      // A voxel, which the mirrored noise may move the valley by.
      const double aside = left.PointAt(0, j, k)[1] - middle;
      for (int i = 0; i < left.Size[0]; ++i, ++voxel)
      {
        ASSERT_TRUE(left.Voxels[voxel] == 0 || aside > -1.6);
        ASSERT_TRUE(right.Voxels[voxel] == 0 || aside < 1.6);
        ASSERT_TRUE(left.Voxels[voxel] == 0 || right.Voxels[voxel] == 0);
      }
    }
  }
  EXPECT_GT(left.CountLabels()[Label(TissueLabel::Gland)], 1000u);
  EXPECT_GT(right.CountLabels()[Label(TissueLabel::Gland)], 1000u);
  options.Side = BreastSide::Left;
  EXPECT_THAT(MessageOf(MakeMri(one, {}), options), testing::HasSubstr("expected two breasts"));
}

TEST(BreastSegmentation, ThresholdsAndThicknessesAreTheOptions)
{
  const IntensityVolume image = MakeMri(Phantom(), {});
  SegmentationOptions options = PhantomOptions();
  options.SpacingMm = 1.6;
  options.SkinThicknessMm = 0;
  options.ChestWallDepthMm = 5;
  options.GlandThreshold = 0.1;
  options.AirThreshold = 60;
  const SegmentationResult bare = SegmentBreast(image, options);
  std::map<int, std::size_t> counts = bare.Labels.CountLabels();
  EXPECT_EQ(bare.GlandThreshold, 0.1);
  EXPECT_EQ(bare.AirThreshold, 60);
  EXPECT_EQ(counts.count(Label(TissueLabel::Skin)), 0u);
  // Nothing of the breast is as dark as a tenth of fat: gland is 0.42.
  EXPECT_EQ(counts.count(Label(TissueLabel::Gland)), 0u);
  const std::size_t thinWall = counts[Label(TissueLabel::ChestWall)];
  options.ChestWallDepthMm = 30; // more than the phantom has
  options.GlandThreshold = 0.95;
  counts = SegmentBreast(image, options).Labels.CountLabels();
  EXPECT_GT(counts[Label(TissueLabel::ChestWall)], thinWall);
  const std::size_t most = counts[Label(TissueLabel::Gland)];
  options.GlandThreshold = 0;
  const SegmentationResult otsu = SegmentBreast(image, options);
  EXPECT_GT(most, otsu.Labels.CountLabels()[Label(TissueLabel::Gland)]);
  // Otsu's threshold lies between gland, 0.42, and fat, 1.
  EXPECT_NEAR(otsu.GlandThreshold, 0.71, 0.1);
  // More classes: what lies between gland and fat counts as gland.
  options.Classes = 3;
  EXPECT_GT(SegmentBreast(image, options).GlandThreshold, otsu.GlandThreshold);
}

TEST(BreastSegmentation, AGivenGlandThresholdIsThatOfItsOwnImage)
{
  const IntensityVolume plain = MakeMri(Phantom(), {});
  const IntensityVolume suppressed = MakeMri(Phantom(), { .FatSuppressed = true });
  SegmentationOptions options = PhantomOptions();
  options.SpacingMm = 1.6;
  options.SkinThicknessMm = 1.6;
  const auto glandOf = [&](const SegmentationResult& result)
  { return result.Labels.CountLabels().at(Label(TissueLabel::Gland)); };
  // What Otsu finds, given back: of the plain image, and of the suppressed one beside it.
  const SegmentationResult found = SegmentBreast(plain, suppressed, options);
  options.GlandThreshold = found.GlandThreshold;
  const SegmentationResult given = SegmentBreast(plain, suppressed, options);
  EXPECT_EQ(given.GlandThreshold, found.GlandThreshold);
  EXPECT_EQ(glandOf(given), glandOf(found));
  // Suppressed fat is dark, and gland above it: a fraction below 1 says nothing of it.
  EXPECT_THAT(MessageOf(suppressed, options), test::Mentions("gland threshold", "more than 1"));
  options.Contrast = FatContrast::FatDark;
  options.GlandThreshold = 1.6;
  EXPECT_EQ(SegmentBreast(suppressed, options).GlandThreshold, 1.6);
  // Of two images, that beyond 1 is the suppressed one's.
  const SegmentationResult second = SegmentBreast(plain, suppressed, options);
  EXPECT_EQ(second.GlandThreshold, found.GlandThreshold);
  EXPECT_GT(glandOf(second), glandOf(found) / 2);
}

TEST(BreastSegmentation, RefusesInOneLine)
{
  EXPECT_THAT(MessageOf({}), test::Mentions("MRI", "axis 0", "0"));
  EXPECT_THAT(MessageOf(Constant({ 20, 20, 20 }, 7)), test::Mentions("intensity 7"));
  EXPECT_THAT(MessageOf(Constant({ 20, 20, 1 }, 7)), testing::HasSubstr("found 20 x 20 x 1"));
  IntensityVolume holed = Constant({ 20, 20, 20 }, 7);
  holed.Voxels[20 * 20 + 3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(MessageOf(holed), test::Mentions("(3, 0, 1)", "nan"));
  // Noise; a chest without a breast: 20 mm of muscle under 5 mm of fat (+y is the back); fat alone.
  IntensityVolume noise = Constant({ 40, 40, 40 }, 0);
  std::mt19937 generator(3);
  std::normal_distribution<float> normal(0, 10);
  for (float& value : noise.Voxels)
  {
    value = std::abs(normal(generator));
  }
  EXPECT_THAT(MessageOf(noise), testing::HasSubstr("times as bright as the air"));
  IntensityVolume flat = Constant({ 60, 60, 60 }, 2);
  IntensityVolume fat = flat;
  for (std::size_t voxel = 0; voxel < flat.Voxels.size(); ++voxel)
  {
    const std::size_t y = voxel / 60 % 60;
    flat.Voxels[voxel] = y >= 40 ? 400.0f : y >= 35 ? 1000.0f : 2.0f;
    fat.Voxels[voxel] = y >= 20 ? 1000.0f : 2.0f;
  }
  EXPECT_THAT(MessageOf(flat), testing::HasSubstr("expected a breast"));
  EXPECT_THAT(MessageOf(fat), testing::StartsWith("MRI: expected "));

  SegmentationOptions options;
  options.Classes = 6;
  EXPECT_THAT(MessageOf(flat, options), test::Mentions("classes", "2 to 5", "6"));
  options = {};
  options.GlandThreshold = 1.5;
  EXPECT_THAT(MessageOf(flat, options), testing::HasSubstr("gland threshold: expected"));
  options = {};
  options.SkinThicknessMm = -1;
  EXPECT_THAT(MessageOf(flat, options), testing::HasSubstr("skin thickness: expected"));
}

TEST(BreastSegmentation, CanBeInterruptedInEveryStage)
{
  const IntensityVolume image = MakeMri(Phantom(), {});
  SegmentationOptions options = PhantomOptions();
  options.SpacingMm = 3.2;
  options.SkinThicknessMm = 3.2;
  int calls = 0;
  double last = 0;
  SegmentBreast(image, options,
    [&](double fraction, const char*)
    {
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      last = fraction;
      ++calls;
      return true;
    });
  EXPECT_GT(calls, 10);
  for (int stop = 1; stop < calls; stop += 1 + calls / 4)
  {
    int count = 0;
    EXPECT_THROW(SegmentBreast(image, options, [&](double, const char*) { return ++count < stop; }),
      Interrupted);
    EXPECT_EQ(count, stop);
  }
}

TEST(BreastSegmentation, RealMriAgreesWithManualLabels)
{
  const std::filesystem::path folder =
    std::filesystem::path(test::SharedDataFolder()) / "duke-breast-mri-153-CC-BY-NC-4.0";
  if (!std::filesystem::exists(folder / "t1_tse"))
  {
    GTEST_SKIP() << "absent: " << folder;
  }
  SegmentationOptions options;
  options.SpacingMm = 1.5;
  const SegmentationResult result =
    SegmentBreast(ReadIntensityVolume((folder / "t1_tse").string()), options);
  EXPECT_EQ(result.Breasts, 2);
  const LabelVolume truth = ReadLabelVolume((folder / "seg_fgt_fat.dcm").string());
  // Segments 2 and 5 (gland, fat) lie in one slice: the whole breast there. Measured: 0.95; what is
  // missed lies behind the cut, as the manual labels reach some 10 mm farther back.
  const int breastSlice =
    static_cast<int>(std::lround(truth.ContinuousIndex({ 0, 0, -54.9057 })[2]));
  EXPECT_GT(BreastDice(result.Labels, truth, breastSlice), 0.93);
  // Segment 1, gland at z = -43.9. It was drawn on another series, of thinner slices and without
  // fat; in this one its median is 0.95 of the fat around it, so that no threshold finds all of it.
  // Measured: 0.9 of what is called gland lies within 3 mm of it, and the Dice is 0.25. With the
  // truth in hand the best threshold of the intensity over its surroundings' median gives 0.35
  // here and 0.18 at z = -54.9 (area under the ROC curve 0.57 and 0.61; 0.95 and 0.88 in the
  // series it was drawn on): in this fatty breast the strands are thinner than these slices.
  const int glandSlice =
    static_cast<int>(std::lround(truth.ContinuousIndex({ 0, 0, -43.9057 })[2]));
  const GlandAgreement gland = CompareGland(result.Labels, truth, glandSlice, 1);
  RecordProperty("gland_dice", std::to_string(gland.Dice));
  EXPECT_GT(gland.NearTruth, 0.8);
  EXPECT_GT(gland.Dice, 0.2);
}

TEST(BreastSegmentation, PlainAndSuppressedImagesOfASessionAgree)
{
  const std::filesystem::path folder =
    std::filesystem::path(test::SharedDataFolder()) / "uta11-breast-mri-CC-BY-SA-4.0" / "a";
  if (!std::filesystem::exists(folder / "t1-tse"))
  {
    GTEST_SKIP() << "absent: " << folder;
  }
  const bool fine = std::getenv("MAMMORAY_LONG_TESTS") != nullptr;
  SegmentationOptions options;
  options.SpacingMm = fine ? 1 : 1.5;
  const LabelVolume plain =
    SegmentBreast(ReadIntensityVolume((folder / "t1-tse").string()), options).Labels;
  const LabelVolume suppressed =
    SegmentBreast(ReadIntensityVolume((folder / "t1-fat-suppressed").string()), options).Labels;
  std::array<double, 2> both{};
  std::array<double, 2> sum{};
  for (int k = 0; k < plain.Size[2]; ++k)
  {
    for (int j = 0; j < plain.Size[1]; ++j)
    {
      for (int i = 0; i < plain.Size[0]; ++i)
      {
        const int labels[] = { plain.Voxels[plain.Index(i, j, k)],
          suppressed.LabelAt(plain.PointAt(i, j, k)) };
        for (std::size_t what = 0; what < 2; ++what)
        {
          int count = 0;
          for (const int label : labels)
          {
            const bool breast =
              label != Label(TissueLabel::Air) && label != Label(TissueLabel::ChestWall);
            count += (what == 0 ? breast : label == Label(TissueLabel::Gland)) ? 1 : 0;
          }
          both[what] += count == 2 ? 2 : 0;
          sum[what] += count;
        }
      }
    }
  }
  const double outline = both[0] / sum[0];
  const double gland = both[1] / sum[1];
  std::printf("plain against fat-suppressed T1: Dice of the breast %.3f, of gland %.3f\n", outline,
    gland);
  // 0.95 and 0.7 are aimed at; measured: 0.943 and 0.487 with voxels of 1 mm, 0.921 and 0.410 with
  // those of 1.5. The plain image does not show the skin (its edge lies 1.2 mm within the other's
  // all over the breasts: 94 of 1550 cm3, which cost 0.03), and no pair of thresholds at equal
  // volume makes gland of a few voxels' width agree better than 0.52.
  EXPECT_GT(outline, fine ? 0.935 : 0.91);
  EXPECT_GT(gland, fine ? 0.46 : 0.38);
}
