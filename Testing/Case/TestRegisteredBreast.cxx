// SPDX-License-Identifier: Apache-2.0
#include "SqueezedBox.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>

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

TEST_F(RegisteredBox, UncertaintyIsThatOfTheParameterAlongItsVelocity)
{
  const Vector3 point{ 12, 20, -6 };
  const ImagedPoint imaged = this->Breast->ToMammogram(point);
  ASSERT_TRUE(imaged.Uncertainty.has_value());
  // Along x, which is along the rows' step: 90 degrees from the columns'.
  EXPECT_NEAR(imaged.Uncertainty->MajorMm, ThicknessSigmaMm * Magnification(Squeezed(point)[2]),
    1e-9);
  EXPECT_NEAR(imaged.Uncertainty->MinorMm, 0, 1e-6);
  EXPECT_NEAR(std::abs(imaged.Uncertainty->AngleDeg), 90, 1e-6);
}

TEST_F(RegisteredBox, APixelHasTheTissueOfItsRayBehindIt)
{
  const ImagedPoint imaged = this->Breast->ToMammogram({ 12, 20, -6 });
  const std::vector<TissueStretch> stretches =
    this->Breast->ToVolume(imaged.Column, imaged.Row, 0.1);
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
  const auto refusal = [](const auto& ask)
  {
    try
    {
      ask();
    }
    catch (const InputError& error)
    {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_THAT(refusal(
                [&] {
                  this->Breast->ToMammogram({ 100, 20, 0 });
                }),
    HasSubstr("expected a place in the breast, found none within 1 mm"));
  EXPECT_THAT(refusal([&] { this->Breast->ToVolume(30, 10); }), HasSubstr("columns 0 to 29"));
  EXPECT_THAT(refusal([&] { this->Breast->ToVolume(3, 10, 0); }), HasSubstr("positive length"));
  std::filesystem::remove(this->Folder.File("compressed.vtu"));
  EXPECT_THAT(refusal([&] { RegisteredBreast(this->Folder.File("")); }),
    HasSubstr("compressed.vtu: no such file"));
}

TEST_F(RegisteredBox, TakesTheWiderCovarianceWhereThereIsOne)
{
  ResultFile result = ReadResultFile(this->Folder.File(""));
  result.ConsideredCovariance = test::OnlyThickness(3);
  const RegisteredBreast breast(ReadBreastInUnit(result));
  const Vector3 point{ 12, 20, -6 };
  EXPECT_NEAR(breast.ToMammogram(point).Uncertainty->MajorMm, 3 * Magnification(Squeezed(point)[2]),
    1e-9);
  result.Covariance.clear();
  result.ConsideredCovariance.clear();
  EXPECT_FALSE(RegisteredBreast(ReadBreastInUnit(result)).ToMammogram(point).Uncertainty);
}
