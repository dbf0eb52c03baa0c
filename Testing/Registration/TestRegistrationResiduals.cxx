// SPDX-License-Identifier: Apache-2.0
#include "Private/PictureResiduals.h"
#include "RegistrationTwin.h"
#include "SurfaceShapes.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/Registration/Private/RegistrationResiduals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
/// Length of the difference of two vectors over that of the first, between two of their entries.
double Difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t begin,
  std::size_t end)
{
  double difference = 0;
  double length = 0;
  for (std::size_t index = begin; index < end; ++index)
  {
    difference += (a[index] - b[index]) * (a[index] - b[index]);
    length += a[index] * a[index];
  }
  return std::sqrt(difference / length);
}

/// Share of the entries in which two vectors differ by more than 2 % of the first one's root mean
/// square.
double ShareOff(const std::vector<double>& a, const std::vector<double>& b, std::size_t begin,
  std::size_t end)
{
  double square = 0;
  for (std::size_t index = begin; index < end; ++index)
  {
    square += a[index] * a[index];
  }
  const auto count = static_cast<double>(end - begin);
  const double tolerance = 0.02 * std::sqrt(square / count);
  double off = 0;
  for (std::size_t index = begin; index < end; ++index)
  {
    off += std::abs(a[index] - b[index]) > tolerance ? 1 : 0;
  }
  return off / count;
}

/// Smooth, unlike the interfaces of cells: where those lie along a ray, its path length all but
/// jumps.
SurfaceMesh SmoothAnatomy()
{
  TetrahedralMesh body = MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2], 10);
  body.Materials.assign(body.NumberOfCells(), 1);
  SurfaceMesh surface = ExtractInterfaces(body);
  shapes::AddSphere(surface, { 12, 28, 6 }, 14, 3, 3, 1);
  return surface;
}
}

TEST(RegistrationResiduals, JacobianAgreesWithDifferencesOfSolvedStates)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(6, 10, 20.0);
  const Beam beam = twin.Model.XRays();
  twin.Model.SetXRays(SmoothAnatomy(), MakeProjector(), beam);
  const RegistrationTarget target = Coarsen(MakeTarget(twin, Truth()), 4);
  BreastPose pose = Truth();
  pose.ThicknessMm = 49;
  pose.RollDeg = 3;
  pose.LateralMm = 2.5;
  pose.AnteriorMm = 5;
  pose.VerticalMm = 1;
  pose.PitchDeg = -2;
  pose.YawDeg = 4;
  pose.TiltDeg = 1.5;
  RegistrationOptions options;
  std::vector<RegistrationParameter> parameters = DefaultParameters(pose);
  // A prior away from its middle, so that its derivative is seen.
  parameters[ThicknessParameter].Start = 47;
  options.Comparison = PictureComparison::Global;
  std::vector<RegistrationOptions> kinds(3, options);
  kinds[1].Comparison = PictureComparison::Local;
  kinds[2].Comparison = PictureComparison::Gradient;
  const RegistrationResiduals residuals(target, parameters, kinds[0]);
  const RegistrationResiduals local(target, parameters, kinds[1]);
  const RegistrationResiduals gradient(target, parameters, kinds[2]);
  // The same target from 15 degrees to either side: any picture will do for derivatives.
  const RegistrationResiduals swept({ { &target, std::nullopt },
                                      { &target, Vector3{ 160, 3, 620 } },
                                      { &target, Vector3{ -160, 0, 620 } } },
    parameters, kinds[0]);
  const std::array<const RegistrationResiduals*, 4> all{ &residuals, &local, &gradient, &swept };
  std::vector<double> values;
  for (const RegistrationParameter& parameter : DefaultParameters(pose))
  {
    values.push_back(parameter.Start);
  }
  values[StiffnessParameter] = 1.4;
  PosedBreast here = twin.At(PoseOf(values));
  std::vector<int> wanted(values.size());
  std::iota(wanted.begin(), wanted.end(), 0);
  // Another order than that of the parameters.
  std::rotate(wanted.begin(), wanted.end() - 1, wanted.end());
  std::array<RegistrationResiduals::Jacobian, 4> jacobians;
  for (std::size_t kind = 0; kind < all.size(); ++kind)
  {
    jacobians[kind] = all[kind]->Differentiate(here, wanted);
  }

  const auto picture = [&](std::size_t kind, std::size_t projection) -> const PictureResiduals&
  { return all[kind]->Picture(projection); };
  const std::size_t outline = picture(0, 0).NumberOfOutlineResiduals();
  const std::size_t intensity = picture(0, 0).NumberOfIntensityResiduals();
  ASSERT_GT(outline, 50u);
  ASSERT_GT(intensity, 100u);
  EXPECT_EQ(picture(1, 0).NumberOfIntensityResiduals(), intensity);
  // Two neighbours of each pixel but those at the edge.
  EXPECT_GT(picture(2, 0).NumberOfIntensityResiduals(), 1.7 * intensity);
  EXPECT_LT(picture(2, 0).NumberOfIntensityResiduals(), 2 * intensity);
  ASSERT_EQ(swept.NumberOfProjections(), 3u);
  EXPECT_EQ(swept.NumberOfResiduals(), 3 * (outline + intensity) + swept.NumberOfPriors());
  for (const int parameter : wanted)
  {
    // Of each kind and projection.
    std::array<std::array<double, 3>, 4> bestOutline{};
    std::array<std::array<double, 3>, 4> fewestOff{};
    for (std::size_t kind = 0; kind < all.size(); ++kind)
    {
      bestOutline[kind].fill(1e9);
      fewestOff[kind].fill(1);
    }
    for (const double step : { 0.1, 0.01, 0.003, 0.001, 0.0001 })
    {
      std::array<std::vector<double>, 4> sides[2];
      for (int side = 0; side < 2; ++side)
      {
        std::vector<double> moved = values;
        moved[parameter] += side == 0 ? -step : step;
        PosedBreast beside = twin.At(PoseOf(moved), &here.State());
        for (std::size_t kind = 0; kind < all.size(); ++kind)
        {
          sides[side][kind] = all[kind]->Evaluate(beside);
        }
      }
      for (std::size_t kind = 0; kind < all.size(); ++kind)
      {
        std::vector<double> differences(sides[0][kind].size());
        for (std::size_t index = 0; index < differences.size(); ++index)
        {
          differences[index] = (sides[1][kind][index] - sides[0][kind][index]) / (2 * step);
        }
        const std::vector<double>& column = jacobians[kind].Columns[parameter];
        ASSERT_EQ(column.size(), differences.size());
        std::size_t first = 0;
        for (std::size_t projection = 0; projection < all[kind]->NumberOfProjections();
             ++projection)
        {
          const std::size_t pictures = first + picture(kind, projection).NumberOfOutlineResiduals();
          const std::size_t end = pictures + picture(kind, projection).NumberOfIntensityResiduals();
          bestOutline[kind][projection] = std::min(bestOutline[kind][projection],
            Difference(column, differences, first, pictures));
          fewestOff[kind][projection] =
            std::min(fewestOff[kind][projection], ShareOff(column, differences, pictures, end));
          first = end;
        }
        for (std::size_t prior = first; prior < column.size(); ++prior)
        {
          EXPECT_NEAR(column[prior], differences[prior], 1e-9);
        }
      }
    }
    const std::string& name = parameters[parameter].Name;
    for (std::size_t kind = 0; kind < all.size(); ++kind)
    {
      for (std::size_t projection = 0; projection < all[kind]->NumberOfProjections(); ++projection)
      {
        // The outline is smooth between kinks: what is left is the equilibrium's own tolerance.
        EXPECT_LT(bestOutline[kind][projection], 1e-4) << name << " " << kind << " " << projection;
        // Path lengths have kinks where a ray goes over an edge: the fewer rays do within a step,
        // the fewer pixels are off; below 0.003 mm differences drown in the rounding of path
        // lengths, 1e-6 mm. A pixel is in many windows, where its part is small, and in four
        // gradients.
        EXPECT_LT(fewestOff[kind][projection], kind == 2 ? 0.08 : 0.02)
          << name << " " << kind << " " << projection;
      }
    }
  }
}

TEST(RegistrationResiduals, ProjectionsOfOneCompressionCountAsOne)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  const RegistrationTarget target = Coarsen(MakeTarget(twin, Truth()), 4);
  BreastPose pose = Truth();
  pose.LateralMm += 6; // some residuals are beyond the robust width
  RegistrationOptions options;
  std::vector<RegistrationParameter> parameters = DefaultParameters(Truth());
  parameters[LateralParameter].PriorSigma = 2;
  PosedBreast here = twin.At(pose);
  const RegistrationResiduals one(target, parameters, options);
  const RegistrationCosts alone = one.Costs(one.Evaluate(here));
  EXPECT_GT(alone.Outline, 1);
  EXPECT_NEAR(alone.Prior, 4.5 * PriorWeight * PriorWeight, 1e-9);
  // Four times the same picture tells what one tells.
  const RegistrationResiduals four(std::vector<ComparedProjection>(4, { &target, std::nullopt }),
    parameters, options);
  const std::vector<double> residuals = four.Evaluate(here);
  const RegistrationCosts together = four.Costs(residuals);
  EXPECT_NEAR(together.Outline, alone.Outline, 1e-9 * alone.Outline);
  EXPECT_NEAR(together.Intensity, alone.Intensity, 1e-9 * alone.Intensity);
  EXPECT_NEAR(together.Prior, alone.Prior, 1e-9);
  // Huber's loss begins at the same distance of the outline.
  const std::vector<double> widths = four.RobustWidths();
  ASSERT_EQ(widths.size(), residuals.size());
  EXPECT_DOUBLE_EQ(widths.front(), 0.5 * options.RobustWidth);
  EXPECT_TRUE(std::isinf(widths.back()));
}

TEST(RegistrationResiduals, WeighMultipliesOutlineAndPictureOfEachProjection)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  const RegistrationTarget target = Coarsen(MakeTarget(twin, Truth()), 4);
  RegistrationOptions options;
  std::vector<RegistrationParameter> parameters = DefaultParameters(Truth());
  parameters[LateralParameter].PriorSigma = 2;
  BreastPose pose = Truth();
  pose.LateralMm += 1;
  PosedBreast here = twin.At(pose);
  RegistrationResiduals residuals({ { &target, std::nullopt }, { &target, std::nullopt } },
    parameters, options);
  const auto column = [&]
  { return residuals.Differentiate(here, { LateralParameter }).Columns[LateralParameter]; };
  const std::vector<double> before = residuals.Evaluate(here);
  const std::vector<double> rates = column();
  const std::vector<double> changes = residuals.Weigh({ 0.3, 0.05, 2.0, 0.7 });
  const std::vector<double> after = residuals.Evaluate(here);
  const std::vector<double> changed = column();
  ASSERT_EQ(changes.size(), before.size());
  EXPECT_DOUBLE_EQ(residuals.Picture(0).OutlineFactor(), 0.3);
  EXPECT_DOUBLE_EQ(residuals.Picture(1).IntensityFactor(), 0.7);
  for (std::size_t index = 0; index < before.size(); ++index)
  {
    EXPECT_NEAR(after[index], changes[index] * before[index], 1e-12 * std::abs(after[index]));
    EXPECT_NEAR(changed[index], changes[index] * rates[index], 1e-12 * std::abs(changed[index]));
  }
  // Of one picture, weighed twice: 2 / 0.3 of the outline, 0.7 / 0.05 of the picture.
  const std::size_t half = residuals.Picture(0).NumberOfResiduals();
  EXPECT_NEAR(changes[half] / changes[0], 2 / 0.3, 1e-12);
  EXPECT_NEAR(changes[2 * half - 1] / changes[half - 1], 14, 1e-12);
  EXPECT_EQ(changes.back(), 1);
}

TEST(RegistrationResiduals, JacobianWithScatterAgreesWithDifferencesOfSolvedStates)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(6, 10, 20.0, false);
  const Beam beam = twin.Model.XRays();
  twin.Model.SetXRays(SmoothAnatomy(), MakeProjector(), beam);
  const RegistrationTarget target = Coarsen(MakeTarget(twin, Truth()), 4);
  BreastPose pose = Truth();
  pose.ThicknessMm = 49;
  pose.RollDeg = 3;
  RegistrationOptions options;
  std::vector<RegistrationParameter> parameters = DefaultParameters(pose);
  options.Comparison = PictureComparison::Global;
  const RegistrationResiduals residuals(target, parameters, options);
  PosedBreast here = twin.At(pose);
  const std::vector<int> wanted{ ThicknessParameter, RollParameter, LateralParameter,
    TiltParameter };
  const RegistrationResiduals::Jacobian primary = residuals.Differentiate(here, wanted);
  twin.Model.SetScatter(ScatterModel(FindScatterKernels(), Spectrum::Monochromatic(20),
    DetectorResponse::EnergyIntegrating, 12));
  PosedBreast scattered = here.MovedTo(pose);
  const RegistrationResiduals::Jacobian jacobian = residuals.Differentiate(scattered, wanted);
  const std::size_t begin = residuals.Picture(0).NumberOfOutlineResiduals();
  const std::size_t end = begin + residuals.Picture(0).NumberOfIntensityResiduals();
  for (const int parameter : wanted)
  {
    const std::vector<double>& column = jacobian.Columns[static_cast<std::size_t>(parameter)];
    double fewestOff = 1;
    for (const double step : { 0.01, 0.003 })
    {
      std::vector<double> sides[2];
      for (const int side : { 0, 1 })
      {
        std::vector<double> moved = ValuesOf(pose);
        moved[static_cast<std::size_t>(parameter)] += side == 0 ? -step : step;
        PosedBreast beside = twin.At(PoseOf(moved), &here.State());
        sides[side] = residuals.Evaluate(beside);
      }
      std::vector<double> differences(column.size());
      for (std::size_t index = 0; index < column.size(); ++index)
      {
        differences[index] = (sides[1][index] - sides[0][index]) / (2 * step);
      }
      fewestOff = std::min(fewestOff, ShareOff(column, differences, begin, end));
    }
    // As above: kinks of path lengths.
    EXPECT_LT(fewestOff, 0.02) << parameters[parameter].Name;
    EXPECT_GT(ShareOff(primary.Columns[static_cast<std::size_t>(parameter)], column, begin, end),
      0.2)
      << "scatter matters to " << parameters[parameter].Name;
  }
}

TEST(DefaultParameters, StartWithinTheirBounds)
{
  BreastPose start = DefaultStart();
  start.ThicknessMm = 62;
  start.RollDeg = 45;
  const auto parameters = DefaultParameters(start);
  ASSERT_EQ(parameters.size(), std::size_t{ ParameterCount });
  for (const RegistrationParameter& parameter : parameters)
  {
    EXPECT_LT(parameter.Lower, parameter.Start) << parameter.Name;
    EXPECT_LT(parameter.Start, parameter.Upper) << parameter.Name;
    EXPECT_GT(parameter.Scale, 0) << parameter.Name;
  }
  EXPECT_EQ(parameters[ThicknessParameter].Start, 62);
  EXPECT_EQ(parameters[RollParameter].Start, 45);
  EXPECT_TRUE(parameters[StiffnessParameter].Fixed);
}
