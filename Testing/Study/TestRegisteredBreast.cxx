// SPDX-License-Identifier: Apache-2.0
#include "SqueezedBox.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammoray/Study/RegisteredBreast.h"

#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
using RegisteredBox = test::SqueezedBox;

/// Magnification of a point at this height above the receptor.
double Magnification(double z)
{
  return 650 / (650 - z);
}

template <typename Ask>
std::string Refusal(const Ask& ask)
{
  try
  {
    ask();
  }
  catch (const InputError& error)
  {
    return error.what();
  }
  return "nothing was refused";
}
}

TEST_F(RegisteredBox, APointIsSeenWhereTheRayThroughItEnds)
{
  const Vector3 point{ 12, 20, -6 };
  const ImagedPoint imaged = this->Breast->ToMammogram(point);
  const Vector3 moved = Squeezed(point);
  EXPECT_LT(Norm(imaged.Compressed - moved), 1e-9);
  const double factor = Magnification(moved[2]);
  EXPECT_NEAR(imaged.ReceptorMm[0], factor * moved[0], 1e-9);
  EXPECT_NEAR(imaged.ReceptorMm[1], factor * moved[1], 1e-9);
  EXPECT_NEAR(imaged.Column, (factor * moved[1] - 1) / 2, 1e-9);
  EXPECT_NEAR(imaged.Row, (48 - factor * moved[0]) / 2, 1e-9);
  EXPECT_TRUE(imaged.InImage);
  EXPECT_EQ(imaged.Material, "fat");
}

TEST_F(RegisteredBox, UncertaintyIsOfTheParameterAlongItsVelocityAndOfTheModelAllAround)
{
  const Vector3 point{ 12, 20, -6 };
  const ImagedPoint imaged = this->Breast->ToMammogram(point);
  ASSERT_TRUE(imaged.Uncertainty.has_value());
  ASSERT_TRUE(imaged.Covariance.has_value());
  // The nearest rigid motion is a shift: the point is a quarter of its x and half of its z off.
  // Middles of some cells stand for the tissue, which turns it by a degree or two.
  const double model = std::hypot(ModelErrorMm, ModelErrorShare * std::hypot(3, 3));
  const std::array<double, 9>& covariance = *imaged.Covariance;
  EXPECT_NEAR(covariance[0], ThicknessSigmaMm * ThicknessSigmaMm + model * model, 0.03);
  EXPECT_NEAR(covariance[4], model * model, 0.03);
  EXPECT_NEAR(covariance[8], covariance[4], 1e-12);
  EXPECT_NEAR(covariance[4], imaged.ModelSigmaMm * imaged.ModelSigmaMm, 1e-12);
  EXPECT_NEAR(covariance[1], 0, 1e-12);
  // Along x, which is along the rows' step: 90 degrees from the columns'. Rays are aslant by 2
  // degrees.
  const double factor = Magnification(Squeezed(point)[2]);
  EXPECT_NEAR(imaged.Uncertainty->MajorMm, factor * std::sqrt(covariance[0]), 0.002);
  EXPECT_NEAR(imaged.Uncertainty->MinorMm, factor * std::sqrt(covariance[4]), 0.002);
  EXPECT_NEAR(std::abs(imaged.Uncertainty->AngleDeg), 90, 0.1);
}

TEST_F(RegisteredBox, APixelHasTheTissueOfItsRayBehindIt)
{
  const ImagedPoint imaged = this->Breast->ToMammogram({ 12, 20, -6 });
  const std::vector<RaySegment> stretches = this->Breast->ToVolume(imaged.Column, imaged.Row, 0.1);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].Material, "fat");
  // From 2 to 22 mm above the receptor, a little aslant; steps of 0.1 mm.
  EXPECT_NEAR(stretches[0].EntryHeightMm, 22, 0.1);
  EXPECT_NEAR(stretches[0].ExitHeightMm, 2, 0.1);
  EXPECT_NEAR(stretches[0].LengthMm, 20, 0.2);
  double nearest = 1e9;
  for (const Vector3& point : stretches[0].Uncompressed)
  {
    nearest = std::min(nearest, Norm(point - Vector3{ 12, 20, -6 }));
  }
  EXPECT_LT(nearest, 0.15); // half a step, stretched by 2
}

TEST_F(RegisteredBox, TwoViewsKnowThePlaceAlongTheXRay)
{
  // A unit that looks along x, its receptor beside the box.
  BreastInUnit turned = ReadBreastInUnit(ReadResultFile(this->Folder.File("")));
  turned.Placed = { { -40, 0, 12 }, { 0, 0, -1 }, { 0, 1, 0 }, { 1, 0, 0 } };
  const RegisteredBreast other(turned);
  const Vector3 point{ 12, 20, -6 };
  const auto seenIn = [&](const RegisteredBreast& breast)
  {
    const ImagedPoint imaged = breast.ToMammogram(point);
    return SeenInView{ &breast, { imaged.Column, imaged.Row } };
  };
  const auto found = FindInTwoViews(seenIn(*this->Breast), seenIn(other));
  ASSERT_TRUE(found.has_value());
  // Steps of 0.5 mm, stretched by 2 along z.
  EXPECT_LT(Norm(found->Point - point), 0.6);
  EXPECT_LT(found->GapMm, 0.7);
  // Beside the box there is nothing.
  EXPECT_FALSE(FindInTwoViews({ this->Breast.get(), { 29, 2 } }, seenIn(other)));
}

TEST_F(RegisteredBox, TissueIsCarriedAndWhatLiesOutsideGoesWithTheNearest)
{
  const CarriedPoint inside = this->Breast->Carry({ 12, 20, -6 });
  EXPECT_FALSE(inside.Outside);
  EXPECT_LT(Norm(Vector3{ 12, 20, -6 } + inside.Displacement - Squeezed({ 12, 20, -6 })), 1e-9);
  const CarriedPoint outside = this->Breast->Carry({ 12, 20, -40 });
  EXPECT_TRUE(outside.Outside);
  EXPECT_LT(Norm(outside.Displacement - (Squeezed({ 12, 20, -20 }) - Vector3{ 12, 20, -20 })),
    1e-9);
}

TEST_F(RegisteredBox, RefusesPlacesOutside)
{
  EXPECT_THAT(Refusal(
                [&] {
                  this->Breast->ToMammogram({ 100, 20, 0 });
                }),
    HasSubstr("expected a place in the breast, found none within 1 mm"));
  EXPECT_THAT(Refusal([&] { this->Breast->ToVolume(30, 10); }), HasSubstr("columns 0 to 29"));
  EXPECT_THAT(Refusal([&] { this->Breast->ToVolume(3, 10, 0); }), HasSubstr("positive length"));
  std::filesystem::remove(this->Folder.File("compressed.vtu"));
  EXPECT_THAT(Refusal([&] { RegisteredBreast(this->Folder.File("")); }),
    HasSubstr("compressed.vtu: no such file"));
}

TEST_F(RegisteredBox, RefusesMeshesOfAnotherRegistration)
{
  const std::string uncompressed = this->Folder.File("uncompressed.vtu");
  const auto read = [&] { ReadBreastInUnit(ReadResultFile(this->Folder.File(""))); };
  const auto grid = ReadMesh(uncompressed);
  WriteMesh(grid, this->Folder.File("compressed.vtu"));
  EXPECT_THAT(Refusal(read),
    HasSubstr("compressed.vtu: expected the points of uncompressed.vtu, displaced"));
  VolumeFromGantry other = ReadResultFile(this->Folder.File("")).Placed;
  other.Origin[1] += 0.1;
  AddPlacement(grid, other);
  WriteMesh(grid, uncompressed);
  EXPECT_THAT(Refusal(read), HasSubstr("found one of another registration"));
}

TEST_F(RegisteredBox, TakesTheWiderCovarianceWhereThereIsOne)
{
  ResultFile result = ReadResultFile(this->Folder.File(""));
  result.ConsideredCovariance = test::OnlyThickness(3);
  const RegisteredBreast breast(ReadBreastInUnit(result));
  const Vector3 point{ 12, 20, -6 };
  // That of the parameter, 4, becomes 9 beside the model's own.
  EXPECT_NEAR((*breast.ToMammogram(point).Covariance)[0],
    (*this->Breast->ToMammogram(point).Covariance)[0] + 9 - ThicknessSigmaMm * ThicknessSigmaMm,
    1e-9);
  result.Covariance.clear();
  result.ConsideredCovariance.clear();
  EXPECT_FALSE(RegisteredBreast(ReadBreastInUnit(result)).ToMammogram(point).Uncertainty);
}
