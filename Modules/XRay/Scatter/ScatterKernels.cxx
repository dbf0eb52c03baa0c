// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include "Private/Interpolation.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>

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
}
