// SPDX-License-Identifier: Apache-2.0
// Makes Data/scatter/breast.csv again, and prints what it says of published figures.
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/XRay/Scatter/Photons.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammoray/XRay/Tube.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <numbers>
#include <string>
#include <vector>

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
  kernels.Shares.resize(kernels.Index(kernels.EnergiesKeV.size(), 0, 0));
  kernels.Multiple.resize(kernels.EnergiesKeV.size() * kernels.ThicknessesMm.size());
  return kernels;
}

/// Russian roulette: a photon of less than this share of the first weight survives with the
/// probability `Survival`, and then stands for those that did not.
constexpr double LeastWeight = 1e-3;
constexpr double Survival = 0.1;

/// The bin of ascending edges that contains the value; beyond the last edge the number of bins.
std::size_t BinOf(const std::vector<double>& edges, double value)
{
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  return static_cast<std::size_t>(above - edges.begin()) - 1;
}

/**
 * Follows photons from one point at right angles into a slab and adds the part of their energy that
 * would meet rings and angles of `axes` at each of its gaps, relative to what comes through
 * unscattered, to sums[(gap * rings + ring) * angles + angle]; numbers `begin` to `end` of the
 * seed. Returns, relative to the same, the energy that leaves the slab's back after more than one
 * collision, and all that leaves it.
 */
std::array<double, 2> FollowThroughSlab(const PhotonMaterial& tissue, double energyKeV,
  double thicknessMm, const ScatterKernels& axes, std::uint64_t seed, std::uint64_t begin,
  std::uint64_t end, std::vector<double>& sums)
{
  const std::size_t rings = axes.NumberOfRings();
  const std::size_t angles = axes.NumberOfAngles();
  const double toPrimary = tissue.At(energyKeV).Total() * thicknessMm;
  std::array<double, 2> left{ 0, 0 };
  const auto score = [&](const Vector3& place, const Vector3& direction, double share)
  {
    const double angle = std::acos(std::min(direction[2], 1.0)) * 180 / std::numbers::pi;
    const std::size_t side = BinOf(axes.AnglesDeg, angle);
    for (std::size_t gap = 0; side < angles && gap < axes.GapsMm.size(); ++gap)
    {
      const double way = axes.GapsMm[gap] / direction[2];
      const std::size_t ring = BinOf(axes.RadiiMm,
        std::hypot(place[0] + way * direction[0], place[1] + way * direction[1]));
      if (ring < rings)
      {
        sums[(gap * rings + ring) * angles + side] += share;
      }
    }
  };
  for (std::uint64_t number = begin; number < end; ++number)
  {
    RandomStream random(seed, number);
    double energy = energyKeV;
    PhotonInteractions here = tissue.At(energy);
    // The first collision anywhere with the same probability: whatever its depth, what leaves the
    // slab has come about as far through it. Weights are relative to those of the primary photons.
    Vector3 place{ 0, 0, thicknessMm * random.Uniform() };
    Vector3 direction{ 0, 0, 1 };
    double weight = toPrimary * std::exp(toPrimary - here.Total() * place[2]);
    const double least = LeastWeight * toPrimary;
    for (int collisions = 1;; ++collisions)
    {
      weight *= (here.Rayleigh + here.Compton) / here.Total();
      if (weight < least)
      {
        if (random.Uniform() >= Survival)
        {
          break;
        }
        weight /= Survival;
      }
      const ScatteredPhoton after =
        random.Uniform() * (here.Rayleigh + here.Compton) < here.Rayleigh
        ? tissue.Rayleigh(energy, random)
        : tissue.Compton(energy, random);
      direction = TurnDirection(direction, after.Cosine, random);
      energy = after.EnergyKeV;
      here = tissue.At(energy);
      if (energy < PhotonMaterial::LowestKeV || direction[2] == 0)
      {
        break;
      }
      const double toFace = (direction[2] > 0 ? thicknessMm - place[2] : -place[2]) / direction[2];
      const double leaves = std::exp(-here.Total() * toFace);
      if (direction[2] > 0)
      {
        const double share = weight * leaves * energy / energyKeV;
        score(place + toFace * direction, direction, share);
        left[0] += collisions > 1 ? share : 0;
        left[1] += share;
      }
      weight *= 1 - leaves;
      const double path = -std::log(1 - random.Uniform() * (1 - leaves)) / here.Total();
      place = place + path * direction;
    }
  }
  return left;
}

/**
 * Fills the table by Monte Carlo with `photons` for each energy and thickness. Collisions are
 * forced to lie within the slab, the share that would leave is scored where it would meet the
 * planes (last-flight estimation), and absorption lowers the photon's weight.
 */
void FillScatterKernels(ScatterKernels& kernels, std::int64_t photons, std::uint64_t seed)
{
  const PhotonMaterial tissue(kernels.Composition, kernels.DensityGPerCm3);
  const std::size_t thicknesses = kernels.ThicknessesMm.size();
  const std::size_t parts = kernels.EnergiesKeV.size() * thicknesses;
  const std::size_t size =
    kernels.GapsMm.size() * kernels.NumberOfRings() * kernels.NumberOfAngles();
  for (std::size_t part = 0; part < parts; ++part)
  {
    std::fprintf(stderr, "\r%3.0f %%",
      100 * static_cast<double>(part) / static_cast<double>(parts));
    std::vector<double> sums(size);
    std::array<double, 2> left{ 0, 0 };
    std::mutex adding;
    ParallelRanges(static_cast<std::size_t>(photons), 1000,
      [&](std::size_t begin, std::size_t end)
      {
        std::vector<double> own(size);
        const auto [multiple, all] =
          FollowThroughSlab(tissue, kernels.EnergiesKeV[part / thicknesses],
            kernels.ThicknessesMm[part % thicknesses], kernels, seed + part, begin, end, own);
        const std::lock_guard lock(adding);
        std::transform(own.begin(), own.end(), sums.begin(), sums.begin(), std::plus<>());
        left = { left[0] + multiple, left[1] + all };
      });
    kernels.Multiple[part] = static_cast<float>(left[1] > 0 ? left[0] / left[1] : 0);
    std::transform(sums.begin(), sums.end(),
      kernels.Shares.begin() +
        static_cast<std::ptrdiff_t>(kernels.Index(part / thicknesses, part % thicknesses, 0)),
      [&](double sum) { return static_cast<float>(sum / static_cast<double>(photons)); });
  }
}

void AddValues(const char* name, const char* format, const double* begin, const double* end,
  std::string& text)
{
  text += name;
  for (const double* value = begin; value != end; ++value)
  {
    char number[32];
    std::snprintf(number, sizeof number, format, *value);
    text += number;
  }
  text += '\n';
}

/// Writes a table that ReadScatterKernels reads, with a comment as first line.
void WriteScatterKernels(const ScatterKernels& kernels, const std::string& comment,
  const std::string& path)
{
  kernels.Validate();
  std::string text = "# " + comment + "\ncomposition," + kernels.Composition + "\n";
  const auto add = [&](const char* name, const std::vector<double>& values)
  { AddValues(name, ",%.5g", values.data(), values.data() + values.size(), text); };
  add("density_g_per_cm3", { kernels.DensityGPerCm3 });
  add("energies_keV", kernels.EnergiesKeV);
  add("thicknesses_mm", kernels.ThicknessesMm);
  add("gaps_mm", kernels.GapsMm);
  add("radii_mm", kernels.RadiiMm);
  add("angles_deg", kernels.AnglesDeg);
  add("multiple", { kernels.Multiple.begin(), kernels.Multiple.end() });
  const std::vector<double> shares(kernels.Shares.begin(), kernels.Shares.end());
  const std::size_t size = kernels.NumberOfRings() * kernels.NumberOfAngles();
  for (std::size_t begin = 0; begin < shares.size(); begin += size)
  {
    AddValues("shares", ",%.3g", &shares[begin], &shares[begin] + size, text);
  }
  WriteAtomicFile(path, text);
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
