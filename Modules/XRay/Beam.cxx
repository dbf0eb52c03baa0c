// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Beam.h"

#include "Private/FastExp.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/Foundation/ValidRange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

namespace mammoray
{
namespace
{
/// Limits beyond all real values, within which sums, squares and the device's floats do not
/// overflow.
constexpr double LeastPhotons = 1e-100;
constexpr double MostPhotons = 1e100;
constexpr double MostKeV = 1e12;
constexpr double MostEfficiency = 1e12;
constexpr double MostPerMm = 1e12;

/// Throws InputError unless the energies are positive, ascending and within these limits.
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
      !(energies[index] <= MostKeV))
    {
      throw InputError(what + ": expected positive, ascending energies up to 1e12 keV, found " +
        NumberText(energies[index]) + " keV at position " + std::to_string(index));
    }
  }
}

/// Smallest number of pixels per thread.
constexpr std::size_t PixelsPerThread = 8192;

constexpr std::size_t BlockSize = 256;

/// sums[i] += weight exp(-sum_m mu[m] lengths[m][i]), and the same with varianceWeight.
MAMMORAY_VECTOR_CLONES
void AddEnergy(const double* lengths, std::size_t materialCount, const double* mu, double weight,
  double varianceWeight, double* sums, double* variances)
{
  double exponents[BlockSize];
  for (std::size_t i = 0; i < BlockSize; ++i)
  {
    exponents[i] = -mu[0] * lengths[i];
  }
  for (std::size_t material = 1; material < materialCount; ++material)
  {
    const double* values = lengths + material * BlockSize;
    for (std::size_t i = 0; i < BlockSize; ++i)
    {
      exponents[i] -= mu[material] * values[i];
    }
  }
  for (std::size_t i = 0; i < BlockSize; ++i)
  {
    exponents[i] = FastExp(exponents[i]);
  }
  for (std::size_t i = 0; i < BlockSize; ++i)
  {
    sums[i] += weight * exponents[i];
  }
  if (varianceWeight > 0)
  {
    for (std::size_t i = 0; i < BlockSize; ++i)
    {
      variances[i] += varianceWeight * exponents[i];
    }
  }
}

/// Pixels with material, collected in blocks for the loops above.
struct Block
{
  static constexpr std::size_t Size = BlockSize;

  /// `materialCount`: without air.
  explicit Block(int materialCount)
    : Materials(static_cast<std::size_t>(std::max(materialCount, 1)))
    , Lengths(this->Materials * Size, 0.0)
  {
  }

  /// Adds the pixel unless all of its lengths are 0.
  void Add(const PathLengthImage& image, std::size_t pixel)
  {
    bool empty = true;
    for (int material = 1; material < image.Materials; ++material)
    {
      const float length = image.Material(material)[pixel];
      this->Lengths[static_cast<std::size_t>(material - 1) * Size + this->Count] = length;
      empty = empty && length == 0;
    }
    this->Pixels[this->Count] = pixel;
    this->Count += empty ? 0 : 1;
  }

  /// `mu[e * stride + m]` of energy e and material m, air being 0.
  void Attenuate(const std::vector<double>& weights, const std::vector<double>& mu, int stride,
    const std::vector<double>* varianceWeights)
  {
    this->Sums.fill(0);
    this->Variances.fill(0);
    for (std::size_t energy = 0; energy < weights.size(); ++energy)
    {
      AddEnergy(this->Lengths.data(), this->Materials,
        &mu[energy * static_cast<std::size_t>(stride) + 1], weights[energy],
        varianceWeights ? (*varianceWeights)[energy] : 0.0, this->Sums.data(),
        this->Variances.data());
    }
  }

  std::size_t Materials;
  std::size_t Count = 0;
  std::array<std::size_t, Size> Pixels{};
  std::array<double, Size> Sums{};
  std::array<double, Size> Variances{};
  /// Lengths[material * Size + index], mm.
  std::vector<double> Lengths;
};
}

Spectrum Spectrum::Monochromatic(double energyKeV)
{
  Spectrum spectrum;
  spectrum.Name = NumberText(energyKeV) + " keV";
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

double Spectrum::PeakEnergyKeV() const
{
  const std::vector<double>& energies = this->EnergiesKeV;
  std::size_t last = energies.size() - 1;
  while (last > 0 && !(this->Weights[last] > 0))
  {
    --last;
  }
  return last > 0 ? 2 * energies[last] - energies[last - 1] : energies[last];
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
        what + ": expected photon numbers that are not negative, found " + NumberText(weight));
    }
    sum += weight;
  }
  if (!(sum > 0))
  {
    throw InputError(what + ": expected photons, found none");
  }
  if (sum < LeastPhotons || sum > MostPhotons)
  {
    throw InputError(what + ": expected 1e-100 to 1e100 photons, found " + NumberText(sum));
  }
}

double AttenuationTable::DensityOf(double statedGPerCm3) const
{
  const std::string what = "attenuation '" + this->Name + "'";
  if (statedGPerCm3 != 0)
  {
    CheckValidRange(ValidRanges::PartDensity, statedGPerCm3, what, {});
    return statedGPerCm3;
  }
  if (!this->HasDensity)
  {
    throw InputError(what +
      ": expected a density in g/cm3 (only elements, NIST's compounds and tables have one of their "
      "own), found none");
  }
  return this->NominalDensityGPerCm3;
}

double AttenuationTable::MuAt(double energyKeV, double densityGPerCm3) const
{
  const std::vector<double>& energies = this->EnergiesKeV;
  if (energies.empty() || !(energyKeV >= energies.front() && energyKeV <= energies.back()))
  {
    throw InputError("attenuation table '" + this->Name + "': no value at " +
      NumberText(energyKeV) + " keV" +
      (energies.empty() ? std::string()
                        : "; it reaches from " + NumberText(energies.front()) + " to " +
            NumberText(energies.back()) + " keV"));
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
      throw InputError(
        what + ": expected positive coefficients, found " + NumberText(mu) + " / mm");
    }
  }
  if (!(this->NominalDensityGPerCm3 > 0) || !std::isfinite(this->NominalDensityGPerCm3))
  {
    throw InputError(what + ": expected a positive nominal density, found " +
      NumberText(this->NominalDensityGPerCm3) + " g/cm3");
  }
}

double DetectorResponse::Signal(double energyKeV) const
{
  const double signal = this->ByEnergy ? energyKeV : 1.0;
  if (this->EnergiesKeV.empty())
  {
    return signal;
  }
  const auto above =
    std::upper_bound(this->EnergiesKeV.begin(), this->EnergiesKeV.end(), energyKeV);
  if (above == this->EnergiesKeV.begin() || above == this->EnergiesKeV.end())
  {
    return signal *
      (above == this->EnergiesKeV.begin() ? this->Efficiency.front() : this->Efficiency.back());
  }
  const auto upper = static_cast<std::size_t>(above - this->EnergiesKeV.begin());
  const double low = this->EnergiesKeV[upper - 1];
  return signal *
    std::lerp(this->Efficiency[upper - 1], this->Efficiency[upper],
      (energyKeV - low) / (this->EnergiesKeV[upper] - low));
}

void DetectorResponse::Validate() const
{
  if (this->Efficiency.size() != this->EnergiesKeV.size())
  {
    throw InputError("detector's response: expected a value for each of " +
      std::to_string(this->EnergiesKeV.size()) + " energies, found " +
      std::to_string(this->Efficiency.size()));
  }
  for (std::size_t index = 0; index < this->EnergiesKeV.size(); ++index)
  {
    if (!(this->EnergiesKeV[index] > (index > 0 ? this->EnergiesKeV[index - 1] : 0)) ||
      !std::isfinite(this->EnergiesKeV[index]) || !(this->Efficiency[index] >= 0) ||
      !(this->Efficiency[index] <= MostEfficiency))
    {
      throw InputError("detector's response: expected ascending energies (keV) and values that are "
                       "not negative, up to 1e12, found " +
        NumberText(this->EnergiesKeV[index]) + " keV, " + NumberText(this->Efficiency[index]));
    }
  }
}

Beam::Beam(const Spectrum& spectrum, const DetectorResponse& response,
  const std::vector<const AttenuationTable*>& tables, const std::vector<double>& densities)
  : MaterialCount(static_cast<int>(tables.size()))
{
  spectrum.Validate();
  response.Validate();
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
  }
  double sum = 0;
  double photons = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    if (spectrum.Weights[bin] == 0)
    {
      continue;
    }
    const double energy = spectrum.EnergiesKeV[bin];
    const double detected = response.Signal(energy);
    this->Weights.push_back(spectrum.Weights[bin] * detected);
    this->VarianceWeights.push_back(spectrum.Weights[bin] * detected * detected);
    sum += this->Weights.back();
    photons += spectrum.Weights[bin];
    this->Mu.push_back(0.0);
    for (std::size_t material = 1; material < tables.size(); ++material)
    {
      this->Mu.push_back(
        tables[material]->MuAt(energy, tables[material]->DensityOf(densities[material])));
      if (!(this->Mu.back() <= MostPerMm))
      {
        throw InputError("beam: expected an attenuation of material " + std::to_string(material) +
          " up to 1e12 / mm, found " + NumberText(this->Mu.back()) + " at " + NumberText(energy) +
          " keV");
      }
    }
  }
  if (!(sum > 0))
  {
    throw InputError("beam: expected a detector that responds to the spectrum, found none");
  }
  for (double& weight : this->Weights)
  {
    weight /= sum;
  }
  for (double& weight : this->VarianceWeights)
  {
    weight *= photons / (sum * sum);
  }
}

template <typename Visit>
void Beam::ForEachEnergy(const double* lengthsMm, const Visit& visit) const
{
  const double* mu = this->Mu.data();
  for (const double weight : this->Weights)
  {
    double exponent = 0;
    for (int material = 1; material < this->MaterialCount; ++material)
    {
      exponent -= mu[material] * lengthsMm[material];
    }
    mu += this->MaterialCount;
    visit(weight, exponent);
  }
}

double Beam::Transmission(const double* lengthsMm) const
{
  double transmitted = 0;
  this->ForEachEnergy(lengthsMm,
    [&](double weight, double exponent) { transmitted += weight * std::exp(exponent); });
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
  this->ForEachEnergy(lengthsMm,
    [&](double weight, double exponent) { absorbed -= weight * std::expm1(exponent); });
  return -std::log1p(-absorbed);
}

void Beam::CheckMaterials(int count) const
{
  if (count > this->MaterialCount)
  {
    throw InputError("beam: expected path lengths of at most " +
      std::to_string(this->MaterialCount) + " materials, found " + std::to_string(count));
  }
}

template <typename Store>
void Beam::ForEachPixel(const PathLengthImage& image, bool wantVariance, const Store& store) const
{
  this->CheckMaterials(image.Materials);
  ParallelRanges(image.NumberOfPixels(), PixelsPerThread,
    [&](std::size_t begin, std::size_t end)
    {
      Block block(image.Materials - 1);
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        block.Add(image, pixel);
        if (block.Count == Block::Size || (pixel + 1 == end && block.Count > 0))
        {
          block.Attenuate(this->Weights, this->Mu, this->MaterialCount,
            wantVariance ? &this->VarianceWeights : nullptr);
          for (std::size_t index = 0; index < block.Count; ++index)
          {
            store(block.Pixels[index], block.Sums[index], block.Variances[index]);
          }
          block.Count = 0;
        }
      }
    });
}

std::vector<float> Beam::Transmission(const PathLengthImage& image) const
{
  std::vector<float> values(image.NumberOfPixels(), 1.0f);
  this->ForEachPixel(image, false,
    [&](std::size_t pixel, double transmission, double)
    { values[pixel] = static_cast<float>(transmission); });
  return values;
}

std::vector<float> Beam::LogAttenuation(const PathLengthImage& image) const
{
  std::vector<float> values(image.NumberOfPixels(), 0.0f);
  this->ForEachPixel(image, false,
    [&](std::size_t pixel, double transmission, double)
    {
      if (transmission > 1e-290 && transmission < 0.9)
      {
        values[pixel] = static_cast<float>(-std::log(transmission));
        return;
      }
      // Next to 1 and to the end of the range of numbers: ray by ray.
      std::vector<double> lengths(static_cast<std::size_t>(this->MaterialCount), 0.0);
      for (int material = 1; material < image.Materials; ++material)
      {
        lengths[static_cast<std::size_t>(material)] = image.Material(material)[pixel];
      }
      values[pixel] = static_cast<float>(this->LogAttenuation(lengths.data()));
    });
  return values;
}

void Beam::AddTransmission(const PathLengthImage& image, double weight,
  std::vector<double>& transmission, std::vector<double>* variance) const
{
  const std::size_t pixelCount = image.NumberOfPixels();
  if (transmission.size() != pixelCount || (variance && variance->size() != pixelCount))
  {
    throw InputError("beam: expected sums of " + std::to_string(pixelCount) + " pixels, found " +
      std::to_string(transmission.size()));
  }
  double openVariance = 0;
  for (const double part : this->VarianceWeights)
  {
    openVariance += part;
  }
  // Pixels that see no material are not visited: what they add is taken as given and put right.
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    transmission[pixel] += weight;
    if (variance)
    {
      (*variance)[pixel] += weight * openVariance;
    }
  }
  this->ForEachPixel(image, variance != nullptr,
    [&](std::size_t pixel, double transmitted, double spread)
    {
      transmission[pixel] += weight * (transmitted - 1);
      if (variance)
      {
        (*variance)[pixel] += weight * (spread - openVariance);
      }
    });
}

std::vector<float> Beam::Backward(const PathLengthImage& image,
  const std::vector<double>& lossByTransmission, std::vector<double>& lossByAttenuation,
  std::vector<double>& lossByWeight) const
{
  this->CheckMaterials(image.Materials);
  const std::size_t pixelCount = image.NumberOfPixels();
  const auto materials = static_cast<std::size_t>(image.Materials);
  const auto stride = static_cast<std::size_t>(this->MaterialCount);
  std::vector<float> losses(pixelCount * materials, 0.0F);
  std::mutex adding;
  ParallelRanges(pixelCount, PixelsPerThread,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<double> transmitted(this->Weights.size());
      std::vector<double> lengths(materials);
      std::vector<double> slopes(materials);
      std::vector<double> attenuation(materials, 0.0);
      std::vector<double> weights(this->Weights.size(), 0.0);
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        const double loss = lossByTransmission[pixel];
        for (std::size_t material = 1; material < materials; ++material)
        {
          lengths[material] = image.Lengths[material * pixelCount + pixel];
        }
        double sum = 0;
        std::fill(slopes.begin(), slopes.end(), 0.0);
        for (std::size_t energy = 0; loss != 0 && energy < this->Weights.size(); ++energy)
        {
          const double* mu = &this->Mu[energy * stride];
          double exponent = 0;
          for (std::size_t material = 1; material < materials; ++material)
          {
            exponent -= mu[material] * lengths[material];
          }
          transmitted[energy] = FastExp(exponent);
          const double photons = this->Weights[energy] * transmitted[energy];
          sum += photons;
          for (std::size_t material = 1; material < materials; ++material)
          {
            slopes[material] -= photons * mu[material];
          }
        }
        for (std::size_t energy = 0; loss != 0 && energy < this->Weights.size(); ++energy)
        {
          weights[energy] += loss * this->Weights[energy] * (transmitted[energy] - sum);
        }
        for (std::size_t material = 1; material < materials; ++material)
        {
          losses[material * pixelCount + pixel] = static_cast<float>(loss * slopes[material]);
          attenuation[material] += loss * slopes[material] * lengths[material];
        }
      }
      const std::lock_guard lock(adding);
      for (std::size_t material = 1; material < materials; ++material)
      {
        lossByAttenuation[material] += attenuation[material];
      }
      for (std::size_t energy = 0; energy < weights.size(); ++energy)
      {
        lossByWeight[energy] += weights[energy];
      }
    });
  return losses;
}

std::vector<float> Beam::MeanAttenuation(const PathLengthImage& image) const
{
  this->CheckMaterials(image.Materials);
  const std::size_t pixelCount = image.NumberOfPixels();
  std::vector<float> values(pixelCount * static_cast<std::size_t>(image.Materials), 0.0f);
  ParallelRanges(pixelCount, PixelsPerThread,
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
