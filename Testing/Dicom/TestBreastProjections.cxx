// SPDX-License-Identifier: Apache-2.0
// Projections of a tomosynthesis: written, read back, and their geometry by the standard's own
// definition of its coordinate systems.
#include "DicomTesting.h"
#include "Files.h"
#include "Private/SourcePlace.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/ProjectionSeries.h"

#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace mammoray;
using mammoray::test::RefusalOf;
using test::DicomTextOf;
using test::ExpectValidDicom;
using test::TemporaryFolder;
using ::testing::HasSubstr;

namespace
{
constexpr double PivotMm = 40;
constexpr double SidMm = 660;

struct Sweep
{
  VolumeFromGantry Gantry;
  std::vector<Vector3> Sources;
  std::vector<Mammogram> Projections;
};

/// Five projections over 50 degrees of a unit at this roll, 7 x 5 pixels; a right breast's are
/// hung turned.
Sweep MakeSweep(double rollDeg, char laterality,
  Mammogram::Intent intent = Mammogram::Intent::ForPresentation)
{
  const AnatomicalAxes axes;
  Sweep sweep;
  sweep.Gantry = PlaceUnit({ axes, { 10, -20, 30 } }, {}, { .RollDeg = rollDeg });
  XRaySource source;
  source.Position = sweep.Gantry.Point({ 0, 0, SidMm });
  XRayDetector detector = DetectorOfUnit(sweep.Gantry, 7, 5, { 0.2, 0.3 });
  if (laterality == 'R')
  {
    detector.Origin = detector.Origin + 6.0 * detector.ColumnStep + 4.0 * detector.RowStep;
    detector.ColumnStep = -1.0 * detector.ColumnStep;
    detector.RowStep = -1.0 * detector.RowStep;
  }
  const AxisLine axis{ sweep.Gantry.Point({ 0, 0, PivotMm }), sweep.Gantry.Y };
  for (const ProjectionView& view : SweepSource(source, detector, axis, 5, 50))
  {
    Mammogram projection = DescribeProjection(view.Source, view.Detector, axes, laterality);
    const DetectorPlane plane(view.Source, view.Detector);
    projection.SourceFootPixel = { plane.FootColumn, plane.FootRow };
    projection.BodyPartThicknessMm = 51;
    std::vector<float> values;
    for (int pixel = 0; pixel < 35; ++pixel)
    {
      values.push_back(
        0.1f * static_cast<float>(pixel) + 0.01f * static_cast<float>(sweep.Sources.size()));
    }
    SetPixels(projection, values, intent);
    sweep.Sources.push_back(view.Source.Position);
    sweep.Projections.push_back(projection);
  }
  return sweep;
}

std::string Written(const Sweep& sweep, const TemporaryFolder& folder)
{
  std::string path = folder.File("sweep.dcm");
  WriteProjections(sweep.Projections, { .Derivation = "Synthetic" }, PivotMm, path);
  return path;
}

/// The file once more, with what `change` makes of its data set.
template <typename Change>
std::string Changed(const std::string& path, const TemporaryFolder& folder, const Change& change)
{
  std::string other = folder.File("changed.dcm");
  test::ChangeDicom(path, other, change);
  return other;
}

/// The data set of a functional group of the second frame.
gdcm::DataSet& GroupOfFrame(gdcm::DataSet& data, const gdcm::Tag& group)
{
  gdcm::SmartPointer<gdcm::SequenceOfItems> frames =
    data.GetDataElement(gdcm::Tag(0x5200, 0x9230)).GetValueAsSQ();
  gdcm::SmartPointer<gdcm::SequenceOfItems> items =
    frames->GetItem(2).GetNestedDataSet().GetDataElement(group).GetValueAsSQ();
  return items->GetItem(1).GetNestedDataSet();
}
}

TEST(BreastProjections, AreReadBackWithWhereTheirSourcesStood)
{
  const TemporaryFolder folder;
  for (const auto& [roll, laterality] :
    { std::pair{ 0.0, 'L' }, { 0.0, 'R' }, { -47.0, 'L' }, { 45.0, 'R' }, { 100.0, 'R' } })
  {
    const Sweep sweep = MakeSweep(roll, laterality);
    const std::string path = Written(sweep, folder);
    ExpectValidDicom(path);
    const std::vector<Mammogram> read = ReadProjections(path);
    ASSERT_EQ(read.size(), 5u);
    for (std::size_t number = 0; number < read.size(); ++number)
    {
      const Mammogram& written = sweep.Projections[number];
      EXPECT_EQ(read[number].Pixels, written.Pixels);
      EXPECT_EQ(read[number].View, written.View);
      EXPECT_EQ(read[number].Laterality, laterality);
      EXPECT_EQ(read[number].RowDirection, written.RowDirection);
      EXPECT_EQ(read[number].ColumnDirection, written.ColumnDirection);
      EXPECT_EQ(read[number].PresentationIntent, written.PresentationIntent);
      EXPECT_EQ(read[number].IntensityRelationship, written.IntensityRelationship);
      EXPECT_EQ(read[number].IntensitySign, written.IntensitySign);
      EXPECT_EQ(read[number].BodyPartThicknessMm, 51);
      EXPECT_NEAR(read[number].ColumnSpacingMm, 0.2, 1e-9);
      EXPECT_NEAR(*read[number].PositionerPrimaryAngleDeg, roll, 1e-7);
      // The distance to the isocenter is of single precision: 3e-5 mm over pixels of 0.2 mm.
      EXPECT_NEAR(*read[number].SourceToDetectorMm, *written.SourceToDetectorMm, 1e-4);
      EXPECT_NEAR((*read[number].SourceFootPixel)[0], (*written.SourceFootPixel)[0], 2e-4);
      EXPECT_NEAR((*read[number].SourceFootPixel)[1], (*written.SourceFootPixel)[1], 2e-4);
    }
    EXPECT_EQ(MiddleProjection(read), 2u);
    EXPECT_EQ(ReadMammogram(path).Pixels, sweep.Projections[2].Pixels);
  }
}

TEST(BreastProjections, StandInTheStandardsIsocenterSystem)
{
  for (const double roll : { 0.0, -47.0, 130.0 })
  {
    const Sweep sweep = MakeSweep(roll, 'L');
    const AnatomicalAxes axes;
    // PS3.3 C.8.31.6: Y from the patient to the gantry, Z up, X by the right-hand rule: LPS has
    // the patient's left at +x, the front at -y.
    const Vector3 x = -1.0 * axes.Left;
    const Vector3 y = axes.Anterior;
    const Vector3 z = axes.Superior;
    ASSERT_NEAR(Norm(Cross(x, y) - z), 0, 1e-12);
    const Vector3 isocenter = sweep.Gantry.Point({ 0, 0, PivotMm });
    for (std::size_t number = 0; number < 5; ++number)
    {
      const SourcePlace place = PlaceSource(sweep.Projections[number], PivotMm);
      EXPECT_NEAR(place.SourceToIsocenterMm, SidMm - PivotMm, 1e-9);
      EXPECT_NEAR(place.SourceSecondaryDeg, 0, 1e-9);
      EXPECT_NEAR(place.DetectorPrimaryDeg, -roll, 1e-9);
      // From +Z towards +X.
      const double angle = place.SourcePrimaryDeg * std::numbers::pi / 180;
      const Vector3 source =
        isocenter + place.SourceToIsocenterMm * (std::cos(angle) * z + std::sin(angle) * x);
      EXPECT_NEAR(Norm(source - sweep.Sources[number]), 0, 1e-9);
      const Vector3 detector =
        isocenter + place.Detector[0] * x + place.Detector[1] * y + place.Detector[2] * z;
      EXPECT_NEAR(Norm(detector - sweep.Gantry.Origin), 0, 1e-9);
    }
    // Steps of 12.5 degrees.
    EXPECT_NEAR(PlaceSource(sweep.Projections[3], PivotMm).SourcePrimaryDeg -
        PlaceSource(sweep.Projections[2], PivotMm).SourcePrimaryDeg,
      12.5, 1e-9);
  }
}

TEST(BreastProjections, AreOfTheirKind)
{
  const TemporaryFolder folder;
  const std::string raw = Written(MakeSweep(0, 'L', Mammogram::Intent::ForProcessing), folder);
  ExpectValidDicom(raw);
  EXPECT_EQ(DicomTextOf(raw, 0x0008, 0x0016), "1.2.840.10008.5.1.4.1.1.13.1.5");
  EXPECT_EQ(DicomTextOf(raw, 0x0028, 0x0008), "5");
  const std::vector<Mammogram> read = ReadProjections(raw);
  EXPECT_EQ(read[1].PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(read[1].IntensityRelationship, Mammogram::Relationship::Linear);
  EXPECT_EQ(read[1].IntensitySign, 1);
  // Of another mammogram itself.
  const std::vector<Mammogram> one =
    ReadProjections(test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FALSE(one.front().SourceFootPixel);
}

TEST(BreastProjections, RefuseWhatDoesNotBelongTogether)
{
  const TemporaryFolder folder;
  const Sweep whole = MakeSweep(0, 'L');
  const auto refused = [&](auto&& change, const std::string& text)
  {
    std::vector<Mammogram> projections = whole.Projections;
    change(projections);
    EXPECT_THAT(
      RefusalOf([&] { WriteProjections(projections, {}, PivotMm, folder.File("sweep.dcm")); }),
      HasSubstr(text));
  };
  using Stack = std::vector<Mammogram>;
  refused([](Stack& stack) { stack.clear(); }, "expected 1 to 999, found 0");
  refused([](Stack& stack) { stack[1].SourceFootPixel.reset(); }, "where the source stood");
  refused([](Stack& stack) { stack[1].Laterality = 'R'; }, "of one size, view and kind");
  refused([](Stack& stack) { stack[4].Pixels[3] = -1; }, "whole numbers");
}

TEST(BreastProjections, DamagedOnesAreRefusedInOneLine)
{
  const TemporaryFolder folder;
  const std::string path = Written(MakeSweep(0, 'L'), folder);
  const gdcm::Tag isocenter(0x0018, 0x9462);
  const auto refused = [&](auto&& change, const std::string& text)
  {
    const std::string changed = Changed(path, folder, change);
    EXPECT_THAT(RefusalOf([&] { ReadProjections(changed); }), HasSubstr(text)) << text;
  };
  refused([&](gdcm::DataSet& data)
    { GroupOfFrame(data, isocenter).Remove(gdcm::Tag(0x0018, 0x9543)); },
    "XRaySourceIsocenterPrimaryAngle (0018,9543)");
  refused([&](gdcm::DataSet& data)
    { GroupOfFrame(data, isocenter).Remove(gdcm::Tag(0x0018, 0x9557)); },
    "DetectorActiveAreaTLHCPosition (0018,9557)");
  refused([&](gdcm::DataSet& data)
    { GroupOfFrame(data, gdcm::Tag(0x0018, 0x9476)).Remove(gdcm::Tag(0x0018, 0x9402)); },
    "DistanceSourceToIsocenter (0018,9402)");
  refused([](gdcm::DataSet& data) { data.Remove(gdcm::Tag(0x5200, 0x9230)); },
    "functional groups for each of 5 frames, found 0");
  refused([](gdcm::DataSet& data) { data.Remove(gdcm::Tag(0x5200, 0x9229)); }, "size of a pixel");
}
