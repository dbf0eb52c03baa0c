// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/Private/KilovoltageSpectrum.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

TEST(KilovoltageSpectrum, IsTheGivenOneAtItsOwnVoltage)
{
  const Spectrum given = FindSpectrum("W28kVp_Rh50um_Be1mm");
  EXPECT_EQ(KilovoltageOf(given), 28);
  // Up to where the law is trusted bin by bin, the rest by at most 1 % of a bin's photons.
  EXPECT_NEAR(AtKilovoltage(given, 28).MeanEnergyKeV(), given.MeanEnergyKeV(), 0.01);
}

TEST(KilovoltageSpectrum, PredictsTheOtherShippedOne)
{
  const Spectrum low = FindSpectrum("W28kVp_Rh50um_Be1mm");
  const Spectrum high = FindSpectrum("W30kVp_Rh50um_Be1mm");
  const double difference = high.MeanEnergyKeV() - low.MeanEnergyKeV();
  ASSERT_GT(difference, 0.2);
  // Kramers' law has no absorption in the target: a third of the way from one to the other.
  EXPECT_NEAR(AtKilovoltage(low, 30).MeanEnergyKeV(), high.MeanEnergyKeV(), 0.33 * difference);
  EXPECT_NEAR(AtKilovoltage(high, 28).MeanEnergyKeV(), low.MeanEnergyKeV(), 0.33 * difference);
}

TEST(KilovoltageSpectrum, HardensWithVoltageAndRefusesWhatHasNoPhotons)
{
  const Spectrum given = FindSpectrum("W28kVp_Rh50um_Be1mm");
  double before = 0;
  for (const double kilovoltage : { 22.0, 25.0, 28.0, 31.0, 34.0 })
  {
    const Spectrum spectrum = AtKilovoltage(given, kilovoltage);
    spectrum.Validate();
    EXPECT_LT(spectrum.EnergiesKeV.back(), kilovoltage);
    EXPECT_GT(spectrum.MeanEnergyKeV(), before);
    before = spectrum.MeanEnergyKeV();
  }
  EXPECT_THROW(AtKilovoltage(given, 5), InputError);
  EXPECT_THROW(AtKilovoltage(given, 39), InputError);
  EXPECT_THROW(AtKilovoltage(Spectrum::Monochromatic(20), 21), InputError);
}
}
