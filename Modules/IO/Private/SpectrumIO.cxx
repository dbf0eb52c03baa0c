// SPDX-License-Identifier: Apache-2.0
#include "Private/SpectrumIO.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ShippedData.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace mammoray
{
namespace
{
/// A line of two numbers.
struct EnergyLine
{
  double Energy = 0;
  double Value = 0;
  std::string EnergyText;
  std::string ValueText;
  /// "path: line n".
  std::string Name;
};

/// visit(line) for each line that is not empty, as long as it answers true; numbers are parted by
/// blanks or a comma, `#` begins a comment. Throws InputError, which says what is `expected`, on
/// lines of another form.
template <typename Visit>
void ForEachEnergyLine(const std::string& path, const char* expected, const Visit& visit)
{
  std::ifstream file = OpenText(path);
  std::string text;
  for (std::size_t number = 1; ReadLine(file, text); ++number)
  {
    text.erase(std::min(text.find('#'), text.size()));
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream words(text);
    EnergyLine line;
    std::string rest;
    if (!(words >> line.EnergyText))
    {
      continue;
    }
    line.Name = LineName(path, number);
    if (!(words >> line.ValueText) || (words >> rest) || !ToNumber(line.EnergyText, line.Energy) ||
      !ToNumber(line.ValueText, line.Value))
    {
      throw InputError(line.Name + ": expected " + expected);
    }
    if (!visit(line))
    {
      return;
    }
  }
}

bool IsAbove(double energy, const std::vector<double>& before)
{
  return energy > 0 && std::isfinite(energy) && (before.empty() || energy > before.back());
}
}

Spectrum ReadSpectrum(const std::string& path)
{
  Spectrum spectrum;
  spectrum.Name = std::filesystem::path(path).stem().string();
  std::vector<double> density;
  ForEachEnergyLine(path, "an energy (eV) and a number of photons",
    [&](const EnergyLine& line)
    {
      if (!IsAbove(line.Energy * 1e-3, spectrum.EnergiesKeV))
      {
        throw InputError(line.Name + ": expected a positive energy above the one before, found " +
          line.EnergyText + " eV");
      }
      spectrum.EnergiesKeV.push_back(line.Energy * 1e-3);
      density.push_back(line.Value);
      return !(line.Value < 0);
    });
  if (density.size() < 2 || !(density.back() < 0))
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
  DetectorResponse response;
  response.ByEnergy = false;
  ForEachEnergyLine(path, "an energy (keV) and a signal",
    [&](const EnergyLine& line)
    {
      if (!IsAbove(line.Energy, response.EnergiesKeV) || !(line.Value >= 0) ||
        !std::isfinite(line.Value))
      {
        throw InputError(line.Name +
          ": expected a positive energy above the one before and a signal that is not negative, "
          "found " +
          line.EnergyText + " keV, " + line.ValueText);
      }
      response.EnergiesKeV.push_back(line.Energy);
      response.Efficiency.push_back(line.Value);
      return true;
    });
  if (response.EnergiesKeV.empty())
  {
    throw InputError(path + ": expected lines of an energy (keV) and a signal, found none");
  }
  return response;
}
}
