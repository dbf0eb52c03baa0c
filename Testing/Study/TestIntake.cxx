// SPDX-License-Identifier: Apache-2.0
// What is taken of a clinic's export and why, on made-up headers; and on real exports where they
// are.
#include "Files.h"
#include "MadeUpStudy.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/StudyCase.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

using namespace mammoray;
using namespace mammoray::test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

namespace
{
std::string StudyRefusal(const MadeUpStudy& files, std::optional<char> side = {})
{
  return RefusalOf([&] { ChooseForRegistration(ReadStudy(files.Folder()), side).Require(); });
}

void AddViews(MadeUpStudy& files, const std::string& side)
{
  files.Add(MadeUpMammogram(side, "CC"), "MG");
  files.Add(MadeUpMammogram(side, "MLO"), "MG");
}

/// A kind of series: what its header says beside a plain T1's, and what is made of it.
struct SeriesRule
{
  const char* Description;
  std::function<void(MadeUpHeader&)> Change;
  FatSuppression Fat;
  ContrastPhase Contrast;
  /// Begin of the reason to leave it out; empty: it can show the tissue.
  const char* LeftOut;
};

void SpinEcho(MadeUpHeader& header, const char* tr, const char* te)
{
  header.Set(0x18, 0x20, "CS", "SE").Set(0x18, 0x80, "DS", tr).Set(0x18, 0x81, "DS", te);
}

void OfOtherMaker(MadeUpHeader& header)
{
  header.Set(8, 0x70, "LO", "GE MEDICAL SYSTEMS").Set(0x18, 0x22, "CS", "FAST_GEMS");
}

const auto AsItIs = [](MadeUpHeader&) {};
constexpr auto NoFs = FatSuppression::Absent;
constexpr auto Fs = FatSuppression::Present;
constexpr auto UnknownFs = FatSuppression::Unknown;
constexpr auto NotTold = ContrastPhase::Unknown;
constexpr auto Before = ContrastPhase::Before;
constexpr auto After = ContrastPhase::After;

const SeriesRule SeriesRules[] = {
  { "t1_tse_tra", [](MadeUpHeader& h) { SpinEcho(h, "780", "10"); }, NoFs, NotTold, "" },
  { "t1_fl3d_tra", [](MadeUpHeader& h) { h.Set(0x18, 0x22, "CS", "PFP\\SFS"); }, Fs, NotTold, "" },
  { "t1_fl3d_tra_spair_pre", AsItIs, Fs, Before, "" },
  { "Ax T1 FS +C", OfOtherMaker, Fs, After, "" },
  { "Ax VIBRANT 3D", OfOtherMaker, Fs, NotTold, "" },
  { "Ax T1 FSPGR", OfOtherMaker, UnknownFs, NotTold, "" },
  { "Ax T1 non fat sat", OfOtherMaker, NoFs, NotTold, "" },
  { "T1 nativ ohne FS", OfOtherMaker, NoFs, Before, "" },
  { "eTHRIVE dyn", OfOtherMaker, Fs, NotTold, "" },
  { "post1 ax dyn", OfOtherMaker, UnknownFs, After, "" },
  { "ax dyn 2nd pass", OfOtherMaker, UnknownFs, After, "" },
  { "WATER: Ax Flex", OfOtherMaker, Fs, NotTold, "" },
  { "t1_vibe_dixon_tra_W", AsItIs, Fs, NotTold, "" },
  { "t1_vibe_dixon_tra_in", AsItIs, NoFs, NotTold, "" },
  { "t1_vibe_dixon_tra_opp", AsItIs, NoFs, NotTold, "opposed phase" },
  { "t1_vibe_dixon_tra_F", AsItIs, NoFs, NotTold, "fat alone" },
  { "mDIXON", [](MadeUpHeader& h) { h.Set(8, 8, "CS", "DERIVED\\PRIMARY\\W\\W\\DERIVED"); }, Fs,
    NotTold, "" },
  { "t1_sub1", AsItIs, NoFs, NotTold, "subtraction" },
  { "Ph2-Ph1", AsItIs, NoFs, NotTold, "subtraction" },
  { "t1", [](MadeUpHeader& h) { h.Set(8, 8, "CS", "DERIVED\\PRIMARY\\M\\SUBTRACTION"); }, NoFs,
    NotTold, "subtraction" },
  { "t1_fl3d_MIP_SAG", AsItIs, NoFs, NotTold, "projection" },
  { "3 plane loc", AsItIs, NoFs, NotTold, "localizer" },
  { "ep2d_diff_b50_800_ADC", AsItIs, NoFs, NotTold, "diffusion" },
  { "t2_tse_tra", [](MadeUpHeader& h) { SpinEcho(h, "5800", "101"); }, NoFs, NotTold,
    "T2-weighted" },
  { "tirm_tra", [](MadeUpHeader& h) { SpinEcho(h, "4000", "60"); }, Fs, NotTold,
    "inversion recovery" },
  { "pd_tse", [](MadeUpHeader& h) { SpinEcho(h, "3000", "20"); }, NoFs, NotTold, "proton density" },
  { "t1 map", AsItIs, NoFs, NotTold, "map computed" },
  { "t1_fl3d_MPR_cor", AsItIs, NoFs, NotTold, "reformat" },
  { "t1_colour", [](MadeUpHeader& h) { h.Set(0x28, 2, "US", Us(3)).Set(0x28, 0x100, "US", Us(8)); },
    NoFs, NotTold, "screenshot" },
  { "what it is",
    [](MadeUpHeader& h) { h.Remove(0x18, 0x20).Remove(0x18, 0x80).Remove(0x18, 0x81); }, NoFs,
    NotTold, "not known to be T1" },
};
}

TEST(Intake, EachSeriesIsJudgedByItsHeader)
{
  for (const SeriesRule& rule : SeriesRules)
  {
    MadeUpStudy files;
    MadeUpHeader header = MadeUpMr("1.2.5", rule.Description);
    rule.Change(header);
    files.AddSlices(header, 30);
    const Study study = ReadStudy(files.Folder());
    ASSERT_EQ(study.Series.size(), 1u) << rule.Description;
    const StudySeries& series = study.Series.front();
    EXPECT_EQ(series.Fat, rule.Fat) << rule.Description << ": " << series.FatEvidence;
    EXPECT_EQ(series.Contrast, rule.Contrast)
      << rule.Description << ": " << series.ContrastEvidence;
    EXPECT_TRUE(series.LeftOut.starts_with(rule.LeftOut) &&
      series.LeftOut.empty() == std::string(rule.LeftOut).empty())
      << rule.Description << ": " << series.LeftOut;
  }
}

TEST(Intake, TakesPlainAndFatSuppressedBeforeContrastAndBothViews)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.1", "localizer"), 5);
  MadeUpHeader plain = MadeUpMr("1.2.4", "t1_tse_tra");
  SpinEcho(plain, "780", "10");
  files.AddSlices(plain);
  for (const int phase : { 1, 2, 3 })
  {
    MadeUpHeader dynamic = MadeUpMr("1.2." + std::to_string(5 + phase), "t1_fl3d_dyn_spair");
    files.AddSlices(dynamic.Set(8, 0x32, "TM", "10" + std::to_string(10 + phase) + "00"));
  }
  AddViews(files, "L");
  files.Add(MadeUpMammogram("R", "CC"), "MG");
  files.Add(MadeUpMammogram("L", "CC", true), "MG");
  files.Write("DICOM/report.pdf", "%PDF");
  files.Write("DICOM/SR1",
    DicomBytes("1.2.840.10008.5.1.4.1.1.88.33", "1.2.3.999",
      Element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.88.33") + Element(8, 0x60, "CS", "SR")));
  files.Write("DICOMDIR",
    DicomBytes("1.2.840.10008.1.3.10", "1.2.3.998", Element(4, 0x1130, "CS", "EXPORT")));

  const Study study = ReadStudy(files.Folder());
  EXPECT_EQ(study.Series.size(), 5u);
  EXPECT_EQ(study.NotDicom, 1u);
  EXPECT_EQ(study.OtherObjects, 1u);
  EXPECT_EQ(study.Directories, 1u);
  const StudyChoice choice = ChooseForRegistration(study, 'L');
  EXPECT_EQ(choice.Refusal, "");
  ASSERT_TRUE(choice.Plain && choice.FatSuppressed && choice.Cc && choice.Mlo);
  EXPECT_EQ(choice.Plain->Header.SeriesInstanceUid, "1.2.4");
  EXPECT_EQ(choice.FatSuppressed->Header.SeriesInstanceUid, "1.2.6");
  EXPECT_EQ(choice.FatSuppressed->Contrast, ContrastPhase::Before);
  EXPECT_EQ(choice.Position, PatientPosition::Prone);
  EXPECT_EQ(choice.Cc->Header.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(choice.Mlo->Header.BodyPartThicknessMm, 52);
  EXPECT_TRUE(choice.Warnings.empty());
  // Two sides: one must be named.
  EXPECT_THAT(StudyRefusal(files),
    HasSubstr("its side to be named, found left CC, left MLO, right CC"));

  // What it takes is a volume although the folder holds all the others.
  const IntensityVolume volume = ReadIntensitySeries(choice.Plain->Files);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 70, 40, 40 }));
  EXPECT_EQ(volume.Origin, choice.Plain->Grid->Origin);
  EXPECT_THAT(ReadStudy(files.File("DICOMDIR")).Series, testing::SizeIs(5));

  const std::string listing = StudyListing(choice);
  EXPECT_THAT(listing, HasSubstr("before contrast (volume 1 of 3 of one protocol)"));
  EXPECT_THAT(listing, HasSubstr("left out: localizer"));
  EXPECT_THAT(listing, HasSubstr("the other form of the exposure"));
  EXPECT_THAT(listing, Not(HasSubstr("Doe")));
  const auto json = nlohmann::json::parse(StudyJson(choice));
  EXPECT_EQ(json["taken"]["fat_suppressed"], "1.2.6");
  EXPECT_EQ(json["series"].size(), 5u);
}

TEST(Intake, ScanOptionsThatNameFatSuppressionInOneSeriesDenyItInOthers)
{
  MadeUpStudy files;
  MadeUpHeader plain = MadeUpMr("1.2.4", "T1W_TSE").Set(8, 0x70, "LO", "Philips");
  SpinEcho(plain, "600", "10");
  files.AddSlices(plain);
  EXPECT_EQ(ReadStudy(files.Folder()).Series.front().Fat, UnknownFs);
  files.AddSlices(
    MadeUpMr("1.2.5", "T1 3D").Set(8, 0x70, "LO", "Philips").Set(0x18, 0x22, "CS", "FS"));
  AddViews(files, "L");
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  ASSERT_TRUE(choice.Plain && choice.FatSuppressed);
  EXPECT_EQ(choice.Plain->Header.SeriesInstanceUid, "1.2.4");
}

TEST(Intake, WhatSaysNothingOfFatIsTakenBesideWhatDoes)
{
  MadeUpStudy files;
  const auto ofOther = [](const std::string& series, const std::string& description)
  { return MadeUpMr(series, description).Set(8, 0x70, "LO", "Philips").Remove(0x18, 0x22); };
  MadeUpHeader plain = ofOther("1.2.4", "T1W_TSE");
  SpinEcho(plain, "600", "10");
  files.AddSlices(plain);
  files.AddSlices(ofOther("1.2.5", "T1 SPAIR pre"));
  AddViews(files, "L");
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  ASSERT_TRUE(choice.Undetermined && choice.FatSuppressed);
  EXPECT_FALSE(choice.Plain);
  EXPECT_EQ(choice.Undetermined->Header.SeriesInstanceUid, "1.2.4");
  EXPECT_EQ(choice.Mri()->Header.SeriesInstanceUid, "1.2.5");
}

TEST(Intake, TheSeriesWithoutANumberIsBeforeContrast)
{
  for (const auto& [first, second] : { std::pair{ "Ph1/ax 3d dyn fs", "Ph2/ax 3d dyn fs" },
         { "ax 3d dyn fs 1st pass", "ax 3d dyn fs 2nd pass" } })
  {
    MadeUpStudy files;
    for (const auto& [series, description] :
      { std::pair{ "1.2.5", "ax 3d dyn fs" }, { "1.2.6", first }, { "1.2.7", second } })
    {
      files.AddSlices(MadeUpMr(series, description));
    }
    AddViews(files, "L");
    const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
    ASSERT_TRUE(choice.FatSuppressed);
    EXPECT_EQ(choice.FatSuppressed->Header.SeriesInstanceUid, "1.2.5");
    EXPECT_EQ(choice.FatSuppressed->Contrast, ContrastPhase::Before) << first;
    EXPECT_THAT(ReasonsOf(choice.Found.Series), testing::Each(Not(HasSubstr("for certain"))));
    // No times: who reads the listing should know.
    EXPECT_THAT(choice.Warnings, ElementsAre(HasSubstr("by the numbers of series alone")));
  }
}

TEST(Intake, DamagedAndDoubledSlicesAreNamed)
{
  const auto refusal =
    [](const std::function<void(MadeUpStudy&)>& change, std::optional<int> series)
  {
    MadeUpStudy files;
    files.AddSlices(MadeUpMr("1.2.4", "t1"), 40);
    change(files);
    return RefusalOf([&] { ReadMri(files.File("DICOM"), VolumeAxes::Patient, series); });
  };
  const auto cut = [](MadeUpStudy& files)
  {
    const std::string whole = ReadFile(files.File("DICOM/IM20"));
    files.Write("DICOM/IM20", whole.substr(0, whole.size() / 2));
  };
  EXPECT_THAT(refusal(cut, {}),
    AllOf(HasSubstr("DICOM/IM20: expected"), HasSubstr("cut short"), Not(HasSubstr("missing"))));
  EXPECT_THAT(refusal(cut, 1),
    AllOf(HasSubstr("missing slices (1, the first after slice 19"), HasSubstr("; damaged: "),
      HasSubstr("DICOM/IM20: expected")));
  // Without its pixels.
  EXPECT_THAT(refusal(
                [](MadeUpStudy& files)
                {
                  const std::string whole = ReadFile(files.File("DICOM/IM20"));
                  files.Write("DICOM/IM20", whole.substr(0, whole.rfind("\xe0\x7f\x10")));
                },
                {}),
    HasSubstr("DICOM/IM20: expected"));
  for (const std::optional<int> series : { std::optional<int>(), std::optional(1) })
  {
    EXPECT_THAT(
      refusal([](MadeUpStudy& files)
        { files.AddSlices(MadeUpMr("1.2.4", "t1").Set(0x20, 0x13, "IS", "41"), 1, -60 + 3 * 19); },
        series),
      AllOf(HasSubstr("found two at one"), HasSubstr("DICOM/IM20"), HasSubstr("DICOM/IM41")));
  }
}

TEST(Intake, AMammogramWithoutThePixelsSizeNeedsIt)
{
  for (const auto& [spacing, found] :
    { std::pair{ "", "found none: the size of a pixel is not known in " },
      { "0\\0", "found 0 x 0 as Imager Pixel Spacing: the size of a pixel is not known in " } })
  {
    MadeUpStudy files;
    files.AddSlices(MadeUpMr("1.2.4", "t1"), 40);
    files.Add(MadeUpMammogram("L", "CC").Set(0x18, 0x1164, "DS", spacing), "MG");
    Study study = ReadStudy(files.Folder());
    const StudyChoice choice = ChooseForRegistration(study);
    EXPECT_THAT(choice.Refusal, HasSubstr(found));
    EXPECT_THAT(ReasonsOf(choice.Found.Mammograms),
      ElementsAre(testing::EndsWith("whose pixels' size is not known")));
    EXPECT_THAT(RefusalOf([&] { choice.Require(); }), testing::EndsWith("; set PixelSpacingMm"));
    RegistrationCase given;
    given.PixelSpacingMm = 0.1;
    EXPECT_EQ(RefusalOf([&] { TakeStudy(files.Folder(), 'L', given, {}); }), NotRefused);
  }
}

TEST(Intake, AViewThatAHeaderLacksIsTheOneThatIsGiven)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.4", "t1"), 40);
  files.Add(MadeUpMammogram("L", "CC").Remove(0x18, 0x5101), "without");
  files.Add(MadeUpMammogram("L", "MLO"), "with");
  RegistrationCase input;
  TakeStudy(files.Folder(), 'L', input, {});
  EXPECT_THAT(input.Mammograms, ElementsAre(HasSubstr("with")));
  input.MammogramViews = { "CC" };
  TakeStudy(files.Folder(), 'L', input, {});
  EXPECT_THAT(input.Mammograms, ElementsAre(HasSubstr("without"), HasSubstr("with")));
  EXPECT_THAT(input.MammogramViews, ElementsAre("CC", "MLO"));
  EXPECT_THAT(RefusalOf([&] { TakeStudy(files.Folder(), 'L', input, {}); }),
    HasSubstr("expected views of the 1 mammograms"));
}

TEST(Intake, APhaseAfterContrastIsTakenWithAWarning)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.4", "t1_spair pre"), 40);
  files.AddSlices(MadeUpMr("1.2.5", "t1_spair +C"), 40);
  AddViews(files, "L");
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()), 'L', { 2 });
  EXPECT_THAT(choice.Warnings,
    testing::Contains(HasSubstr("although: after contrast (description '+c')")));
  NoteKeeper notes;
  ReadMri(files.File("DICOM"), VolumeAxes::Patient, 1);
  EXPECT_THAT(notes.Lines(), testing::IsEmpty());
  ReadMri(files.File("DICOM"), VolumeAxes::Patient, 2);
  EXPECT_THAT(notes.Lines(), ElementsAre(HasSubstr("although: after contrast")));
}

TEST(Intake, AVolumeOfAMixedFolderIsChosenByItsNumber)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.4", "t1"), 30);
  files.AddSlices(MadeUpMr("1.2.5", "t1_sub"), 40);
  files.AddSlices(MadeUpMr("1.2.6", "t1_spair"), 50);
  AddViews(files, "L");
  const std::string mri = files.File("DICOM");
  const std::string refusal = RefusalOf([&] { ReadMri(mri, VolumeAxes::Patient); });
  EXPECT_THAT(refusal,
    AllOf(HasSubstr("expected one volume, found 3: 1 't1' (30 slices of 70 x 40), 2 't1_sub' (40 "),
      HasSubstr("; set Series")));
  EXPECT_EQ(ReadMri(mri, VolumeAxes::Patient, 3).Size[2], 50);
  EXPECT_THAT(RefusalOf([&] { ReadMri(mri, VolumeAxes::Patient, 4); }),
    HasSubstr("expected a volume from 1 to 3, found 4: 1 't1'"));
  EXPECT_EQ(FatOfMri(mri, 3), FatSuppression::Present);
  EXPECT_EQ(FatOfMri(mri), FatSuppression::Unknown);

  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()), 'L', { 2, 3 });
  ASSERT_TRUE(choice.Plain && choice.FatSuppressed);
  EXPECT_EQ(choice.Plain->Header.SeriesInstanceUid, "1.2.5");
  EXPECT_THAT(ReasonsOf(choice.Found.Series),
    ElementsAre(HasSubstr("another one was asked for"), HasSubstr("taken: asked for"),
      HasSubstr("taken: asked for")));
  EXPECT_THAT(choice.Warnings, ElementsAre(HasSubstr("although: subtraction")));
  EXPECT_EQ(choice.Refusal, "");
  EXPECT_THAT(StudyListing(choice), HasSubstr("\n    2 t1_sub "));
  EXPECT_THAT(RefusalOf(
                [&] {
                  ChooseForRegistration(ReadStudy(files.Folder()), 'L', { 1, 2 });
                }),
    HasSubstr("found 't1' and 't1_sub', of one kind"));
}

TEST(Intake, TheOnlyVolumeBelowAFolderIsRead)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.4", "t1"), 30);
  EXPECT_EQ(ReadMri(files.Folder(), VolumeAxes::Patient).Size[2], 30);
}

TEST(Intake, TextsOfAnyLengthAndKindAreShown)
{
  MadeUpStudy files;
  // A pattern that is looked for in 65,000 letters ends the process.
  files.AddSlices(MadeUpMr("1.2.4", "1+" + std::string(65000, '1')));
  files.AddSlices(MadeUpMr("1.2.5", std::string(30, 'a') + "\xc3\xbc\xc3\xbc\xc3\xbc")
                    .Set(0x20, 0x12, "IS", "1e300"));
  files.Add(MadeUpMammogram("L", "CC").Set(8, 0x20, "DA", "2026\xf0\x31\x32\x35"), "MG");
  const Study study = ReadStudy(files.Folder());
  const StudyChoice choice = ChooseForRegistration(study, 'L');
  std::istringstream listing(StudyListing(choice));
  for (std::string line; std::getline(listing, line);)
  {
    EXPECT_EQ(EscapeControls(line), line);
  }
  EXPECT_THAT(listing.str(), HasSubstr(std::string(30, 'a') + "..."));
}

TEST(Intake, PhasesOfOneSeriesAreToldApart)
{
  for (const bool numbered : { true, false })
  {
    MadeUpStudy files;
    MadeUpHeader dynamic = MadeUpMr("1.2.5", "t1_fl3d_spair");
    for (int slice = 0; slice < 60; ++slice)
    {
      // Without a number the order of the images is all there is.
      const int phase = slice / 20;
      dynamic.Set(0x20, 0x13, "IS", std::to_string(slice + 1));
      if (numbered)
      {
        dynamic.Set(0x20, 0x100, "IS", std::to_string(phase + 1));
      }
      dynamic.Set(0x20, 0x32, "DS", Join({ -175, -100, 4.0 * (slice % 20) }));
      files.Add(dynamic);
    }
    const Study study = ReadStudy(files.Folder());
    ASSERT_EQ(study.Series.size(), 3u) << numbered;
    for (int phase = 0; phase < 3; ++phase)
    {
      const StudySeries& series = study.Series[static_cast<std::size_t>(phase)];
      EXPECT_EQ(series.Phase, phase + 1);
      EXPECT_EQ(series.Files.size(), 20u);
      EXPECT_EQ(series.Contrast, phase == 0 ? Before : After);
      EXPECT_EQ(series.LeftOut, "");
    }
  }
}

TEST(Intake, VolumesThatHoldNoBreastAreLeftOut)
{
  const auto leftOut = [](const MadeUpHeader& header, int count, double gapAfter = 1e9)
  {
    MadeUpStudy files;
    for (int slice = 0; slice < count; ++slice)
    {
      MadeUpHeader placed = header;
      const double height = 3 * slice + (slice > gapAfter ? 3 : 0);
      files.Add(placed.Set(0x20, 0x32, "DS", Join({ -175, -100, height })));
    }
    return ReadStudy(files.Folder()).Series.front().LeftOut;
  };
  const MadeUpHeader good = MadeUpMr("1.2.5", "t1");
  EXPECT_EQ(leftOut(good, 40), "");
  EXPECT_EQ(leftOut(good, 4), "too few slices (4)");
  EXPECT_THAT(leftOut(good, 40, 20), HasSubstr("missing slices"));
  EXPECT_THAT(leftOut(good, 15), HasSubstr("45 mm from head to foot"));
  MadeUpHeader small = good;
  EXPECT_THAT(leftOut(small.SetSize(10, 70), 40), HasSubstr("50 mm from front to back"));
  MadeUpHeader coarse = good;
  EXPECT_THAT(leftOut(coarse.Set(0x28, 0x30, "DS", "8\\8"), 40), HasSubstr("too coarse"));
  MadeUpHeader nowhere = good;
  EXPECT_THAT(leftOut(nowhere.Remove(0x20, 0x37), 40), HasSubstr("no place"));
}

TEST(Intake, OneBreastAlone)
{
  // 100 mm to the patient's right of the middle.
  MadeUpStudy files;
  MadeUpHeader right = MadeUpMr("1.2.5", "t1");
  right.SetSize(40, 25);
  files.AddSlices(right);
  AddViews(files, "L");
  AddViews(files, "R");
  EXPECT_EQ(ReadStudy(files.Folder()).Series.front().Side, 'R');
  EXPECT_THAT(StudyRefusal(files, 'L'), HasSubstr("shows the right breast only"));
  EXPECT_EQ(StudyRefusal(files, 'R'), NotRefused);
}

TEST(Intake, HowThePatientLay)
{
  for (const auto& [code, position] :
    { std::pair{ "HFP", PatientPosition::Prone }, { "FFP", PatientPosition::Prone },
      { "HFS", PatientPosition::Supine }, { "FFS", PatientPosition::Supine } })
  {
    MadeUpStudy files;
    files.AddSlices(MadeUpMr("1.2.5", "t1").Set(0x18, 0x5100, "CS", code));
    AddViews(files, "L");
    EXPECT_EQ(ChooseForRegistration(ReadStudy(files.Folder())).Position, position) << code;
  }
  MadeUpStudy side;
  side.AddSlices(MadeUpMr("1.2.5", "t1").Set(0x18, 0x5100, "CS", "HFDR"));
  AddViews(side, "L");
  EXPECT_THAT(StudyRefusal(side), HasSubstr("found the position HFDR"));
  EXPECT_THAT(StudyRefusal(side), testing::EndsWith("; set ImagePosition"));
  const StudyChoice told =
    ChooseForRegistration(ReadStudy(side.Folder()), {}, {}, PatientPosition::Prone);
  EXPECT_EQ(told.Refusal, "");
  EXPECT_EQ(told.Position, PatientPosition::Prone);
  MadeUpStudy unsaid;
  unsaid.AddSlices(MadeUpMr("1.2.5", "t1").Remove(0x18, 0x5100));
  AddViews(unsaid, "L");
  const StudyChoice choice = ChooseForRegistration(ReadStudy(unsaid.Folder()));
  EXPECT_FALSE(choice.Position);
  EXPECT_THAT(choice.Warnings, ElementsAre(HasSubstr("prone or supine")));
}

TEST(Intake, OtherExaminationsAndPositionsAreNotMixed)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.5", "t1").Set(8, 0x20, "DA", "20240101"));
  files.AddSlices(MadeUpMr("1.2.6", "t1_spair_post").Set(8, 0x20, "DA", "20250101"));
  AddViews(files, "L");
  StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  EXPECT_FALSE(choice.Plain);
  EXPECT_EQ(choice.FatSuppressed->Header.SeriesInstanceUid, "1.2.6");
  EXPECT_THAT(ReasonsOf(choice.Found.Series), testing::Contains(HasSubstr("older examination")));
  EXPECT_THAT(choice.Warnings, ElementsAre(HasSubstr("taken after contrast")));

  // One examination over midnight.
  MadeUpStudy late;
  for (const auto& [uid, date, time] :
    { std::tuple{ "1.2.5", "20231231", "235800" }, { "1.2.6", "20240101", "000100" } })
  {
    late.AddSlices(MadeUpMr(uid, "t1_spair")
                     .Set(8, 0x20, "DA", "20231231")
                     .Set(8, 0x22, "DA", date)
                     .Set(8, 0x32, "TM", time));
  }
  AddViews(late, "L");
  choice = ChooseForRegistration(ReadStudy(late.Folder()));
  EXPECT_EQ(choice.FatSuppressed->Header.SeriesInstanceUid, "1.2.5");

  MadeUpStudy moved;
  moved.AddSlices(MadeUpMr("1.2.5", "t1_pre"));
  moved.AddSlices(MadeUpMr("1.2.6", "t1_spair").Set(0x20, 0x52, "UI", "1.88"));
  AddViews(moved, "L");
  choice = ChooseForRegistration(ReadStudy(moved.Folder()));
  EXPECT_TRUE(choice.Plain);
  EXPECT_FALSE(choice.FatSuppressed);
  EXPECT_THAT(ReasonsOf(choice.Found.Series), testing::Contains(HasSubstr("lay otherwise")));
}

/// What a mammogram's header says beside a CC's, and why it is left out.
struct MammogramRule
{
  const char* Reason;
  std::function<void(MadeUpHeader&)> Change;
};

const MammogramRule MammogramRules[] = {
  { "tomosynthesis",
    [](MadeUpHeader& h) { h.Set(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.13.1.3"); } },
  { "single projection",
    [](MadeUpHeader& h) { h.Set(8, 8, "CS", "ORIGINAL\\PRIMARY\\TOMO_PROJ\\LEFT"); } },
  { "spot compression",
    [](MadeUpHeader& h)
    {
      h.Set(0x54, 0x222, "SQ",
        Sequence(0x54, 0x222, { Element(8, 0x100, "SH", "399055006") }).substr(12));
    } },
  { "magnification", [](MadeUpHeader& h) { h.Set(0x18, 0x1114, "DS", "1.8"); } },
  { "specimen", [](MadeUpHeader& h) { h.Set(8, 0x103e, "LO", "L Specimen"); } },
  { "implant", [](MadeUpHeader& h) { h.Set(0x28, 0x1300, "CS", "YES"); } },
  { "part of a breast", [](MadeUpHeader& h) { h.Set(0x28, 0x1350, "CS", "YES"); } },
  { "contrast mammography",
    [](MadeUpHeader& h) { h.Set(8, 8, "CS", "DERIVED\\PRIMARY\\POST_CONTRAST\\SUBTRACTION"); } },
  { "names no view", [](MadeUpHeader& h) { h.Remove(0x18, 0x5101); } },
  { "modality CR",
    [](MadeUpHeader& h) { h.Set(8, 0x60, "CS", "CR").Set(8, 0x103e, "LO", "Mammo CC"); } },
};

TEST(Intake, EachMammogramIsJudgedByItsHeader)
{
  MadeUpStudy files;
  files.Add(MadeUpMammogram("L", "CC"));
  for (const MammogramRule& rule : MammogramRules)
  {
    MadeUpHeader header = MadeUpMammogram("L", "CC");
    rule.Change(header);
    files.Add(header);
  }
  const Study study = ReadStudy(files.Folder());
  ASSERT_EQ(study.Mammograms.size(), 1 + std::size(MammogramRules));
  for (const StudyMammogram& image : study.Mammograms)
  {
    const auto number = std::stoul(image.Header.Path.substr(image.Header.Path.rfind("IM") + 2));
    const std::string expected = number == 1 ? "" : MammogramRules[number - 2].Reason;
    EXPECT_TRUE(image.LeftOut.find(expected) != std::string::npos &&
      image.LeftOut.empty() == expected.empty())
      << expected << ": " << image.LeftOut;
  }
}

TEST(Intake, TheNewestExposureAndOneOfItsForms)
{
  MadeUpStudy files;
  files.AddSlices(MadeUpMr("1.2.5", "t1"));
  files.Add(MadeUpMammogram("L", "CC").Set(8, 0x20, "DA", "20240101"));     // 41: older
  files.Add(MadeUpMammogram("L", "CC").Set(8, 0x32, "TM", "101500"));       // 42: repeated
  files.Add(MadeUpMammogram("L", "CC").Set(8, 0x32, "TM", "102001.5"));     // 43
  files.Add(MadeUpMammogram("L", "CC", true).Set(8, 0x32, "TM", "102000")); // 44: taken
  files.Add(MadeUpMammogram("L", "CC")
              .Set(8, 8, "CS", "DERIVED\\PRIMARY\\TOMO\\GENERATED_2D")
              .Set(8, 0x32, "TM", "103000")); // 45
  const StudyChoice choice = ChooseForRegistration(ReadStudy(files.Folder()));
  EXPECT_THAT(choice.Cc->Header.Path, testing::EndsWith("IM44"));
  EXPECT_THAT(choice.Warnings, ElementsAre(HasSubstr("no MLO of the left breast")));
  EXPECT_THAT(ReasonsOf(choice.Found.Mammograms),
    ElementsAre(HasSubstr("older"), HasSubstr("older"), HasSubstr("other form"),
      HasSubstr("taken: the newest CC, For Processing"), HasSubstr("tomosynthesis")));
}

TEST(Intake, RefusalsSayWhatThereIs)
{
  const MadeUpHeader mr = MadeUpMr("1.2.5", "t1");
  MadeUpStudy noMri;
  AddViews(noMri, "L");
  EXPECT_THAT(StudyRefusal(noMri), HasSubstr("expected an MRI of the breast, found none"));

  MadeUpStudy subtraction;
  subtraction.AddSlices(MadeUpMr("1.2.5", "t1_sub"));
  AddViews(subtraction, "L");
  EXPECT_THAT(StudyRefusal(subtraction), HasSubstr("found only: subtraction"));

  MadeUpStudy noMammogram;
  noMammogram.AddSlices(mr);
  EXPECT_THAT(StudyRefusal(noMammogram), HasSubstr("expected a mammogram, found none"));
  noMammogram.Add(MadeUpMammogram("R", "MLO"));
  EXPECT_THAT(StudyRefusal(noMammogram, 'L'),
    HasSubstr("expected a CC or MLO mammogram of the left breast, found right MLO"));

  MadeUpStudy unsided;
  unsided.AddSlices(mr);
  unsided.Add(MadeUpMammogram("", "CC"));
  EXPECT_THAT(StudyRefusal(unsided), HasSubstr("side to be named, found unnamed CC"));
  EXPECT_EQ(ChooseForRegistration(ReadStudy(unsided.Folder()), 'R').Cc->Header.Laterality, 'R');

  MadeUpStudy damaged;
  damaged.AddSlices(mr, 30);
  AddViews(damaged, "L");
  MadeUpHeader cut = mr;
  const std::string whole = cut.Set(0x20, 0x32, "DS", Join({ -175, -100, 30 })).Bytes("1.2.3.77");
  damaged.Write("DICOM/CUT", whole.substr(0, whole.size() / 2));
  const StudyChoice choice = ChooseForRegistration(ReadStudy(damaged.Folder()));
  EXPECT_EQ(choice.Refusal, "");
  EXPECT_THAT(choice.Warnings, ElementsAre(AllOf(HasSubstr("DICOM/CUT"), HasSubstr("cut short"))));

  TemporaryFolder other;
  const auto read = [](const std::string& path) { return RefusalOf([&] { ReadStudy(path); }); };
  EXPECT_THAT(read(other.File("nothing")), HasSubstr("found nothing there"));
  EXPECT_THAT(read(other.File("")), HasSubstr("found no file in it"));
  EXPECT_THAT(read(other.Write("export.zip", "PK")), HasSubstr("found a file"));
  EXPECT_THAT(read(other.File("")), HasSubstr("1 packed: unpack first"));
  EXPECT_THROW(ReadStudy(noMri.Folder(), [](double, const char*) { return false; }), Interrupted);
}

TEST(Intake, TwoPatientsAreRefusedWithoutTheirNames)
{
  const auto withOther = [](const std::function<void(MadeUpHeader&)>& change)
  {
    MadeUpStudy files;
    files.AddSlices(MadeUpMr("1.2.5", "t1"));
    MadeUpHeader other = MadeUpMammogram("L", "CC");
    change(other);
    files.Add(other, "second");
    return StudyRefusal(files);
  };
  for (const auto& change : std::vector<std::function<void(MadeUpHeader&)>>{ [](MadeUpHeader& h)
         { h.Set(0x10, 0x20, "LO", "P2").Set(0x10, 0x10, "PN", "Roe^Ann"); },
         [](MadeUpHeader& h) { h.Set(0x10, 0x30, "DA", "19700102"); },
         [](MadeUpHeader& h) { h.Set(0x10, 0x40, "CS", "M"); },
         [](MadeUpHeader& h) { h.Set(0x10, 0x20, "LO", "P2").Set(0x10, 0x30, "DA", ""); } })
  {
    const std::string message = withOther(change);
    EXPECT_THAT(message, HasSubstr("expected the images of one patient, found those of 2: 40 "));
    EXPECT_THAT(message, HasSubstr("first in second"));
    for (const char* secret : { "Doe", "Roe", "P1", "P2", "1970" })
    {
      EXPECT_THAT(message, Not(HasSubstr(secret)));
    }
  }
  // The same woman at two clinics, or by her new name; and anonymised in one of them.
  EXPECT_EQ(withOther([](MadeUpHeader& h) { h.Set(0x10, 0x20, "LO", "P2"); }), NotRefused);
  EXPECT_EQ(withOther([](MadeUpHeader& h) { h.Set(0x10, 0x10, "PN", "Poe^Jane"); }), NotRefused);
  EXPECT_EQ(
    withOther([](MadeUpHeader& h) { h.Remove(0x10, 0x20).Remove(0x10, 0x10).Remove(0x10, 0x30); }),
    NotRefused);
}

TEST(Intake, RealExports)
{
  const std::string folder = SharedDataFolder() + "/uta11-breast-mri-CC-BY-SA-4.0";
  if (!std::filesystem::exists(folder))
  {
    GTEST_SKIP() << "absent: " << folder;
  }
  const StudyChoice choice = ChooseForRegistration(ReadStudy(folder + "/a"));
  EXPECT_THAT(choice.Refusal, HasSubstr("expected a mammogram, found none"));
  ASSERT_TRUE(choice.Plain && choice.FatSuppressed);
  EXPECT_EQ(choice.Plain->Description, "t1_tse_tra_p2");
  EXPECT_EQ(choice.FatSuppressed->Description, "t1_fl3d_tra_dynaVIEWS_spair_1+5");
  EXPECT_EQ(choice.FatSuppressed->Contrast, ContrastPhase::Before);
  EXPECT_EQ(choice.Position, PatientPosition::Prone);
  // Acquisition 2 of 1+5.
  const StudyChoice other = ChooseForRegistration(ReadStudy(folder + "/b"));
  EXPECT_EQ(other.FatSuppressed->Contrast, ContrastPhase::After);
  // One patient in each folder.
  const auto patients = std::ranges::count_if(std::filesystem::directory_iterator(folder),
    [](const std::filesystem::directory_entry& entry) { return entry.is_directory(); });
  EXPECT_THAT(RefusalOf([&] { ReadStudy(folder); }),
    HasSubstr("found those of " + std::to_string(patients) + ": 457 images of patient"));
}
