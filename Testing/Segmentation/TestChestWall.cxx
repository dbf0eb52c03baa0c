// SPDX-License-Identifier: Apache-2.0
#include "MadeUpImages.h"
#include "mammoray/Segmentation/Private/ChestWall.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace
{
using namespace mammoray;
using test::MadeUpHeights;
using test::MadeUpImage;

/// Cubes of 2 mm; 120 x 140 x 100 mm.
constexpr std::array<int, 3> ChestSize{ 60, 70, 50 };

using Heights = std::function<double(int, int)>;

/// A body by formula: its skin and the front of its muscle, mm over the columns.
struct MadeUpChest
{
  Heights Skin;
  Heights Wall;

  double HeightOf(int y) const { return 2 * (y + 0.5); }
  bool InBody(int x, int y, int z) const { return this->HeightOf(y) < this->Skin(x, z); }
  bool InMuscle(int x, int y, int z) const { return this->HeightOf(y) < this->Wall(x, z); }
  MaskImage::Pointer Body() const
  {
    return MadeUpImage<MaskImage>(ChestSize, { 2, 2, 2 },
      [&](int x, int y, int z) { return this->InBody(x, y, z) ? 1 : 0; });
  }
  /// Fat's intensity before the wall, muscle's behind it, and noise.
  FloatImage::Pointer Image(double fat, double muscle, double deviation = 0) const
  {
    std::mt19937 generator(17);
    std::normal_distribution<double> noise(0, 1);
    return MadeUpImage<FloatImage>(ChestSize, { 2, 2, 2 },
      [&](int x, int y, int z)
      {
        const double signal = !this->InBody(x, y, z) ? 0 : this->InMuscle(x, y, z) ? muscle : fat;
        return std::abs(signal + deviation * noise(generator));
      });
  }
};

/// A breast of 60 mm on a chest wall that is bent like a thorax and tilted.
MadeUpChest BreastOnThorax()
{
  const auto wall = [](int x, int z) { return 60 - 0.006 * (x - 25) * (x - 25) + 0.2 * (z - 25); };
  return { [wall](int x, int z)
    {
      const double r = std::hypot(x - 30, z - 25) / 24;
      return wall(x, z) + 12 + 50 * std::exp(-r * r);
    },
    wall };
}

/// Median and largest difference of a sheet and a formula, over columns within the rim.
std::array<double, 2> SheetError(const HeightMap* sheet, const Heights& expected)
{
  std::vector<double> away;
  for (int z = 4; z < ChestSize[2] - 4; ++z)
  {
    for (int x = 4; x < ChestSize[0] - 4; ++x)
    {
      away.push_back(std::abs(sheet->GetPixel({ { x, z } }) - expected(x, z)));
    }
  }
  std::sort(away.begin(), away.end());
  return { away[away.size() / 2], away.back() };
}

TEST(FrontOf, IsTheFrontFaceOfTheForemostVoxel)
{
  const MaskImage::Pointer mask = MadeUpImage<MaskImage>({ 3, 4, 2 }, { 1, 2.5, 4 },
    [](int x, int y, int z) {
      return x == 0 ? y == 3 : x == 1 ? y == 0 || (y == 2 && z == 1) : 0;
    });
  const HeightMap::Pointer front = FrontOf(mask);
  EXPECT_EQ(front->GetSpacing()[0], 1);
  EXPECT_EQ(front->GetSpacing()[1], 4);
  EXPECT_EQ(front->GetPixel({ { 0, 0 } }), 10);
  EXPECT_EQ(front->GetPixel({ { 1, 0 } }), 2.5);
  EXPECT_EQ(front->GetPixel({ { 1, 1 } }), 7.5);
  EXPECT_EQ(front->GetPixel({ { 2, 1 } }), -1);
}

TEST(HeightsOver, AreBilinearWithinAndNearestBeyond)
{
  const HeightMap::Pointer map =
    MadeUpHeights(8, 6, 2, [](int x, int z) { return 5 + 3 * x - 2 * z; });
  // Finer, larger and other spacings along x and z: a plane stays one, up to the outer centres.
  const FloatImage::Pointer grid =
    MadeUpImage<FloatImage>({ 25, 3, 12 }, { 0.8, 1, 1.5 }, [](int, int, int) { return 0; });
  const HeightMap::Pointer over = HeightsOver(map, *grid);
  ASSERT_EQ(over->GetLargestPossibleRegion().GetSize()[0], 25u);
  ASSERT_EQ(over->GetLargestPossibleRegion().GetSize()[1], 12u);
  for (int z = 0; z < 12; ++z)
  {
    for (int x = 0; x < 25; ++x)
    {
      const double i = std::clamp(0.8 * (x + 0.5) / 2 - 0.5, 0.0, 7.0);
      const double k = std::clamp(1.5 * (z + 0.5) / 2 - 0.5, 0.0, 5.0);
      EXPECT_NEAR(over->GetPixel({ { x, z } }), 5 + 3 * i - 2 * k, 1e-5) << x << ' ' << z;
    }
  }
  const HeightMap::Pointer one = MadeUpHeights(1, 1, 2, [](int, int) { return 42; });
  EXPECT_EQ(HeightsOver(one, *grid)->GetPixel({ { 24, 11 } }), 42);
}

TEST(BehindSheet, HoldsTheTissueOfALayerUnderTheBreast)
{
  // The image is its own height; the sheet lies at 20 mm, the skin at 60 mm, but for one column.
  const FloatImage::Pointer image =
    MadeUpImage<FloatImage>({ 2, 40, 1 }, { 2, 2, 2 }, [](int, int y, int) { return 2 * y + 1; });
  const MaskImage::Pointer tissue = MadeUpImage<MaskImage>({ 2, 40, 1 }, { 2, 2, 2 },
    [](int, int y, int) { return y != 6 ? 1 : 0; });
  const HeightMap::Pointer skin =
    MadeUpHeights(2, 1, 2, [](int x, int) { return x == 0 ? 60 : 50; });
  ChestWallSheet sheet;
  sheet.Front = MadeUpHeights(2, 1, 2, [](int, int) { return 20; });
  sheet.Steps = MadeUpHeights(2, 1, 2, [](int x, int) { return x == 0 ? 0.6 : 0.35; });
  sheet.LargeStep = 0.6;
  // 3 to 9 mm behind: the centres at 17, 15, 13, 11; that of 13 mm is no tissue.
  EXPECT_THAT(BehindSheet(image, tissue, skin, sheet, { 3, 9, 35 }), testing::ElementsAre(15, 17));
  EXPECT_THAT(BehindSheet(image, tissue, skin, sheet, { 3, 9.5, 35 }),
    testing::ElementsAre(11, 15, 17));
  EXPECT_THAT(BehindSheet(image, tissue, skin, sheet, { 3, 9, 40 }), testing::IsEmpty());
  EXPECT_EQ(BehindSheet(image, tissue, skin, sheet, { 3, 9, 10 }).size(), 4u);
  // Less than half the large step is no muscle.
  sheet.LargeStep = 0.8;
  EXPECT_EQ(BehindSheet(image, tissue, skin, sheet, { 3, 9, 10 }).size(), 2u);
}

TEST(BeforeSheet, IsWhatLiesApartFromWallAndSkinAndBeforeTheCut)
{
  // Body up to 60 mm, in one column to 40; the sheet lies at 20 mm.
  const MaskImage::Pointer body = MadeUpImage<MaskImage>({ 20, 40, 1 }, { 2, 2, 2 },
    [](int x, int y, int) { return y < (x == 0 ? 20 : 30) ? 1 : 0; });
  ChestWallSheet sheet;
  sheet.Front = MadeUpHeights(20, 1, 2, [](int, int) { return 20; });
  const auto heights = [&](int x, double cutMm)
  {
    const MaskImage::Pointer before = BeforeSheet(body, sheet, 4, cutMm);
    std::vector<int> found;
    for (int y = 0; y < 40; ++y)
    {
      if (before->GetPixel({ { x, y, 0 } }) != 0)
      {
        found.push_back(2 * y + 1);
      }
    }
    return found;
  };
  EXPECT_THAT(heights(10, 0),
    testing::AllOf(testing::SizeIs(16), testing::Contains(25), testing::Contains(55)));
  EXPECT_THAT(heights(0, 0), testing::ElementsAre(25, 27, 29, 31, 33, 35));
  EXPECT_THAT(heights(0, 30), testing::ElementsAre(31, 33, 35));
  EXPECT_THAT(heights(0, 40), testing::IsEmpty());
}

TEST(LogChannel, FallsFromFatToMuscleAndIgnoresTheCoil)
{
  const MadeUpChest chest{ [](int, int) { return 100; }, [](int, int) { return 50; } };
  const MaskImage::Pointer body = chest.Body();
  const FloatImage::Pointer image = chest.Image(1000, 350);
  const FloatImage::Pointer bright = LogChannel(image, body, 1e-3, true);
  const FloatImage::Pointer dark = LogChannel(chest.Image(100, 250), body, 1e-3, false);
  // Between 6 mm in front of and behind the step: what the mean over 30 mm takes away is the slope
  // of a step blurred so, 12 / (30 sqrt(2 pi)) of it and twice that at the body's end.
  const auto step = [](const FloatImage* log) {
    return log->GetPixel({ { 30, 28, 25 } }) - log->GetPixel({ { 30, 22, 25 } });
  };
  EXPECT_NEAR(step(bright) / std::log(1000.0 / 350), 0.8, 0.1);
  EXPECT_NEAR(step(dark) / std::log(250.0 / 100), 0.8, 0.1);
  // A sensitivity that rises threefold over the body's 100 mm changes a channel that keeps it by
  // 0.13 over 12 mm, and this one by less than half of that.
  const FloatImage::Pointer lit = MakeFrom<FloatImage>(*image,
    [&](std::size_t voxel)
    {
      const double heightMm = 2 * (static_cast<double>(voxel / 60 % 70) + 0.5);
      return image->GetBufferPointer()[voxel] * std::exp(std::log(3.0) * heightMm / 100);
    });
  EXPECT_LT(std::abs(step(LogChannel(lit, body, 1e-3, true)) - step(bright)), 0.06);
  // Twice the sensitivity changes nothing.
  const FloatImage::Pointer twice = LogChannel(chest.Image(2000, 700), body, 1e-3, true);
  EXPECT_NEAR(step(twice), step(bright), 1e-3);
  EXPECT_NEAR(twice->GetPixel({ { 30, 30, 25 } }), bright->GetPixel({ { 30, 30, 25 } }), 1e-3);
}

TEST(ChestWall, IsTheSheetBetweenFatAndMuscle)
{
  const MadeUpChest chest = BreastOnThorax();
  const MaskImage::Pointer body = chest.Body();
  for (const bool fatBright : { true, false })
  {
    const FloatImage::Pointer image =
      fatBright ? chest.Image(1000, 350, 20) : chest.Image(150, 380, 20);
    const ChestWallSheet sheet =
      FindChestWall({ LogChannel(image, body, 20, fatBright) }, body, body);
    const auto [median, largest] = SheetError(sheet.Front, chest.Wall);
    // Steps beyond 0.4 are worth the same: of 1.05 that leaves 3.7 mm on either side, of which the
    // front is taken (RefineChestWall goes on from there).
    EXPECT_LT(median, 2) << fatBright;
    EXPECT_LT(largest, 3.7) << fatBright;
    // The step of the mean of 6 mm each, blurred by 2 mm (a quarter less): log(1000 / 350) = 1.05
    // and log(400 / 170) = 0.86.
    EXPECT_NEAR(sheet.Step, fatBright ? 0.8 : 0.65, 0.15) << fatBright;
    EXPECT_GT(sheet.LargeStep, sheet.Step) << fatBright;
  }
}

TEST(ChestWall, StandsFirmInNoiseAndWithASecondChannel)
{
  const MadeUpChest chest = BreastOnThorax();
  const MaskImage::Pointer body = chest.Body();
  // Suppressed fat hardly darker than muscle, in noise half as loud as the step.
  const FloatImage::Pointer weak = LogChannel(chest.Image(150, 200, 25), body, 20, false);
  const ChestWallSheet alone = FindChestWall({ weak }, body, body);
  EXPECT_LT(SheetError(alone.Front, chest.Wall)[0], 2);
  const ChestWallSheet both =
    FindChestWall({ LogChannel(chest.Image(1000, 350, 20), body, 20, true), weak }, body, body);
  EXPECT_LT(SheetError(both.Front, chest.Wall)[1], 3);
  EXPECT_GT(both.Step, alone.Step);
}

TEST(ChestWall, GlandBeforeItIsNoWall)
{
  // A ball of gland, as dark as muscle, 25 mm before the wall.
  const MadeUpChest chest = BreastOnThorax();
  const MaskImage::Pointer body = chest.Body();
  const FloatImage::Pointer image = chest.Image(1000, 350, 20);
  for (int z = 0; z < ChestSize[2]; ++z)
  {
    for (int y = 0; y < ChestSize[1]; ++y)
    {
      for (int x = 0; x < ChestSize[0]; ++x)
      {
        if (std::hypot(x - 30, y - 45, z - 25) < 7)
        {
          image->SetPixel({ { x, y, z } }, 380);
        }
      }
    }
  }
  const ChestWallSheet sheet = FindChestWall({ LogChannel(image, body, 20, true) }, body, body);
  EXPECT_LT(SheetError(sheet.Front, chest.Wall)[0], 2); // as above
  EXPECT_LT(SheetError(sheet.Front, chest.Wall)[1], 3.7);
}

TEST(ChestWall, MirroredBodiesHaveMirroredSheets)
{
  const MadeUpChest chest = BreastOnThorax();
  const auto mirror = [](const Heights& heights) -> Heights
  { return [heights](int x, int z) { return heights(ChestSize[0] - 1 - x, z); }; };
  const MadeUpChest mirrored{ mirror(chest.Skin), mirror(chest.Wall) };
  const ChestWallSheet sheet = FindChestWall(
    { LogChannel(chest.Image(1000, 350), chest.Body(), 20, true) }, chest.Body(), chest.Body());
  const ChestWallSheet other =
    FindChestWall({ LogChannel(mirrored.Image(1000, 350), mirrored.Body(), 20, true) },
      mirrored.Body(), mirrored.Body());
  const auto [median, largest] = SheetError(other.Front,
    [&](int x, int z) {
      return sheet.Front->GetPixel({ { ChestSize[0] - 1 - x, z } });
    });
  // The stiff plate's cells of 12 mm do not lie alike; where two heights cost the same, another is
  // taken: a voxel at most, smoothed.
  EXPECT_LT(median, 0.1);
  EXPECT_LT(largest, 1);
  EXPECT_NEAR(other.Step, sheet.Step, 0.02);
}

TEST(ChestWall, WithoutABreastThereIsNoStep)
{
  // 20 mm of fat all over: no column with 30 mm of body before the wall.
  const MadeUpChest flat{ [](int, int) { return 80; }, [](int, int) { return 60; } };
  const MaskImage::Pointer body = flat.Body();
  const ChestWallSheet sheet =
    FindChestWall({ LogChannel(flat.Image(1000, 350), body, 20, true) }, body, body);
  EXPECT_LT(SheetError(sheet.Front, flat.Wall)[1], 3.7);
  EXPECT_EQ(sheet.Step, 0);
  EXPECT_EQ(sheet.LargeStep, 0);
  // Without any body: some sheet, of no step.
  const MaskImage::Pointer none =
    MadeUpImage<MaskImage>(ChestSize, { 2, 2, 2 }, [](int, int, int) { return 0; });
  const ChestWallSheet nothing = FindChestWall({ flat.Image(0, 0) }, none, none);
  EXPECT_EQ(nothing.Step, 0);
  EXPECT_EQ(std::isfinite(nothing.Front->GetPixel({ { 30, 25 } })), true);
}

TEST(RefineChestWall, GoesFromANearbySheetToTheFront)
{
  const MadeUpChest chest = BreastOnThorax();
  const MaskImage::Pointer body = chest.Body();
  // 1 in fat, 0 in muscle; the sheet known about lies 8 mm too far in front.
  const FloatImage::Pointer fatness = chest.Image(1, 0);
  const HeightMap::Pointer near = MadeUpHeights(ChestSize[0], ChestSize[2], 2,
    [&](int x, int z) { return chest.Wall(x, z) + 8; });
  const ChestWallSheet sheet = RefineChestWall({ fatness }, body, body, near);
  const auto [median, largest] = SheetError(sheet.Front, chest.Wall);
  // Heights are whole voxels of 2 mm, smoothed over 20 mm.
  EXPECT_LT(median, 0.7);
  EXPECT_LT(largest, 3);
  EXPECT_NEAR(sheet.Step, 1, 0.2);
}

/// How far a sheet lies before (positive) the wall of a thorax that falls back to its sides, mm:
/// the largest of the medians over rows of columns 2 mm wide, 60 to 100 mm aside of the middle.
double BeforeTheSides(double step, double skinStep)
{
  constexpr std::array<int, 3> size{ 130, 80, 40 };
  constexpr double radius = 130;
  constexpr double fatMm = 14;
  const auto aside = [&](int x) { return 2 * (x + 0.5) - size[0]; };
  // Circles about (0, -20); at 100 mm aside the wall falls by 1.2 mm/mm and the fat is 22 mm thick.
  const auto circle = [&](int x, double r)
  { return std::sqrt(std::max(0.0, r * r - aside(x) * aside(x))) - 20; };
  const auto skin = [&](int x, int z)
  {
    const double breast = std::hypot(std::abs(aside(x)) - 60, 2 * (z - 20)) / 32;
    return circle(x, radius + fatMm) + 30 * std::exp(-std::pow(breast, 4.0));
  };
  const auto height = [](int y) { return 2 * (y + 0.5); };
  const MaskImage::Pointer body = MadeUpImage<MaskImage>(size, { 2, 2, 2 },
    [&](int x, int y, int z) { return height(y) < skin(x, z) ? 1 : 0; });
  // Bright skin before suppressed fat is a step, too, to the wrong side.
  const FloatImage::Pointer channel = MadeUpImage<FloatImage>(size, { 2, 2, 2 },
    [&](int x, int y, int z)
    {
      const double depth = skin(x, z) - height(y);
      return depth < 0 ? 0.0 : depth < 3 ? -skinStep : height(y) < circle(x, radius) ? -step : 0.0;
    });
  const ChestWallSheet sheet = FindChestWall({ channel }, body, body);
  double largest = 0;
  for (int x = 0; x < size[0]; ++x)
  {
    std::vector<double> before;
    for (int z = 5; z < size[2] - 5; ++z)
    {
      before.push_back(sheet.Front->GetPixel({ { x, z } }) - circle(x, radius));
    }
    std::nth_element(before.begin(), before.begin() + 15, before.end());
    const bool side = std::abs(aside(x)) > 60 && std::abs(aside(x)) < 100;
    largest = side ? std::max(largest, before[15]) : largest;
  }
  return largest;
}

TEST(FindChestWall, FollowsAThoraxToItsSidesWhereStepsAreSmall)
{
  // A plate stiff over 220 mm bends hardly more than a line there: near it alone the sheet leaves
  // steps of 0.2 for the skin. A voxel of the steep wall, and what the plate of 20 mm smooths.
  EXPECT_LT(BeforeTheSides(0.2, 0.2), 5);
  EXPECT_LT(BeforeTheSides(0.8, 0.8), 5);
}
}
