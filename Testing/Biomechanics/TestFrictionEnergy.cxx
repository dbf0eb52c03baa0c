// SPDX-License-Identifier: Apache-2.0
#include "EnergyChecks.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "mammoray/Biomechanics/Private/FrictionEnergy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;
using test::PressedBlock;
using test::Shaken;

using ElementFriction = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementFriction);

/// The block, all free, with points that stick and points that slide: 0.02 to 0.2 mm from their
/// anchors.
struct Rubbed : PressedBlock
{
  static constexpr double Coefficient = 0.5;
  MovingPart Part{ Body, std::vector<bool>(Positions.size(), false) };
  ContactEnergy Contact{ Part, 1000 };
  FrictionEnergy Friction{ Part };
  FrictionStart Before{ {}, Shaken(Positions, 0.1, 3), Plates };

  explicit Rubbed(ElementType type)
    : PressedBlock(type)
  {
    this->Contact.SetPlates(this->Plates);
    this->Friction.SetPlates(this->Plates);
    this->Friction.SetPoints(FrictionOfContact(this->Part, this->Contact, this->Positions,
      this->Plates, Coefficient, this->Before));
  }
  /// By all coordinates.
  std::vector<double> Gradient() const
  {
    std::vector<double> gradient(this->Positions.size(), 0.0);
    for (std::size_t element = 0; element < this->Friction.NumberOfPieces(); ++element)
    {
      const auto at =
        test::EvaluatePiece(this->Friction, element, this->Positions, EnergyOrder::Gradient);
      for (std::size_t c = 0; c < at.Gradient.size(); ++c)
      {
        gradient[3 * this->Friction.NodesOf(element)[c / 3] + c % 3] += at.Gradient[c];
      }
    }
    return gradient;
  }
};

TEST_P(ElementFriction, DerivativesMatchCentralDifferences)
{
  const Rubbed block(GetParam());
  ASSERT_GT(block.Friction.Points().size(), 20u);
  const auto errors = test::FindDerivativeErrors(block.Friction, block.Positions, 1e-6);
  EXPECT_GT(Norm(errors.Measures.Friction[0]), 1);
  // h^2 = 1e-12 mm^2 over the square of the slip.
  EXPECT_LT(errors.Gradient, 1e-7 * errors.GradientSize);
  EXPECT_LT(errors.Hessian, 1e-6 * errors.HessianSize);
}

TEST_P(ElementFriction, OfAContactIsNoMoreThanCoulombs)
{
  const Rubbed block(GetParam());
  double sliding = 0;
  for (const FrictionPoint& point : block.Friction.Points())
  {
    EXPECT_DOUBLE_EQ(point.SlidingForce, Rubbed::Coefficient * point.NormalForce);
    sliding += point.SlidingForce;
  }
  Vector3 sum{ 0, 0, 0 };
  const std::vector<double> gradient = block.Gradient();
  for (std::size_t c = 0; c < gradient.size(); ++c)
  {
    sum[c % 3] -= gradient[c];
  }
  EXPECT_GT(Norm(sum), 0);
  EXPECT_LE(Norm(sum), sliding * (1 + 1e-12));
}

TEST_P(ElementFriction, PointsThatTouchedKeepTheirAnchors)
{
  Rubbed block(GetParam());
  const FrictionPoints first = block.Friction.Points();
  block.Before.Dragged = DraggedTo(block.Body, block.Positions, block.Plates, first);
  const FrictionPoints again = FrictionOfContact(block.Part, block.Contact, block.Positions,
    block.Plates, Rubbed::Coefficient, block.Before);
  ASSERT_EQ(again.size(), first.size());
  int dragged = 0;
  for (std::size_t p = 0; p < first.size(); ++p)
  {
    const auto& expected = block.Before.Dragged[p];
    EXPECT_EQ(again[p].Face, expected.Face);
    EXPECT_EQ(again[p].Anchor, expected.Anchor);
    dragged += expected.Anchor != first[p].Anchor;
  }
  EXPECT_GT(dragged, 0);
  EXPECT_LT(dragged, static_cast<int>(first.size()));
}

TEST_P(ElementFriction, ForcesOfParametersAreRatesOfTheGradient)
{
  Rubbed block(GetParam());
  PlatePairVelocity velocity;
  velocity.Paddle = { { 0.2, 0.3, -0.4 }, { 0.01, 0.005, 0.01 } };
  std::vector<double> moving(block.Positions.size(), 0.0), rougher = moving;
  for (std::size_t element = 0; element < block.Friction.NumberOfPieces(); ++element)
  {
    block.Friction.AddPlateForces(element, block.Positions, { velocity }, moving);
    block.Friction.AddCoefficientForces(element, block.Positions, 0.3, rougher.data());
  }
  constexpr double h = 1e-6;
  const auto moved = [&](double by)
  {
    block.Friction.SetPlates(MovedPlates(block.Plates, velocity, by));
    return block.Gradient();
  };
  std::vector<double> difference = test::Difference(moved(-h), moved(h));
  for (double& value : difference)
  {
    value /= 2 * h;
  }
  EXPECT_LT(test::NormOf(test::Difference(difference, moving)), 1e-6 * test::NormOf(moving));
  // The force is linear in the coefficient.
  std::vector<double> whole = moved(0);
  for (double& value : whole)
  {
    value *= -0.3 / Rubbed::Coefficient;
  }
  EXPECT_LT(test::NormOf(test::Difference(whole, rougher)), 1e-12 * test::NormOf(rougher));
}
}
