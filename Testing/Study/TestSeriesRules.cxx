// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Private/SeriesRules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A T1-weighted gradient echo of 60 axial slices over 320 x 320 x 120 mm, prone.
SeriesCandidate PlainCandidate(const std::string& description = "t1")
{
  SeriesCandidate candidate;
  DicomHeader& header = candidate.First;
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
  candidate.Series.Slices.assign(60, { "file" });
  VolumeGrid grid;
  grid.Size = { 320, 320, 60 };
  grid.Spacing = { 1, 1, 2 };
  grid.Origin = { -160, -160, 0 };
  candidate.Series.Grid = grid;
  return candidate;
}

StudySeries Described(const std::string& description)
{
  SeriesCandidate candidate = PlainCandidate(description);
  DescribeSeries(candidate);
  return candidate.Series;
}

/// What the words of one series alone say of contrast.
ContrastPhase PhaseByWords(const std::string& description)
{
  std::vector<SeriesCandidate> candidates{ PlainCandidate(description) };
  DescribeSeries(candidates.front());
  FindContrastPhases(candidates);
  return candidates.front().Series.Contrast;
}

TEST(SeriesRules, ContrastIsToldByWordsOfManyTongues)
{
  for (const char* description :
    { "T1 pre", "T1 pre contrast", "T1 precontrast", "t1_pre_gd", "t1 tra pre KM", "T1 nativ",
      "T1 native", "T1 unenhanced", "t1 w/o contrast", "T1 without contrast",
      "T1 without IV contrast", "T1 wo gad", "T1 non contrast", "t1 ohne KM",
      "t1 ohne Kontrastmittel", "t1 vor KM", "T1 sans injection", "T1 sans gado",
      "T1 sin contraste", "T1 sem contraste", "T1 senza mdc", "T1 basale", "T1 avant injection" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::Before) << description;
  }
  for (const char* description : { "T1 post", "T1 post contrast", "T1 postgad", "T1 +C", "T1 C+",
         "T1 with contrast", "t1 nach KM", "t1 mit KM", "t1 KM", "t1 nach Kontrastmittel",
         "T1 avec injection", "T1 con contraste", "T1 com contraste", "T1 delayed", "T1 late",
         "T1 tardif", "T1 Gadovist", "T1 2nd pass",
         // In UTF-8 and in Latin 1, both cases.
         "T1 apr\xc3\xa8s injection", "T1 APR\xc3\x88S INJECTION", "T1 apr\xe8s inj",
         "T1 apres injection", "t1 sp\xc3\xa4t", "t1 SP\xc3\x84T", "t1 sp\xe4tphase", "t1 spaet" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::After) << description;
  }
  for (const char* description :
    { "T1", "t1 tra", "t1_fl3d_tra_spair", "T1 spatial sat", "T1 pre and post", "T1 spread" })
  {
    EXPECT_EQ(PhaseByWords(description), ContrastPhase::Unknown) << description;
  }
}

TEST(SeriesRules, CountedPhasesAreBeforeUpToTheCount)
{
  std::vector<SeriesCandidate> candidates;
  for (int acquisition = 1; acquisition <= 4; ++acquisition)
  {
    SeriesCandidate candidate = PlainCandidate("dyn 1+3");
    candidate.First.AcquisitionNumber = acquisition;
    candidates.push_back(candidate);
  }
  FindContrastPhases(candidates);
  EXPECT_EQ(candidates[0].Series.Contrast, ContrastPhase::Before);
  for (std::size_t phase = 1; phase < 4; ++phase)
  {
    EXPECT_EQ(candidates[phase].Series.Contrast, ContrastPhase::After);
  }
}

TEST(SeriesRules, VolumesOfOneProtocolAndWhatFollowsThem)
{
  std::vector<SeriesCandidate> candidates{ PlainCandidate("t1 tra"), PlainCandidate("dyn 1"),
    PlainCandidate("dyn 2"), PlainCandidate("t1 cor"), PlainCandidate("t1 old") };
  candidates[4].First.Identity.StudyInstanceUid = "1.3";
  for (SeriesCandidate& candidate : candidates)
  {
    DescribeSeries(candidate);
  }
  FindContrastPhases(candidates);
  EXPECT_EQ(candidates[0].Series.Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(candidates[1].Series.Contrast, ContrastPhase::Before);
  EXPECT_EQ(candidates[2].Series.Contrast, ContrastPhase::After);
  EXPECT_EQ(candidates[3].Series.Contrast, ContrastPhase::After);   // taken after one with contrast
  EXPECT_EQ(candidates[4].Series.Contrast, ContrastPhase::Unknown); // another examination
}

TEST(SeriesRules, AnAgentTellsWhereNotAllHeadersNameIt)
{
  std::vector<SeriesCandidate> candidates{ PlainCandidate("a"), PlainCandidate("b"),
    PlainCandidate("c") };
  candidates[1].First.ContrastAgent = "Gadovist 7 ml";
  candidates[2].First.ContrastAgent = "NO";
  candidates[2].First.SeriesTime = "090000";
  std::vector<SeriesCandidate> all = candidates;
  all[0].First.ContrastAgent = all[2].First.ContrastAgent = "Gadovist 7 ml";
  FindContrastPhases(candidates);
  EXPECT_EQ(candidates[0].Series.Contrast, ContrastPhase::Unknown);
  EXPECT_EQ(candidates[1].Series.Contrast, ContrastPhase::After);
  FindContrastPhases(all);
  EXPECT_EQ(all[1].Series.Contrast, ContrastPhase::Unknown); // named in every header
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
  SeriesCandidate candidate = PlainCandidate("breast");
  DicomHeader& header = candidate.First;
  const auto leftOut = [&](const char* sequence, double tr, double te)
  {
    header.ScanningSequence = { sequence };
    header.RepetitionTimeMs = tr;
    header.EchoTimeMs = te;
    candidate.Series.LeftOut.clear();
    DescribeSeries(candidate);
    return candidate.Series.LeftOut;
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
  SeriesCandidate candidate = PlainCandidate("t1 non fat sat");
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Fat, FatSuppression::Absent);
  candidate.First.ScanOptions = { "PFP", "FS" };
  candidate.First.HasScanOptions = true;
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Fat, FatSuppression::Present); // what the scanner did
  EXPECT_EQ(candidate.Series.FatEvidence, "ScanOptions FS");
  // Beside such a series of the same examination, options without it deny it.
  SeriesCandidate silent = PlainCandidate("t1");
  silent.First.HasScanOptions = true;
  SeriesCandidate other = silent;
  other.First.Identity.StudyInstanceUid = "1.3";
  SeriesCandidate without = silent;
  without.First.HasScanOptions = false;
  std::vector<SeriesCandidate> candidates{ candidate, silent, other, without };
  for (SeriesCandidate& each : candidates)
  {
    DescribeSeries(each);
  }
  CompareScanOptions(candidates);
  EXPECT_EQ(candidates[1].Series.Fat, FatSuppression::Absent);
  EXPECT_EQ(candidates[2].Series.Fat, FatSuppression::Unknown);
  EXPECT_EQ(candidates[3].Series.Fat, FatSuppression::Unknown);
}

TEST(SeriesRules, SideAndPlaneComeFromTheGrid)
{
  SeriesCandidate candidate = PlainCandidate();
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Side, 'B');
  EXPECT_EQ(candidate.Series.Plane, "axial");
  EXPECT_EQ(candidate.Series.Position, PatientPosition::Prone);
  // Sagittal slices of one breast: 150 mm from left to right, the middle 100 mm to the left.
  candidate.First.AlongRow = { 0, 1, 0 };
  candidate.First.AlongColumn = { 0, 0, -1 };
  candidate.First.PatientPosition = "FFS";
  VolumeGrid& grid = *candidate.Series.Grid;
  grid.Size = { 200, 200, 50 };
  grid.Spacing = { 1, 1, 3 };
  grid.Direction = { { { 0, 1, 0 }, { 0, 0, -1 }, { -1, 0, 0 } } };
  grid.Origin = { 173.5, -100, 100 };
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Side, 'L');
  EXPECT_EQ(candidate.Series.Plane, "sagittal");
  EXPECT_EQ(candidate.Series.Position, PatientPosition::Supine);
  grid.Origin[0] = -26.5;
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Side, 'R');
  grid.Origin[0] = 73.5 + 20; // 20 mm beside the middle
  DescribeSeries(candidate);
  EXPECT_EQ(candidate.Series.Side, '?');
}

TEST(SeriesRules, VolumesOfNoBreastSayWhy)
{
  EXPECT_THAT(WhyNoBreastVolume(PlainCandidate()), IsEmpty());
  SeriesCandidate few = PlainCandidate();
  few.Series.Slices.resize(FewestSlicesOfBreast - 1);
  EXPECT_THAT(WhyNoBreastVolume(few), HasSubstr("too few slices (11)"));
  SeriesCandidate irregular = PlainCandidate();
  irregular.Series.Grid.reset();
  EXPECT_THAT(WhyNoBreastVolume(irregular), HasSubstr("missing slices"));
  SeriesCandidate coarse = PlainCandidate();
  coarse.Series.Grid->Spacing[2] = 6.5;
  EXPECT_THAT(WhyNoBreastVolume(coarse), HasSubstr("voxels of 6.5 mm, at most 6"));
  SeriesCandidate small = PlainCandidate();
  small.Series.Grid->Size[2] = 30;
  EXPECT_THAT(WhyNoBreastVolume(small), HasSubstr("60 mm from head to foot"));
  SeriesCandidate nowhere = PlainCandidate();
  nowhere.First.Position.reset();
  EXPECT_THAT(WhyNoBreastVolume(nowhere), HasSubstr("no place in the patient"));
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
