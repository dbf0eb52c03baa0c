// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include "Private/Interpolation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
/// Clamps a value to the range of an axis.
double Within(const std::vector<double>& axis, double value)
{
  return std::clamp(value, axis.front(), axis.back());
}

void CheckAxis(const char* name, const std::vector<double>& axis, std::size_t least, double low)
{
  const bool ascends =
    std::adjacent_find(axis.begin(), axis.end(), std::greater_equal<>()) == axis.end();
  constexpr std::size_t Most = 1000; // so that numbers of shares can be multiplied
  if (axis.size() < least || axis.size() > Most || !ascends || !(axis.front() >= low) ||
    !std::isfinite(axis.back()))
  {
    throw InputError(
      std::string("scatter kernels: expected ascending ") + name + ", found others or none");
  }
}

/// Russian roulette: a photon of less than this share of the first weight survives with the
/// probability `Survival`, and then stands for those that did not.
constexpr double LeastWeight = 1e-3;
constexpr double Survival = 0.1;
/// A slab of more mean free paths lets nothing through that counts.
constexpr double MostFreePaths = 80;

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
std::array<double, 2> FollowThroughSlab(const PhotonMaterial& material, double energyKeV,
  double thicknessMm, const ScatterKernels& axes, std::uint64_t seed, std::uint64_t begin,
  std::uint64_t end, std::vector<double>& sums)
{
  const std::size_t rings = axes.NumberOfRings();
  const std::size_t angles = axes.NumberOfAngles();
  const double toPrimary = material.At(energyKeV).Total() * thicknessMm;
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
    PhotonInteractions here = material.At(energy);
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
        ? material.Rayleigh(energy, random)
        : material.Compton(energy, random);
      direction = TurnDirection(direction, after.Cosine, random);
      energy = after.EnergyKeV;
      here = material.At(energy);
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

/// The mean material along the rays of a picture: its composition, and its density, g/cm^3.
std::pair<std::string, double> MeanMaterial(const Scene& scene, const PathLengthImage& lengths)
{
  const std::size_t pixels = lengths.NumberOfPixels();
  std::vector<double> volumes(static_cast<std::size_t>(lengths.Materials));
  double all = 0;
  for (int material = 1; material < lengths.Materials; ++material)
  {
    const float* of = lengths.Material(material);
    volumes[static_cast<std::size_t>(material)] = std::accumulate(of, of + pixels, 0.0);
    all += volumes[static_cast<std::size_t>(material)];
  }
  if (!(all > 0))
  {
    throw InputError("scatter.kernels: expected a scene with something in the beam, found nothing");
  }
  std::map<int, double> masses;
  double mass = 0;
  std::string only;
  for (std::size_t material = 1; material < volumes.size(); ++material)
  {
    const double share = std::round(100 * volumes[material] / all) / 100;
    if (share == 0)
    {
      continue;
    }
    const std::string& text = scene.Scatter.Compositions.at(material);
    const CompositionParts parts = ParseComposition(text,
      "scatter.kernels: material '" + scene.Materials.Materials[material].Name + "'");
    only = share == 1 ? text : only;
    const double weight = share * scene.Materials.Materials[material].DensityGPerCm3;
    mass += weight;
    for (const auto& [element, fraction] : parts.MassFractions)
    {
      masses[element] += weight * fraction;
    }
  }
  for (auto& [element, value] : masses)
  {
    value /= mass;
  }
  return { only.empty() ? MixtureText(masses) : only, mass };
}

/// Energies on an axis: those that pass 99 % and more of the signal behind a thickness.
std::vector<double> EnergiesBehind(const Scene& scene, const PhotonMaterial& material,
  double thicknessMm)
{
  const Spectrum& spectrum = scene.XRays;
  std::vector<double> signals;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    const double energy = spectrum.EnergiesKeV[bin];
    signals.push_back(spectrum.Weights[bin] * scene.Response.Signal(energy) *
      std::exp(-material.At(energy).Total() * thicknessMm));
  }
  const double all = std::accumulate(signals.begin(), signals.end(), 0.0);
  double low = 0;
  double high = 0;
  double done = 0;
  for (std::size_t bin = 0; bin < signals.size(); ++bin)
  {
    done += signals[bin];
    low = low == 0 && done > 0.01 * all ? spectrum.EnergiesKeV[bin] : low;
    high = signals[bin] > 0 ? spectrum.EnergiesKeV[bin] : high;
  }
  if (!(low > 0))
  {
    throw InputError("scatter.kernels: expected photons that pass the bodies, found none");
  }
  constexpr int Steps = 7;
  std::vector<double> energies{ low };
  for (int step = 1; high > 1.05 * low && step <= Steps; ++step)
  {
    energies.push_back(low * std::pow(high / low, static_cast<double>(step) / Steps));
  }
  return energies;
}
}

std::vector<double> ScatterKernels::At(double energyKeV, std::size_t thickness, double gapMm) const
{
  const auto [energy, energyShare] =
    PlaceOn(this->EnergiesKeV, Within(this->EnergiesKeV, energyKeV));
  const auto [gap, gapShare] = PlaceOn(this->GapsMm, Within(this->GapsMm, gapMm));
  std::vector<double> shares(this->NumberOfRings() * this->NumberOfAngles());
  const auto add = [&](std::size_t e, std::size_t g, double weight)
  {
    const float* from = weight > 0 ? &this->Shares[this->Index(e, thickness, g)] : nullptr;
    for (std::size_t place = 0; from && place < shares.size(); ++place)
    {
      shares[place] += weight * from[place];
    }
  };
  add(energy, gap, (1 - energyShare) * (1 - gapShare));
  add(energy, gap + 1, (1 - energyShare) * gapShare);
  add(energy + 1, gap, energyShare * (1 - gapShare));
  add(energy + 1, gap + 1, energyShare * gapShare);
  return shares;
}

double ScatterKernels::MultipleAt(double energyKeV, std::size_t thickness) const
{
  const auto [energy, share] = PlaceOn(this->EnergiesKeV, Within(this->EnergiesKeV, energyKeV));
  const auto at = [&](std::size_t e)
  { return this->Multiple[e * this->ThicknessesMm.size() + thickness]; };
  return at(energy) + (share > 0 ? share * (at(energy + 1) - at(energy)) : 0);
}

void ScatterKernels::Validate() const
{
  CheckAxis("energies", this->EnergiesKeV, 1, 1);
  CheckAxis("thicknesses", this->ThicknessesMm, 1, 1e-3);
  CheckAxis("gaps", this->GapsMm, 1, 0);
  CheckAxis("radii", this->RadiiMm, 2, 0);
  CheckAxis("angles", this->AnglesDeg, 2, 0);
  const std::size_t wanted = this->Index(this->EnergiesKeV.size(), 0, 0);
  const std::size_t slabs = this->EnergiesKeV.size() * this->ThicknessesMm.size();
  if (this->Multiple.size() != slabs ||
    std::any_of(this->Multiple.begin(), this->Multiple.end(),
      [](float share) { return !(share >= 0 && share <= 1); }))
  {
    throw InputError("scatter kernels: expected shares of multiple scattering, 0 to 1, of " +
      std::to_string(slabs) + " slabs, found others");
  }
  const bool usable = std::all_of(this->Shares.begin(), this->Shares.end(),
    [](float share) { return share >= 0 && std::isfinite(share); });
  if (this->Shares.size() != wanted || !usable)
  {
    throw InputError("scatter kernels: expected " + std::to_string(wanted) +
      " shares that are not negative, found " + std::to_string(this->Shares.size()) +
      (usable ? "" : ", some of them unusable"));
  }
}

void FillScatterKernels(ScatterKernels& kernels, std::int64_t photons, std::uint64_t seed,
  const ProgressCallback& progress)
{
  const PhotonMaterial material(kernels.Composition, kernels.DensityGPerCm3);
  const std::size_t thicknesses = kernels.ThicknessesMm.size();
  const std::size_t parts = kernels.EnergiesKeV.size() * thicknesses;
  kernels.Shares.assign(kernels.Index(kernels.EnergiesKeV.size(), 0, 0), 0);
  kernels.Multiple.assign(parts, 0);
  kernels.Validate();
  const std::size_t size =
    kernels.GapsMm.size() * kernels.NumberOfRings() * kernels.NumberOfAngles();
  // The number of runs does not depend on that of cores, so rounding is always the same.
  constexpr std::size_t Runs = 16;
  const auto count = static_cast<std::uint64_t>(photons);
  for (std::size_t part = 0; part < parts; ++part)
  {
    ReportProgress(progress, static_cast<double>(part) / static_cast<double>(parts),
      "making scatter kernels");
    const double energy = kernels.EnergiesKeV[part / thicknesses];
    const double thickness = kernels.ThicknessesMm[part % thicknesses];
    if (material.At(energy).Total() * thickness > MostFreePaths)
    {
      continue;
    }
    std::vector<std::vector<double>> sums(Runs, std::vector<double>(size));
    std::vector<std::array<double, 2>> left(Runs);
    ParallelRanges(Runs, 1,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t run = begin; run < end; ++run)
        {
          left[run] = FollowThroughSlab(material, energy, thickness, kernels, seed + part,
            count * run / Runs, count * (run + 1) / Runs, sums[run]);
        }
      });
    for (std::size_t run = 1; run < Runs; ++run)
    {
      std::transform(sums[run].begin(), sums[run].end(), sums[0].begin(), sums[0].begin(),
        std::plus<>());
      left[0] = { left[0][0] + left[run][0], left[0][1] + left[run][1] };
    }
    kernels.Multiple[part] = static_cast<float>(left[0][1] > 0 ? left[0][0] / left[0][1] : 0);
    std::transform(sums[0].begin(), sums[0].end(),
      kernels.Shares.begin() +
        static_cast<std::ptrdiff_t>(kernels.Index(part / thicknesses, part % thicknesses, 0)),
      [&](double sum) { return static_cast<float>(sum / static_cast<double>(photons)); });
  }
}

ScatterKernels KernelAxesOf(const Scene& scene, const PathLengthImage& lengths)
{
  ScatterKernels kernels;
  std::tie(kernels.Composition, kernels.DensityGPerCm3) = MeanMaterial(scene, lengths);
  const std::vector<double> thicknesses = TissueThickness(lengths);
  const double longest = *std::max_element(thicknesses.begin(), thicknesses.end());
  // In steps of 10 %, so that a body that moves a little keeps its kernels.
  const double thickest = std::pow(1.1, std::ceil(std::log(longest) / std::log(1.1)));
  for (const double share : { 0.0625, 0.125, 0.25, 0.375, 0.5, 0.65, 0.8, 1.0 })
  {
    kernels.ThicknessesMm.push_back(share * thickest);
  }
  kernels.EnergiesKeV = EnergiesBehind(scene,
    PhotonMaterial(kernels.Composition, kernels.DensityGPerCm3), kernels.ThicknessesMm.front());
  kernels.GapsMm = { 0, 10 };
  while (kernels.GapsMm.back() < scene.Scatter.AirGapMm + 0.5 * thickest)
  {
    kernels.GapsMm.push_back(2 * kernels.GapsMm.back());
  }
  const XRayDetector& detector = scene.Detector;
  const double reach = std::hypot(detector.Columns * Norm(detector.ColumnStep),
    detector.Rows * Norm(detector.RowStep));
  for (const double radius : { 0, 2, 4, 6, 9, 12, 16, 21, 27, 34, 42, 52, 64, 78, 94, 114, 138, 168,
         204, 250, 300, 370, 460, 600 })
  {
    kernels.RadiiMm.push_back(radius / 600 * reach);
  }
  kernels.AnglesDeg = { 0, 4, 8, 12, 16, 21, 28, 40, 60, 90 };
  return kernels;
}

std::int64_t PhotonsPerSlab(const ScatterKernels& kernels, double photons)
{
  const auto slabs = static_cast<double>(kernels.EnergiesKeV.size() * kernels.ThicknessesMm.size());
  return static_cast<std::int64_t>(std::max(photons / slabs, 1.0));
}
}
