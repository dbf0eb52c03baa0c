// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "ValidationCases.h"

#include <gtest/gtest.h>

#include <filesystem>

using namespace mammoray;

TEST(ValidationCases, PhantomsAreOfTheProjectAndOfThePublicData)
{
  const std::vector<Phantom> phantoms = ValidationPhantoms("/public", 0.7);
  ASSERT_EQ(phantoms.size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(phantoms[0].Labels.Path));
  EXPECT_EQ(phantoms[1].Labels.Path, "/public/breastphantom-scattered-1001/labels.nrrd");
  for (const Phantom& phantom : phantoms)
  {
    EXPECT_EQ(phantom.Labels.SpacingMm, 0.7);
    EXPECT_TRUE(phantom.Labels.OnlyCoarsen);
  }
}

TEST(ValidationCases, TheUnitOfTheLandmarksStandsAsDataSays)
{
  const std::vector<LandmarkCase> cases = ValidationLandmarks("/nowhere");
  ASSERT_EQ(cases.size(), 3u);
  const LandmarkCase& landmarks = cases[0];
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

TEST(ValidationCases, AnotherProgramsCompressionIsSoughtWithTrueAndWrongStiffness)
{
  const std::vector<LandmarkCase> cases = ValidationLandmarks("/nowhere");
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_TRUE(std::filesystem::exists(cases[1].Case.Labels.Path));
  EXPECT_TRUE(std::filesystem::exists(cases[1].Case.Mammograms.at(0)));
  EXPECT_EQ(cases[1].Case.Mammograms, cases[2].Case.Mammograms);
  EXPECT_EQ(cases[1].Case.Start[StiffnessParameter], std::vector<double>{ 2 });
  EXPECT_TRUE(cases[2].Case.Start[StiffnessParameter].empty());
  EXPECT_NE(cases[1].Name, cases[2].Name);
  // Data/README.md: y, x and z of the gantry frame.
  EXPECT_EQ(cases[1].Truth.Placed.ToGantry({ 10, 20, 30 }), (Vector3{ 20, 10, 30 }));
  int imaged = 0;
  for (const Landmark& landmark : ReadLandmarks(cases[1].Landmarks))
  {
    imaged += landmark.Imaged ? 1 : 0;
    // Between the plates, whose distance is 58.3 mm and which stand 2 mm over the receptor.
    EXPECT_TRUE(!landmark.Imaged || (landmark.Compressed[2] > 2 && landmark.Compressed[2] < 60.3));
  }
  EXPECT_GT(imaged, 20);
}

TEST(ValidationCases, ForeignMammogramsAreRegisteredToEachPhantom)
{
  const std::vector<Phantom> phantoms = ValidationPhantoms("/public", 0.5);
  const std::vector<MammogramCase> mammograms = ValidationMammograms(phantoms, "/public");
  ASSERT_EQ(mammograms.size(), 21u);
  EXPECT_EQ(mammograms[0].Case.Mammograms, mammograms[2].Case.Mammograms);
  EXPECT_EQ(mammograms[1].Case.Labels.Path, phantoms[1].Labels.Path);
  EXPECT_NE(mammograms[2].Case.Mammograms, mammograms[3].Case.Mammograms);
  EXPECT_EQ(mammograms.back().Case.MammogramViews, std::vector<std::string>{ "MLO" });
  EXPECT_EQ(mammograms.back().Case.Laterality, "L");
  EXPECT_NEAR(*mammograms[6].Case.PixelSpacingMm, 0.1167, 1e-4);
}
