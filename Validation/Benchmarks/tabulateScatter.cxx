// SPDX-License-Identifier: Apache-2.0
// Makes Data/scatter/breast.csv again, and prints what it says of published figures.
#include "mammoray/IO/ScatterData.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammoray/XRay/Tube.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace
{
using namespace mammoray;

/// Ratio of scatter to primary, 1 / (a + b d^-1.5 + c t^-0.5), of Boone and Cooper (2000): t and d
/// in cm, 15 mm of air.
double PublishedRatio(double thicknessCm, double diameterCm)
{
  return 1 /
    (-2.35452817 + 22.39609806 * std::pow(diameterCm, -1.5) +
      8.85064260 * std::pow(thicknessCm, -0.5));
}

/// An empty table with the axes and the tissue of the shipped one: 25 % gland and 75 % fat by mass
/// (Hammerstein 1979), 0.955 g/cm^3.
ScatterKernels ShippedKernelAxes()
{
  ScatterKernels kernels;
  kernels.Composition =
    "H:0.1095 C:0.51025 N:0.02075 O:0.3575 P:0.0005 S:0.0005 K:0.0005 Ca:0.0005";
  kernels.DensityGPerCm3 = 0.955;
  kernels.EnergiesKeV = { 10, 14, 18, 22, 27, 33, 40, 50 };
  kernels.ThicknessesMm = { 10, 20, 30, 40, 50, 60, 80, 100 };
  kernels.GapsMm = { 0, 10, 20, 40, 80 };
  kernels.RadiiMm = { 0, 1, 2, 3, 4.5, 6, 8, 10.5, 13.5, 17, 21, 26, 32, 39, 47, 57, 69, 84, 102,
    125, 150, 185, 230, 300 };
  kernels.AnglesDeg = { 0, 4, 8, 12, 16, 21, 28, 40, 60, 90 };
  return kernels;
}

void PrintRatios(const ScatterKernels& kernels)
{
  XRayTube tube;
  tube.Anode = "W";
  tube.KilovoltagePeak = 28;
  tube.Filters = { XRayFilter::FromText("Rh:0.05") };
  const ScatterModel model(kernels, TubeSpectrum(tube), DetectorResponse::EnergyIntegrating, 15);
  std::printf("scatter to primary on the axis, W/Rh 28 kV, 15 mm of air: here / published\n%8s",
    "d cm");
  for (double thickness = 2; thickness <= 8; thickness += 1)
  {
    std::printf("     t %2.0f cm    ", thickness);
  }
  for (const double diameter : { 3.0, 5.0, 8.0, 12.0, 15.0, 20.0, 25.0, 30.0 })
  {
    std::printf("\n%8.0f", diameter);
    for (double thickness = 2; thickness <= 8; thickness += 1)
    {
      const double here = model.ScatterToPrimary(10 * thickness, 10 * diameter);
      const double there = PublishedRatio(thickness, diameter);
      std::printf("  %.3f %.3f %3.0f%%", here, there, 100 * (here / there - 1));
    }
  }
  std::printf("\n");
}
}

int main(int argc, char** argv)
{
  CLI::App app{ "Tabulates what breast tissue scatters, by Monte Carlo" };
  std::string output;
  std::int64_t photons = 1000000;
  std::uint64_t seed = 1;
  app.add_option("-o,--output", output, "table to write (.csv)")->required();
  app.add_option("--photons", photons, "for each energy and thickness")->check(CLI::PositiveNumber);
  app.add_option("--seed", seed);
  CLI11_PARSE(app, argc, argv);
  try
  {
    ScatterKernels kernels = ShippedKernelAxes();
    FillScatterKernels(kernels, photons, seed);
    WriteScatterKernels(kernels,
      "made by tabulateScatter --photons " + std::to_string(photons) + " --seed " +
        std::to_string(seed) + "; see Modules/XRay/README.md",
      output);
    PrintRatios(kernels);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "tabulateScatter: %s\n", error.what());
    return 1;
  }
  return 0;
}
