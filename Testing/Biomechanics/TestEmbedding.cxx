// SPDX-License-Identifier: Apache-2.0
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;

CompressionSimulation MakeSimulation(ElementType type = ElementType::Quadratic)
{
  CompressionOptions options;
  options.Element = type;
  return CompressionSimulation(test::MakeHalfEllipsoidMesh(30, 35, 28, 6), { {}, {}, {} },
    { false, false, true }, {}, options);
}

using ElementEmbedding = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementEmbedding);

TEST_P(ElementEmbedding, CarriesItsPolynomialsInside)
{
  CompressionSimulation simulation = MakeSimulation(GetParam());
  const double square = GetParam() == ElementType::Quadratic ? 0.01 : 0;
  const auto field = [square](const double* x, int axis)
  { return axis + x[0] * 2 - x[1] + square * (x[axis] * x[(axis + 1) % 3] + x[2] * x[2]); };
  std::vector<double> values = simulation.RestPositions();
  for (std::size_t n = 0; n < values.size(); n += 3)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      values[n + axis] = field(&simulation.RestPositions()[n], axis);
    }
  }
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> coordinate(-12, 12);
  std::vector<double> points;
  for (int p = 0; p < 200; ++p)
  {
    points.insert(points.end(),
      { coordinate(generator), 13 + coordinate(generator), coordinate(generator) });
  }
  const Embedding embedding(simulation, points);
  const std::vector<double> mapped = embedding.Map(values);
  for (std::size_t n = 0; n < points.size(); ++n)
  {
    // Ten shape functions span all quadratic polynomials, four all linear ones: roundoff only.
    EXPECT_NEAR(mapped[n], field(&points[n - n % 3], static_cast<int>(n % 3)), 1e-10);
  }
}

TEST_P(ElementEmbedding, ExtendsLinearFieldsOutside)
{
  CompressionSimulation simulation = MakeSimulation(GetParam());
  // 2 mm in front of the nipple, where the mesh has a node at y = 35; one far off; one behind the
  // wall.
  const std::vector<double> points{ 0, 37, 0, 60, 60, 0, 3, -1, 2 };
  const Embedding embedding(simulation, points);
  const std::vector<double> mapped = embedding.Map(simulation.RestPositions());
  for (std::size_t n = 0; n < points.size(); ++n)
  {
    EXPECT_NEAR(mapped[n], points[n], 1e-9);
  }
}

TEST(Embedding, TakesTheMiddlesGradientOutside)
{
  // Tissue that is pulled out towards the nipple, with a gradient of 10 at its tip.
  CompressionSimulation simulation = MakeSimulation();
  std::vector<double> positions = simulation.RestPositions();
  for (std::size_t n = 1; n < positions.size(); n += 3)
  {
    positions[n] += std::pow(std::max(0.0, positions[n] - 30), 2);
  }
  const std::vector<double> mapped = Embedding(simulation, { 0, 35, 0, 0, 37, 0 }).Map(positions);
  EXPECT_NEAR(mapped[1], 60, 1e-9);
  // Of the cell, not of its corner: 2 mm times 1 + 10 would be 22.
  EXPECT_GT(mapped[4], 60 + 2);
  EXPECT_LT(mapped[4], 60 + 18);
}

TEST_P(ElementEmbedding, GatheringIsTheTransposeOfMapping)
{
  CompressionSimulation simulation = MakeSimulation(GetParam());
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> number(-20, 20);
  const auto random = [&](std::size_t count)
  {
    std::vector<double> values(count);
    std::generate(values.begin(), values.end(), [&] { return number(generator); });
    return values;
  };
  const Embedding embedding(simulation, random(60));
  const std::vector<double> nodes = random(3 * simulation.NumberOfNodes());
  const std::vector<double> points = random(60);
  const std::vector<double> mapped = embedding.Map(nodes);
  const std::vector<double> gathered = embedding.Gather(points, simulation.NumberOfNodes());
  EXPECT_NEAR(std::inner_product(mapped.begin(), mapped.end(), points.begin(), 0.0),
    std::inner_product(nodes.begin(), nodes.end(), gathered.begin(), 0.0), 1e-8);
}

TEST(Embedding, RefusesWhatIsNoPoint)
{
  CompressionSimulation simulation = MakeSimulation();
  EXPECT_THROW(Embedding(simulation, { 1, 2 }), InputError);
  EXPECT_THROW(Embedding(simulation, { 1, 2, std::numeric_limits<double>::quiet_NaN() }),
    InputError);
  EXPECT_TRUE(Embedding(simulation, {}).Map(simulation.RestPositions()).empty());
}
}
