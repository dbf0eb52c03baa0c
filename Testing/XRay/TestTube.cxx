// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Tube.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace
{
using namespace mammoray;

/// Behind as much air as is between focus and dosimeter.
Spectrum BehindAir(const XRayTube& tube, double millimetres)
{
  return FilterSpectrum(TubeSpectrum(tube), { "Air, Dry (near sea level)", millimetres });
}

TEST(Tube, SameModelAsTheShippedSpectra)
{
  // Of the tool that made them, with its own attenuation of rhodium: but for a common factor bins
  // agree to 6 % from 14 keV on; below, where rhodium absorbs most, its attenuation seems
  // interpolated from fewer energies (10, 15, 20 keV), and a tenth is between us. Mean energies to
  // 0.1 keV.
  for (const double kilovolts : { 28.0, 30.0 })
  {
    const Spectrum ours = TubeSpectrum({ "W", kilovolts, { { "Rh", 0.05 }, { "Be", 1 } } });
    const Spectrum shipped =
      FindSpectrum(kilovolts == 28 ? "W28kVp_Rh50um_Be1mm" : "W30kVp_Rh50um_Be1mm");
    std::vector<double> ratios;
    for (std::size_t bin = 0; bin < ours.Weights.size(); ++bin)
    {
      for (std::size_t other = 0; other < shipped.Weights.size(); ++other)
      {
        // The last bin is where the tool's own interpolation ends.
        if (std::abs(shipped.EnergiesKeV[other] - ours.EnergiesKeV[bin]) < 1e-9 &&
          ours.EnergiesKeV[bin] >= 14 && ours.EnergiesKeV[bin] < kilovolts - 0.5)
        {
          ratios.push_back(shipped.Weights[other] / ours.Weights[bin]);
        }
      }
    }
    ASSERT_GT(ratios.size(), 25u);
    std::vector<double> sorted = ratios;
    std::sort(sorted.begin(), sorted.end());
    for (const double ratio : ratios)
    {
      EXPECT_NEAR(ratio / sorted[sorted.size() / 2], 1, 0.065);
    }
    EXPECT_NEAR(ours.MeanEnergyKeV(), kilovolts == 28 ? 19.0 : 19.3, 0.1);
  }
}

struct PublishedLayer
{
  XRayTube Tube;
  /// mm Al.
  double Layer;
};

TEST(Tube, HalfValueLayersArePublishedOnes)
{
  // With 600 mm of air, as between focus and a dosimeter on a mammography unit's table. Mo/Mo: the
  // qualities RQR-M1 to 4 of IEC 61267 (2005), as in IAEA TRS 457. W/Rh: what Siemens' tool states
  // in the headers of the shipped spectra. 3 %: what the issue asks for.
  const std::vector<PublishedLayer> published{
    { { "Mo", 25, { { "Mo", 0.03 } } }, 0.28 },
    { { "Mo", 28, { { "Mo", 0.03 } } }, 0.31 },
    { { "Mo", 30, { { "Mo", 0.03 } } }, 0.33 },
    { { "Mo", 35, { { "Mo", 0.03 } } }, 0.36 },
    { { "W", 28, { { "Rh", 0.05 }, { "Be", 1 } } }, 0.486 },
    { { "W", 30, { { "Rh", 0.05 }, { "Be", 1 } } }, 0.503 },
    { { "W", 28, { { "Rh", 0.05 }, { "Be", 1 }, { "Al", 2 } } }, 0.754 },
  };
  for (const auto& [tube, layer] : published)
  {
    EXPECT_NEAR(HalfValueLayerMm(BehindAir(tube, 600)) / layer, 1, 0.03) << tube.Name();
  }
}

TEST(Tube, HalfValueLayerOfOneEnergyIsClosedForm)
{
  AttenuationTable aluminium;
  ASSERT_TRUE(FindComposition("Al", aluminium));
  EXPECT_NEAR(HalfValueLayerMm(Spectrum::Monochromatic(20)),
    std::log(2.0) / aluminium.MuAt(20, aluminium.NominalDensityGPerCm3), 1e-12);
}

TEST(Tube, FiltersFollowBeerLambert)
{
  const XRayTube open{ "Mo", 28, {} };
  const Spectrum twice =
    FilterSpectrum(FilterSpectrum(TubeSpectrum(open), { "Mo", 0.01 }), { "Mo", 0.02 });
  const Spectrum once = TubeSpectrum({ "Mo", 28, { { "Mo", 0.03 } } });
  ASSERT_EQ(twice.Weights.size(), once.Weights.size());
  for (std::size_t bin = 0; bin < once.Weights.size(); ++bin)
  {
    EXPECT_NEAR(twice.Weights[bin], once.Weights[bin], 1e-12 * once.Weights[bin]);
  }
  // Twice as dense, half as thick.
  const Spectrum dense = FilterSpectrum(TubeSpectrum(open), { "Al", 0.25, 5.4 });
  const Spectrum thick = FilterSpectrum(TubeSpectrum(open), { "Al", 0.5, 2.7 });
  for (std::size_t bin = 0; bin < dense.Weights.size(); ++bin)
  {
    EXPECT_NEAR(dense.Weights[bin], thick.Weights[bin], 1e-12 * thick.Weights[bin]);
  }
  // Molybdenum's lines, 17.5 and 19.6 keV, stand out; rhodium's are at 20.2 and 22.7.
  const auto strongest = [](const Spectrum& spectrum)
  {
    return spectrum.EnergiesKeV[static_cast<std::size_t>(
      std::max_element(spectrum.Weights.begin(), spectrum.Weights.end()) -
      spectrum.Weights.begin())];
  };
  EXPECT_NEAR(strongest(once), 17.5, 0.25);
  EXPECT_NEAR(strongest(TubeSpectrum({ "Rh", 30, { { "Rh", 0.025 } } })), 20.2, 0.25);
  // No photon has more energy than the electrons.
  EXPECT_LE(TubeSpectrum({ "Rh", 26.3, {} }).EnergiesKeV.back(), 26.3);
}

TEST(Tube, FiltersAreReadAndRefused)
{
  const XRayFilter filter = XRayFilter::FromText("SiO2@2.2:1.5");
  EXPECT_EQ(filter.Material, "SiO2");
  EXPECT_EQ(filter.DensityGPerCm3, 2.2);
  EXPECT_EQ(filter.ThicknessMm, 1.5);
  EXPECT_EQ(XRayFilter::FromText("H:0.112 O:0.888:20").Material, "H:0.112 O:0.888");
  for (const char* text : { "Rh", "Rh:", ":0.05", "Rh:-1", "Rh:thick", "Rh@0:1", "Rh:nan", "" })
  {
    EXPECT_THROW(XRayFilter::FromText(text), InputError) << text;
  }
  EXPECT_THROW(TubeSpectrum({ "Cu", 28, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 17, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 43, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", std::nan(""), {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 28, { { "butter", 1 } } }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 28, { { "Pb", 1e4 } } }), InputError) << "nothing is left";
}

TEST(Tube, ALayerDetectsWhatItAbsorbs)
{
  // 0.15 mm of CsI: mu by NIST at 60 keV 7.92 cm2/g of 4.51 g/cm3; 3 %.
  const DetectorResponse layer = AbsorbingDetector({ "CsI", 0.15, 4.51 });
  EXPECT_NEAR(layer.Signal(60), 60 * (1 - std::exp(-0.015 * 4.51 * 7.92)), 0.03 * layer.Signal(60));
  // More just above the K edge of caesium, 35.98 keV, than below it.
  EXPECT_GT(layer.Signal(36.1), 1.5 * layer.Signal(33.0));
  // A thick layer detects all, none nothing.
  EXPECT_NEAR(AbsorbingDetector({ "CsI", 50, 4.51 }).Signal(20), 20, 1e-9);
  EXPECT_EQ(AbsorbingDetector({ "CsI", 0, 4.51 }).Signal(20), 0);
  EXPECT_THROW(AbsorbingDetector({ "CsI", -1, 4.51 }), InputError);
}
}
