// SPDX-License-Identifier: Apache-2.0
#include "Beam.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <thread>

namespace mammoray
{
namespace
{
std::string Number(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Throws unless the energies are positive, finite and ascending.
void CheckEnergies(const std::vector<double>& energies, std::size_t valueCount,
  const std::string& what)
{
  if (energies.empty() || energies.size() != valueCount)
  {
    throw InputError(what + ": expected as many values as energies and at least one, found " +
      std::to_string(valueCount) + " and " + std::to_string(energies.size()));
  }
  for (std::size_t index = 0; index < energies.size(); ++index)
  {
    if (!(energies[index] > (index == 0 ? 0.0 : energies[index - 1])) ||
      !std::isfinite(energies[index]))
    {
      throw InputError(what + ": expected positive, ascending energies, found " +
        Number(energies[index]) + " keV at position " + std::to_string(index));
    }
  }
}

/// Calls work(begin, end) on parts of [0, count) by as many threads as pay.
template <typename Work>
void InParallel(std::size_t count, const Work& work)
{
  const std::size_t parts = std::clamp<std::size_t>(
    std::min<std::size_t>(std::thread::hardware_concurrency(), count / 8192), 1, 64);
  std::vector<std::thread> threads;
  for (std::size_t part = 1; part < parts; ++part)
  {
    threads.emplace_back(work, count * part / parts, count * (part + 1) / parts);
  }
  work(0, count / parts);
  for (std::thread& thread : threads)
  {
    thread.join();
  }
}
}

Spectrum Spectrum::Monochromatic(double energyKeV)
{
  Spectrum spectrum;
  spectrum.Name = Number(energyKeV) + " keV";
  spectrum.EnergiesKeV = { energyKeV };
  spectrum.Weights = { 1.0 };
  spectrum.Validate();
  return spectrum;
}

double Spectrum::MeanEnergyKeV() const
{
  double sum = 0;
  double weightSum = 0;
  for (std::size_t bin = 0; bin < this->Weights.size(); ++bin)
  {
    sum += this->Weights[bin] * this->EnergiesKeV[bin];
    weightSum += this->Weights[bin];
  }
  return sum / weightSum;
}

void Spectrum::Validate() const
{
  const std::string what = "spectrum '" + this->Name + "'";
  CheckEnergies(this->EnergiesKeV, this->Weights.size(), what);
  double sum = 0;
  for (const double weight : this->Weights)
  {
    if (!(weight >= 0) || !std::isfinite(weight))
    {
      throw InputError(
        what + ": expected photon numbers that are not negative, found " + Number(weight));
    }
    sum += weight;
  }
  if (!(sum > 0))
  {
    throw InputError(what + ": expected photons, found none");
  }
}

double AttenuationTable::MuAt(double energyKeV, double densityGPerCm3) const
{
  const std::vector<double>& energies = this->EnergiesKeV;
  if (energies.empty() || !(energyKeV >= energies.front() && energyKeV <= energies.back()))
  {
    throw InputError("attenuation table '" + this->Name + "': no value at " + Number(energyKeV) +
      " keV" +
      (energies.empty() ? std::string()
                        : "; it reaches from " + Number(energies.front()) + " to " +
            Number(energies.back()) + " keV"));
  }
  const double scale = densityGPerCm3 / this->NominalDensityGPerCm3;
  const auto above = static_cast<std::size_t>(
    std::lower_bound(energies.begin(), energies.end(), energyKeV) - energies.begin());
  if (energies[above] == energyKeV)
  {
    return scale * this->MuPerMm[above];
  }
  const std::size_t below = above - 1;
  const double fraction =
    std::log(energyKeV / energies[below]) / std::log(energies[above] / energies[below]);
  return scale *
    std::exp(
      (1 - fraction) * std::log(this->MuPerMm[below]) + fraction * std::log(this->MuPerMm[above]));
}

void AttenuationTable::Validate() const
{
  const std::string what = "attenuation table '" + this->Name + "'";
  CheckEnergies(this->EnergiesKeV, this->MuPerMm.size(), what);
  for (const double mu : this->MuPerMm)
  {
    if (!(mu > 0) || !std::isfinite(mu))
    {
      throw InputError(what + ": expected positive coefficients, found " + Number(mu) + " / mm");
    }
  }
  if (!(this->NominalDensityGPerCm3 > 0) || !std::isfinite(this->NominalDensityGPerCm3))
  {
    throw InputError(what + ": expected a positive nominal density, found " +
      Number(this->NominalDensityGPerCm3) + " g/cm3");
  }
}

Beam::Beam(const Spectrum& spectrum, DetectorResponse response,
  const std::vector<const AttenuationTable*>& tables, const std::vector<double>& densities)
  : MaterialCount(static_cast<int>(tables.size()))
{
  spectrum.Validate();
  if (tables.empty() || densities.size() != tables.size())
  {
    throw InputError("beam: expected one density per material and at least air, found " +
      std::to_string(densities.size()) + " densities of " + std::to_string(tables.size()) +
      " materials");
  }
  for (std::size_t material = 1; material < tables.size(); ++material)
  {
    if (!tables[material])
    {
      throw InputError("beam: material " + std::to_string(material) + " has no attenuation table");
    }
    tables[material]->Validate();
    if (!(densities[material] > 0) || !std::isfinite(densities[material]))
    {
      throw InputError("beam: expected a positive density of material " + std::to_string(material) +
        ", found " + Number(densities[material]) + " g/cm3");
    }
  }
  double sum = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    if (spectrum.Weights[bin] == 0)
    {
      continue;
    }
    const double energy = spectrum.EnergiesKeV[bin];
    const double detected = response == DetectorResponse::EnergyIntegrating ? energy : 1.0;
    this->Weights.push_back(spectrum.Weights[bin] * detected);
    sum += this->Weights.back();
    this->Mu.push_back(0.0);
    for (std::size_t material = 1; material < tables.size(); ++material)
    {
      this->Mu.push_back(tables[material]->MuAt(energy, densities[material]));
    }
  }
  for (double& weight : this->Weights)
  {
    weight /= sum;
  }
}

double Beam::Transmission(const double* lengthsMm) const
{
  double transmitted = 0;
  const double* mu = this->Mu.data();
  for (const double weight : this->Weights)
  {
    double exponent = 0;
    for (int material = 1; material < this->MaterialCount; ++material)
    {
      exponent -= mu[material] * lengthsMm[material];
    }
    mu += this->MaterialCount;
    transmitted += weight * std::exp(exponent);
  }
  return transmitted;
}

double Beam::LogAttenuation(const double* lengthsMm) const
{
  const double transmitted = this->Transmission(lengthsMm);
  if (transmitted < 0.9)
  {
    return -std::log(transmitted);
  }
  // 1 - I / I0 without cancellation.
  double absorbed = 0;
  const double* mu = this->Mu.data();
  for (const double weight : this->Weights)
  {
    double exponent = 0;
    for (int material = 1; material < this->MaterialCount; ++material)
    {
      exponent -= mu[material] * lengthsMm[material];
    }
    mu += this->MaterialCount;
    absorbed -= weight * std::expm1(exponent);
  }
  return -std::log1p(-absorbed);
}

template <typename Function>
std::vector<float> Beam::PerPixel(const PathLengthImage& image, float outside,
  const Function& function) const
{
  if (image.Materials > this->MaterialCount)
  {
    throw InputError("beam: expected path lengths of at most " +
      std::to_string(this->MaterialCount) + " materials, found " + std::to_string(image.Materials));
  }
  const std::size_t pixelCount = image.NumberOfPixels();
  std::vector<float> values(pixelCount);
  InParallel(pixelCount,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<double> lengths(static_cast<std::size_t>(this->MaterialCount), 0.0);
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        bool empty = true;
        for (int material = 1; material < image.Materials; ++material)
        {
          lengths[static_cast<std::size_t>(material)] = image.Material(material)[pixel];
          empty = empty && lengths[static_cast<std::size_t>(material)] == 0;
        }
        values[pixel] = empty ? outside : static_cast<float>(function(lengths.data()));
      }
    });
  return values;
}

std::vector<float> Beam::Transmission(const PathLengthImage& image) const
{
  return this->PerPixel(image, 1.0f,
    [this](const double* lengths) { return this->Transmission(lengths); });
}

std::vector<float> Beam::LogAttenuation(const PathLengthImage& image) const
{
  return this->PerPixel(image, 0.0f,
    [this](const double* lengths) { return this->LogAttenuation(lengths); });
}

std::vector<float> Beam::MeanAttenuation(const PathLengthImage& image) const
{
  if (image.Materials > this->MaterialCount)
  {
    throw InputError("beam: expected path lengths of at most " +
      std::to_string(this->MaterialCount) + " materials, found " + std::to_string(image.Materials));
  }
  const std::size_t pixelCount = image.NumberOfPixels();
  std::vector<float> values(pixelCount * static_cast<std::size_t>(image.Materials), 0.0f);
  InParallel(pixelCount,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<double> exponents(this->Weights.size());
      std::vector<double> sums(static_cast<std::size_t>(image.Materials));
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        for (std::size_t energy = 0; energy < this->Weights.size(); ++energy)
        {
          const double* mu = &this->Mu[energy * static_cast<std::size_t>(this->MaterialCount)];
          exponents[energy] = 0;
          for (int material = 1; material < image.Materials; ++material)
          {
            exponents[energy] -= mu[material] * image.Material(material)[pixel];
          }
        }
        // A common factor cancels; taking out the largest keeps dense pixels from underflow.
        const double largest = *std::max_element(exponents.begin(), exponents.end());
        double total = 0;
        std::fill(sums.begin(), sums.end(), 0.0);
        for (std::size_t energy = 0; energy < this->Weights.size(); ++energy)
        {
          const double* mu = &this->Mu[energy * static_cast<std::size_t>(this->MaterialCount)];
          const double photons = this->Weights[energy] * std::exp(exponents[energy] - largest);
          total += photons;
          for (int material = 1; material < image.Materials; ++material)
          {
            sums[static_cast<std::size_t>(material)] += photons * mu[material];
          }
        }
        for (int material = 1; material < image.Materials; ++material)
        {
          values[static_cast<std::size_t>(material) * pixelCount + pixel] =
            static_cast<float>(sums[static_cast<std::size_t>(material)] / total);
        }
      }
    });
  return values;
}
}
