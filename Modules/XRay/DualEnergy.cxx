// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/DualEnergy.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mammoray
{
namespace
{
/// -ln of the transmission of a slab of one material.
double SlabAttenuation(const Beam& beam, int material, double thicknessMm)
{
  std::vector<double> lengths(static_cast<std::size_t>(beam.NumberOfMaterials()), 0.0);
  lengths[static_cast<std::size_t>(material)] = thicknessMm;
  return beam.LogAttenuation(lengths.data());
}
}

double CancellingWeight(const Beam& low, const Beam& high, int a, int b, double thicknessMm)
{
  const int count = std::min(low.NumberOfMaterials(), high.NumberOfMaterials());
  if (a < 0 || b < 0 || a >= count || b >= count || a == b)
  {
    throw InputError("dual energy: expected two materials of " + std::to_string(count) +
      ", found " + std::to_string(a) + " and " + std::to_string(b));
  }
  if (!(thicknessMm > 0) || !std::isfinite(thicknessMm))
  {
    throw InputError("dual energy: expected a positive thickness");
  }
  const double atLow = SlabAttenuation(low, a, thicknessMm) - SlabAttenuation(low, b, thicknessMm);
  const double atHigh =
    SlabAttenuation(high, a, thicknessMm) - SlabAttenuation(high, b, thicknessMm);
  if (!(std::abs(atLow) > 1e-9))
  {
    throw InputError(
      "dual energy: expected materials that differ at low energy, found two that do not");
  }
  return atHigh / atLow;
}

std::vector<float> Recombine(const Exposure& low, const Exposure& high, double weight)
{
  if (low.LogAttenuation.size() != high.LogAttenuation.size())
  {
    throw InputError("dual energy: expected two pictures of one size, found " +
      std::to_string(low.LogAttenuation.size()) + " and " +
      std::to_string(high.LogAttenuation.size()) + " pixels");
  }
  std::vector<float> recombined(low.LogAttenuation.size());
  std::transform(low.LogAttenuation.begin(), low.LogAttenuation.end(), high.LogAttenuation.begin(),
    recombined.begin(),
    [&](float atLow, float atHigh) { return static_cast<float>(atHigh - weight * atLow); });
  return recombined;
}
}
