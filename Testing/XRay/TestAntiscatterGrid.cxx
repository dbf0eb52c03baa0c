// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Scatter/Photons.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

/// The mean over 20,000 places of a photon that is followed from septum to septum.
double FollowedTransmission(const AntiscatterGridOptions& options, double energy, double across,
  double along)
{
  const PhotonMaterial septa(options.Septa, options.SeptaDensityGPerCm3);
  const PhotonMaterial interspace(options.Interspace, options.InterspaceDensityGPerCm3);
  const double period = 1 / options.LinesPerMm;
  const double height = options.Ratio * (period - options.SeptumMm);
  const double reach = height * std::abs(across);
  const double slant = std::sqrt(1 + across * across + along * along);
  constexpr int Places = 20000;
  double sum = 0;
  for (int place = 0; place < Places; ++place)
  {
    const double begin = (place + 0.5) / Places * period;
    double inSeptum = 0; // of the way across
    for (double septum = 0; septum < begin + reach; septum += period)
    {
      inSeptum +=
        std::max(std::min(septum + options.SeptumMm, begin + reach) - std::max(septum, begin), 0.0);
    }
    const double share = reach > 0 ? inSeptum / reach : (begin < options.SeptumMm ? 1.0 : 0.0);
    sum += std::exp(-height * slant *
      (share * septa.At(energy).Total() + (1 - share) * interspace.At(energy).Total()));
  }
  return sum / Places;
}

TEST(AntiscatterGrid, IsTheMeanOverAllPlaces)
{
  AntiscatterGridOptions options;
  for (const double ratio : { 1.0, 5.0, 12.0 })
  {
    options.Ratio = ratio;
    // Thin and thick septa, so that either is wider than what a photon crosses beyond whole
    // periods.
    for (const double septum : { 0.016, 0.065, 0.25 })
    {
      options.SeptumMm = septum;
      const AntiscatterGrid grid(options);
      for (const double across : { 0.0, 0.01, 0.1, -0.35, 1.0, 3.0 })
      {
        for (const double along : { 0.0, 0.8 })
        {
          const double expected = FollowedTransmission(options, 22, across, along);
          // A place in 20,000 on the wrong side of an edge.
          EXPECT_NEAR(grid.Transmission(22, across, along), expected, 2e-4)
            << ratio << " " << septum << " " << across << " " << along;
        }
      }
    }
  }
}

TEST(AntiscatterGrid, PrimaryPhotonsFlyAlongSepta)
{
  const AntiscatterGridOptions options;
  const AntiscatterGrid grid(options);
  const double period = 1 / options.LinesPerMm;
  const double gap = period - options.SeptumMm;
  const PhotonMaterial between(options.Interspace, options.InterspaceDensityGPerCm3);
  // Lead of 1.3 mm lets less than 1e-9 of 22 keV through.
  EXPECT_NEAR(grid.PrimaryTransmission(22),
    gap / period * std::exp(-between.At(22).Total() * options.Ratio * gap), 1e-9);
  EXPECT_NEAR(grid.TransmissionAt(22, 0), grid.PrimaryTransmission(22), 1e-12);
}

TEST(AntiscatterGrid, SeptaMayRunEitherWay)
{
  AntiscatterGridOptions options;
  const AntiscatterGrid one(options);
  options.AlongChestWall = false;
  const AntiscatterGrid other(options);
  EXPECT_EQ(one.Transmission(20, 0.3, 0.1), other.Transmission(20, 0.1, 0.3));
  EXPECT_LT(one.Transmission(20, 0.3, 0), one.Transmission(20, 0, 0.3));
}

TEST(AntiscatterGrid, StopsMoreTheMoreAPhotonLeans)
{
  const AntiscatterGrid grid({});
  double before = 1;
  for (const double degrees : { 0.0, 3.0, 6.0, 10.0, 20.0, 40.0, 70.0 })
  {
    const double passed = grid.TransmissionAt(20, degrees * 3.14159265358979 / 180);
    EXPECT_LT(passed, before) << degrees;
    before = passed;
  }
}

TEST(AntiscatterGrid, RefusesWhatIsNone)
{
  AntiscatterGridOptions options;
  options.Ratio = 0.5;
  EXPECT_THROW(AntiscatterGrid{ options }, InputError);
  options = {};
  options.SeptumMm = 0.4;
  EXPECT_THROW(AntiscatterGrid{ options }, InputError);
  options = {};
  options.LinesPerMm = NAN;
  EXPECT_THROW(AntiscatterGrid{ options }, InputError);
  options = {};
  options.Interspace = "nothing";
  EXPECT_THROW(AntiscatterGrid{ options }, InputError);
}

TEST(AntiscatterGrid, IsMadeOfTheNumbersItIsSoldBy)
{
  const AntiscatterGridOptions options = AntiscatterGridOptions::OfLead({ 4, 40, 50 }, "air");
  EXPECT_DOUBLE_EQ(options.Ratio, 4);
  EXPECT_DOUBLE_EQ(options.LinesPerMm, 4);
  EXPECT_DOUBLE_EQ(options.SeptumMm, 0.05);
  // 20 keV: 0.2 mm of septa's height, of which air takes nothing and a fifth is lead.
  EXPECT_NEAR(AntiscatterGrid(options).PrimaryTransmission(20), 0.8, 1e-3);
  EXPECT_THROW(AntiscatterGridOptions::OfLead({ 4, 40, 50 }, "wood"), InputError);
}
}
