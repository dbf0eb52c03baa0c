// SPDX-License-Identifier: Apache-2.0
// Derivatives that pass through the shape without load, against states unloaded and solved again.
#include "BreastBetweenPlates.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace
{
using namespace mammoray;

/// A breast that hung in its image and stands, drawn onto the receptor, between the plates.
struct UnloadedBreast
{
  TetrahedralMesh Mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  std::vector<ElasticMaterial> Materials{ {}, { 1.5, 0.48, 1, 0.95 }, { 5, 0.49 },
    { 6, 0.49, 2, 1.05 } };
  CompressionOptions Options;
  PlatePair Plates = test::MakePlates(58);

  UnloadedBreast(ElementType type, ChestWallMode mode)
    : Options(test::WithElement(type, 1e-12))
  {
    this->Options.ChestWall = mode;
    this->Options.Wall = { 30, 5 };
    this->Options.GravityMPerS2 = { 0, 1, -StandardGravityMPerS2 };
    this->Options.PullN = { 0, 0.5, 0 };
  }

  CompressionSimulation Simulation() const
  {
    CompressionSimulation simulation(
      this->Mesh, this->Materials, { false, false, true, false },
      [](const Vector3& x) { return std::hypot(x[0], x[1] - 20, x[2]) < 17 ? 3 : 1; },
      this->Options);
    simulation.Unload({ 0, StandardGravityMPerS2, 2 });
    return simulation;
  }

  std::vector<ElasticMaterial> Moved(const MaterialDerivative& velocity, double by) const
  {
    std::vector<ElasticMaterial> moved = this->Materials;
    for (std::size_t m = 0; m < moved.size(); ++m)
    {
      moved[m].YoungsModulusKPa += by * velocity[m].YoungsModulusKPa;
      moved[m].PoissonRatio += by * velocity[m].PoissonRatio;
      moved[m].FungExponent += by * velocity[m].FungExponent;
    }
    return moved;
  }
};

/// The smallest relative error over the steps `h` of central differences of `at(by)`.
double ErrorOfRate(std::span<const double> rate,
  const std::function<std::vector<double>(double by)>& at, std::initializer_list<double> steps)
{
  double best = 1;
  for (const double h : steps)
  {
    std::vector<double> difference = test::Difference(at(h), at(-h));
    for (double& value : difference)
    {
      value /= 2 * h;
    }
    best =
      std::min(best, test::NormOf(test::Difference(difference, rate)) / test::NormOf(difference));
  }
  return best;
}

using ElementUnloadedSensitivities = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementUnloadedSensitivities);

TEST_P(ElementUnloadedSensitivities, ToMaterialsMatchCentralDifferences)
{
  // The ratio gland / fat, both Poisson's ratios together (in hundredths), the fat's exponent.
  const std::vector<MaterialDerivative> velocities{ { {}, {}, {}, { 1.5, 0, 0 } },
    { {}, { 0, 0.01, 0 }, {}, { 0, 0.01, 0 } }, { {}, { 0, 0, 1 }, {}, {} } };
  for (const ChestWallMode mode : { ChestWallMode::Fixed, ChestWallMode::Elastic })
  {
    const UnloadedBreast breast(GetParam(), mode);
    CompressionSimulation simulation = breast.Simulation();
    const CompressionState state = simulation.Compress(breast.Plates);
    const VectorFields exact = simulation.Sensitivities(state, {}, velocities);
    ASSERT_EQ(exact.Count(), velocities.size());
    for (std::size_t p = 0; p < velocities.size(); ++p)
    {
      const double error = ErrorOfRate(exact[p],
        [&](double by)
        {
          simulation.SetMaterials(breast.Moved(velocities[p], by));
          return simulation.Compress(breast.Plates, &state).Positions;
        },
        { 1e-3, 1e-4, 1e-5 });
      // As without unloading: contact points that come and go bend the curve, and for small steps
      // the solvers' 1e-12 / h counts.
      EXPECT_LT(error, 1e-6) << "mode " << static_cast<int>(mode) << ", parameter " << p;
    }
  }
}

TEST_P(ElementUnloadedSensitivities, ToTheChestWallMatchCentralDifferences)
{
  UnloadedBreast breast(GetParam(), ChestWallMode::Elastic);
  CompressionSimulation simulation = breast.Simulation();
  const CompressionState state = simulation.Compress(breast.Plates);
  std::vector<LoadingDerivative> velocities(2);
  velocities[0].Wall = { 3, 1 };
  velocities[1].GravityMPerS2 = { 1, 0, 2 };
  const VectorFields exact = simulation.Sensitivities(state, {}, {}, velocities);
  const CompressionOptions options = breast.Options;
  for (int p = 0; p < 2; ++p)
  {
    const double error = ErrorOfRate(exact[p],
      [&](double by)
      {
        breast.Options.Wall.Normal = options.Wall.Normal + by * velocities[p].Wall.Normal;
        breast.Options.Wall.Tangential =
          options.Wall.Tangential + by * velocities[p].Wall.Tangential;
        breast.Options.GravityMPerS2 = options.GravityMPerS2 + by * velocities[p].GravityMPerS2;
        return breast.Simulation().Compress(breast.Plates, &state).Positions;
      },
      { 1e-2, 1e-3, 1e-4 });
    EXPECT_LT(error, 1e-6) << "parameter " << p;
  }
}

TEST_P(ElementUnloadedSensitivities, MatchCentralDifferencesWhereStiffnessIsRaised)
{
  UnloadedBreast breast(GetParam(), ChestWallMode::Fixed);
  breast.Materials[1].YoungsModulusKPa = breast.Materials[3].YoungsModulusKPa = 0.02;
  breast.Materials[1].FungExponent = breast.Materials[3].FungExponent = 0;
  // Such tissue hangs, but does not stand.
  breast.Options.GravityMPerS2 = { 0, StandardGravityMPerS2, 0 };
  breast.Options.PullN = { 0, 0, 0 };
  breast.Plates = MovedPlates(breast.Plates, { {}, { { 0, 0, 20 }, {} } }, 1);
  CompressionSimulation simulation = breast.Simulation();
  const double factor = simulation.StiffnessFactor();
  ASSERT_GT(factor, 1);
  const MaterialDerivative velocity{ {}, {}, {}, { 0.02, 0, 0 } };
  const CompressionState state = simulation.Compress(breast.Plates);
  const std::vector<double> exact = simulation.Sensitivities(state, {}, { velocity }).Values;
  const double error = ErrorOfRate(exact,
    [&](double by)
    {
      simulation.SetMaterials(breast.Moved(velocity, by));
      EXPECT_EQ(simulation.StiffnessFactor(), factor);
      return simulation.Compress(breast.Plates, &state).Positions;
    },
    { 1e-3, 1e-4, 1e-5 });
  EXPECT_LT(error, 1e-6);
}
}
