// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/HeaderRules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace
{
using namespace mammoray;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A T1-weighted gradient echo of 60 axial slices over 320 x 320 x 120 mm, prone.
StudySeries PlainSeries(const std::string& description = "t1")
{
  StudySeries series;
  DicomHeader& header = series.Header;
  header.SeriesDescription = description;
  header.Manufacturer = "GE MEDICAL SYSTEMS";
  header.Identity.StudyInstanceUid = "1.2";
  header.SeriesDate = "20240101";
  header.SeriesTime = "100000";
  header.ScanningSequence = { "GR" };
  header.RepetitionTimeMs = 5;
  header.EchoTimeMs = 2;
  header.Rows = header.Columns = 320;
  header.Position = Vector3{ -160, -160, 0 };
  header.PatientPosition = "HFP";
  series.Slices.assign(60, { "file" });
  VolumeGrid grid;
  grid.Size = { 320, 320, 60 };
  grid.Spacing = { 1, 1, 2 };
  grid.Origin = { -160, -160, 0 };
  series.Grid = grid;
  return series;
}

StudySeries Described(const std::string& description)
{
  StudySeries series = PlainSeries(description);
  DescribeSeries(series);
  return series;
}

/// What the words of one series alone say of contrast.
ContrastPhase PhaseByWords(const std::string& description)
{
  std::vector<StudySeries> all{ PlainSeries(description) };
  DescribeSeries(all.front());
  CompareSeries(all);
  return all.front().Contrast;
}

TEST(SeriesRules, ContrastIsToldByWordsOfManyTongues)
{
  for (const char* description : { "T1 pre", "T1 pre contrast", "T1 precontrast", "t1_pre_gd",
         "t1 tra pre KM", "T1 nativ", "T1 native", "T1 unenhanced", "t1 w/o contrast",
         "T1 without contrast", "T1 without IV contrast", "T1 wo gad", "T1 non contrast",
         "t1 ohne KM", "t1 ohne Kontrastmittel", "t1 vor KM", "T1 sans injection", "T1 sans gado",
         "T1 sin contraste", "T1 sem contraste", "T1 senza mdc", "T1 basale", "T1 avant injection",
         "T1 ax senza mdc", "T1 prima del mezzo di contrasto", "T1 pre-mdc", "T1 sin civ",
         "T1 antes del contraste", "T1 s/ contraste", "T1 avant injection de gadolinium",
         "AX T1 FS NON INJECTE", "T1 zonder contrast", "T1 voor gadolinium", "T1 SPAIR blanco",
         "T1 KM-frei", "T1FSpre", "T1 before contrast injection", "T1 prior to contrast",
         "T1 no contrast", "T1 non-enhanced" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::Before) << description;
  }
  for (const char* description :
    { "T1 post", "T1 post contrast", "T1 postgad", "T1 +C", "T1 C+", "T1 with contrast",
      "t1 nach KM", "t1 mit KM", "t1 KM", "t1 nach Kontrastmittel", "T1 avec injection",
      "T1 con contraste", "T1 com contraste", "T1 delayed", "T1 late", "T1 tardif", "T1 Gadovist",
      "T1 2nd pass", "T1 3D FS assiale dopo mdc", "T1 dopo gadolinio", "T1 con mdc", "T1 mdc",
      "T1 dopo mezzo di contrasto", "T1 AX FATSAT POS CONTRASTE", "T1 p\xc3\xb3s-contraste",
      "T1 P\xd3S CONTRASTE", "T1 ap\xc3\xb3s contraste", "T1 c/ contraste",
      "T1 despu\xc3\xa9s de gadolinio", "T1 tras contraste", "T1 con CIV", "T1 contrastado",
      "AX T1 FS INJECTE 2", "T1 apr\xc3\xa8s gado", "T1 nach Gabe KM", "t1 nach Kontrast",
      "T1 post-op +C", "T1 pre-op post gad", "T1 post THRIVE", "T1 post 2", "T1 post RT",
      "T1FSpostGd", "T1 ax SPAIR na contrast", "T1 na gadolinium", "T1 met contrast", "T1 na gd",
      // In UTF-8 and in Latin 1, both cases.
      "T1 apr\xc3\xa8s injection", "T1 APR\xc3\x88S INJECTION", "T1 apr\xe8s inj",
      "T1 apres injection", "t1 sp\xc3\xa4t", "t1 SP\xc3\x84T", "t1 sp\xe4tphase", "t1 spaet" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::After) << description;
  }
  for (const char* description :
    { "T1", "t1 tra", "t1_fl3d_tra_spair", "T1 spatial sat", "T1 pre and post", "T1 spread",
      "T1 W/WO CONTRAST", "T1 W WO CONTRAST", "T1 with and without contrast", "t1 ohne und mit KM",
      // Something else than contrast is before or after.
      "T1 post-op", "T1 POSTOP", "T1 postoperative", "T1 post op sag", "T1 post biopsy",
      "T1 post-chemo", "T1 post NAC", "T1 posterior", "T1 post-radiotherapy", "T1 postoperativ",
      "T1 post-quir\xc3\xbargico", "T1 post intervento", "T1 pre-op", "T1 preop", "T1 pre chemo",
      "T1 prechemo" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::Unknown) << description;
  }
}

TEST(SeriesRules, CountedPhasesAreBeforeUpToTheCount)
{
  std::vector<StudySeries> all;
  for (int acquisition = 1; acquisition <= 4; ++acquisition)
  {
    StudySeries series = PlainSeries("dyn 1+3");
    series.Header.AcquisitionNumber = acquisition;
    all.push_back(series);
  }
  CompareSeries(all);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Before);
  for (std::size_t phase = 1; phase < 4; ++phase)
  {
    EXPECT_EQ(all[phase].Contrast, ContrastPhase::After);
  }
}

TEST(SeriesRules, VolumesOfOneProtocolAndWhatFollowsThem)
{
  std::vector<StudySeries> all{ PlainSeries("t1 tra"), PlainSeries("dyn 1"), PlainSeries("dyn 2"),
    PlainSeries("t1 cor"), PlainSeries("t1 old") };
  all[4].Header.Identity.StudyInstanceUid = "1.3";
  for (StudySeries& series : all)
  {
    DescribeSeries(series);
  }
  CompareSeries(all);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(all[1].Contrast, ContrastPhase::Before);
  EXPECT_EQ(all[2].Contrast, ContrastPhase::After);
  EXPECT_EQ(all[3].Contrast, ContrastPhase::After);   // taken after one with contrast
  EXPECT_EQ(all[4].Contrast, ContrastPhase::Unknown); // another examination
}

/// Series of these descriptions one after the other, a minute apart or without times.
std::vector<StudySeries> InOrder(const std::vector<std::string>& descriptions, bool timed = true)
{
  std::vector<StudySeries> all;
  for (const std::string& description : descriptions)
  {
    StudySeries series = PlainSeries(description);
    series.Header.SeriesTime = timed ? std::to_string(100000 + 100 * all.size()) : "";
    DescribeSeries(series);
    all.push_back(series);
  }
  return all;
}

TEST(SeriesRules, WhatCountsFromOneFollowsWhatDoesNotCount)
{
  for (const auto& names : std::vector<std::vector<std::string>>{
         { "ax 3d dyn", "Ph1/ax 3d dyn", "Ph2/ax 3d dyn", "Ph3/ax 3d dyn" },
         { "ax 3d dyn", "Ph1/ax 3d dyn" }, { "t1_fl3d_dyn", "t1_fl3d_dyn_1", "t1_fl3d_dyn_2" },
         { "AX DYN", "AX DYN phase 1", "AX DYN phase 2" }, { "dyn", "dyn 1/4", "dyn 2/4" },
         { "pre ax dyn", "Ph1/ax dyn", "Ph2/ax dyn" }, { "ax dyn pre", "ax dyn", "ax dyn" },
         { "Sag Vibrant", "P1 Sag Vibrant", "P2 Sag Vibrant", "P3 Sag Vibrant" } })
  {
    std::vector<StudySeries> all = InOrder(names);
    // Scanners adapt the repetition time.
    *all.back().Header.RepetitionTimeMs *= 1.01;
    CompareSeries(all);
    EXPECT_EQ(all[0].Contrast, ContrastPhase::Before) << names[1];
    EXPECT_FALSE(all[0].ContrastByOrder) << names[1];
    for (std::size_t phase = 1; phase < all.size(); ++phase)
    {
      EXPECT_EQ(all[phase].Contrast, ContrastPhase::After) << names[phase];
    }
    all = InOrder(names, false);
    CompareSeries(all);
    EXPECT_EQ(all[0].ContrastByOrder, !names[0].starts_with("pre") && !names[0].ends_with("pre"));
  }
}

TEST(SeriesRules, WhatIsOfAnotherProtocolDoesNotCount)
{
  // Numbers from 0, an earlier series of other slices, and the other breast.
  std::vector<StudySeries> zero = InOrder({ "ax dyn", "ax dyn 0", "ax dyn 1" });
  CompareSeries(zero);
  EXPECT_EQ(zero[1].Contrast, ContrastPhase::Before);
  std::vector<StudySeries> finer = InOrder({ "ax dyn", "Ph1/ax dyn", "Ph2/ax dyn" });
  finer[0].Slices.resize(50);
  CompareSeries(finer);
  EXPECT_EQ(finer[0].Contrast, ContrastPhase::Unknown);
  EXPECT_TRUE(finer[1].ContrastByOrder);
  std::vector<StudySeries> sides = InOrder({ "sag t1", "sag t1" });
  sides[0].Side = 'L';
  sides[1].Side = 'R';
  CompareSeries(sides);
  EXPECT_EQ(sides[0].Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(sides[1].Contrast, ContrastPhase::Unknown);
}

TEST(SeriesRules, OrderAloneMakesNothingCertain)
{
  const std::vector<std::string> names{ "dyn 1", "dyn 2", "dyn 3" };
  std::vector<StudySeries> all = InOrder(names);
  CompareSeries(all);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Before);
  EXPECT_TRUE(all[0].ContrastByOrder);

  all = InOrder(names);
  all[1].Header.ContrastAgent = all[2].Header.ContrastAgent = "Gadovist";
  CompareSeries(all);
  EXPECT_FALSE(all[0].ContrastByOrder);

  all = InOrder({ "dyn 1", "dyn 2", "dyn 3", "dyn 3 - dyn 1" });
  CompareSeries(all);
  EXPECT_FALSE(all[0].ContrastByOrder);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Before);

  all = InOrder(names);
  for (StudySeries& series : all)
  {
    series.Header.AcquisitionTime = series.Header.SeriesTime;
    series.Header.ContrastStartTime = "100150";
  }
  CompareSeries(all);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Before);
  EXPECT_EQ(all[1].Contrast, ContrastPhase::Before); // began before the injection
  EXPECT_EQ(all[2].Contrast, ContrastPhase::After);
  EXPECT_FALSE(all[1].ContrastByOrder);
  // A time that is not of this examination tells nothing.
  all = InOrder(names);
  all[0].Header.AcquisitionTime = "100000";
  all[0].Header.ContrastStartTime = "235959";
  CompareSeries(all);
  EXPECT_TRUE(all[0].ContrastByOrder);
}

TEST(SeriesRules, CopiesOfAnImageAreNoPhases)
{
  std::vector<StudySeries> all = InOrder({ "t1 fs", "t1 fs" });
  all[0].Header.ImageType = { "ORIGINAL", "PRIMARY", "M", "ND" };
  all[1].Header.ImageType = { "ORIGINAL", "PRIMARY", "M", "DIS2D" };
  CompareSeries(all);
  EXPECT_EQ(all[0].Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(all[1].Contrast, ContrastPhase::Unknown);
}

TEST(SeriesRules, AnInjectionBeforeWhatSaysPreIsTold)
{
  std::vector<StudySeries> all = InOrder({ "t1 loc", "t1 pre", "t1 post" });
  for (StudySeries& series : all)
  {
    series.Header.AcquisitionTime = series.Header.SeriesTime;
    series.Header.ContrastStartTime = "100050";
  }
  CompareSeries(all);
  EXPECT_EQ(all[1].Contrast, ContrastPhase::Before);
  EXPECT_EQ(all[1].ContrastEvidence,
    "description 'pre', though its header has the injection before it");
}

TEST(SeriesRules, SeriesOfOneCountGoByTheirOrder)
{
  // Each a series of its own, without a number or each of acquisition 1.
  for (const std::optional<double> number : { std::optional<double>(), std::optional<double>(1) })
  {
    for (const auto& [name, before] :
      { std::pair{ "t1_fl3d_tra_dyn_spair_1+5", 1U }, { "dyn_2+4", 2U } })
    {
      std::vector<StudySeries> all = InOrder(std::vector<std::string>(6, name));
      for (StudySeries& series : all)
      {
        series.Header.AcquisitionNumber = number;
      }
      CompareSeries(all);
      for (std::size_t index = 0; index < 6; ++index)
      {
        EXPECT_EQ(all[index].Contrast,
          index < before ? ContrastPhase::Before : ContrastPhase::After)
          << name << ' ' << index;
        EXPECT_EQ(all[index].ContrastByOrder, index < before) << name << ' ' << index;
      }
    }
  }
  // One alone may be any of the six.
  EXPECT_EQ(PhaseByWords("dyn 1+5"), ContrastPhase::Unknown);
}

TEST(SeriesRules, AnAgentTellsWhereNotAllHeadersNameIt)
{
  std::vector<StudySeries> some{ PlainSeries("a"), PlainSeries("b"), PlainSeries("c") };
  some[1].Header.ContrastAgent = "Gadovist 7 ml";
  some[2].Header.ContrastAgent = "NO";
  some[2].Header.SeriesTime = "090000";
  std::vector<StudySeries> all = some;
  all[0].Header.ContrastAgent = all[2].Header.ContrastAgent = "Gadovist 7 ml";
  CompareSeries(some);
  EXPECT_EQ(some[0].Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(some[1].Contrast, ContrastPhase::After);
  CompareSeries(all);
  EXPECT_EQ(all[1].Contrast, ContrastPhase::Unknown); // named in every header
}

TEST(SeriesRules, LocalizersAndLateWordsInAnyEncoding)
{
  for (const char* description : { "Localizer", "3-plane loc", "Scout", "survey_BH", "reperage",
         "rep\xc3\xa9rage", "REP\xc3\x89RAGE", "rep\xe9rage" })
  {
    EXPECT_THAT(Described(description).LeftOut, StartsWith("localizer")) << description;
  }
}

TEST(SeriesRules, WeightingGoesByNumbersBeforeWords)
{
  StudySeries series = PlainSeries("breast");
  DicomHeader& header = series.Header;
  const auto leftOut = [&](const char* sequence, double tr, double te)
  {
    header.ScanningSequence = { sequence };
    header.RepetitionTimeMs = tr;
    header.EchoTimeMs = te;
    series.LeftOut.clear();
    DescribeSeries(series);
    return series.LeftOut;
  };
  EXPECT_THAT(leftOut("SE", 600, 12), IsEmpty());
  EXPECT_THAT(leftOut("SE", 4000, 90), StartsWith("T2-weighted (TR 4000 TE 90 ms)"));
  EXPECT_THAT(leftOut("SE", 3000, 20), StartsWith("proton density"));
  EXPECT_THAT(leftOut("GR", 5, 2.4), IsEmpty());
  EXPECT_THAT(leftOut("GR", 500, 25), StartsWith("T2-weighted"));
  EXPECT_THAT(leftOut("EP", 4000, 60), StartsWith("diffusion"));
  header.InversionTimeMs = 160;
  EXPECT_THAT(leftOut("IR", 4500, 40), StartsWith("inversion recovery (inversion time of fat)"));
}

TEST(SeriesRules, FatSuppressionByOptionsThenByWords)
{
  StudySeries series = PlainSeries("t1 non fat sat");
  DescribeSeries(series);
  EXPECT_EQ(series.Fat, FatSuppression::Absent);
  series.Header.ScanOptions = { "PFP", "FS" };
  series.Header.HasScanOptions = true;
  DescribeSeries(series);
  EXPECT_EQ(series.Fat, FatSuppression::Present); // what the scanner did
  EXPECT_EQ(series.FatEvidence, "ScanOptions FS");
  // Beside such a series of the same examination, options without it deny it.
  StudySeries silent = PlainSeries("t1");
  silent.Header.HasScanOptions = true;
  StudySeries other = silent;
  other.Header.Identity.StudyInstanceUid = "1.3";
  StudySeries without = silent;
  without.Header.HasScanOptions = false;
  std::vector<StudySeries> all{ series, silent, other, without };
  for (StudySeries& each : all)
  {
    DescribeSeries(each);
  }
  CompareSeries(all);
  EXPECT_EQ(all[1].Fat, FatSuppression::Absent);
  EXPECT_EQ(all[2].Fat, FatSuppression::Unknown);
  EXPECT_EQ(all[3].Fat, FatSuppression::Unknown);
}

TEST(SeriesRules, SideAndPlaneComeFromTheGrid)
{
  StudySeries series = PlainSeries();
  DescribeSeries(series);
  EXPECT_EQ(series.Side, 'B');
  EXPECT_EQ(series.Plane, "axial");
  EXPECT_EQ(series.Position, PatientPosition::Prone);
  // Sagittal slices of one breast: 150 mm from left to right, the middle 100 mm to the left.
  series.Header.AlongRow = { 0, 1, 0 };
  series.Header.AlongColumn = { 0, 0, -1 };
  series.Header.PatientPosition = "FFS";
  VolumeGrid& grid = *series.Grid;
  grid.Size = { 200, 200, 50 };
  grid.Spacing = { 1, 1, 3 };
  grid.Direction = { { { 0, 1, 0 }, { 0, 0, -1 }, { -1, 0, 0 } } };
  grid.Origin = { 173.5, -100, 100 };
  DescribeSeries(series);
  EXPECT_EQ(series.Side, 'L');
  EXPECT_EQ(series.Plane, "sagittal");
  EXPECT_EQ(series.Position, PatientPosition::Supine);
  grid.Origin[0] = -26.5;
  DescribeSeries(series);
  EXPECT_EQ(series.Side, 'R');
  grid.Origin[0] = 73.5 + 20; // 20 mm beside the middle
  DescribeSeries(series);
  EXPECT_EQ(series.Side, '?');
}

TEST(SeriesRules, VolumesOfNoBreastSayWhy)
{
  const auto leftOut = [](const std::function<void(StudySeries&)>& change)
  {
    StudySeries series = PlainSeries();
    change(series);
    DescribeSeries(series);
    return series.LeftOut;
  };
  using S = StudySeries;
  EXPECT_THAT(leftOut([](S&) {}), IsEmpty());
  EXPECT_THAT(leftOut([](S& s) { s.Slices.resize(FewestSlicesOfBreast - 1); }),
    HasSubstr("too few slices (11)"));
  EXPECT_THAT(leftOut([](S& s) { s.Grid.reset(); }), HasSubstr("missing slices"));
  EXPECT_THAT(leftOut([](S& s) { s.Grid->Spacing[2] = 6.5; }),
    HasSubstr("voxels of 6.5 mm, at most 6"));
  EXPECT_THAT(leftOut([](S& s) { s.Grid->Size[2] = 30; }), HasSubstr("60 mm from head to foot"));
  EXPECT_THAT(leftOut([](S& s) { s.Header.Position.reset(); }),
    HasSubstr("no place in the patient"));
}

TEST(SeriesRules, MomentsSortAsTheyPassed)
{
  DicomHeader header;
  EXPECT_EQ(MomentOf(header), "");
  header.Identity.StudyDate = "20240102";
  header.SeriesTime = "101112";
  EXPECT_EQ(MomentOf(header), "20240102 101112");
  header.SeriesDate = "20240103";
  header.AcquisitionTime = "101110.5";
  EXPECT_EQ(MomentOf(header), "20240102 101110.5"); // of the acquisition or the study
  header.AcquisitionDate = "20240104";
  EXPECT_EQ(MomentOf(header), "20240104 101110.5");
}
}
