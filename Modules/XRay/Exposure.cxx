// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Exposure.h"

#include "Private/ExposureViews.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/Scatter/Photons.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// ln k!
double LogFactorial(double k)
{
  int sign = 0;
  return lgamma_r(k + 1, &sign); // std::lgamma writes a global
}

/// A number of a Poisson distribution. Uniform numbers are multiplied below a mean of 10; above it
/// Hormann's transformed rejection PTRS is used (Insurance: Mathematics and Economics 12, 1993).
double PoissonNumber(double mean, RandomStream& random)
{
  if (mean < 10)
  {
    const double limit = std::exp(-mean);
    double k = 0;
    for (double product = random.Uniform(); product > limit; product *= random.Uniform())
    {
      ++k;
    }
    return k;
  }
  const double b = 0.931 + 2.53 * std::sqrt(mean);
  const double a = -0.059 + 0.02483 * b;
  const double inverseAlpha = 1.1239 + 1.1328 / (b - 3.4);
  const double accept = 0.9277 - 3.6224 / (b - 2);
  for (;;)
  {
    const double u = random.Uniform() - 0.5;
    const double v = random.Uniform();
    const double us = 0.5 - std::abs(u);
    const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= accept)
    {
      return k;
    }
    if (k >= 0 && (us >= 0.013 || v <= us) &&
      std::log(v * inverseAlpha / (a / (us * us) + b)) <=
        k * std::log(mean) - mean - LogFactorial(k))
    {
      return k;
    }
  }
}

void AddLengths(const PathLengthImage& image, float weight, std::shared_ptr<PathLengthImage>& mean)
{
  if (!mean)
  {
    mean = std::make_shared<PathLengthImage>(image);
    for (float& length : mean->Lengths)
    {
      length *= weight;
    }
    return;
  }
  for (std::size_t index = 0; index < mean->Lengths.size(); ++index)
  {
    mean->Lengths[index] += weight * image.Lengths[index];
  }
  for (std::size_t pixel = 0; pixel < mean->Inconsistent.size(); ++pixel)
  {
    mean->Inconsistent[pixel] |= image.Inconsistent[pixel];
  }
}

/// Seed of what is the detector's, whatever its noise.
constexpr std::uint64_t PixelSeed = 0x70697865;
/// Share of the largest count that the open beam has.
constexpr double OpenShare = 0.8;

/// A number of the normal distribution: two others make one (Box and Muller 1958).
double NormalNumber(RandomStream& random)
{
  const double radius = std::sqrt(-2 * std::log(random.Uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.Uniform());
}

/// `mean` photons' worth of signal with `variance`, both per incident photon.
double NoisyTransmission(double mean, double variance, double photons, RandomStream& random)
{
  if (!(mean > 0 && variance > 0))
  {
    return 0;
  }
  // c Poisson(m / c) has mean m and variance c m.
  const double scale = variance / mean;
  return scale / photons * PoissonNumber(photons * mean / scale, random);
}

/// Applies the open field and adds scatter to transmissions, and to their variances if there are
/// any.
void AddFields(const ExposureOptions& options, const PathLengthImage& lengths,
  std::vector<double>& variance, std::vector<double>& transmission)
{
  for (std::size_t pixel = 0; pixel < options.OpenField.size(); ++pixel)
  {
    transmission[pixel] *= options.OpenField[pixel];
    if (!variance.empty())
    {
      variance[pixel] *= options.OpenField[pixel];
    }
  }
  if (!options.Scatter)
  {
    return;
  }
  const std::vector<double> scatter = options.Scatter(lengths, transmission);
  if (scatter.size() != transmission.size())
  {
    throw InputError("exposure: expected scatter of " + std::to_string(transmission.size()) +
      " pixels, found " + std::to_string(scatter.size()));
  }
  for (std::size_t pixel = 0; pixel < transmission.size(); ++pixel)
  {
    const double primary = transmission[pixel];
    transmission[pixel] += scatter[pixel];
    if (!variance.empty())
    {
      variance[pixel] =
        primary > 0 ? variance[pixel] * transmission[pixel] / primary : transmission[pixel];
    }
  }
}

/// visit(pixel) for all of them, on several threads.
template <typename Visit>
void ForEachPixel(std::size_t count, const Visit& visit)
{
  ParallelRanges(count, 16384,
    [&visit](std::size_t begin, std::size_t end)
    {
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        visit(pixel);
      }
    });
}

/// From mean transmissions, and their variances where there is noise, to what is detected.
void Detect(const XRayDetector& detector, const ExposureOptions& options,
  const std::vector<double>& variance, std::vector<double>& transmission)
{
  if (options.PhotonsPerPixel > 0)
  {
    ForEachPixel(transmission.size(),
      [&](std::size_t pixel)
      {
        RandomStream random(options.Seed, pixel);
        transmission[pixel] =
          NoisyTransmission(transmission[pixel], variance[pixel], options.PhotonsPerPixel, random);
      });
  }
  if (options.HasBlur())
  {
    BlurImage(detector, options, transmission);
  }
  if (options.GainSpread > 0 || options.DeadPixels > 0)
  {
    ForEachPixel(transmission.size(),
      [&](std::size_t pixel)
      {
        RandomStream random(PixelSeed, pixel);
        const double gain = 1 + options.GainSpread * NormalNumber(random);
        transmission[pixel] *= random.Uniform() < options.DeadPixels ? 0 : std::max(gain, 0.0);
      });
  }
  if (options.ElectronicNoisePhotons > 0)
  {
    ForEachPixel(transmission.size(),
      [&](std::size_t pixel)
      {
        RandomStream random(~options.Seed, pixel); // another stream
        transmission[pixel] +=
          options.ElectronicNoisePhotons / options.PhotonsPerPixel * NormalNumber(random);
      });
  }
  const double most = std::exp2(options.Bits) - 1;
  for (std::size_t pixel = 0; options.HasPixelErrors() && pixel < transmission.size(); ++pixel)
  {
    const double signal = transmission[pixel] + options.DarkLevel;
    transmission[pixel] = options.Bits == 0
      ? signal
      : std::clamp(std::round(OpenShare * most * signal), 0.0, most) / (OpenShare * most);
  }
}

}

Exposure Expose(const PathLengthFunction& pathLengths, const XRaySource& source,
  const XRayDetector& detector, const Beam& beam, const ExposureOptions& options,
  const ProgressCallback& progress)
{
  options.Validate();
  const std::vector<ExposureView> views = ViewsOf(source, detector, options);
  const bool noise = options.PhotonsPerPixel > 0;
  const std::size_t pixelCount = detector.NumberOfPixels();
  if (!options.OpenField.empty() && options.OpenField.size() != pixelCount)
  {
    throw InputError("exposure: expected an open field of " + std::to_string(pixelCount) +
      " pixels, found " + std::to_string(options.OpenField.size()));
  }
  Exposure exposure;
  if (views.size() == 1 && !noise && options.OpenField.empty() && !options.HasBlur() &&
    !options.HasPixelErrors() && !options.Scatter)
  {
    exposure.Lengths = pathLengths(views.front().Source, views.front().Detector);
    exposure.Transmission = beam.Transmission(*exposure.Lengths);
    exposure.LogAttenuation = beam.LogAttenuation(*exposure.Lengths);
    return exposure;
  }
  std::vector<double> transmission(pixelCount, 0.0);
  std::vector<double> variance(noise ? pixelCount : 0, 0.0);
  const double weight = 1.0 / static_cast<double>(views.size());
  double done = 0;
  std::shared_ptr<PathLengthImage> mean;
  for (const ExposureView& view : views)
  {
    ReportProgress(progress, done, "projecting");
    const std::shared_ptr<const PathLengthImage> image = pathLengths(view.Source, view.Detector);
    if (weight == 1)
    {
      exposure.Lengths = image;
    }
    else
    {
      AddLengths(*image, static_cast<float>(weight), mean);
      exposure.Lengths = mean;
    }
    beam.AddTransmission(*image, weight, transmission, noise ? &variance : nullptr);
    done += weight;
  }
  AddFields(options, *exposure.Lengths, variance, transmission);
  Detect(detector, options, variance, transmission);
  const double least = noise ? 0.5 / options.PhotonsPerPixel : 1e-300;
  exposure.Transmission.resize(pixelCount);
  exposure.LogAttenuation.resize(pixelCount);
  ForEachPixel(pixelCount,
    [&](std::size_t pixel)
    {
      exposure.Transmission[pixel] = static_cast<float>(std::max(transmission[pixel], 0.0));
      exposure.LogAttenuation[pixel] =
        static_cast<float>(-std::log(std::max(transmission[pixel], least)));
    });
  return exposure;
}

void ExposureOptions::Validate() const
{
  RequireBetween("exposure", "a focal spot (mm)", this->FocalSpotColumnMm, 0, 1e3);
  RequireBetween("exposure", "a focal spot (mm)", this->FocalSpotRowMm, 0, 1e3);
  RequireBetween("exposure", "focal spot samples", this->FocalSpotSamples, 1, 32);
  RequireBetween("exposure", "photons per pixel", this->PhotonsPerPixel, 0, 1e12);
  RequireBetween("exposure", "electronic noise (photons)", this->ElectronicNoisePhotons, 0, 1e6);
  if (this->HalfModulationPerMm != 0)
  {
    RequireBetween("exposure", "half modulation (cycles per mm)", this->HalfModulationPerMm, 0.1,
      1000);
  }
  RequireBetween("exposure", "a spread of gains", this->GainSpread, 0, 0.5);
  RequireBetween("exposure", "a fraction of dead pixels", this->DeadPixels, 0, 0.5);
  RequireBetween("exposure", "a dark level", this->DarkLevel, 0, 10);
  if (this->Bits != 0)
  {
    RequireBetween("exposure", "bits", this->Bits, 8, 16);
  }
  this->Spread.Validate();
  if (this->HalfModulationPerMm > 0 && !this->Spread.DistancesMm.empty())
  {
    throw InputError("exposure: expected a half modulation or a line spread, found both");
  }
  if (this->ElectronicNoisePhotons > 0 && !(this->PhotonsPerPixel > 0))
  {
    throw InputError("exposure: expected photons per pixel for electronic noise, found none");
  }
  for (const float value : this->OpenField)
  {
    if (!(value >= 0) || !std::isfinite(value))
    {
      throw InputError(
        "exposure: expected an open field that is not negative, found " + std::to_string(value));
    }
  }
}

double LineSpread::Transfer(double cyclesPerMm) const
{
  const double w = 2 * std::numbers::pi * cyclesPerMm;
  double area = 0;
  double sum = 0;
  for (std::size_t node = 1; node < this->DistancesMm.size(); ++node)
  {
    const double x0 = this->DistancesMm[node - 1];
    const double x1 = this->DistancesMm[node];
    const double v0 = this->Values[node - 1];
    const double v1 = this->Values[node];
    const double piece = 0.5 * (v0 + v1) * (x1 - x0);
    area += piece;
    // The integral of (v0 + s (x - x0)) cos(w x) by parts; of short waves only.
    sum += w * (x1 - x0) < 1e-4 ? piece * std::cos(0.5 * w * (x0 + x1))
                                : (v1 * std::sin(w * x1) - v0 * std::sin(w * x0)) / w +
        (v1 - v0) / (x1 - x0) * (std::cos(w * x1) - std::cos(w * x0)) / (w * w);
  }
  return sum / area;
}

void LineSpread::Validate() const
{
  const std::vector<double>& x = this->DistancesMm;
  if (x.empty() && this->Values.empty())
  {
    return;
  }
  const bool ascends =
    std::adjacent_find(x.begin(), x.end(), [](double a, double b) { return !(a < b); }) == x.end();
  const bool areValues = std::all_of(this->Values.begin(), this->Values.end(),
    [](double value) { return value >= 0 && std::isfinite(value); });
  const bool hasArea =
    std::any_of(this->Values.begin(), this->Values.end(), [](double value) { return value > 0; });
  if (x.size() < 2 || x.size() != this->Values.size() || x.front() != 0 || !ascends ||
    !std::isfinite(x.back()) || !areValues || !hasArea)
  {
    throw InputError(
      "line spread: expected two values or more that are not negative, not all 0, at "
      "distances that ascend from 0");
  }
}
}
