// SPDX-License-Identifier: Apache-2.0
// The shape without load: closed forms, random breasts there and back, tissue that is too soft.
#include "BreastBetweenPlates.h"
#include "EveryElement.h"
#include "HangingBody.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace
{
using namespace mammoray;

const std::vector<bool> HeldMaterials{ false, false, true, false };
/// A breast hangs along its own axis.
const Vector3 Hanging{ 0, StandardGravityMPerS2, 0 };

/// A half-ellipsoid of fat with a lump of gland, its softest tissue from 0.5 to 20 kPa, that hangs
/// along its axis or up to 30 degrees off it.
struct RandomBreast
{
  TetrahedralMesh Mesh;
  std::vector<ElasticMaterial> Materials;
  CompressionOptions Options;
  std::string Name;

  RandomBreast(ElementType type, ChestWallMode mode, unsigned int seed)
  {
    std::mt19937 generator(seed);
    const auto draw = [&](double low, double high)
    { return std::uniform_real_distribution<double>(low, high)(generator); };
    const double a = draw(35, 60), b = draw(40, 65), c = draw(35, 55);
    const double nu = draw(0.45, 0.499), ratio = std::pow(10.0, draw(0, 1));
    const double modulus = 0.5 * std::pow(40.0, draw(0, 1));
    this->Mesh = test::MakeHalfEllipsoidMesh(a, b, c, type == ElementType::Quadratic ? 4 : 6);
    for (std::size_t cell = 0; cell < this->Mesh.NumberOfCells(); ++cell)
    {
      Vector3 middle{ 0, 0, 0 };
      for (int corner = 0; corner < 4; ++corner)
      {
        middle = middle + 0.25 * this->Mesh.Point(this->Mesh.Cells[4 * cell + corner]);
      }
      std::int32_t& material = this->Mesh.Materials[cell];
      const double depth = std::hypot(middle[0] / a, (middle[1] - 0.45 * b) / b, middle[2] / c);
      material = material == 1 && depth < 0.45 ? 3 : material;
    }
    this->Materials = { {}, { modulus, nu, 0, 0.95 }, { 5, nu }, { ratio * modulus, nu, 0, 1.05 } };
    this->Options = test::WithElement(type, 1e-8);
    this->Options.ChestWall = mode;
    this->Options.Wall = { std::pow(10.0, draw(1, 3)), std::pow(10.0, draw(0.5, 2)) };
    const double tilt = draw(0, M_PI / 6), turn = draw(0, 2 * M_PI);
    this->Options.GravityMPerS2 = StandardGravityMPerS2 *
      Vector3{ std::sin(tilt) * std::cos(turn), std::cos(tilt), std::sin(tilt) * std::sin(turn) };
    this->Name = "seed " + std::to_string(seed) + ": " + std::to_string(modulus) + " kPa, gland " +
      std::to_string(ratio) + " times, nu " + std::to_string(nu) + ", length " + std::to_string(b) +
      " mm, tilted by " + std::to_string(tilt);
  }

  CompressionSimulation Simulation(const std::vector<double>& points) const
  {
    TetrahedralMesh mesh = this->Mesh;
    mesh.Points = points;
    return CompressionSimulation(mesh, this->Materials, HeldMaterials, {}, this->Options);
  }
};

using ElementUnloading = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementUnloading);

/// A breast at rest hangs, and is unloaded of its weight again.
void HangAndUnload(ElementType type, unsigned int seed)
{
  const RandomBreast breast(type, ChestWallMode::Fixed, seed);
  SCOPED_TRACE(breast.Name);
  const std::vector<double>& rest = breast.Mesh.Points;
  const CompressionState hanging = breast.Simulation(rest).Compress(test::OpenPlates());
  CompressionSimulation image = breast.Simulation(test::CornersOf(hanging.Positions, breast.Mesh));
  image.Unload(breast.Options.GravityMPerS2);
  EXPECT_EQ(image.StiffnessFactor(), 1);
  EXPECT_LT(test::LargestDifference(image.RestPositions(), rest), 0.01);
}

/// The shape of an image is unloaded, and hangs again from there.
void UnloadAndHang(ElementType type, unsigned int seed)
{
  const RandomBreast breast(type, ChestWallMode::Fixed, seed);
  SCOPED_TRACE(breast.Name);
  const std::vector<double>& points = breast.Mesh.Points;
  CompressionSimulation simulation = breast.Simulation(points);
  simulation.Unload(breast.Options.GravityMPerS2);
  RandomBreast again = breast;
  for (ElasticMaterial& material : again.Materials)
  {
    material.YoungsModulusKPa *= simulation.StiffnessFactor();
  }
  const CompressionState hanging =
    again.Simulation(test::CornersOf(simulation.RestPositions(), breast.Mesh))
      .Compress(test::OpenPlates());
  EXPECT_LT(test::LargestDifference(hanging.Positions, points), 0.01);
}

void CheckRandomBreasts(ElementType type, unsigned int from, unsigned int to)
{
  for (unsigned int seed = from; seed <= to; ++seed)
  {
    try
    {
      HangAndUnload(type, seed);
      UnloadAndHang(type, seed);
    }
    catch (const ConvergenceError& error)
    {
      ADD_FAILURE() << "seed " << seed << ": " << error.what();
    }
  }
}

TEST_P(ElementUnloading, GivesBackRandomBreasts)
{
  CheckRandomBreasts(GetParam(), 1, 8);
}

TEST_P(ElementUnloading, GivesBackManyRandomBreastsLong)
{
  if (!std::getenv("MAMMORAY_LONG_TESTS"))
  {
    GTEST_SKIP() << "some minutes; set MAMMORAY_LONG_TESTS to run it";
  }
  CheckRandomBreasts(GetParam(), 9, 208);
}

TEST_P(ElementUnloading, RaisesTheStiffnessOfTissueThatCannotBearItsWeight)
{
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 4);
  const auto materials = [](double modulus) {
    return std::vector<ElasticMaterial>{ {}, { modulus, 0.49 }, { modulus, 0.49 } };
  };
  for (const ChestWallMode mode :
    { ChestWallMode::Fixed, ChestWallMode::Sliding, ChestWallMode::Elastic })
  {
    CompressionOptions options = test::WithElement(GetParam(), 1e-8);
    options.ChestWall = mode;
    options.Wall = { 2, 0.5 };
    options.GravityMPerS2 = Hanging;
    CompressionSimulation soft(mesh, materials(0.004), HeldMaterials, {}, options);
    soft.Unload(Hanging);
    const double factor = soft.StiffnessFactor();
    EXPECT_GT(factor, 1.1);
    EXPECT_LT(factor, 50);
    EXPECT_EQ(soft.Materials(), materials(0.004));
    // The image is a state in equilibrium, and no cell at rest is turned inside out.
    const CompressionState hanging = soft.Compress(test::OpenPlates());
    EXPECT_LT(test::LargestDifference(hanging.Positions, mesh.Points), 0.01);
    EXPECT_EQ(hanging.StiffnessFactor, factor);
    EXPECT_GE(hanging.SmallestJ, 0.1);
    TetrahedralMesh rest = mesh;
    rest.Points = test::CornersOf(soft.RestPositions(), mesh);
    for (std::size_t cell = 0; cell < rest.NumberOfCells(); ++cell)
    {
      EXPECT_TRUE(mesh.Materials[cell] == 2 || rest.CellVolume(cell) > 0);
    }
    // Tissue and wall as stiff as that bear it as they are; a tenth softer ones do not.
    options.Wall = { 2 * factor, 0.5 * factor };
    CompressionSimulation enough(mesh, materials(0.004 * factor), HeldMaterials, {}, options);
    enough.Unload(Hanging);
    options.Wall = { 1.8 * factor, 0.45 * factor };
    CompressionSimulation softer(mesh, materials(0.0036 * factor), HeldMaterials, {}, options);
    softer.Unload(Hanging);
    if (mode != ChestWallMode::Sliding) // whose stiffness along the wall is a constant
    {
      EXPECT_EQ(enough.StiffnessFactor(), 1);
      EXPECT_GT(softer.StiffnessFactor(), 1);
    }
  }
}

TEST(StiffnessNote, TellsOfTheFactor)
{
  EXPECT_EQ(StiffnessNote(1), "");
  EXPECT_EQ(StiffnessNote(1.834),
    "The tissue is too soft for its own weight: all stiffness was raised by a factor of 1.83, the "
    "least that bears it");
}

TEST_P(ElementUnloading, FollowsTheMaterials)
{
  const RandomBreast breast(GetParam(), ChestWallMode::Elastic, 3);
  const Vector3 gravity = breast.Options.GravityMPerS2;
  CompressionSimulation changed = breast.Simulation(breast.Mesh.Points);
  changed.Unload(gravity);
  const std::vector<double> first = changed.RestPositions();
  RandomBreast stiffer = breast;
  stiffer.Materials[1].YoungsModulusKPa *= 1.3;
  stiffer.Materials[3].PoissonRatio = 0.46;
  changed.SetMaterials(stiffer.Materials);
  EXPECT_EQ(changed.Materials(), stiffer.Materials);
  CompressionSimulation made = stiffer.Simulation(breast.Mesh.Points);
  made.Unload(gravity);
  EXPECT_GT(test::LargestDifference(changed.RestPositions(), first), 0.3);
  EXPECT_LT(test::LargestDifference(changed.RestPositions(), made.RestPositions()), 1e-4);
  EXPECT_LT(test::LargestDifference(changed.ImagePositions(), made.ImagePositions()), 1e-4);
  // Softer ones than bear it: the factor rises, and stays.
  RandomBreast soft = breast;
  soft.Materials[1].YoungsModulusKPa = soft.Materials[3].YoungsModulusKPa = 0.02;
  changed.SetMaterials(soft.Materials);
  const double factor = changed.StiffnessFactor();
  EXPECT_GT(factor, 1);
  EXPECT_LT(
    test::LargestDifference(changed.Compress(test::OpenPlates()).Positions, breast.Mesh.Points),
    0.01);
  changed.SetMaterials(breast.Materials);
  EXPECT_EQ(changed.StiffnessFactor(), factor);
  // What is refused leaves things as they were.
  const std::vector<double> rest = changed.RestPositions();
  RandomBreast bad = breast;
  bad.Materials[1].PoissonRatio = 0.5;
  EXPECT_THROW(changed.SetMaterials(bad.Materials), InputError);
  EXPECT_EQ(changed.Materials(), breast.Materials);
  EXPECT_LT(test::LargestDifference(changed.RestPositions(), rest), 1e-12);
  EXPECT_EQ(changed.StiffnessFactor(), factor);
}

TEST_P(ElementUnloading, InterruptedLeavesThingsAsTheyWere)
{
  const RandomBreast breast(GetParam(), ChestWallMode::Elastic, 5);
  CompressionSimulation simulation = breast.Simulation(breast.Mesh.Points);
  const auto interruptAfter = [&](int calls, const Vector3& gravity)
  {
    const std::vector<double> rest = simulation.RestPositions();
    const std::vector<double> image = simulation.ImagePositions();
    const double factor = simulation.StiffnessFactor();
    EXPECT_THROW(simulation.Unload(gravity, [&](double, const char*) { return calls-- > 0; }),
      Interrupted);
    EXPECT_EQ(simulation.RestPositions(), rest);
    EXPECT_EQ(simulation.ImagePositions(), image);
    EXPECT_EQ(simulation.StiffnessFactor(), factor);
  };
  interruptAfter(0, breast.Options.GravityMPerS2);
  interruptAfter(3, breast.Options.GravityMPerS2);
  const CompressionState before = simulation.Compress(test::OpenPlates());
  simulation.Unload(breast.Options.GravityMPerS2);
  interruptAfter(2, -3.0 * breast.Options.GravityMPerS2);
  EXPECT_LT(
    test::LargestDifference(simulation.Compress(test::OpenPlates()).Positions, breast.Mesh.Points),
    1e-6);
  // Its own shape is still the one that belongs to its materials.
  std::vector<ElasticMaterial> materials = breast.Materials;
  simulation.SetMaterials(materials);
  EXPECT_LT(
    test::LargestDifference(simulation.Compress(test::OpenPlates()).Positions, breast.Mesh.Points),
    1e-6);
  EXPECT_GT(test::LargestDifference(before.Positions, breast.Mesh.Points), 0.1);
}
}
