// SPDX-License-Identifier: Apache-2.0
#include "Private/Thresholds.h"

#include "mammoray/Foundation/Numbers.h"

#include <itkHistogram.h>
#include <itkOtsuMultipleThresholdsCalculator.h>

#include <algorithm>
#include <utility>

namespace mammoray
{
double Quantile(std::vector<float> values, double fraction)
{
  return QuantileElement(std::move(values), fraction);
}

double MiddleOfShortestHalf(std::vector<float> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  std::size_t best = 0;
  for (std::size_t first = 0; first + half < values.size(); ++first)
  {
    if (values[first + half] - values[first] < values[best + half] - values[best])
    {
      best = first;
    }
  }
  return 0.5 * (static_cast<double>(values[best]) + values[best + half]);
}

std::vector<double> OtsuThresholds(const std::vector<float>& values, int classes)
{
  const double lowest = Quantile(values, 0.001);
  const double highest = Quantile(values, 0.999);
  if (!(lowest < highest))
  {
    return std::vector<double>(static_cast<std::size_t>(classes - 1), lowest);
  }
  // Search time grows with the number of bins to the power of the number of thresholds.
  const itk::SizeValueType bins = classes <= 3 ? 256 : 64;
  using Histogram = itk::Statistics::Histogram<double>;
  auto histogram = Histogram::New();
  histogram->SetMeasurementVectorSize(1);
  Histogram::SizeType size(1);
  size.Fill(bins);
  Histogram::MeasurementVectorType low(1);
  Histogram::MeasurementVectorType high(1);
  low.Fill(lowest);
  high.Fill(highest);
  histogram->Initialize(size, low, high);
  histogram->SetClipBinsAtEnds(false);
  Histogram::MeasurementVectorType measurement(1);
  Histogram::IndexType index(1);
  for (const float value : values)
  {
    measurement[0] = value;
    histogram->GetIndex(measurement, index);
    histogram->IncreaseFrequencyOfIndex(index, 1);
  }
  auto calculator = itk::OtsuMultipleThresholdsCalculator<Histogram>::New();
  calculator->SetInputHistogram(histogram);
  calculator->SetNumberOfThresholds(static_cast<itk::SizeValueType>(classes - 1));
  calculator->Compute();
  return calculator->GetOutput();
}
}
