// SPDX-License-Identifier: Apache-2.0
#include "EnergyChecks.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "mammoray/Biomechanics/Private/ContactEnergy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace
{
using namespace mammoray;
using test::PressedBlock;

using ElementContact = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementContact);

TEST(ContactLaw, IsAParabolaAndItsTangentBeyondTheLayer)
{
  constexpr double stiffness = 300, layer = ContactEnergy::LayerMm;
  const ContactLaw inside(stiffness, 0.6 * layer);
  EXPECT_DOUBLE_EQ(inside.Pressure, stiffness * 0.36 * layer * layer);
  const ContactLaw at(stiffness, layer), beyond(stiffness, 3 * layer);
  EXPECT_DOUBLE_EQ(beyond.Pressure, at.Pressure + 2 * layer * at.Slope);
  EXPECT_DOUBLE_EQ(beyond.Slope, at.Slope);
  for (const double depth : { 0.4 * layer, 0.999 * layer, 1.001 * layer, 2.5 * layer })
  {
    constexpr double h = 1e-6;
    const ContactLaw low(stiffness, depth - h), high(stiffness, depth + h), law(stiffness, depth);
    // h^2 and eps / h.
    EXPECT_NEAR((high.Energy - low.Energy) / (2 * h), law.Pressure, 1e-8);
    EXPECT_NEAR((high.Pressure - low.Pressure) / (2 * h), law.Slope, 1e-6);
  }
}

/// The block, all free, its plates in place.
struct Pressed : PressedBlock
{
  MovingPart Part{ Body, std::vector<bool>(Positions.size(), false) };
  ContactEnergy Contact{ Part, 1000 };

  explicit Pressed(ElementType type)
    : PressedBlock(type)
  {
    this->Contact.SetPlates(this->Plates);
  }
};

TEST_P(ElementContact, DerivativesMatchCentralDifferences)
{
  const Pressed block(GetParam());
  const auto errors = test::FindDerivativeErrors(block.Contact, block.Positions, 1e-6);
  EXPECT_GT(errors.Measures.Penetration, 0.05);
  EXPECT_GT(errors.Measures.NormalForce[0], 1);
  EXPECT_GT(errors.Measures.NormalForce[1], 1);
  // h^2 = 1e-12 over the layer's 0.05 mm squared; where a point comes into the layer within h the
  // curvature bends.
  EXPECT_LT(errors.Gradient, 1e-7 * errors.GradientSize);
  EXPECT_LT(errors.Hessian, 1e-6 * errors.HessianSize);
}

TEST_P(ElementContact, ForcesOfTheNodesAreThoseOnThePlates)
{
  const Pressed block(GetParam());
  Vector3 sum{ 0, 0, 0 };
  PositionMeasures measures;
  double pressed = 0;
  for (std::size_t element = 0; element < block.Contact.NumberOfPieces(); ++element)
  {
    const auto at =
      test::EvaluatePiece(block.Contact, element, block.Positions, EnergyOrder::Gradient);
    measures.Add(at.Measures);
    for (std::size_t c = 0; c < at.Gradient.size(); ++c)
    {
      sum[c % 3] -= at.Gradient[c];
    }
    for (const ContactPoint& point : block.Contact.PointsAt(element, block.Positions, block.Plates))
    {
      pressed += point.Weight * point.Law.Pressure;
    }
  }
  EXPECT_NEAR(sum[2], measures.NormalForce[0] - measures.NormalForce[1], 1e-9 * pressed);
  // On the rounded edges pressure points along the plates, too.
  EXPECT_LE(measures.NormalForce[0] + measures.NormalForce[1], pressed);
  EXPECT_GT(measures.NormalForce[0] + measures.NormalForce[1], 0.5 * pressed);
}

TEST_P(ElementContact, PlateForcesAreTheRateOfTheGradient)
{
  Pressed block(GetParam());
  PlatePairVelocity velocity;
  velocity.Paddle = { { 0.2, 0.3, -0.4 }, { 0.01, 0.005, 0.01 } };
  velocity.Support.Linear = { 0.1, -0.3, 0.2 };
  std::vector<double> exact(block.Positions.size(), 0.0);
  for (std::size_t element = 0; element < block.Contact.NumberOfPieces(); ++element)
  {
    block.Contact.AddPlateForces(element, block.Positions, { velocity }, exact);
  }
  const auto gradientAt = [&](double by)
  {
    block.Contact.SetPlates(MovedPlates(block.Plates, velocity, by));
    std::vector<double> gradient(block.Positions.size(), 0.0);
    for (std::size_t element = 0; element < block.Contact.NumberOfPieces(); ++element)
    {
      const auto at =
        test::EvaluatePiece(block.Contact, element, block.Positions, EnergyOrder::Gradient);
      for (std::size_t c = 0; c < at.Gradient.size(); ++c)
      {
        gradient[3 * block.Contact.NodesOf(element)[c / 3] + c % 3] += at.Gradient[c];
      }
    }
    return gradient;
  };
  constexpr double h = 1e-6;
  std::vector<double> difference = test::Difference(gradientAt(-h), gradientAt(h));
  for (double& value : difference)
  {
    value /= 2 * h;
  }
  EXPECT_LT(test::NormOf(test::Difference(difference, exact)), 1e-6 * test::NormOf(exact));
}

TEST_P(ElementContact, OpenedPlatesTouchNothing)
{
  const Pressed block(GetParam());
  const std::array<double, 2> opening = block.Contact.Opening(block.Positions, block.Plates);
  for (const double less : { 0.0, 0.02 })
  {
    PlatePair opened = block.Plates;
    opened.Support.Edge = opened.Support.Edge - (opening[0] - less) * opened.Support.Normal;
    opened.Paddle.Edge = opened.Paddle.Edge - (opening[1] - less) * opened.Paddle.Normal;
    int touching[2] = { 0, 0 };
    for (std::size_t element = 0; element < block.Contact.NumberOfPieces(); ++element)
    {
      for (const ContactPoint& point : block.Contact.PointsAt(element, block.Positions, opened))
      {
        // 1e-12 mm: roundoff of positions.
        touching[point.Side] += ContactEnergy::LayerMm - point.Distance.Distance > 1e-12;
      }
    }
    EXPECT_EQ(touching[0] > 0, less > 0);
    EXPECT_EQ(touching[1] > 0, less > 0);
  }
}

TEST_P(ElementContact, NodePressuresOfAnEvenlyPressedFaceAreItsPressure)
{
  // The support 0.03 mm deep in all of the bottom face.
  Pressed block(GetParam());
  Plate support;
  support.Edge = { 0, -50, 0.03 - ContactEnergy::LayerMm };
  PlatePair plates = block.Plates;
  plates.Support = support;
  plates.Paddle.Edge = { 0, 0, 500 };
  block.Contact.SetPlates(plates);
  const std::vector<double>& rest = block.Body.RestPositions();
  const std::vector<double> pressures = block.Contact.NodePressures(rest);
  int below = 0;
  for (std::size_t n = 0; n < pressures.size(); ++n)
  {
    // The corner in the middle of the face; others share theirs with the free sides.
    const bool inside = rest[3 * n] == 10 && rest[3 * n + 1] == 10;
    if (rest[3 * n + 2] < 1e-9 && inside)
    {
      EXPECT_NEAR(pressures[n], 1000 * 0.03 * 0.03, 1e-12);
      ++below;
    }
    else if (rest[3 * n + 2] > 10)
    {
      EXPECT_EQ(pressures[n], 0);
    }
  }
  EXPECT_EQ(below, 1);
}

TEST(FacePoints, IntegrateTheTriangle)
{
  double weight = 0;
  std::array<double, 3> middle{};
  for (const FacePoint& point : FacePoints())
  {
    weight += point.Weight;
    for (int c = 0; c < 3; ++c)
    {
      middle[c] += point.Weight * point.Lambda[c];
    }
    for (const int nodes : { 3, 6 })
    {
      const std::array<double, 6> shape = FaceShape(point, nodes);
      EXPECT_NEAR(std::accumulate(shape.begin(), shape.end(), 0.0), 1, 1e-14);
    }
  }
  EXPECT_EQ(FacePoints().size(), 64u);
  EXPECT_NEAR(weight, 1, 1e-14);
  for (const double coordinate : middle)
  {
    EXPECT_NEAR(coordinate, 1 / 3.0, 1e-14);
  }
}
}
