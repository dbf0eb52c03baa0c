// SPDX-License-Identifier: Apache-2.0
#include "Private/SpectrumIO.h"

#include "Private/TextTable.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ShippedData.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace mammoray
{
Spectrum ReadSpectrum(const std::string& path)
{
  std::ifstream file = OpenText(path);
  Spectrum spectrum;
  spectrum.Name = std::filesystem::path(path).stem().string();
  std::vector<double> density;
  bool ended = false;
  std::string line;
  for (std::size_t lineNumber = 1; !ended && std::getline(file, line); ++lineNumber)
  {
    line.erase(std::min(line.find('#'), line.size()));
    std::istringstream words(line);
    std::string energyText;
    std::string photonsText;
    std::string rest;
    if (!(words >> energyText))
    {
      continue;
    }
    double energy = 0;
    double photons = 0;
    if (!(words >> photonsText) || (words >> rest) || !ToNumber(energyText, energy) ||
      !ToNumber(photonsText, photons))
    {
      throw InputError(
        LineName(path, lineNumber) + ": expected an energy (eV) and a number of photons");
    }
    if (!(energy > 0) ||
      (!spectrum.EnergiesKeV.empty() && !(energy * 1e-3 > spectrum.EnergiesKeV.back())))
    {
      throw InputError(LineName(path, lineNumber) +
        ": expected a positive energy above the one before, found " + energyText + " eV");
    }
    spectrum.EnergiesKeV.push_back(energy * 1e-3);
    density.push_back(photons);
    ended = photons < 0;
  }
  if (!ended || density.size() < 2)
  {
    throw InputError(path + ": expected a list of photons that ends with a negative value");
  }
  for (std::size_t bin = 0; bin + 1 < density.size(); ++bin)
  {
    spectrum.Weights.push_back(
      density[bin] * (spectrum.EnergiesKeV[bin + 1] - spectrum.EnergiesKeV[bin]));
  }
  spectrum.EnergiesKeV.pop_back();
  spectrum.Validate();
  return spectrum;
}

DetectorResponse ReadDetectorResponse(const std::string& path)
{
  std::ifstream file = OpenText(path);
  DetectorResponse response;
  response.ByEnergy = false;
  std::string line;
  for (std::size_t lineNumber = 1; std::getline(file, line); ++lineNumber)
  {
    line.erase(std::min(line.find('#'), line.size()));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string energyText;
    std::string signalText;
    std::string rest;
    if (!(words >> energyText))
    {
      continue;
    }
    double energy = 0;
    double signal = 0;
    if (!(words >> signalText) || (words >> rest) || !ToNumber(energyText, energy) ||
      !ToNumber(signalText, signal))
    {
      throw InputError(LineName(path, lineNumber) + ": expected an energy (keV) and a signal");
    }
    if (!(energy > 0) || !(signal >= 0) || !std::isfinite(energy) || !std::isfinite(signal) ||
      (!response.EnergiesKeV.empty() && !(energy > response.EnergiesKeV.back())))
    {
      throw InputError(LineName(path, lineNumber) +
        ": expected a positive energy above the one before and a signal that is not negative, "
        "found " +
        energyText + " keV, " + signalText);
    }
    response.EnergiesKeV.push_back(energy);
    response.Efficiency.push_back(signal);
  }
  if (response.EnergiesKeV.empty())
  {
    throw InputError(path + ": expected lines of an energy (keV) and a signal, found none");
  }
  return response;
}
}
