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

TEST(PlateFriction, ForceIsCoulombsBeyondTheSlipAndElasticBelow)
{
  const Plate plate;
  FrictionPoint point; // sticks at the plate's edge
  for (const double slip : { 0.2 * FrictionPoint::SlipMm, FrictionPoint::SlipMm, 3.0 })
  {
    const FrictionTerms terms(point, plate, { 0.6 * slip, 0.8 * slip, -0.02 });
    EXPECT_NEAR(Norm(terms.Slip), slip, 1e-15);
    const double y = slip / FrictionPoint::SlipMm;
    EXPECT_NEAR(Norm(terms.Gradient()), y < 1 ? 2 * y - y * y : 1, 1e-12);
    EXPECT_NEAR(terms.Gradient()[2], 0, 1e-15);
  }
}

TEST(PlateFriction, DerivativesMatchCentralDifferences)
{
  Plate plate;
  plate.Edge = { 3, -2, 5 };
  plate.Normal = { 0.6, 0, 0.8 };
  plate.Inward = { 0, 1, 0 };
  FrictionPoint point;
  point.Anchor = { 1, 4, 0.01 };
  point.Normal = { 0, -0.6, 0.8 }; // on the round of the edge
  const PlateVelocity velocity{ { 0.3, -0.2, 0.5 }, { 0.02, 0.03, -0.05 } };
  for (const double slip : { 0.02, 0.3 })
  {
    const Vector3 x = PointFromPlate(plate, point.Anchor) + slip * Vector3{ 0.3, 0.9, 0.5 };
    const FrictionTerms terms(point, plate, x);
    constexpr double h = 1e-6;
    for (const Vector3& v : { Vector3{ 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } })
    {
      const FrictionTerms low(point, plate, x - h * v), high(point, plate, x + h * v);
      // h^2 over the square of the slip's length, 4e-4 mm^2; roundoff over h.
      EXPECT_NEAR((high.Energy - low.Energy) / (2 * h), Dot(terms.Gradient(), v), 1e-8);
      const Vector3 difference = (1 / (2 * h)) * (high.Gradient() - low.Gradient());
      EXPECT_NEAR(Norm(difference - terms.HessianTimes(v)), 0, 1e-6);
    }
    const FrictionTerms low(point, MovedPlate(plate, velocity, -h), x);
    const FrictionTerms high(point, MovedPlate(plate, velocity, h), x);
    const Vector3 difference = (1 / (2 * h)) * (high.Gradient() - low.Gradient());
    EXPECT_NEAR(Norm(difference - terms.GradientDerivative(plate, velocity, x)), 0, 1e-6);
  }
}

TEST(PlateFriction, AnAnchorIsDraggedNoFartherThanItMust)
{
  const Plate plate;
  FrictionPoint point;
  const Vector3 near{ 0.5 * FrictionPoint::SlipMm, 0, 0 };
  EXPECT_EQ(Dragged(point, plate, near).Anchor, point.Anchor);
  const Vector3 far{ 0, 2, 0.01 };
  const FrictionTerms terms(Dragged(point, plate, far), plate, far);
  EXPECT_NEAR(Norm(terms.Slip - Vector3{ 0, FrictionPoint::SlipMm, 0 }), 0, 1e-12);
}
}
