// SPDX-License-Identifier: Apache-2.0
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "mammoray/Biomechanics/Private/MovingPart.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace
{
using namespace mammoray;
using test::PressedBlock;

using ElementPart = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementPart);

TEST_P(ElementPart, UnknownsAreTheFreeCoordinatesOfMovingElements)
{
  const PressedBlock block(GetParam());
  const ElasticBody& body = block.Body;
  std::vector<bool> fixed(block.Positions.size(), false);
  for (std::size_t n = 0; n < fixed.size(); n += 3)
  {
    fixed[n] = fixed[n + 1] = fixed[n + 2] = body.RestPositions()[n + 1] < 10 + 1e-9;
  }
  const MovingPart part(body, fixed, test::CellsOfMaterial(PressedBlock::Mesh(), 2));
  EXPECT_NEAR(part.RigidVolume(), 4000, 1e-9);
  EXPECT_EQ(part.NumberOfUnknowns(),
    static_cast<std::size_t>(std::count(fixed.begin(), fixed.end(), false)));
  for (std::size_t u = 0; u < part.NumberOfUnknowns(); ++u)
  {
    EXPECT_EQ(part.Unknowns()[part.Coordinates()[u]], static_cast<std::int32_t>(u));
  }
  // Faces: of the moving half, five sides of 20 x 20 x 10.
  double area = 0;
  for (const std::int32_t element : part.Elements())
  {
    for (const std::int32_t f : part.FacesOf(element))
    {
      EXPECT_EQ(part.ElementOfFace(f), element);
      area += body.Faces()[f].Area;
    }
  }
  EXPECT_NEAR(area, 400 + 4 * 200, 1e-9);
  EXPECT_THROW(MovingPart(body, std::vector<bool>(fixed.size(), true)), InputError);
  EXPECT_THROW(MovingPart(body, { true }), InputError);
}
}
