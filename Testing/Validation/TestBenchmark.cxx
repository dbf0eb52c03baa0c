// SPDX-License-Identifier: Apache-2.0
// One coarse study: what a stranger gets is all there, and fits what is true.
#include "Benchmark.h"
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

namespace
{
using namespace mammoray;
using testing::HasSubstr;
namespace fs = std::filesystem;

PlannedStudy CoarseStudy()
{
  PlannedStudy study;
  study.Phantom = "victre-1";
  study.Labels.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
  study.Labels.SpacingMm = 1;
  study.Options.Seed = 7;
  study.Options.FatSuppressed = false;
  study.Options.MriPixelMm = 2;
  study.Options.MriSliceMm = 3;
  study.Options.MammogramPixelMm = 0.5;
  study.Options.AnatomyMm = 8;
  study.Options.GravityFineness = 5;
  study.Options.CompressionFineness = 7;
  return study;
}

TEST(Benchmark, HoldsWhatAnyMethodNeeds)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const test::TemporaryFolder folder;
  const std::string path = folder.File("benchmark");
  const std::vector<BaselineScore> scores = ExportBenchmark({ CoarseStudy() }, path);
  const std::string own = path + "/007-victre-1";

  const StudyTruth truth = ReadStudyTruth(path + "/truth/007-victre-1.json");
  const auto answered = [&](const std::string& file)
  { return ScoreAnswers(truth, ReadStudyAnswers(path + file)); };
  for (const AnswerScore& score : answered("/truth/007-victre-1.csv"))
  {
    // Three digits behind the point of pixels of 0.5 mm.
    EXPECT_LT(Quantile(score.Imaged.OnReceptorMm, 1), 1e-3) << score.View;
    EXPECT_LT(Quantile(score.Imaged.InSpaceMm, 1), 2e-3) << score.View;
    EXPECT_EQ(score.Missing, 0u);
  }

  // The points lie in the MRI's breast, the mammograms are those of the export.
  const IntensityVolume mri = ReadIntensityVolume(own + "/mri-plain.nii.gz");
  EXPECT_FALSE(fs::exists(own + "/mri-fat-suppressed.nii.gz"));
  const LabelVolume labels = ReadLabelVolume(own + "/labels.nii.gz");
  int inside = 0;
  for (const Vector3& point : truth.MriPoints)
  {
    EXPECT_TRUE(mri.ValueAt(point).has_value());
    inside += labels.LabelAt(point) != 0 ? 1 : 0;
  }
  EXPECT_GE(inside, 95); // of 100; the others lie beside what is kept of the body
  EXPECT_EQ(ReadMammogram(own + "/cc.dcm").View, "CC");
  EXPECT_EQ(ReadMammogram(own + "/mlo.dcm").View, "MLO");
  EXPECT_TRUE(fs::is_directory(own + "/export/DICOM"));
  EXPECT_FALSE(fs::exists(own + "/truth.json"));
  EXPECT_THAT(test::ReadFile(own + "/points.csv"), testing::StartsWith("point,x,y,z\n0,"));
  EXPECT_EQ(test::ReadFile(path + "/studies.csv"),
    "study,anatomy,side,sequences,views\n007-victre-1,victre-1,left,plain,CC MLO\n");
  EXPECT_THAT(test::ReadFile(path + "/PROTOCOL.md"), HasSubstr("view,point,column,row"));

  // Each file has its checksum.
  std::istringstream sums(test::ReadFile(path + "/SHA256SUMS"));
  std::size_t count = 0;
  for (std::string line; std::getline(sums, line); ++count)
  {
    EXPECT_EQ(line.substr(0, 64), Sha256OfFile(path + '/' + line.substr(66)));
  }
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(path))
  {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(count + 1, files);

  // By outline alone: no more than two centimetres off, or frames are mixed up.
  ASSERT_EQ(scores.size(), 2u);
  EXPECT_EQ(scores[0].Baseline, "rigid");
  EXPECT_EQ(scores[1].Baseline, "affine");
  for (const BaselineScore& score : scores)
  {
    const std::vector<AnswerScore> read =
      answered("/baselines/007-victre-1-" + score.Baseline + ".csv");
    ASSERT_EQ(read.size(), 2u);
    for (std::size_t view = 0; view < 2; ++view)
    {
      const double median = Quantile(score.Views[view].Imaged.InSpaceMm, 0.5);
      EXPECT_LT(median, 20) << score.Baseline;
      EXPECT_NEAR(Quantile(read[view].Imaged.InSpaceMm, 0.5), median, 2e-3);
      EXPECT_EQ(read[view].Missing, 0u);
    }
  }

  EXPECT_THAT(test::RefusalOf([&] { ExportBenchmark({}, path); }),
    HasSubstr("expected a new or an empty folder, found one with files"));
}
}
