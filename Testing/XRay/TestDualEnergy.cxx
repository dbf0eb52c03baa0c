// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/DualEnergy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

/// Air, fat, gland, and gland with 2 mg of iodine per ml.
class DualEnergy : public testing::Test
{
protected:
  Beam BeamOf(const Spectrum& spectrum) const
  {
    return { spectrum, DetectorResponse::EnergyIntegrating,
      { nullptr, &this->Fat, &this->Gland, &this->Enhanced }, { 0, 0.93, 1.04, 1.04 } };
  }

  AttenuationTable Fat = RequireComposition("H:0.112 C:0.619 N:0.017 O:0.251 S:0.001", "fat");
  AttenuationTable Gland = RequireComposition("H:0.102 C:0.184 N:0.032 O:0.677 S:0.005", "gland");
  AttenuationTable Enhanced = WithIodine(Gland, 1.04, 2);
  Spectrum LowSpectrum{ "low", { 18, 20, 22, 25 }, { 1, 2, 2, 1 } };
  Spectrum HighSpectrum{ "high", { 33, 35, 38, 42 }, { 1, 2, 2, 1 } };
};
}

TEST_F(DualEnergy, SingleEnergiesCancelAtAnyThickness)
{
  const Beam low = this->BeamOf(Spectrum::Monochromatic(22));
  const Beam high = this->BeamOf(Spectrum::Monochromatic(35));
  const double weight = CancellingWeight(low, high, 1, 2, 50);
  EXPECT_NEAR(weight,
    (this->Fat.MuAt(35, 0.93) - this->Gland.MuAt(35, 1.04)) /
      (this->Fat.MuAt(22, 0.93) - this->Gland.MuAt(22, 1.04)),
    1e-9);
  EXPECT_NEAR(CancellingWeight(low, high, 2, 1, 20), weight, 1e-9);
  // 40 mm of whatever mixture look the same; 5 mm of it with iodine by what iodine adds alone.
  const double iodine = 2e-3; // g/cm3
  const AttenuationTable pure = RequireComposition("I", "iodine");
  for (const double fat : { 0.0, 11.0, 35.0 })
  {
    const double plain[4] = { 0, fat, 40 - fat, 0 };
    const double enhanced[4] = { 0, fat, 35 - fat, 5 };
    const double without = high.LogAttenuation(plain) - weight * low.LogAttenuation(plain);
    const double with = high.LogAttenuation(enhanced) - weight * low.LogAttenuation(enhanced);
    const double allGland[4] = { 0, 0, 40, 0 };
    EXPECT_NEAR(without, high.LogAttenuation(allGland) - weight * low.LogAttenuation(allGland),
      1e-9);
    // Tables are interpolated by logarithms, the sum's apart from the parts': 1e-4 of it.
    const double expected = 5 * (pure.MuAt(35, iodine) - weight * pure.MuAt(22, iodine));
    EXPECT_NEAR(with - without, expected, 1e-4 * expected);
  }
}

TEST_F(DualEnergy, SpectraCancelForSlabsOfThatThickness)
{
  const Beam low = this->BeamOf(this->LowSpectrum);
  const Beam high = this->BeamOf(this->HighSpectrum);
  const double weight = CancellingWeight(low, high, 1, 2, 50);
  const double fat[4] = { 0, 50, 0, 0 };
  const double gland[4] = { 0, 0, 50, 0 };
  const double enhanced[4] = { 0, 25, 20, 5 };
  const auto recombined = [&](const double* lengths)
  { return high.LogAttenuation(lengths) - weight * low.LogAttenuation(lengths); };
  EXPECT_NEAR(recombined(fat), recombined(gland), 1e-12);
  // What is left of tissue is small beside 5 mm of 2 mg/ml, which each exposure alone shows less
  // than the tissues' difference.
  const double mixed[4] = { 0, 25, 25, 0 };
  const double iodine = recombined(enhanced) - recombined(mixed);
  EXPECT_LT(std::abs(recombined(mixed) - recombined(fat)), 0.2 * iodine);
  EXPECT_GT(low.LogAttenuation(gland) - low.LogAttenuation(fat), 10 * iodine);
}

TEST_F(DualEnergy, PicturesAreRecombinedPixelByPixel)
{
  Exposure low;
  Exposure high;
  low.LogAttenuation = { 1, 2, 3 };
  high.LogAttenuation = { 2, 2, 1 };
  EXPECT_EQ(Recombine(low, high, 0.5), (std::vector<float>{ 1.5F, 1, -0.5F }));
  high.LogAttenuation.pop_back();
  EXPECT_THROW(Recombine(low, high, 0.5), InputError);
}

TEST_F(DualEnergy, IodineAddsToTheTable)
{
  const AttenuationTable pure = RequireComposition("I", "iodine");
  for (const double energy : { 20.0, 33.16, 33.18, 60.0 })
  {
    EXPECT_NEAR(this->Enhanced.MuAt(energy, 1.04),
      this->Gland.MuAt(energy, 1.04) + pure.MuAt(energy, 2e-3), 1e-6)
      << energy;
  }
  // The K edge at 33.17 keV: 6.6 to 35.8 cm2/g (NIST).
  EXPECT_NEAR(this->Enhanced.MuAt(33.18, 1.04) - this->Enhanced.MuAt(33.16, 1.04),
    2e-4 * (35.8 - 6.55), 1e-4);
  EXPECT_THROW(WithIodine(this->Gland, 0, 2), InputError);
  EXPECT_THROW(WithIodine(this->Gland, 1, -2), InputError);
}

TEST_F(DualEnergy, RefusesWhatCannotCancel)
{
  const Beam low = this->BeamOf(this->LowSpectrum);
  const Beam high = this->BeamOf(this->HighSpectrum);
  EXPECT_THROW(CancellingWeight(low, high, 1, 1, 50), InputError);
  EXPECT_THROW(CancellingWeight(low, high, 1, 4, 50), InputError);
  EXPECT_THROW(CancellingWeight(low, high, 1, 2, 0), InputError);
}
