// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/Private/CaseChecks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace
{
using namespace mammoray;
using test::NotRefused;
using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A breast outlined as a rectangle of 20 mm from the chest wall on, at the left of the picture.
RegisteredView Pictured(char laterality, double widthMm)
{
  RegisteredView view;
  view.Path = "m.dcm";
  view.Mammogram.View = "CC";
  view.Mammogram.Laterality = laterality;
  view.Mammogram.RowDirection = "A";
  view.Mammogram.ColumnDirection = "R";
  view.View.Target.Grid.Columns = 40;
  view.View.Target.Grid.Rows = 400;
  view.View.Target.Grid.ColumnStep = { 0, 1 };
  view.View.Target.Grid.RowStep = { -1, 0 };
  view.View.Target.BreastMask.assign(16000, 0);
  for (int row = 0; row <= widthMm; ++row)
  {
    std::fill_n(view.View.Target.BreastMask.begin() + 40 * row, 20, 1);
  }
  return view;
}

TEST(CaseChecks, ABreastHasAWidthInThePicture)
{
  const RegistrationCase input;
  RegisteredView usual = Pictured('L', 120);
  EXPECT_NO_THROW(CheckPicturedBreast(input, usual));
  EXPECT_THAT(usual.View.Target.Disagreements, IsEmpty());
  for (const double width : { 29.0, 301.0 })
  {
    RegisteredView unusual = Pictured('L', width);
    EXPECT_THAT(RefusalOf([&] { CheckPicturedBreast(input, unusual); }),
      HasSubstr("m.dcm: expected a breast width from 30 to 300 mm, found " +
        std::to_string(static_cast<int>(width))));
    RegistrationCase accepting;
    accepting.Labels.AcceptUnusual = true;
    EXPECT_NO_THROW(CheckPicturedBreast(accepting, unusual));
  }
}

TEST(CaseChecks, TheSideIsThatOfThePictureUnlessSaid)
{
  RegistrationCase input;
  RegisteredView view = Pictured('R', 120);
  CheckPicturedBreast(input, view);
  EXPECT_THAT(view.View.Target.Disagreements,
    ElementsAre(HasSubstr("says right breast, but the chest wall is at the left edge")));
  // Hung as a right one.
  RegisteredView right = Pictured('R', 120);
  right.View.Target.Grid.ColumnStep = { 0, -1 };
  CheckPicturedBreast(input, right);
  EXPECT_THAT(right.View.Target.Disagreements, IsEmpty());
  // Turned by 90 degrees, it tells nothing.
  RegisteredView turned = Pictured('R', 120);
  turned.View.Target.Grid.ColumnStep = { -1, 0 };
  turned.View.Target.Grid.RowStep = { 0, 1 };
  turned.View.Target.BreastMask.assign(16000, 1);
  RegistrationCase accepting;
  accepting.Labels.AcceptUnusual = true;
  CheckPicturedBreast(accepting, turned);
  EXPECT_THAT(turned.View.Target.Disagreements, IsEmpty());
  input.Laterality = "R";
  RegisteredView said = Pictured('R', 120);
  CheckPicturedBreast(input, said);
  EXPECT_THAT(said.View.Target.Disagreements, IsEmpty());
}

TEST(CaseChecks, AnObliqueViewIsOfTheBreastItsDirectionsSay)
{
  const RegistrationCase input;
  for (const auto& [laterality, direction, refused] :
    { std::tuple{ 'L', "FR", false }, { 'L', "FL", true }, { 'R', "FL", false },
      { 'R', "FR", true }, { 'R', "HR", false }, { 'R', "HL", true }, { 'R', "F", false } })
  {
    RegisteredView view = Pictured(laterality, 120);
    view.Mammogram.View = "MLO";
    view.Mammogram.ColumnDirection = direction;
    const std::string refusal = RefusalOf([&] { CheckPicturedBreast(input, view); });
    EXPECT_EQ(refusal != NotRefused, refused) << laterality << direction << ": " << refusal;
  }
}

TEST(CaseChecks, LengthsInPlaceOfTheHeadersAreTold)
{
  const auto warnings = [](double spacingMm, double distanceMm)
  {
    RegistrationCase input;
    input.Mammograms = { DataDirectory() + "/victre-phantom-1/victre1_lcc_processing.dcm" };
    input.PixelSpacingMm = spacingMm;
    input.SourceToDetectorMm = distanceMm;
    std::vector<RegisteredView> views(1);
    ReadCasePictures(input, views);
    return views[0].Warnings;
  };
  EXPECT_THAT(warnings(0.1004, 650), IsEmpty());
  EXPECT_THAT(warnings(0.12, 660),
    ElementsAre("Pixel spacing: 0.12 mm as given; the header says 0.1 mm.",
      "Source to detector distance: 660 mm as given; the header says 650 "
      "mm."));
}

TEST(CaseChecks, AMaskLeavesSomeOfTheBreast)
{
  const test::TemporaryFolder folder;
  RegistrationCase input;
  input.Mammograms = { DataDirectory() + "/victre-phantom-1/victre1_lcc_processing.dcm" };
  std::vector<RegisteredView> views(1);
  ReadCasePictures(input, views);
  const RegistrationTarget target = views[0].View.Target;
  const std::string path = folder.File("mask.mha");
  input.Masks = { path };
  const auto refusal = [&](const std::string& mask)
  {
    folder.Write("mask.mha",
      "ObjectType = Image\nNDims = 2\nBinaryData = True\nDimSize = " +
        std::to_string(target.Grid.Columns) + ' ' + std::to_string(target.Grid.Rows) +
        "\nElementSpacing = 1 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + mask);
    std::vector<RegisteredView> masked(1);
    return RefusalOf([&] { ReadCasePictures(input, masked); });
  };
  EXPECT_EQ(refusal(std::string(target.Grid.NumberOfPixels(), '\0')), NotRefused);
  EXPECT_THAT(refusal(std::string(target.Grid.NumberOfPixels(), '\xff')),
    HasSubstr(path +
      ": expected a mask that is 0 where the breast is compared, found one that "
      "leaves out all of it"));
  // The breast itself, drawn as what is compared.
  EXPECT_THAT(refusal(std::string(target.BreastMask.begin(), target.BreastMask.end())),
    HasSubstr("leaves out all of it"));
}

TEST(CaseChecks, PicturesShowAsMuchBreastAsTheMri)
{
  RegistrationCase input;
  input.Study = std::make_shared<const StudyChoice>();
  const auto viewed = [](const char* name, double widthMm)
  {
    RegisteredView view = Pictured('L', widthMm - 1);
    view.Mammogram.View = name;
    view.Mammogram.BodyPartThicknessMm = 50; // 20 mm deep: a cm3 for each mm of width
    return view;
  };
  const auto disagreements = [&](double breastCm3, std::vector<RegisteredView> views)
  {
    CheckSizes(input, breastCm3, views);
    return views.back().View.Target.Disagreements;
  };
  EXPECT_THAT(disagreements(200, { viewed("CC", 100), viewed("MLO", 130) }), IsEmpty());
  EXPECT_THAT(disagreements(200, { viewed("CC", 55) }),
    ElementsAre(HasSubstr("shows 55 cm3 of breast (area times thickness), the MRI 200 cm3")));
  EXPECT_THAT(disagreements(80, { viewed("CC", 100) }), ElementsAre(HasSubstr("another breast")));
  EXPECT_THAT(disagreements(80, { viewed("MLO", 100) }), IsEmpty());
  EXPECT_THAT(disagreements(150, { viewed("CC", 60), viewed("MLO", 140) }),
    ElementsAre(HasSubstr("28 cm2 in MLO and 12 in CC")));
  const auto refusal = [&](double breastCm3)
  { return RefusalOf([&] { disagreements(breastCm3, { viewed("CC", 100) }); }); };
  // A header in centimetres, and what is given in its place.
  std::vector<RegisteredView> given{ viewed("CC", 100) };
  given[0].Mammogram.BodyPartThicknessMm = 5;
  given[0].View.Parameters = DefaultParameters({ .ThicknessMm = 50 });
  EXPECT_THAT(RefusalOf([&] { disagreements(100, given); }), HasSubstr("found one of 10 cm3"));
  input.Start[ThicknessParameter] = { 50 };
  EXPECT_THAT(disagreements(100, given), IsEmpty());
  input.Start[ThicknessParameter].clear();
  EXPECT_THAT(refusal(700),
    HasSubstr(
      "m.dcm: expected a picture of the breast in the MRI (700 cm3), found one of 100 cm3"));
  EXPECT_THAT(refusal(45), HasSubstr("of another breast"));
  input.Labels.AcceptUnusual = true;
  EXPECT_EQ(refusal(700), NotRefused);
  input.Labels.AcceptUnusual = false;
  input.Study.reset();
  EXPECT_EQ(refusal(700), NotRefused);
}

/// LPS, voxels of 4 mm: chest wall (2) from `first` to `last` of 100, 12 deep, behind a breast (1)
/// of 100 x 80 x 100 mm in the middle. `turned`: the breast is behind the chest wall.
LabelVolume Body(int first, int last, bool turned = false)
{
  LabelVolume volume;
  volume.Size = { 100, 32, 30 };
  volume.Spacing = { 4, 4, 4 };
  volume.Voxels.assign(100 * 32 * 30, 0);
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const int depth = turned ? 31 - j : j; // from the front on
      if (depth >= 20 && i >= first && i < last)
      {
        volume.Voxels[voxel] = 2;
      }
      else if (depth < 20 && i >= 38 && i < 63 && k >= 2 && k < 27)
      {
        volume.Voxels[voxel] = 1;
      }
    });
  return volume;
}

TEST(CaseChecks, TheBreastLiesInFrontAndIsThatOfItsSide)
{
  RegistrationCase input;
  input.Labels.Path = "labels.nrrd";
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("LPS");
  const std::vector<bool> held{ false, false, true };
  const auto refusal = [&](const LabelVolume& volume, char laterality)
  { return RefusalOf([&] { CheckTissue(input, volume, held, axes, laterality); }); };
  EXPECT_EQ(refusal(Body(30, 70), 'L'), NotRefused);
  EXPECT_THAT(refusal(Body(30, 70, true), 'L'),
    HasSubstr("labels.nrrd: expected the breast in front of what holds it, found it"));
  // The body goes on to the patient's right, lower x: this is the left breast.
  EXPECT_EQ(refusal(Body(0, 70), 'L'), NotRefused);
  EXPECT_EQ(refusal(Body(0, 70), '?'), NotRefused);
  EXPECT_THAT(refusal(Body(0, 70), 'R'),
    HasSubstr("expected the right breast, which the mammogram shows, found the left one"));
  EXPECT_EQ(refusal(Body(30, 100), 'R'), NotRefused);
  EXPECT_THAT(refusal(Body(30, 100), 'L'), HasSubstr("found the right one"));
  const LabelVolume one = Body(0, 100);
  LabelVolume two = one;
  two.ForEachVoxel([&](int i, int j, int k, std::size_t voxel)
    { two.Voxels[voxel] = one.Voxels[one.Index(i < 50 ? i + 30 : i - 30, j, k)]; });
  EXPECT_THAT(refusal(two, 'L'),
    HasSubstr("labels.nrrd: expected one breast, found two side by side; 'mammoray segment' makes "
              "labels of one side; set Crop or AcceptUnusual"));
  LabelVolume large = Body(30, 70);
  large.Spacing = { 20, 20, 20 };
  EXPECT_THAT(refusal(large, 'L'), HasSubstr("expected a breast width from 30 to 300 mm"));
  input.Labels.AcceptUnusual = true;
  EXPECT_EQ(refusal(large, 'R'), NotRefused);
  EXPECT_EQ(refusal(Body(30, 70, true), 'L'), NotRefused);
}
}
