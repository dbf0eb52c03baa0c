// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "RegistrationTwin.h"
#include "mammoray/Registration/BreastModel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using test::RefusalOf;
using testing::HasSubstr;

/// A coarse breast with a glandular ball, without X-rays.
BreastBody CoarseBody()
{
  const ElasticTable table = test::Twin::Materials();
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(test::HalfAxes[0], test::HalfAxes[1],
    test::HalfAxes[2], std::array{ 4, 4, 4 });
  return { CompressionSimulation(mesh, table.Elastic, table.Fixed, test::AnatomyAt), table.Elastic,
    { 3 } };
}

const UnitPlacement BodyPlacement{ { AnatomicalAxes::FromCode("RAS"), { 0, 10, 0 } }, {} };

TEST(BreastBody, RefusesUnknownMaterialsAndAbsentSurfaces)
{
  const ElasticTable table = test::Twin::Materials();
  for (const int unknown : { -1, 4 })
  {
    EXPECT_THAT(RefusalOf(
                  [&]
                  {
                    BreastBody(
                      CompressionSimulation(test::MakeAnatomy(4), table.Elastic, table.Fixed),
                      table.Elastic, { unknown });
                  }),
      HasSubstr("expected a material of the 4 known to scale"));
  }
  const BreastBody body = CoarseBody();
  EXPECT_TRUE(body.HasGland());
  EXPECT_THAT(RefusalOf([&] { body.Surface(); }), HasSubstr("expected a surface to X-ray"));
}

TEST(BreastBody, VelocitiesAreThoseOfPlacesInTheUnit)
{
  BreastBody body = CoarseBody();
  body.SetSurface(test::MakeAnatomy(4).Points);
  const std::vector<double> values = ValuesOf(test::Truth());
  const CompressionState state = body.Compress(BodyPlacement, PoseOf(values));
  const std::vector<double> positions = body.Surface().Map(state.Positions);
  const std::vector<int> wanted{ ThicknessParameter, RollParameter, LateralParameter,
    AnteriorParameter, StiffnessParameter };
  const auto velocities = body.VelocitiesSeenFromUnit(BodyPlacement, PoseOf(values), state,
    body.Surface(), positions, wanted);
  ASSERT_EQ(velocities.Count(), wanted.size());
  // Gantry coordinates of the points at a pose beside this one.
  const auto seenAt = [&](int parameter, double step)
  {
    std::vector<double> beside = values;
    beside[static_cast<std::size_t>(parameter)] += step;
    const BreastPose pose = PoseOf(beside);
    const std::vector<double> moved =
      body.Surface().Map(body.Compress(BodyPlacement, pose, &state).Positions);
    const VolumeFromGantry placed = BodyPlacement.At(pose);
    std::vector<Vector3> seen;
    for (std::size_t at = 0; at < moved.size(); at += 3)
    {
      seen.push_back(placed.ToGantry({ moved[at], moved[at + 1], moved[at + 2] }));
    }
    return seen;
  };
  const VolumeFromGantry placed = BodyPlacement.At(PoseOf(values));
  for (std::size_t n = 0; n < wanted.size(); ++n)
  {
    const double step = 1e-3;
    const std::vector<Vector3> before = seenAt(wanted[n], -step);
    const std::vector<Vector3> after = seenAt(wanted[n], step);
    double error = 0;
    double size = 0;
    for (std::size_t point = 0; point < before.size(); ++point)
    {
      const Vector3 difference = (0.5 / step) * (after[point] - before[point]);
      const Vector3 here{ positions[3 * point], positions[3 * point + 1],
        positions[3 * point + 2] };
      const Vector3 velocity{ velocities[n][3 * point], velocities[n][3 * point + 1],
        velocities[n][3 * point + 2] };
      // The velocity's direction in the gantry frame.
      const Vector3 exact = placed.ToGantry(here + velocity) - placed.ToGantry(here);
      error += Dot(difference - exact, difference - exact);
      size += Dot(exact, exact);
    }
    // Equilibria to 1e-4 of the forces or better over a step of 1e-3, and contact points that open
    // and close: a hundredth, in the root mean square.
    EXPECT_LT(std::sqrt(error / size), 0.01) << PoseParameters[wanted[n]].Name;
    EXPECT_GT(size, 0) << PoseParameters[wanted[n]].Name;
  }
}
}
