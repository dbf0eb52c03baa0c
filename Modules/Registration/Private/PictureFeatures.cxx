// SPDX-License-Identifier: Apache-2.0
#include "Private/PictureFeatures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
constexpr std::size_t None = std::numeric_limits<std::size_t>::max();

/// The number in `pixels` of each pixel of a picture; None for others.
std::vector<std::size_t> Numbers(const ReceptorGrid& grid, const std::vector<std::size_t>& pixels)
{
  std::vector<std::size_t> numbers(grid.NumberOfPixels(), None);
  for (std::size_t index = 0; index < pixels.size(); ++index)
  {
    numbers[pixels[index]] = index;
  }
  return numbers;
}
}

PictureFeatures::PictureFeatures(PictureComparison kind, const ReceptorGrid& grid,
  const std::vector<std::size_t>& pixels, double windowMm)
  : Kind(kind)
  , Pixels(pixels)
{
  if (kind == PictureComparison::Local)
  {
    this->FindWindows(grid, windowMm);
  }
  else if (kind == PictureComparison::Gradient)
  {
    this->FindNeighbours(grid);
  }
}

void PictureFeatures::FindWindows(const ReceptorGrid& grid, double windowMm)
{
  const std::vector<std::size_t> numbers = Numbers(grid, this->Pixels);
  const int across =
    std::max(1, static_cast<int>(std::lround(0.5 * windowMm / grid.ColumnSpacingMm())));
  const int down = std::max(1, static_cast<int>(std::lround(0.5 * windowMm / grid.RowSpacingMm())));
  for (const std::size_t pixel : this->Pixels)
  {
    this->First.push_back(this->Members.size());
    const int column = static_cast<int>(pixel % grid.Columns);
    const int row = static_cast<int>(pixel / grid.Columns);
    for (int y = std::max(0, row - down); y <= std::min(grid.Rows - 1, row + down); ++y)
    {
      for (int x = std::max(0, column - across); x <= std::min(grid.Columns - 1, column + across);
           ++x)
      {
        const std::size_t number = numbers[grid.Index(x, y)];
        if (number != None)
        {
          this->Members.push_back(number);
        }
      }
    }
  }
  this->First.push_back(this->Members.size());
}

void PictureFeatures::FindNeighbours(const ReceptorGrid& grid)
{
  const std::vector<std::size_t> numbers = Numbers(grid, this->Pixels);
  const auto add = [&](std::size_t from, std::size_t pixel, double distance)
  {
    if (numbers[pixel] != None)
    {
      this->Pairs.push_back({ from, numbers[pixel] });
      this->Distances.push_back(distance);
    }
  };
  for (std::size_t index = 0; index < this->Pixels.size(); ++index)
  {
    const std::size_t pixel = this->Pixels[index];
    if ((pixel + 1) % grid.Columns != 0)
    {
      add(index, pixel + 1, grid.ColumnSpacingMm());
    }
    if (pixel + grid.Columns < numbers.size())
    {
      add(index, pixel + grid.Columns, grid.RowSpacingMm());
    }
  }
}

std::size_t PictureFeatures::Size() const
{
  return this->Kind == PictureComparison::Gradient ? this->Pairs.size() : this->Pixels.size();
}

std::vector<std::size_t> PictureFeatures::Places() const
{
  std::vector<std::size_t> places(this->Size());
  for (std::size_t index = 0; index < places.size(); ++index)
  {
    places[index] = this->Kind == PictureComparison::Gradient ? this->Pairs[index][0] : index;
  }
  return places;
}

std::vector<double> PictureFeatures::Differences(const std::vector<double>& values) const
{
  std::vector<double> found;
  found.reserve(this->Pairs.size());
  for (std::size_t pair = 0; pair < this->Pairs.size(); ++pair)
  {
    found.push_back(
      (values[this->Pairs[pair][1]] - values[this->Pairs[pair][0]]) / this->Distances[pair]);
  }
  return found;
}

double PictureFeatures::MeanOver(std::size_t window, const std::vector<double>& values) const
{
  double sum = 0;
  for (std::size_t index = this->First[window]; index < this->First[window + 1]; ++index)
  {
    sum += values[this->Members[index]];
  }
  return sum / static_cast<double>(this->First[window + 1] - this->First[window]);
}

PictureFeatures::Found PictureFeatures::Of(const std::vector<float>& image) const
{
  Found found{ {}, ZScores(image, this->Pixels), {}, {} };
  const std::vector<double>& scores = found.Whole.Scores;
  switch (this->Kind)
  {
    case PictureComparison::Global:
      found.Values = scores;
      break;
    case PictureComparison::Gradient:
      found.Values = this->Differences(scores);
      break;
    case PictureComparison::Local:
    {
      // Windows take the scores of the whole picture: their own scale and offset cancel in any
      // case, and the least deviation needs no unit.
      std::vector<double> squares(scores.size());
      std::transform(scores.begin(), scores.end(), squares.begin(),
        [](double score) { return score * score; });
      for (std::size_t window = 0; window < scores.size(); ++window)
      {
        const double mean = this->MeanOver(window, scores);
        const double variance = std::max(0.0, this->MeanOver(window, squares) - mean * mean) +
          LeastDeviation * LeastDeviation;
        found.Means.push_back(mean);
        found.Deviations.push_back(std::sqrt(variance));
        found.Values.push_back((scores[window] - mean) / found.Deviations.back());
      }
      break;
    }
  }
  return found;
}

std::vector<double> PictureFeatures::Differentiate(const Found& at,
  std::vector<double> derivatives) const
{
  at.Whole.Differentiate(derivatives);
  switch (this->Kind)
  {
    case PictureComparison::Global:
      return derivatives;
    case PictureComparison::Gradient:
      return this->Differences(derivatives);
    default:
      break;
  }
  std::vector<double> rates;
  // d deviation = mean((score - mean) d score) / deviation.
  const std::vector<double>& scores = at.Whole.Scores;
  std::vector<double> products(scores.size());
  std::transform(scores.begin(), scores.end(), derivatives.begin(), products.begin(),
    [](double score, double rate) { return score * rate; });
  for (std::size_t window = 0; window < scores.size(); ++window)
  {
    const double mean = this->MeanOver(window, derivatives);
    const double deviation = at.Deviations[window];
    const double spread = (this->MeanOver(window, products) - at.Means[window] * mean) / deviation;
    rates.push_back((derivatives[window] - mean - at.Values[window] * spread) / deviation);
  }
  return rates;
}
}
