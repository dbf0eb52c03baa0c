// SPDX-License-Identifier: Apache-2.0
// A phantom placed, moved and pictured, against closed forms.
#include "Files.h"
#include "LabelShapes.h"
#include "PatientTissue.h"
#include "SimulatedMri.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/Segmentation/BreastSegmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;

namespace
{
MaterialTable SoftTable()
{
  MaterialTable table;
  table.Name = "test";
  table.Materials = { { .Name = "air" }, { .Name = "fat", .Attenuation = "adipose" },
    { .Name = "gland", .Attenuation = "glandular" },
    { .Name = "muscle", .Attenuation = "muscle", .Fixed = true } };
  return table;
}

/// A ball of 20 mm before a wall that is thicker at +x; the front is -y.
int WedgedBall(const Vector3& point)
{
  const double wall = 12 - 0.1 * point[0];
  return point[1] > wall && point[1] < 22 && std::hypot(point[0], point[2]) < 22 ? 3
    : Norm(point) < 20                                                           ? 1
                                                                                 : 0;
}

double VolumeOf(const LabelVolume& labels, int label)
{
  return static_cast<double>(labels.CountLabels()[label]) * labels.VoxelVolume();
}
}

TEST(PatientTissue, MovingKeepsWhatAnAffineMotionSays)
{
  const LabelVolume ball =
    test::LabelledCube(50, 1, [](const Vector3& p) { return Norm(p) < 18 ? 2 : 0; });
  // Sheared, stretched by 1.2 along y, shifted.
  const PointMotion motion = [](const std::vector<double>& points)
  {
    std::vector<double> moved = points;
    for (std::size_t at = 0; at < moved.size(); at += 3)
    {
      moved[at] = points[at] + 0.3 * points[at + 2] + 5;
      moved[at + 1] = 1.2 * points[at + 1];
    }
    return moved;
  };
  VolumeGrid grid = ball;
  grid.Size = { 140, 140, 140 };
  grid.Spacing = { 0.5, 0.5, 0.5 };
  grid.Origin = { -34, -34, -34 };
  const LabelVolume moved = MoveLabels(ball, motion, grid);
  // Within half a per cent: the ball's voxels are a tenth as large as its radius squared is long.
  EXPECT_NEAR(VolumeOf(moved, 2) / VolumeOf(ball, 2), 1.2, 6e-3);
  EXPECT_EQ(moved.LabelAt({ 5, 21, 0 }), 2);
  EXPECT_EQ(moved.LabelAt({ 5, 22.5, 0 }), 0);
  EXPECT_EQ(moved.LabelAt({ 5 + 0.3 * 16, 0, 16 }), 2);
  EXPECT_EQ(moved.LabelAt({ 5 - 0.3 * 16, 0, 16 }), 0) << "x of 5 - 9.6 is left of it there";

  const LabelVolume same = MoveLabels(
    ball, [](const std::vector<double>& points) { return points; }, ball);
  EXPECT_EQ(same.Voxels, ball.Voxels);
}

TEST(PatientTissue, ThePhantomLiesOnItsSideOfTheChest)
{
  const LabelVolume phantom = test::LabelledCube(50, 1, WedgedBall);
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("LPS");
  const double off = OffMidlineMm(phantom, axes);
  EXPECT_EQ(off, 85);
  const ChestCurve curve{ 0, 400 };
  // The wall reaches farther forwards at +x, the patient's left: the breast of the right side.
  const LabelVolume right = PlaceOnChest(phantom, SoftTable(), axes, 'R', off, curve);
  const LabelVolume left = PlaceOnChest(phantom, SoftTable(), axes, 'L', off, curve);
  EXPECT_NEAR(VolumeOf(right, 1) / VolumeOf(phantom, 1), 1, 0.02);
  for (const double x : { -97.5, -85.5, -73.5 })
  {
    // Its posterior face lies on the curve, and mirrored the same on the other side.
    EXPECT_EQ(right.LabelAt({ x, curve.At(x) - 1.2, 0 }), 3) << x;
    EXPECT_EQ(right.LabelAt({ x, curve.At(x) + 1.2, 0 }), 0) << x;
    EXPECT_EQ(left.LabelAt({ -x, curve.At(x) - 1.2, 0 }), 3) << x;
  }
  const auto thickness = [&](const LabelVolume& placed, double x)
  {
    double count = 0;
    for (double y = -60; y < 40; y += 0.25)
    {
      count += placed.LabelAt({ x, y, 0 }) == 3 ? 0.25 : 0;
    }
    return count;
  };
  EXPECT_GT(thickness(right, -75), thickness(right, -95) + 1);
  EXPECT_NEAR(thickness(left, 75), thickness(right, -75), 1);
}

TEST(PatientTissue, TheChestGoesOnAroundWhatWasCutOut)
{
  // 24 mm of fat before a wall of 10 mm, cut flat at |x| = 15 and |z| = 15 mm; skin in front.
  MaterialTable table = SoftTable();
  table.Materials.push_back({ .Name = "skin", .Attenuation = "skin", .Thin = true });
  const LabelVolume cut = test::LabelledCube(50, 1,
    [](const Vector3& p)
    {
      return std::abs(p[0]) > 15 || std::abs(p[2]) > 15 || p[1] > 10 || p[1] < -26 ? 0
        : p[1] > 0                                                                 ? 3
        : p[1] > -24                                                               ? 1
                                                                                   : 4;
    });
  const ChestCurve curve{ 10, 400 };
  const LabelVolume placed =
    PlaceOnChest(cut, table, AnatomicalAxes::FromCode("LPS"), 'L', 85, curve);
  constexpr double reach = 30;
  const LabelVolume chest = SurroundByChest(placed, table, curve, 10, reach);
  const auto fatAt = [&](double x, double z)
  {
    double fat = 0;
    for (double before = 0.25; before < 60; before += 0.5)
    {
      fat += chest.LabelAt({ x, curve.At(x) - 10 - before, z }) == 1 ? 0.5 : 0;
    }
    return fat;
  };
  // What was there is as it was.
  for (const Vector3& own : { Vector3{ 85, 10 - 40, 0 }, Vector3{ 95, 10 + 2, 8 } })
  {
    EXPECT_EQ(chest.LabelAt(own), placed.LabelAt(own));
  }
  // It goes on as high as the cut, falls off to half of it at half the reach, then is 8 mm; within
  // a voxel, and two where it is steep.
  EXPECT_NEAR(fatAt(85, 16.5), 24, 1.5);
  EXPECT_NEAR(fatAt(85, 15 + reach / 2), 12, 2);
  EXPECT_NEAR(fatAt(85, -15 - reach / 2), 12, 2);
  EXPECT_NEAR(fatAt(85 + 15 + reach / 2, 0), 12, 2);
  EXPECT_NEAR(fatAt(85, 15 + reach - 2), 8, 1.5);
  // So does a wall that comes 6 mm further forwards than the one around.
  const LabelVolume stepped = SurroundByChest(placed, table, curve, 4, reach);
  const auto wallAt = [&](double z)
  {
    double wall = 0;
    for (double ahead = 0.25; ahead < 60; ahead += 0.5)
    {
      wall += stepped.LabelAt({ 85, curve.At(85) - ahead, z }) == 3 ? 0.5 : 0;
    }
    return wall;
  };
  EXPECT_NEAR(wallAt(16.5), 10, 1);
  EXPECT_NEAR(wallAt(15 + reach / 2), 7, 1);
  EXPECT_NEAR(wallAt(15 + reach - 2), 4, 1);
  for (const double z : { -40.0, 40.0 })
  {
    EXPECT_EQ(chest.LabelAt({ 85, curve.At(85) - 5, z }), 3) << "the wall goes on";
  }
  EXPECT_EQ(chest.LabelAt({ 85, curve.At(85) + 2, 40 }), 0) << "nothing behind it";
}

TEST(PatientTissue, TheBodyIsBehindAndTheOtherBreastBeside)
{
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("LPS");
  const ChestCurve curve{ 0, 400 };
  const LabelVolume placed =
    PlaceOnChest(test::LabelledCube(50, 1, WedgedBall), SoftTable(), axes, 'R', 85, curve);
  VolumeGrid grid;
  grid.Size = { 240, 100, 40 };
  grid.Spacing = { 1.5, 1.5, 2 };
  grid.Origin = { -0.75 * 239, -80, -39 };
  const LabelVolume moved = MoveLabels(
    placed, [](const std::vector<double>& points) { return points; }, grid);
  const LabelVolume body = JoinBody(moved, TissuesOf(SoftTable()), curve, 8, true);
  const auto at = [&](const Vector3& point) { return static_cast<Tissue>(body.LabelAt(point)); };
  for (const double x : { -85.0, 85.0 })
  {
    EXPECT_EQ(at({ x, curve.At(x) - 30, 0 }), Tissue::Fat) << x;
    EXPECT_EQ(at({ x, curve.At(x) - 60, 0 }), Tissue::Air) << x;
    EXPECT_EQ(at({ x, curve.At(x), 0 }), Tissue::Muscle) << x;
    EXPECT_EQ(at({ x, curve.At(x) + 40, 0 }), Tissue::Lung) << x;
  }
  // Between the breasts: fat under skin before the wall.
  EXPECT_EQ(at({ 0.5, -8 - 4, 0 }), Tissue::Fat);
  EXPECT_EQ(at({ 0.5, -8 - 9, 0 }), Tissue::Skin);
  EXPECT_EQ(at({ 0.5, -8 - 12, 0 }), Tissue::Air);
}

TEST(SimulatedMri, SignalsSensitivityAndNoise)
{
  LabelVolume tissue;
  tissue.Size = { 40, 40, 20 };
  tissue.Voxels.assign(32000, static_cast<std::uint16_t>(Tissue::Air));
  std::fill(tissue.Voxels.begin() + 16000, tissue.Voxels.end(),
    static_cast<std::uint16_t>(Tissue::Fat));
  CoilPair coils;
  coils.Centres = { { 20, -980.5, 10 } };
  coils.HalfAtMm = 1000;
  coils.Reference = { 20, 19.5, 10 };
  EXPECT_NEAR(coils.At({ 20, 19.5, 10 }), 1, 1e-12);
  // Half as far in, (1 + 1) / (1 + 1/4).
  EXPECT_NEAR(coils.At({ 20, -480.5, 10 }), 1.6, 1e-12);
  Draws draws(1, 0, 0);
  TissueSignals signals{};
  signals[static_cast<std::size_t>(Tissue::Fat)] = 0.8;
  const IntensityVolume picture =
    SimulateMri(tissue, tissue, { signals }, coils, 0.02, 1000, draws).front();
  double air = 0;
  double fat = 0;
  double squares = 0;
  for (int index = 0; index < 14400; ++index)
  {
    air += picture.Voxels[static_cast<std::size_t>(index)] / 14400;
  }
  for (std::size_t index = 17600; index < 32000; ++index)
  {
    fat += picture.Voxels[index] / 14400;
    squares += picture.Voxels[index] * picture.Voxels[index] / 14400;
  }
  // Rayleigh in air: sigma sqrt(pi / 2); Gaussian in the signal, with sigma. 2 %: 14400 voxels, and
  // a sensitivity that varies by 4 % over them.
  EXPECT_NEAR(air, 20 * std::sqrt(0.5 * std::numbers::pi), 0.4);
  EXPECT_NEAR(fat, 800, 8);
  EXPECT_NEAR(std::sqrt(squares - fat * fat), 20, 3);
}

TEST(SimulatedMri, ASegmentationFindsThatItsFatIsBright)
{
  // The step from dark skin to the fat behind it looks like one from suppressed fat to muscle.
  const MaterialTable table = ReadMaterialTable(test::DataFolder() + "/materials/victre.json");
  const LabelVolume phantom = table.ToMaterials(
    ReadLabelVolume(test::DataFolder() + "/victre-phantom-1/labels.nrrd"), "phantom");
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("ALS");
  const double offMm = OffMidlineMm(phantom, axes);
  const LabelVolume placed = PlaceOnChest(phantom, table, axes, 'L', offMm, {});
  VolumeGrid fine;
  fine.Size = { 352, 160, 120 };
  fine.Spacing = { 1, 1, 1.5 };
  fine.Origin = { -175.5, -90.5, -89.25 };
  VolumeGrid grid;
  grid.Size = { 176, 80, 60 };
  grid.Spacing = { 2, 2, 3 };
  grid.Origin = { -175, -90, -88.5 };
  const PointMotion none = [](const std::vector<double>& points) { return points; };
  const LabelVolume body = JoinBody(MoveLabels(placed, none, fine), TissuesOf(table), {},
    WallThicknessMm(placed, table.Fixed()), true);
  CoilPair coils;
  coils.Centres = { { offMm, -60, 0 }, { -offMm, -60, 0 } };
  coils.Reference = { offMm, -40, 0 };
  Draws draws(1, 0, 0);
  const IntensityVolume plain =
    SimulateMri(body, grid, { PlainT1 }, coils, 1.0 / 30, 900, draws).front();
  SegmentationOptions options;
  options.SpacingMm = 2;
  EXPECT_EQ(SegmentBreast(plain, options).Contrast, FatContrast::FatBright);
}

TEST(FreeOfCoil, MakesABreastAsWideAsHigh)
{
  const auto sizes = [](double width, double height, bool free)
  {
    // A box of fat, 60 mm deep, in front of a wall.
    LabelVolume box = test::LabelledCube(70, 2,
      [&](const Vector3& p)
      {
        return p[1] > 20                                                            ? 2
          : std::abs(p[0]) < width / 2 && std::abs(p[2]) < height / 2 && p[1] > -40 ? 1
                                                                                    : 0;
      });
    box = free ? FreeOfCoil(std::move(box), { false, false, true }) : box;
    std::array<Extent, 3> extents;
    box.ForEachVoxel(
      [&](int i, int j, int k, std::size_t index)
      {
        for (std::size_t axis = 0; axis < 3 && box.Voxels[index] == 1; ++axis)
        {
          extents[axis].Add(box.PointAt(i, j, k)[axis] + 0.5 * box.Spacing[axis]);
          extents[axis].Add(box.PointAt(i, j, k)[axis] - 0.5 * box.Spacing[axis]);
        }
      });
    return Vector3{ extents[0].Length(), extents[1].Length(), extents[2].Length() };
  };
  // Twice as high as wide: s^(3/2) = 2, but for the 20 voxels across, whose middles deviate by less
  // than the box does.
  const Vector3 squeezed = sizes(40, 80, true);
  EXPECT_NEAR(squeezed[0], 40 * std::cbrt(4.0), 0.1);
  EXPECT_NEAR(squeezed[1], 60 / std::cbrt(2.0), 0.1);
  EXPECT_NEAR(squeezed[2], squeezed[0], 0.1);
  // No further than by 1.8; what is wide already stays.
  EXPECT_NEAR(sizes(40, 120, true)[0], 72, 0.01);
  EXPECT_EQ(sizes(80, 40, true), sizes(80, 40, false));
}

TEST(FlattenChest, TakesOutASurfaceOfSecondOrder)
{
  // 20 mm of fat in front of a wall that slopes to the side and to the head and is round.
  const auto front = [](double x, double z)
  { return 3 + 0.3 * x - 0.2 * z + 0.006 * x * x + 0.004 * x * z; };
  const LabelVolume curved = test::LabelledCube(60, 1,
    [&](const Vector3& p)
    {
      const double behind = p[1] - front(p[0], p[2]);
      return std::hypot(p[0], p[2]) > 20 || behind < -20 ? 0 : behind < 0 ? 1 : 3;
    });
  const std::vector<bool> held{ false, false, false, true };
  const LabelVolume flat = FlattenChest(curved, held);
  Extent fronts;
  Extent backs;
  flat.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      const Vector3 at = flat.PointAt(i, j, k);
      if (std::hypot(at[0], at[2]) < 18 &&
        flat.Voxels[index] != flat.LabelAt(at - Vector3{ 0, 1, 0 }))
      {
        (flat.Voxels[index] == 3 ? backs : fronts).Add(at[1]);
      }
    });
  // Within a voxel.
  EXPECT_LE(backs.Length(), 1.01);
  EXPECT_NEAR(backs.Low - fronts.Low, 20, 1.01);
  EXPECT_NEAR(VolumeOf(flat, 1) / VolumeOf(curved, 1), 1, 0.02);
  // Without a wall there is nothing to flatten.
  EXPECT_EQ(FlattenChest(curved, std::vector<bool>(4, false)).Voxels, curved.Voxels);
}

TEST(HoldCutTissue, PutsTheHeldTissueBehindWhatWasCut)
{
  const std::vector<bool> held{ false, false, true };
  for (const double backwards : { 1.0, -1.0 })
  {
    // Rows of 3 mm from the front: tissue before muscle in the first column, tissue that ends with
    // it in the second, tissue that ends before it in the third, and air.
    LabelVolume volume;
    volume.Size = { 4, 10, 1 };
    volume.Spacing = { 1, 3, 1 };
    volume.Direction[1] = { 0, backwards, 0 };
    volume.Voxels.assign(40, 0);
    const auto voxel = [&](int column, int row) -> std::uint16_t&
    { return volume.Voxels[volume.Index(column, backwards > 0 ? row : 9 - row, 0)]; };
    for (int row = 1; row < 4; ++row)
    {
      voxel(0, row) = row < 3 ? 1 : 2;
      voxel(1, row) = 1;
      voxel(2, row) = row < 2 ? 1 : 0;
    }
    const LabelVolume before = volume;
    for (int row = 4; row < 8; ++row)
    {
      voxel(1, row) = 2;
    }
    const LabelVolume expected = volume;
    volume = before;
    HoldCutTissue(volume, held);
    EXPECT_EQ(volume.Voxels, expected.Voxels);
    // Again: nothing that is not fixed ends there any more.
    HoldCutTissue(volume, held);
    EXPECT_EQ(volume.Voxels, expected.Voxels);
  }
}

TEST(HoldCutTissue, TakesThePlaceOfTissueWhereTheVolumeEnds)
{
  LabelVolume volume;
  volume.Size = { 1, 6, 1 };
  volume.Spacing = { 1, 4, 1 };
  volume.Voxels.assign(6, 1);
  HoldCutTissue(volume, { false, false, true });
  EXPECT_EQ(volume.Voxels, (std::vector<std::uint16_t>{ 1, 1, 1, 2, 2, 2 }));
  // Nothing is held: nothing to hold with.
  volume.Voxels.assign(6, 1);
  HoldCutTissue(volume, { false, false, false });
  EXPECT_EQ(volume.Voxels, std::vector<std::uint16_t>(6, 1));
}
