// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderRules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using testing::HasSubstr;
using testing::StartsWith;

DicomHeader LeftCc()
{
  DicomHeader header;
  header.Modality = "MG";
  header.SopClassUid = "1.2.840.10008.5.1.4.1.1.1.2";
  header.View = "CC";
  header.Laterality = 'L';
  header.SeriesDescription = "L CC";
  return header;
}

StudyMammogram Exposure(const std::string& date, const std::string& time, Mammogram::Intent intent,
  bool synthetic = false)
{
  StudyMammogram mammogram;
  mammogram.Header.View = "CC";
  mammogram.Header.Laterality = 'L';
  mammogram.Header.AcquisitionDate = date;
  mammogram.Header.AcquisitionTime = time;
  mammogram.Header.PresentationIntent = intent;
  mammogram.Synthetic = synthetic;
  return mammogram;
}
constexpr auto Processing = Mammogram::Intent::ForProcessing;
constexpr auto Presentation = Mammogram::Intent::ForPresentation;

TEST(MammogramRules, EachReasonToLeaveOutIsSeen)
{
  EXPECT_EQ(DescribeMammogram(LeftCc()).LeftOut, "");
  const auto leftOut = [](const std::function<void(DicomHeader&)>& change)
  {
    DicomHeader header = LeftCc();
    change(header);
    return DescribeMammogram(header).LeftOut;
  };
  using H = DicomHeader;
  EXPECT_THAT(leftOut([](H& h) { h.Modality = "CR"; }), StartsWith("modality CR"));
  EXPECT_THAT(leftOut([](H& h) { h.SamplesPerPixel = 3; }), StartsWith("screenshot"));
  EXPECT_THAT(leftOut([](H& h) { h.Frames = 50; }), HasSubstr("tomosynthesis (50 frames)"));
  EXPECT_THAT(leftOut([](H& h) { h.ViewModifiers = { "Spot Compression" }; }),
    StartsWith("spot compression view"));
  EXPECT_EQ(leftOut([](H& h) { h.ViewModifiers = { "Nipple in profile" }; }), "");
  EXPECT_THAT(leftOut([](H& h) { h.Magnification = 1.8; }), StartsWith("magnification"));
  // The magnification of the detector's distance is none: 1.0 to 1.1.
  EXPECT_EQ(leftOut([](H& h) { h.Magnification = 1.08; }), "");
  EXPECT_THAT(leftOut([](H& h) { h.PaddleDescription = "Spot 9cm"; }), StartsWith("spot"));
  EXPECT_THAT(leftOut([](H& h) { h.SeriesDescription = "L CC Recombined"; }),
    StartsWith("contrast mammography"));
  EXPECT_THAT(leftOut([](H& h) { h.SeriesDescription = "stereotactic scout"; }),
    StartsWith("specimen or biopsy"));
  EXPECT_THAT(leftOut([](H& h) { h.PartialView = true; }), StartsWith("part of a breast"));
  EXPECT_THAT(leftOut([](H& h) { h.ImplantPresent = true; }), StartsWith("implant"));
  EXPECT_THAT(leftOut([](H& h) { h.View = ""; }), StartsWith("its header names no view"));
}

TEST(MammogramRules, FilmsOfBreastsAreMammogramsAndChestsAreNot)
{
  DicomHeader header;
  header.Modality = "CR";
  header.SeriesDescription = "MAMMOGRAPHIE";
  EXPECT_TRUE(IsMammogram(header));
  header.SeriesDescription = "THORAX";
  EXPECT_FALSE(IsMammogram(header));
  header.ProtocolName = "Mammo";
  EXPECT_TRUE(IsMammogram(header));
  header.Modality = "MR";
  EXPECT_FALSE(IsMammogram(header));
}

TEST(MammogramRules, TheNewestExposureAndItsFormForProcessing)
{
  std::vector<StudyMammogram> mammograms{
    Exposure("20230101", "090000", Processing), // older
    Exposure("20240101", "101502", Presentation),
    Exposure("20240101", "101459.7", Processing),       // 2.3 s apart: one exposure
    Exposure("20240101", "093000", Processing),         // that of the other day's first try
    Exposure("20250101", "101500", Presentation, true), // computed, however new
  };
  EXPECT_EQ(ChooseMammogram(mammograms, 'L', "CC"), 2u);
  EXPECT_THAT(mammograms[0].Reason, HasSubstr("an older exposure"));
  EXPECT_THAT(mammograms[1].Reason, HasSubstr("the other form of the exposure"));
  EXPECT_EQ(mammograms[2].Reason, "taken: the newest CC, For Processing");
  EXPECT_THAT(mammograms[3].Reason, HasSubstr("an older exposure"));
  EXPECT_THAT(mammograms[4].Reason, HasSubstr("computed from tomosynthesis"));
  // Whatever their order in the folder.
  std::vector<StudyMammogram> reversed(mammograms.rbegin(), mammograms.rend());
  EXPECT_EQ(ChooseMammogram(reversed, 'L', "CC"), 2u);
}

TEST(MammogramRules, TakesWhatThereIs)
{
  std::vector<StudyMammogram> mammograms{ Exposure("20240101", "", Presentation, true) };
  EXPECT_EQ(ChooseMammogram(mammograms, 'L', "CC"), 0u);
  EXPECT_THAT(mammograms[0].Reason, HasSubstr("for want of an exposure"));
  EXPECT_FALSE(ChooseMammogram(mammograms, 'R', "CC"));
  EXPECT_FALSE(ChooseMammogram(mammograms, 'L', "MLO"));
  mammograms[0].LeftOut = "implant";
  EXPECT_FALSE(ChooseMammogram(mammograms, 'L', "CC"));
  // Across a minute and an hour.
  std::vector<StudyMammogram> late{ Exposure("20240101", "105959", Processing),
    Exposure("20240101", "110003", Presentation) };
  EXPECT_EQ(ChooseMammogram(late, 'L', "CC"), 0u);
}
}
