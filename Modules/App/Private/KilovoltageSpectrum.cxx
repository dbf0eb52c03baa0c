// SPDX-License-Identifier: Apache-2.0
#include "Private/KilovoltageSpectrum.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
double KilovoltageOf(const Spectrum& spectrum)
{
  double last = 0;
  for (std::size_t bin = 0; bin < spectrum.EnergiesKeV.size(); ++bin)
  {
    last = spectrum.Weights[bin] > 0 ? spectrum.EnergiesKeV[bin] : last;
  }
  return std::floor(last) + 1;
}

Spectrum AtKilovoltage(const Spectrum& spectrum, double kilovoltage)
{
  const double given = KilovoltageOf(spectrum);
  if (!(kilovoltage > spectrum.EnergiesKeV.front() + 1) || !(kilovoltage <= given + 10) ||
    spectrum.EnergiesKeV.size() < 2)
  {
    throw InputError("tube voltage: expected more than " +
      std::to_string(spectrum.EnergiesKeV.front() + 1) + " and at most " +
      std::to_string(given + 10) + " kV of a spectrum of several energies, found " +
      std::to_string(kilovoltage));
  }
  Spectrum scaled;
  char name[32];
  std::snprintf(name, sizeof name, ", at %.1f kV", kilovoltage);
  scaled.Name = spectrum.Name + name;
  const double step = spectrum.EnergiesKeV[1] - spectrum.EnergiesKeV[0];
  // What the law leaves: filter, 1 / E, lines. Close to the end it is a quotient of small numbers.
  const double trusted = given - 2;
  double rest = 0;
  for (std::size_t bin = 0;; ++bin)
  {
    const double energy = bin < spectrum.EnergiesKeV.size()
      ? spectrum.EnergiesKeV[bin]
      : spectrum.EnergiesKeV.front() + static_cast<double>(bin) * step;
    if (!(energy < kilovoltage))
    {
      return scaled;
    }
    if (bin < spectrum.EnergiesKeV.size() && energy <= trusted)
    {
      rest = spectrum.Weights[bin] / (given - energy);
    }
    scaled.EnergiesKeV.push_back(energy);
    scaled.Weights.push_back(rest * (kilovoltage - energy));
  }
}
}
