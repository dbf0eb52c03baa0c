// SPDX-License-Identifier: Apache-2.0
// A small study of a half-ellipsoid: what is written is what its truth says.
#include "Files.h"
#include "LabelShapes.h"
#include "Refusals.h"
#include "VirtualStudy.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/StudyCase.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

using namespace mammoray;
using test::RefusalOf;
using testing::HasSubstr;

namespace
{
/// Fat with a ball of gland before muscle; the front is -y. Indices of the table victre.
int EllipsoidMaterial(const Vector3& point)
{
  if (point[1] > 16 && point[1] < 26 && std::hypot(point[0], point[2]) < 44)
  {
    return 4;
  }
  const double depth = (16 - point[1]) / 45;
  if (depth < 0 || std::hypot(point[0] / 40, depth, point[2] / 36) > 1)
  {
    return 0;
  }
  return Norm(point - Vector3{ 6, -6, 4 }) < 20 ? 2 : 1;
}

VirtualStudyOptions SmallStudy()
{
  VirtualStudyOptions options;
  options.Seed = 3;
  options.Laterality = 'R';
  options.Scanner = "philips";
  options.MriPixelMm = 2;
  // Slices of 4 mm would leave 11 +- 3 of 100 points in voxels that are partly gland, of 2 mm 6.
  options.MriSliceMm = 2;
  options.SignalToNoise = 40;
  options.MammogramPixelMm = 1;
  options.GravityFineness = 4;
  options.CompressionFineness = 6;
  options.AnatomyMm = 8;
  options.Projections = 3;
  options.SpanDeg = 30;
  return options;
}

StudyTruth MakeSmallStudy(const std::string& folder, const ProgressCallback& progress = {})
{
  return MakeVirtualStudy(test::LabelledCube(48, 2, EllipsoidMaterial), FindMaterialTable("victre"),
    AnatomicalAxes::FromCode("LPS"), SmallStudy(), folder, progress);
}
}

namespace
{
/// Every point of the CC's compression lies in the breast's shadow of each projection, too, where
/// the place of the source puts it.
void ExpectProjectionsOf(const TrueView& view, const std::string& path)
{
  const std::vector<Mammogram> projections = ReadProjections(path);
  ASSERT_EQ(projections.size(), 3u);
  const Mammogram& middle = projections[MiddleProjection(projections)];
  const auto enlarged = [](const Mammogram& projection, double height)
  { return 1 / (1 - height / *projection.SourceToDetectorMm); };
  for (const Mammogram& projection : projections)
  {
    EXPECT_EQ(projection.View, "CC");
    EXPECT_EQ(projection.BodyPartThicknessMm, view.HeaderThicknessMm);
    const float air = projection.Pixels.front();
    for (std::size_t index = 0; index < view.Gantry.size(); ++index)
    {
      const double height = view.Gantry[index][2];
      std::array<long, 2> pixel{};
      for (std::size_t axis = 0; axis < 2; ++axis)
      {
        const double from = (*middle.SourceFootPixel)[axis];
        const double under = from + (view.Pixels[index][axis] - from) / enlarged(middle, height);
        const double foot = (*projection.SourceFootPixel)[axis];
        pixel[axis] = std::lround(foot + enlarged(projection, height) * (under - foot));
      }
      if (pixel[0] >= 0 && pixel[0] < projection.Columns)
      {
        EXPECT_GT(
          projection.Pixels[static_cast<std::size_t>(pixel[1] * projection.Columns + pixel[0])],
          air + 100)
          << index;
      }
    }
  }
}

/// The three as one mammogram of the study's MRI, in coarse meshes and pixels.
void ExpectRegisteredTogether(const StudyTruth& truth, const std::string& path)
{
  RegistrationCase input;
  TakeStudy(path + "/export", {}, input);
  input.Mammograms = { path + "/" + StudyProjectionsFile };
  input.Labels.AcceptUnusual = true; // pixels of 1 mm
  input.AnatomyCellSizeMm = 8;
  input.SimulationCellSizeMm = 14;
  input.Options.PixelSizesMm = { 4 };
  input.Options.MaximumIterations = 4;
  const RegistrationCaseResult result = RunRegistrationCase(input);
  ASSERT_EQ(result.Views.size(), 1u);
  const RegisteredView& view = result.Views[0];
  // 610 mm about 40 mm above the receptor, 15 degrees to each side.
  EXPECT_NEAR(view.View.Unit.FocalSpotMm[0], 0, 1e-3);
  ASSERT_EQ(view.View.Projections.size(), 2u);
  EXPECT_NEAR(std::abs(view.View.Projections[0].FocalSpotMm[0]), 610 * 0.258819, 1e-3);
  EXPECT_NEAR(view.View.Projections[0].FocalSpotMm[0], -view.View.Projections[1].FocalSpotMm[0],
    1e-3);
  EXPECT_NEAR(view.View.Projections[0].FocalSpotMm[2], 40 + 610 * 0.965926, 1e-3);
  // A compression that fits the middle one fits the others as well, whichever side they are of: a
  // source on the wrong side would put the outlines 10 mm apart.
  EXPECT_LT(view.Registration.After.MeanOutlineDistanceMm, 2);
  ASSERT_EQ(view.Registration.ProjectionsAfter.size(), 2u);
  for (const Similarity& after : view.Registration.ProjectionsAfter)
  {
    EXPECT_LT(after.MeanOutlineDistanceMm, 1 + view.Registration.After.MeanOutlineDistanceMm);
    EXPECT_GT(after.Correlation, 0.8);
  }
  std::vector<double> errors;
  const std::vector<Vector3> moved = Displace(truth.MriPoints, UncompressedGrid(result, view));
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    if (truth.Views[0].Receptor[index][1] >= 0)
    {
      errors.push_back(
        Norm(view.Registration.Placed.ToGantry(moved[index]) - truth.Views[0].Gantry[index]));
    }
  }
  // Voxels of 2 mm, cells of 14 and four iterations.
  EXPECT_LT(Quantile(errors, 0.5), 6);
}

/// A T1 of which no header says that fat is not suppressed is found out by its histogram.
void ExpectSilentSeriesUsed(const StudyChoice& choice)
{
  const MaterialTable table = FindMaterialTable(StudyMaterials);
  const StudyTissue told = SegmentStudy(choice, table, {}, true);
  EXPECT_EQ(told.Doubt, "");
  StudyChoice silent = choice;
  silent.Undetermined = std::exchange(silent.Plain, std::nullopt);
  const StudyTissue found = SegmentStudy(silent, table, {}, true);
  EXPECT_TRUE(found.Labels.Voxels == told.Labels.Voxels);
}
}

TEST(VirtualStudy, RefusesTwoBreasts)
{
  const LabelVolume both = test::LabelledCube(90, 2,
    [](const Vector3& p) {
      return EllipsoidMaterial({ std::abs(p[0]) - 45, p[1], p[2] });
    });
  const std::string folder = testing::TempDir() + "mammoray-two-breasts";
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  MakeVirtualStudy(both, FindMaterialTable("victre"),
                    AnatomicalAxes::FromCode("LPS"), SmallStudy(), folder);
                }),
    HasSubstr("expected labels of one breast, found two side by side; 'mammoray segment --side "
              "left' (or right) makes labels of one"));
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(VirtualStudy, WhatIsWrittenIsWhatItsTruthSays)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const test::TemporaryFolder folder;
  const std::string path = folder.File("study");
  const StudyTruth truth = MakeSmallStudy(path);
  ASSERT_EQ(truth.MriPoints.size(), 100u);
  ASSERT_EQ(truth.Views.size(), 2u);

  // A clinic's export, of which the right things are taken.
  const StudyChoice choice = ChooseForRegistration(ReadStudy(path + "/export"));
  EXPECT_EQ(choice.Refusal, "");
  EXPECT_EQ(choice.Laterality, 'R');
  EXPECT_EQ(choice.Position, PatientPosition::Prone);
  ASSERT_TRUE(choice.Plain && choice.FatSuppressed && choice.Cc && choice.Mlo);
  EXPECT_EQ(choice.FatSuppressed->Contrast, ContrastPhase::Before);
  EXPECT_EQ(choice.Cc->Header.Path, path + "/" + truth.Views[0].File);
  ExpectSilentSeriesUsed(choice);

  // The MRI: where it is dark without and bright with fat suppression is gland.
  const IntensityVolume plain = ReadIntensitySeries(choice.Plain->Files);
  const IntensityVolume suppressed = ReadIntensitySeries(choice.FatSuppressed->Files);
  int gland = 0;
  int contradictions = 0;
  for (const Vector3& point : truth.MriPoints)
  {
    const double fatBright = plain.ValueAt(point).value_or(0);
    const double fatDark = suppressed.ValueAt(point).value_or(0);
    ASSERT_GT(fatBright, 100) << "tissue at every point";
    // Fat's ratio is 5, gland's 0.62; partial volume lies between.
    gland += fatBright < fatDark ? 1 : 0;
    contradictions += fatBright > fatDark && fatBright < 2 * fatDark ? 1 : 0;
  }
  // The ball is a quarter of the breast.
  EXPECT_GT(gland, 10);
  EXPECT_LT(gland, 50);
  EXPECT_LT(contradictions, 15);

  // The mammograms: every point lies between the plates and in the breast's shadow.
  for (const TrueView& view : truth.Views)
  {
    const Mammogram image = ReadMammogram(path + "/" + view.File);
    EXPECT_EQ(image.View, view.View);
    EXPECT_EQ(image.BodyPartThicknessMm, view.HeaderThicknessMm);
    EXPECT_LE(std::abs(view.HeaderThicknessMm - view.Pose.ThicknessMm), 4.5);
    EXPECT_EQ(image.RowDirection, "P"); // the chest wall at the right, as a right breast is hung
    const float air = image.Pixels.front();
    for (std::size_t index = 0; index < view.Gantry.size(); ++index)
    {
      const Vector3& at = view.Gantry[index];
      if (at[1] > view.Unit.EdgeRadiusMm)
      {
        EXPECT_GT(at[2], view.Unit.SupportHeightMm - 0.1);
        // The paddle opens by 2 degrees towards the nipple.
        EXPECT_LT(at[2], view.Unit.SupportHeightMm + view.Pose.ThicknessMm + 0.04 * 60);
      }
      const double enlarged = 1 / (1 - at[2] / view.Unit.SourceToDetectorMm);
      EXPECT_NEAR(view.Receptor[index][0], enlarged * at[0], 1e-9);
      const auto column = std::lround(view.Pixels[index][0]);
      const auto row = std::lround(view.Pixels[index][1]);
      if (column >= 0 && column < image.Columns) // elsewhere behind the receptor's edge
      {
        EXPECT_GT(image.Pixels[static_cast<std::size_t>(row * image.Columns + column)], air + 100)
          << view.View << ' ' << index;
      }
    }
  }

  ExpectProjectionsOf(truth.Views[0], path + "/" + StudyProjectionsFile);
  ExpectRegisteredTogether(truth, path);

  const StudyTruth read = ReadStudyTruth(path + "/truth.json");
  EXPECT_EQ(read.MriPoints, truth.MriPoints);
  EXPECT_EQ(read.Views[1].Gantry, truth.Views[1].Gantry);
  EXPECT_EQ(read.Views[1].Pose.RollDeg, truth.Views[1].Pose.RollDeg);
  EXPECT_EQ(read.YoungsModuliKPa, truth.YoungsModuliKPa);
  EXPECT_GT(truth.MeanHangMm, 0.5);
  EXPECT_THAT(RefusalOf([&] { MakeSmallStudy(path); }),
    HasSubstr("expected a new or an empty folder"));
}

TEST(VirtualStudy, InterruptedWorkLeavesNothing)
{
  const test::TemporaryFolder folder;
  EXPECT_THROW(MakeSmallStudy(folder.File("study"), [](double, const char*) { return false; }),
    Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder.File("study")));
  const std::string broken = folder.Write("truth.json", "{ \"truth_version\": 1 }");
  EXPECT_THAT(RefusalOf([&] { ReadStudyTruth(broken); }), HasSubstr("truth of a virtual study"));
}
