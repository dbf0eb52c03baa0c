// SPDX-License-Identifier: Apache-2.0
// Makes Data/scatter/breast.csv again, and prints what it says of published figures.
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammoray/XRay/Tube.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>

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
  app.add_option("--photons", photons, "for each energy and thickness");
  app.add_option("--seed", seed);
  CLI11_PARSE(app, argc, argv);
  try
  {
    ScatterKernels kernels = ShippedKernelAxes();
    FillScatterKernels(kernels, photons, seed,
      [](double fraction, const char*)
      {
        std::fprintf(stderr, "\r%3.0f %%", 100 * fraction);
        return true;
      });
    std::fprintf(stderr, "\n");
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
