// SPDX-License-Identifier: Apache-2.0
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Private/ElasticBody.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace
{
using namespace mammoray;
using test::FromModuli;

using ElementBody = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(ElementBody);

TEST_P(ElementBody, AveragesTheFieldOverTheCells)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 4, 4, 4 }, { 1, 1, 1 });
  const std::vector<ElasticMaterial> materials{ {}, FromModuli(1, 20), FromModuli(3, 60),
    FromModuli(100, 2000) };
  // Material 2 where z < 2, air elsewhere: there the cell's own material 1 counts.
  const ElasticBody half(
    mesh, materials, [](const Vector3& p) { return p[2] < 2 ? 2 : 0; }, {}, GetParam());
  double mu = 0;
  for (std::size_t element = 0; element < half.NumberOfElements(); ++element)
  {
    mu += half.ElementShearModulus(element) * half.ElementVolume(element) / 64;
  }
  // 220 lattice points in a cell meet 2 % of the difference of 2, 35 meet 4 %.
  EXPECT_NEAR(mu, 2, GetParam() == ElementType::Quadratic ? 0.04 : 0.08);
  // An ignored material counts as the cell's own.
  const ElasticBody ignoring(
    mesh, materials, [](const Vector3&) { return 3; }, { false, false, false, true }, GetParam());
  EXPECT_DOUBLE_EQ(ignoring.ElementShearModulus(0), materials[1].ShearModulusKPa());
  EXPECT_THROW(ElasticBody(
                 mesh, materials, [](const Vector3&) { return 9; }, {}, GetParam()),
    InputError);
}

TEST_P(ElementBody, MeasuresAnotherShapeAtRestAnew)
{
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 2, 3, 4 }, { 2, 2, 2 });
  ElasticBody body(mesh, { {}, {} }, {}, {}, GetParam());
  for (std::size_t c = 0; c < mesh.Points.size(); c += 3)
  {
    mesh.Points[c] *= 1.5;
  }
  body.SetRestCorners(mesh.Points);
  const ElasticBody wider(mesh, { {}, {} }, {}, {}, GetParam());
  for (std::size_t c = 0; c < wider.RestPositions().size(); ++c)
  {
    EXPECT_DOUBLE_EQ(body.RestPositions()[c], wider.RestPositions()[c]);
  }
  double area = 0;
  for (std::size_t f = 0; f < body.Faces().size(); ++f)
  {
    EXPECT_NEAR(body.Faces()[f].Area, wider.Faces()[f].Area, 1e-12);
    area += body.Faces()[f].Area;
  }
  EXPECT_NEAR(area, 2 * (3 * 3 + 3 * 4 + 3 * 4), 1e-12);
  double volume = 0;
  for (std::size_t element = 0; element < body.NumberOfElements(); ++element)
  {
    volume += body.ElementVolume(element);
  }
  EXPECT_NEAR(volume, 3 * 3 * 4, 1e-12);
}

TEST_P(ElementBody, NodeIntegralsSumToTheVolumeAndCarryItsMiddle)
{
  const ElasticBody body(test::MakeBoxMesh({ 1, 2, 3 }, { 3, 5, 7 }, { 2, 2, 2 }), { {}, {} }, {},
    {}, GetParam());
  const std::vector<double> parts =
    body.NodeIntegrals(std::vector<double>(body.NumberOfCells(), 2.0));
  EXPECT_NEAR(std::accumulate(parts.begin(), parts.end(), 0.0), 2 * 24, 1e-12);
  // Linear functions are integrated exactly: the first moment is the middle's.
  for (int axis = 0; axis < 3; ++axis)
  {
    double moment = 0;
    for (std::size_t n = 0; n < parts.size(); ++n)
    {
      moment += parts[n] * body.RestPositions()[3 * n + axis];
    }
    EXPECT_NEAR(moment / 48, Vector3({ 2, 3.5, 5 })[axis], 1e-12);
  }
}

TEST(ElasticBody, RefusesBadMaterials)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 1, 1, 1 }, { 1, 1, 1 });
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.5 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { -1, 0.4 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.4, -1 } }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {}, { 5, 0.4, 51 } }), InputError);
  ElasticBody body(mesh, { {}, { 5, 0.4 } });
  EXPECT_THROW(body.SetMaterials({ {} }), InputError);
  EXPECT_THROW(ElasticBody(mesh, { {} }), InputError) << "material 1 is not in the table";
}
}
