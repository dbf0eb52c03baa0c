// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Evidence/EvidenceCases.h"

#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;

TEST(EvidenceCases, PhantomsAreOfTheProjectAndOfThePublicData)
{
  const std::vector<EvidencePhantom> phantoms = PhantomsOfEvidence("/public", 0.7);
  ASSERT_EQ(phantoms.size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(phantoms[0].Labels.Path));
  EXPECT_EQ(phantoms[1].Labels.Path, "/public/breastphantom-scattered-1001/labels.nrrd");
  for (const EvidencePhantom& phantom : phantoms)
  {
    EXPECT_EQ(phantom.Labels.SpacingMm, 0.7);
    EXPECT_TRUE(phantom.Labels.OnlyCoarsen);
  }
}

TEST(EvidenceCases, TheUnitOfTheLandmarksStandsAsDataSays)
{
  const EvidenceLandmarks landmarks = LandmarksOfEvidence("/nowhere");
  EXPECT_TRUE(std::filesystem::exists(landmarks.Case.Labels.Path));
  EXPECT_TRUE(std::filesystem::exists(landmarks.Case.Mammograms.at(0)));
  EXPECT_EQ(ReadLandmarks(landmarks.Landmarks).size(), 24u);
  EXPECT_EQ(landmarks.CompressedLabels.Path, "");
  EXPECT_EQ(landmarks.Truth.SourceToDetectorMm, 650);
  // Data/README.md: x_g = y - 7.4466, y_g = x - 8.4, z_g = z + 27.3184 mm.
  const Vector3 gantry = landmarks.Truth.Placed.ToGantry({ 10, 20, 30 });
  EXPECT_NEAR(gantry[0], 20 - 7.4466, 1e-12);
  EXPECT_NEAR(gantry[1], 10 - 8.4, 1e-12);
  EXPECT_NEAR(gantry[2], 30 + 27.3184, 1e-12);
}

TEST(EvidenceCases, ForeignMammogramsAreRegisteredToAnotherBreast)
{
  const std::vector<EvidenceMammogram> mammograms = MammogramsOfEvidence("/public");
  ASSERT_EQ(mammograms.size(), 2u);
  EXPECT_NE(mammograms[0].Case.Mammograms, mammograms[1].Case.Mammograms);
  EXPECT_EQ(mammograms[0].Case.Labels.Path, mammograms[1].Case.Labels.Path);
}
