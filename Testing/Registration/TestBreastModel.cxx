// SPDX-License-Identifier: Apache-2.0
#include "RegistrationTwin.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/BreastModel.h"

#include <gtest/gtest.h>

#include <utility>

using namespace mammoray;
using namespace mammoray::test;

TEST(BreastModel, SimulatesOnASmallAnatomyItselfAndCarriesItOtherwise)
{
  const TetrahedralMesh anatomy = MakeAnatomy(6);
  BreastModel own(anatomy, Twin::Materials(), { 3 });
  EXPECT_FALSE(own.IsCarried());
  EXPECT_EQ(own.NumberOfSimulationCells(), anatomy.NumberOfCells());
  EXPECT_EQ(own.Predictor(), nullptr);
  EXPECT_FALSE(own.HasXRays());
  // The points at rest are their own images.
  const std::vector<double> points =
    own.AnatomyPoints().Map(own.Body().Simulation().RestPositions());
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    EXPECT_NEAR(points[index], anatomy.Points[index], 1e-9);
  }

  const TetrahedralMesh coarse = MakeAnatomy(4);
  BreastModel carried(anatomy, Twin::Materials(), { 3 },
    { .SimulationMesh = coarse, .Predicted = true });
  EXPECT_TRUE(carried.IsCarried());
  EXPECT_EQ(carried.NumberOfSimulationCells(), coarse.NumberOfCells());
  ASSERT_NE(carried.Predictor(), nullptr);
  // Linear cells have no nodes on their edges.
  EXPECT_LT(carried.Predictor()->Simulation().NumberOfNodes(),
    carried.Body().Simulation().NumberOfNodes());
}

TEST(BreastModel, OneAnswerForEachElement)
{
  EXPECT_EQ(MostSimulationCells(ElementType::Quadratic), 20000u);
  EXPECT_GT(MostSimulationCells(ElementType::PatchAveragedLinear),
    MostSimulationCells(ElementType::Quadratic));
}

TEST(BreastModel, StiffnessBelongsToThePoseThatWasAskedForLast)
{
  Twin twin(4, 4, 20.0, false);
  BreastBody& body = twin.Model.Body();
  EXPECT_TRUE(body.HasGland());
  BreastPose pose = Truth();
  const CompressionState soft = body.Compress(twin.Placement, pose);
  pose.Stiffness = 3;
  const CompressionState stiff = body.Compress(twin.Placement, pose, &soft);
  EXPECT_GT(stiff.PaddleForceN, soft.PaddleForceN);
  EXPECT_DOUBLE_EQ(body.Simulation().Materials()[3].YoungsModulusKPa, 45);
  EXPECT_DOUBLE_EQ(body.Elastic()[3].YoungsModulusKPa, 15);
  // A cold start: from another state the tissue may fold otherwise at the plates' edges.
  pose.Stiffness = 1;
  EXPECT_NEAR(body.Compress(twin.Placement, pose).PaddleForceN, soft.PaddleForceN,
    1e-6 * soft.PaddleForceN);
}

TEST(BreastModel, UnusableInputIsRefused)
{
  EXPECT_THROW(BreastModel(MakeAnatomy(4), Twin::Materials(), { 7 }), InputError);
  MaterialTable nothingHeld;
  nothingHeld.Name = "nothing held";
  nothingHeld.Materials.resize(4);
  EXPECT_THROW(BreastModel(MakeAnatomy(4), nothingHeld), InputError);
  BreastModel model(MakeAnatomy(4), Twin::Materials(), {});
  EXPECT_THROW(
    model.SetXRays(ExtractInterfaces(model.Anatomy()), nullptr,
      Beam(Spectrum::Monochromatic(20), DetectorResponse::EnergyIntegrating, { nullptr }, { 1 })),
    InputError);
  EXPECT_THROW(model.Body().Surface(), InputError);
}
