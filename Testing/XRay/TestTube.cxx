// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
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

/// A beam that a standards laboratory states: a tungsten target at 20 degrees, filters in mm.
struct StandardBeam
{
  const char* Name;
  double Kilovolts;
  double Be;
  double Al;
  double Cu;
  double Sn;
  double Pb;
  /// Of air, mm.
  double Distance;
  /// First half-value layer, mm.
  double Layer;
  /// Mean energy, keV; 0: not stated.
  double MeanKeV;
};

Spectrum SpectrumOf(const StandardBeam& beam, bool hasKapton)
{
  XRayTube tube{ "W", beam.Kilovolts, {}, 20 };
  for (const auto& [material, thickness] : { std::pair{ "Be", beam.Be }, { "Al", beam.Al },
         { "Cu", beam.Cu }, { "Sn", beam.Sn }, { "Pb", beam.Pb } })
  {
    tube.Filters.push_back({ material, thickness });
  }
  tube.Filters.push_back({ "Air, Dry (near sea level)", beam.Distance });
  if (hasKapton)
  {
    tube.Filters.push_back({ "Kapton Polyimide Film", 0.25 });
  }
  return TubeSpectrum(tube);
}

TEST(Tube, Iso4037BeamsHaveTheirHalfValueLayersAndMeanEnergies)
{
  // Filters and layers (Cu): PTB's catalogue (Ankerhold, PTB-Dos-34, 2000). Mean energies: ISO
  // 4037-1, to 1 keV. 3 %: what issue 60 asks for. The laboratories differ by as much: NIST's table
  // (Calibration Services, VIII.6) has 1.14, 1.76, 5.34 and 6.17 for N-100, N-120, N-250 and N-300.
  const std::vector<StandardBeam> beams{
    { "W-60", 60, 1, 4, 0.3, 0, 0, 950, 0.18, 45 },
    { "W-80", 80, 1, 4, 0.5, 0, 0, 950, 0.349, 57 },
    { "W-110", 110, 1, 4, 2, 0, 0, 950, 0.933, 79 },
    { "W-150", 150, 7, 4, 0, 1, 0, 950, 1.78, 104 },
    { "W-200", 200, 7, 4, 0, 2, 0, 950, 3.00, 137 },
    { "W-250", 250, 7, 4, 0, 4, 0, 950, 4.14, 173 },
    { "W-300", 300, 7, 4, 0, 6.5, 0, 950, 5.03, 208 },
    { "N-40", 40, 1, 4, 0.21, 0, 0, 950, 0.085, 33 },
    { "N-60", 60, 1, 4, 0.6, 0, 0, 950, 0.234, 48 },
    { "N-80", 80, 1, 4, 2, 0, 0, 950, 0.578, 65 },
    { "N-100", 100, 1, 4, 5, 0, 0, 950, 1.09, 83 },
    { "N-120", 120, 1, 4, 5, 1, 0, 950, 1.67, 100 },
    { "N-150", 150, 7, 4, 0, 2.5, 0, 950, 2.30, 118 },
    { "N-200", 200, 7, 4, 2, 3, 1, 950, 3.92, 164 },
    { "N-250", 250, 7, 4, 0, 2, 3, 950, 5.10, 208 },
    { "N-300", 300, 7, 4, 0, 3, 5, 950, 5.96, 250 },
    { "L-55", 55, 1, 4, 1.2, 0, 0, 950, 0.248, 0 },
    { "L-70", 70, 1, 4, 2.5, 0, 0, 950, 0.483, 0 },
    { "L-125", 125, 7, 4, 1, 4, 0, 950, 1.98, 0 },
    { "L-170", 170, 7, 4, 1, 3, 1.5, 950, 3.40, 0 },
    { "L-210", 210, 7, 4, 0.5, 2, 3.5, 950, 4.52, 0 },
    { "L-240", 240, 7, 4, 0.5, 2, 5.5, 950, 5.19, 0 },
    { "H-100", 100, 1, 4, 0.15, 0, 0, 950, 0.294, 0 },
    { "H-200", 200, 7, 4, 1, 0, 0, 950, 1.54, 0 },
    { "H-250", 250, 7, 4, 1.6, 0, 0, 950, 2.42, 0 },
    { "H-280", 280, 7, 4, 3, 0, 0, 950, 3.26, 0 },
    { "H-300", 300, 7, 4, 2.2, 0, 0, 950, 3.22, 0 },
  };
  for (const StandardBeam& beam : beams)
  {
    const Spectrum spectrum = SpectrumOf(beam, true);
    EXPECT_NEAR(HalfValueLayerMm(spectrum, "Cu") / beam.Layer, 1, 0.03) << beam.Name;
    EXPECT_EQ(spectrum.PeakEnergyKeV(), beam.Kilovolts);
    if (beam.MeanKeV > 0)
    {
      EXPECT_NEAR(spectrum.MeanEnergyKeV() / beam.MeanKeV, 1, 0.03) << beam.Name;
    }
  }
}

TEST(Tube, BipmQualitiesHaveTheirHalfValueLayers)
{
  // Kessler and Burns, rapport BIPM-2018/06: mm Al up to 50 kV, Cu above. Behind so few filters the
  // electrons' depths, L lines and the inherent filter show; 10 %.
  const std::vector<StandardBeam> beams{
    { "25 kV", 25, 3, 0.372, 0, 0, 0, 500, 0.242, 0 },
    { "30 kV", 30, 3, 0.208, 0, 0, 0, 500, 0.169, 0 },
    { "50 kV b", 50, 3, 1.008, 0, 0, 0, 500, 1.017, 0 },
    { "50 kV a", 50, 3, 3.989, 0, 0, 0, 500, 2.262, 0 },
    { "100 kV", 100, 3, 3.431, 0, 0, 0, 1150, 0.149, 0 },
    { "135 kV", 135, 3, 2.228, 0.232, 0, 0, 1150, 0.489, 0 },
    { "180 kV", 180, 3, 2.228, 0.485, 0, 0, 1150, 0.977, 0 },
    { "250 kV", 250, 3, 2.228, 1.570, 0, 0, 1150, 2.484, 0 },
  };
  for (const StandardBeam& beam : beams)
  {
    const Spectrum spectrum = SpectrumOf(beam, false);
    EXPECT_NEAR(HalfValueLayerMm(spectrum, beam.Kilovolts > 50 ? "Cu" : "Al") / beam.Layer, 1, 0.10)
      << beam.Name;
  }
}

TEST(Tube, ComputedSpectraAgreeWithMeasuredOnes)
{
  // The measured ones have a window of beryllium, which the computed ones need, too. Mean energies
  // to 3 %; half-value layers to 10 %, as the window is not stated.
  for (const double kilovolts : { 30.0, 36.0, 42.0 })
  {
    const Spectrum measured = TubeSpectrum({ "W", kilovolts, { { "Al", 1 } } });
    const Spectrum computed = TubeSpectrum({ "W", kilovolts, { { "Al", 1 }, { "Be", 0.5 } }, 12 });
    EXPECT_NEAR(computed.MeanEnergyKeV() / measured.MeanEnergyKeV(), 1, 0.03) << kilovolts;
    EXPECT_NEAR(HalfValueLayerMm(computed) / HalfValueLayerMm(measured), 1, 0.10) << kilovolts;
  }
}

TEST(Tube, ASmallerTargetAngleHardensTheBeam)
{
  double before = 0;
  for (const double angle : { 40.0, 20.0, 12.0, 7.0 })
  {
    const double layer = HalfValueLayerMm(TubeSpectrum({ "W", 120, { { "Al", 2.5 } }, angle }));
    EXPECT_GT(layer, before) << angle;
    before = layer;
  }
  EXPECT_EQ(TubeSpectrum({ "W", 120, {} }).Weights, TubeSpectrum({ "W", 120, {}, 12 }).Weights);
}

TEST(Tube, KLinesStandWhereTungstenHasThem)
{
  // 59.3 and 67.2 keV, from 69.5 keV on; each far above what is two bins beside.
  const Spectrum above = TubeSpectrum({ "W", 100, {} });
  const Spectrum below = TubeSpectrum({ "W", 69, {} });
  const auto contrast = [](const Spectrum& spectrum, double energy)
  {
    const auto bin = static_cast<std::size_t>(
      std::lower_bound(spectrum.EnergiesKeV.begin(), spectrum.EnergiesKeV.end(), energy) -
      spectrum.EnergiesKeV.begin());
    return spectrum.Weights[bin] / spectrum.Weights[bin + 2];
  };
  EXPECT_GT(contrast(above, 59), 3);
  EXPECT_GT(contrast(above, 67), 1.5);
  EXPECT_NEAR(contrast(below, 59), 1, 0.4);
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
  EXPECT_THAT(test::RefusalOf([] { XRayFilter::FromText("CsI@4510:0.15", "scintillator"); }),
    testing::StartsWith("scintillator: 'CsI@4510': expected a density from"));
  EXPECT_THROW(TubeSpectrum({ "Cu", 28, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 17, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "Mo", 43, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 451, {} }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 19, {}, 12 }), InputError);
  EXPECT_THROW(TubeSpectrum({ "W", 120, {}, 2 }), InputError);
  EXPECT_THROW(TubeSpectrum({ "Mo", 30, {}, 12 }), InputError);
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
