// SPDX-License-Identifier: Apache-2.0
#include "RegistrationTwin.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/Private/Silhouette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

using namespace mammoray;
using namespace mammoray::test;

namespace
{
ReceptorGrid Grid(double pixelMm)
{
  ReceptorGrid grid;
  grid.Columns = static_cast<int>(65 / pixelMm);
  grid.Rows = static_cast<int>(120 / pixelMm);
  grid.Origin = { 60, 0.5 * pixelMm };
  grid.ColumnStep = { 0, pixelMm };
  grid.RowStep = { -pixelMm, 0 };
  return grid;
}
}

TEST(PosedBreast, ComputesEachThingOnceAndAnewForAnotherGrid)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  PosedBreast here = twin.At(Truth());
  const ReceptorGrid grid = Grid(2);
  const std::vector<float> picture = here.PictureOn(grid, 2).LogAttenuation;
  EXPECT_EQ(here.PictureOn(grid, 2).LogAttenuation, picture);
  EXPECT_EQ(here.NumberOfProjections(), 1);
  // Derivatives need a pass of their own, whose picture is the one at hand.
  const VectorFields velocities = here.Velocities({ ThicknessParameter, LateralParameter });
  EXPECT_EQ(velocities.Count(), 2U);
  EXPECT_EQ(velocities.Length, here.SurfacePoints().size());
  EXPECT_EQ(here.DifferentiatePicture(grid, 2, velocities).size(), 2U);
  EXPECT_EQ(here.NumberOfProjections(), 1);
  here.PictureOn(Grid(4), 2);
  here.PictureOn(Grid(4), 1);
  EXPECT_EQ(here.NumberOfProjections(), 3);
  const double* const points = here.SurfacePoints().data();
  EXPECT_EQ(here.SurfacePoints().data(), points);

  // Where the derivatives come first, they bring the same picture.
  PosedBreast first = here.MovedTo(Truth());
  first.DifferentiatePicture(grid, 2, first.Velocities({ ThicknessParameter }));
  EXPECT_EQ(first.PictureOn(grid, 2).LogAttenuation, picture);
  EXPECT_EQ(first.NumberOfProjections(), 1);
}

TEST(PosedBreast, AddsWhatScatters)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  PosedBreast here = twin.At(Truth());
  const ReceptorGrid grid = Grid(2);
  const PosedBreast::Picture primary = here.PictureOn(grid, 2);
  const ScatterModel scatter(FindScatterKernels(), Spectrum::Monochromatic(20),
    DetectorResponse::EnergyIntegrating, 12);
  twin.Model.SetScatter(scatter);
  PosedBreast scattering = here.MovedTo(Truth());
  const std::vector<float> both = scattering.PictureOn(grid, 2).LogAttenuation;
  std::vector<double> through;
  for (const float attenuation : primary.LogAttenuation)
  {
    through.push_back(std::exp(-static_cast<double>(attenuation)));
  }
  const std::vector<double> added = scatter.Scatter(SourceOf(here.Placed(), here.Placement().Unit),
    DetectorOf(here.Placed(), grid, 2), TissueThickness(primary.Lengths), through);
  double largest = 0;
  for (std::size_t pixel = 0; pixel < both.size(); ++pixel)
  {
    // Floats.
    EXPECT_NEAR(both[pixel], -std::log(through[pixel] + added[pixel]), 1e-5);
    largest = std::max(largest, added[pixel] / through[pixel]);
  }
  EXPECT_GT(largest, 0.3) << "scatter over primary behind 47 mm";
}

TEST(PosedBreast, MovedElsewhereKeepsThePointsAndShiftsThePicture)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  PosedBreast here = twin.At(Truth());
  BreastPose shifted = Truth();
  shifted.LateralMm += 3;
  PosedBreast moved = here.MovedTo(shifted);
  EXPECT_EQ(moved.SurfacePoints(), here.SurfacePoints());
  EXPECT_EQ(moved.State().Positions, here.State().Positions);
  for (std::size_t point = 0; point < here.SurfaceOnReceptor().size(); point += 100)
  {
    // The unit moves by 3 mm, its shadow of a point at the height z by sid / (sid - z) times that.
    const double shift = here.SurfaceOnReceptor()[point][0] - moved.SurfaceOnReceptor()[point][0];
    EXPECT_GE(shift, 3 - 1e-9);
    EXPECT_LT(shift, 3.6);
  }
  const std::vector<ReceptorPoint> directions = HalfCircleDirections(20);
  const ReceptorPoint centre{ 0, 0 };
  const std::vector<double> radii = here.SilhouetteFrom(centre, directions).Radii;
  EXPECT_EQ(here.SilhouetteFrom(centre, directions).Radii, radii);
  EXPECT_NE(here.SilhouetteFrom({ 1, 0 }, directions).Radii, radii);
}

TEST(PosedBreast, SeenFromAnotherFocalSpotKeepsTheBreastAndMovesItsShadow)
{
  std::string reason;
  if (ListDevices(&reason).empty())
  {
    GTEST_SKIP() << reason;
  }
  Twin twin(4, 8, 20.0, false);
  PosedBreast here = twin.At(Truth());
  const Vector3 spot{ -120, 5, 610 };
  PosedBreast& aside = here.SeenFrom(spot);
  EXPECT_EQ(&here.SeenFrom(spot), &aside);
  EXPECT_NE(&here.SeenFrom({ 120, 5, 610 }), &aside);
  EXPECT_EQ(aside.SurfacePoints(), here.SurfacePoints());
  EXPECT_EQ(aside.Placed().Origin, here.Placed().Origin);
  for (std::size_t point = 0; point < here.SurfaceOnReceptor().size(); point += 100)
  {
    const double* at = here.SurfacePoints().data() + 3 * point;
    const Vector3 gantry = here.Placed().ToGantry({ at[0], at[1], at[2] });
    // Where the line from the focal spot through the point meets z = 0.
    const double along = spot[2] / (spot[2] - gantry[2]);
    EXPECT_NEAR(aside.SurfaceOnReceptor()[point][0], spot[0] + along * (gantry[0] - spot[0]), 1e-9);
    EXPECT_NEAR(aside.SurfaceOnReceptor()[point][1], spot[1] + along * (gantry[1] - spot[1]), 1e-9);
  }
  // The picture and the silhouette are of the same rays: beyond the silhouette nothing is in the
  // beam, a millimetre within it the breast is.
  const ReceptorGrid grid = Grid(2);
  const std::vector<float> picture = aside.PictureOn(grid, 1).LogAttenuation;
  const ReceptorPoint centre{ 10, 0 };
  const std::vector<ReceptorPoint> directions = HalfCircleDirections(20);
  const std::vector<double>& radii = aside.SilhouetteFrom(centre, directions).Radii;
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const ReceptorPoint pixel = grid.PositionOf(column, row);
      const double radius = std::hypot(pixel[0] - centre[0], pixel[1] - centre[1]);
      for (std::size_t index = 0; index < directions.size(); ++index)
      {
        const double across = std::abs((pixel[0] - centre[0]) * directions[index][1] -
          (pixel[1] - centre[1]) * directions[index][0]);
        if (across < 0.5 && std::abs(radius - radii[index]) > 2)
        {
          const std::size_t number = static_cast<std::size_t>(row) * grid.Columns + column;
          EXPECT_EQ(picture[number] > 0, radius < radii[index])
            << pixel[0] << " " << pixel[1] << " " << radius << " " << radii[index];
        }
      }
    }
  }
  EXPECT_EQ(here.NumberOfProjections(), 1);
}
