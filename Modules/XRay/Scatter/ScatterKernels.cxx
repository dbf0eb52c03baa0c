// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/ScatterKernels.h"

#include "Private/AxisPlace.h"
#include "Private/SlabScatter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

namespace mammoray
{
namespace
{
/// As at its ends beyond them.
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

void FillScatterKernels(ScatterKernels& kernels, std::int64_t photons, std::uint64_t seed,
  const ProgressCallback& progress)
{
  kernels.Validate();
  if (photons < 1)
  {
    throw InputError(
      "scatter kernels: expected 1 photon or more, found " + std::to_string(photons));
  }
  const PhotonMaterial tissue(kernels.Composition, kernels.DensityGPerCm3);
  const std::size_t thicknesses = kernels.ThicknessesMm.size();
  const std::size_t parts = kernels.EnergiesKeV.size() * thicknesses;
  const std::size_t size =
    kernels.GapsMm.size() * kernels.NumberOfRings() * kernels.NumberOfAngles();
  for (std::size_t part = 0; part < parts; ++part)
  {
    ReportProgress(progress, static_cast<double>(part) / static_cast<double>(parts),
      "following photons");
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
}
