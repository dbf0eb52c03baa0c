// SPDX-License-Identifier: Apache-2.0
// Registration of a small half-ellipsoid "breast" with a glandular ball in it. The target is not made by the model:
// it has another mesh density for the mechanics and for the picture, another spectrum (30 instead of 20 keV), noise,
// and an unknown scale and offset of its intensities.
#include "Beam.h"
#include "Error.h"
#include "PlacedPlates.h"
#include "Registration.h"
#include "TargetImage.h"
#include "TestMeshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

using namespace mammoray;

namespace
{
constexpr double HalfAxes[3] = { 45, 55, 40 };

/// Material 3 in a ball off the middle, 2 at the chest wall, else 1.
int AnatomyAt(const Vector3& point)
{
  const Vector3 centre{ 12, 28, 6 };
  return Norm(point - centre) < 14 ? 3 : 1;
}

TetrahedralMesh MakeAnatomy(int count)
{
  TetrahedralMesh mesh =
    test::MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2], count);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    if (mesh.Materials[cell] == 1)
    {
      Vector3 centre{ 0, 0, 0 };
      for (int corner = 0; corner < 4; ++corner)
      {
        centre = centre + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
      }
      mesh.Materials[cell] = AnatomyAt(centre);
    }
  }
  return mesh;
}

AttenuationTable Constant(const char* name, double mu20, double mu30)
{
  AttenuationTable table;
  table.Name = name;
  table.EnergiesKeV = { 20, 30 };
  table.MuPerMm = { mu20, mu30 };
  return table;
}

/// Everything a registration needs, kept together.
struct Twin
{
  Twin(int simulationCount, int anatomyCount, double energyKeV)
    : Fat(Constant("fat", 0.0512, 0.028))
    , Gland(Constant("gland", 0.0793, 0.0376))
    , XRays(Spectrum::Monochromatic(energyKeV), DetectorResponse::EnergyIntegrating,
        { nullptr, &this->Fat, &this->Fat, &this->Gland }, { 1, 1, 1, 1 })
    , Simulation(test::MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2],
                   std::array{ simulationCount, 4, simulationCount }),
        { {}, { 5, 0.49 }, { 5, 0.49 }, { 15, 0.49 } }, { false, false, true, false }, AnatomyAt)
    , Surface(ExtractInterfaces(MakeAnatomy(anatomyCount)))
    , SurfaceEmbedding(this->Simulation, this->Surface.Points)
    , Projector(MakeRayTracingProjector())
  {
    this->Projector->SetSurface(this->Surface);
    this->Model.Simulation = &this->Simulation;
    this->Model.Surface = &this->Surface;
    this->Model.SurfaceEmbedding = &this->SurfaceEmbedding;
    this->Model.Projector = this->Projector.get();
    this->Model.XRays = &this->XRays;
    // The test mesh has +x lateral, +y anterior, +z up: a left-handed (L, A, S) is avoided by calling
    // its +x the patient's right.
    this->Model.Axes = AnatomicalAxes::FromCode("RAS");
    this->Model.Anchor = { 0, 10, 0 };
  }

  AttenuationTable Fat;
  AttenuationTable Gland;
  Beam XRays;
  CompressionSimulation Simulation;
  SurfaceMesh Surface;
  Embedding SurfaceEmbedding;
  std::unique_ptr<PathLengthProjector> Projector;
  RegistrationModel Model;
};

BreastPose Truth()
{
  BreastPose pose;
  pose.ThicknessMm = 47;
  pose.RollDeg = 8;
  pose.ShiftLateralMm = 4;
  pose.ShiftAnteriorMm = 7;
  return pose;
}

/// The mammogram of the true pose: 0.5 mm pixels, mask and exact distances to the true outline.
RegistrationTarget MakeTarget(const Twin& setup, const BreastPose& pose)
{
  RegistrationTarget target;
  target.Columns = 130;
  target.Rows = 240;
  target.Origin = { 60, 0.25 };
  target.ColumnStep = { 0, 0.5 };
  target.RowStep = { -0.5, 0 };
  const auto pixels = static_cast<std::size_t>(target.Columns) * target.Rows;
  target.LogAttenuation.assign(pixels, 0);
  target.BreastMask.assign(pixels, 0);
  target.SignedDistanceMm.assign(pixels, 0);
  target.BreastMask[120 * 130] = 1; // the centre of the silhouette that Synthesize looks for
  const CompressionState state = setup.Simulation.Compress(
    PlatesOf(PlaceUnit(setup.Model.Axes, setup.Model.Anchor, setup.Model.Unit, pose),
      setup.Model.Unit, pose.ThicknessMm));
  const SyntheticMammogram synthetic = Synthesize(setup.Model, pose, state, target, 1);
  EXPECT_EQ(synthetic.InconsistentRays, 0u);

  std::mt19937 generator(7);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    target.BreastMask[pixel] = synthetic.LogAttenuation[pixel] > 0 ? 1 : 0;
    target.LogAttenuation[pixel] = 3.0f * (synthetic.LogAttenuation[pixel] + noise(generator)) + 7.0f;
  }
  for (int row = 0; row < target.Rows; ++row)
  {
    for (int column = 0; column < target.Columns; ++column)
    {
      const ReceptorPoint point = PixelPosition(target, column, row);
      double distance = 1e9;
      for (const ReceptorPoint& outline : synthetic.Outline)
      {
        distance = std::min(distance, std::hypot(point[0] - outline[0], point[1] - outline[1]));
      }
      const std::size_t pixel = static_cast<std::size_t>(row) * target.Columns + column;
      target.SignedDistanceMm[pixel] =
        static_cast<float>(target.BreastMask[pixel] ? -distance : distance);
    }
  }
  return target;
}

RegistrationOptions OptionsFrom(const BreastPose& start)
{
  RegistrationOptions options;
  options.Parameters = DefaultParameters(start);
  options.PixelSizesMm = { 3.0 };
  return options;
}

/// Skips the test where there is no device; a shared setup, because meshes and pipelines take seconds.
class Registration : public testing::Test
{
protected:
  void SetUp() override
  {
    std::string reason;
    if (ListDevices(&reason).empty())
    {
      GTEST_SKIP() << reason;
    }
    if (Target)
    {
      return;
    }
    Model = std::make_unique<Twin>(6, 12, 20.0);
    const Twin other(8, 16, 30.0);
    Target = std::make_unique<RegistrationTarget>(MakeTarget(other, Truth()));
  }
  static void TearDownTestSuite()
  {
    Model.reset();
    Target.reset();
  }

  static inline std::unique_ptr<Twin> Model;
  static inline std::unique_ptr<RegistrationTarget> Target;
};
}

TEST_F(Registration, RecoversATwinMadeWithAnotherMeshSpectrumAndNoise)
{
  for (const double sense : { 1.0, -1.0 })
  {
    BreastPose start;
    start.ThicknessMm = 50;
    start.RollDeg = Truth().RollDeg + sense * 8;
    start.ShiftLateralMm = -sense * 6;
    start.ShiftAnteriorMm = 3;
    const RegistrationResult result =
      Register(Model->Model, *Target, OptionsFrom(start), {});
    EXPECT_TRUE(result.Converged) << result.StopReason;
    // The result's own standard deviations must be useful, and the errors no larger than what is called
    // useful: the ball is all that shows the angle, and thickness has little effect on a z-scored picture.
    const double truth[] = { Truth().ThicknessMm, Truth().RollDeg, Truth().ShiftLateralMm,
      Truth().ShiftAnteriorMm };
    // Half of the 3 mm pixels for the shifts.
    const double useful[] = { 3.0, 5.0, 1.5, 1.5 };
    for (int parameter = 0; parameter < 4; ++parameter)
    {
      const double error = std::abs(result.Values[parameter] - truth[parameter]);
      const double deviation = result.StandardDeviations[parameter];
      EXPECT_GT(deviation, 0) << parameter;
      EXPECT_LT(deviation, useful[parameter]) << parameter;
      EXPECT_LT(error, useful[parameter]) << parameter;
    }
    EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
    EXPECT_GT(result.After.Correlation, 0.95);
    EXPECT_GT(result.After.Correlation, result.Before.Correlation);
    ASSERT_GE(result.Iterations.size(), 2u);
    EXPECT_LT(result.Iterations.back().Cost, result.Iterations.front().Cost);
    EXPECT_TRUE(std::isnan(result.StandardDeviations[4])); // fixed
    EXPECT_EQ(result.Pose.ShiftVerticalMm, 0);
  }
}

TEST_F(Registration, NothingFreeAnswersTheStart)
{
  RegistrationOptions options = OptionsFrom(Truth());
  for (RegistrationParameter& parameter : options.Parameters)
  {
    parameter.Fixed = true;
  }
  const RegistrationResult result = Register(Model->Model, *Target, options, {});
  EXPECT_TRUE(result.Converged);
  EXPECT_EQ(result.Pose.ThicknessMm, Truth().ThicknessMm);
  EXPECT_EQ(result.Evaluations, 1);
  // The true pose: what is left is the difference of the meshes.
  EXPECT_GT(result.After.Correlation, 0.95);
  EXPECT_LT(result.After.MeanOutlineDistanceMm, 0.7);
}

TEST_F(Registration, StopsWhenAskedWithTheBestSoFar)
{
  RegistrationOptions options = OptionsFrom(Truth());
  int calls = 0;
  const RegistrationResult result = Register(Model->Model, *Target, options,
    [&](double, const char* stage)
    { return std::string(stage) != "differentiate" || ++calls < 6; });
  EXPECT_FALSE(result.Converged);
  EXPECT_NE(result.StopReason.find("interrupted"), std::string::npos);
  EXPECT_GT(result.After.Correlation, 0.9);
}

TEST_F(Registration, UnusableInputIsRefused)
{
  RegistrationOptions options = OptionsFrom(Truth());
  options.Parameters[1].Start = 1000;
  EXPECT_THROW(Register(Model->Model, *Target, options, {}), InputError);
  options = OptionsFrom(Truth());
  options.Parameters.pop_back();
  EXPECT_THROW(Register(Model->Model, *Target, options, {}), InputError);
  RegistrationModel incomplete = Model->Model;
  incomplete.Projector = nullptr;
  EXPECT_THROW(Register(incomplete, *Target, OptionsFrom(Truth()), {}), InputError);
  RegistrationTarget target = *Target;
  target.BreastMask.assign(target.BreastMask.size(), 0);
  EXPECT_THROW(Register(Model->Model, target, OptionsFrom(Truth()), {}), InputError);
}
