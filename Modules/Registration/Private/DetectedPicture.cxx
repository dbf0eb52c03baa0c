// SPDX-License-Identifier: Apache-2.0
#include "Private/DetectedPicture.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mammoray
{
namespace
{
std::vector<double> PrimaryOf(const BreastModel& model, const PathLengthImage& lengths)
{
  std::vector<double> primary(lengths.NumberOfPixels());
  model.XRays().AddTransmission(lengths, 1, primary);
  return primary;
}
}

std::vector<float> DetectedAttenuation(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths)
{
  if (!model.Scatter())
  {
    return model.XRays().LogAttenuation(lengths);
  }
  const std::vector<double> primary = PrimaryOf(model, lengths);
  const std::vector<double> scatter =
    model.Scatter()->Scatter(source, detector, TissueThickness(lengths), primary);
  std::vector<float> attenuation(primary.size());
  std::transform(primary.begin(), primary.end(), scatter.begin(), attenuation.begin(),
    [](double through, double scattered)
    { return static_cast<float>(-std::log(std::max(through + scattered, 1e-300))); });
  return attenuation;
}

std::vector<std::vector<double>> DetectedRates(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths,
  const std::vector<float>& attenuation, const PathLengthDerivatives& derivatives)
{
  const std::size_t pixels = lengths.NumberOfPixels();
  const std::vector<float> mean = model.XRays().MeanAttenuation(lengths);
  // Of the primary radiation alone.
  std::vector<std::vector<double>> rates(static_cast<std::size_t>(derivatives.Fields),
    std::vector<double>(pixels));
  for (int field = 0; field < derivatives.Fields; ++field)
  {
    std::vector<double>& rate = rates[static_cast<std::size_t>(field)];
    for (int material = 1; material < lengths.Materials; ++material)
    {
      const float* mu = mean.data() + static_cast<std::size_t>(material) * pixels;
      const float* length = derivatives.Of(field, material);
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      {
        rate[pixel] += static_cast<double>(mu[pixel]) * length[pixel];
      }
    }
  }
  if (!model.Scatter())
  {
    return rates;
  }
  const std::vector<double> primary = PrimaryOf(model, lengths);
  std::vector<ScatterModel::SignalRates> signals;
  for (int field = 0; field < derivatives.Fields; ++field)
  {
    ScatterModel::SignalRates& signal = signals.emplace_back();
    signal.ThicknessesMm.resize(pixels);
    for (int material = 1; material < lengths.Materials; ++material)
    {
      const float* length = derivatives.Of(field, material);
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      {
        signal.ThicknessesMm[pixel] += length[pixel];
      }
    }
    signal.Primary = std::move(rates[static_cast<std::size_t>(field)]);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      signal.Primary[pixel] *= -primary[pixel];
    }
  }
  rates =
    model.Scatter()->Differentiate(source, detector, TissueThickness(lengths), primary, signals);
  for (std::size_t field = 0; field < rates.size(); ++field)
  {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      const double detected = std::exp(-static_cast<double>(attenuation[pixel]));
      rates[field][pixel] = -(signals[field].Primary[pixel] + rates[field][pixel]) / detected;
    }
  }
  return rates;
}
}
