// SPDX-License-Identifier: Apache-2.0
#include "Private/ImitatedMammogram.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
RegistrationTarget ImitatedDetector(double pixelMm, double up, const DetectorField& field)
{
  // The left breast's, whose up is +x, has its chest wall at the left.
  const double inward = up;
  RegistrationTarget grid;
  grid.Columns = static_cast<int>(field.DepthMm / pixelMm);
  grid.Rows = static_cast<int>(field.WidthMm / pixelMm);
  grid.Origin = { up * 0.5 * (grid.Rows - 1) * pixelMm,
    (inward > 0 ? 0.5 : grid.Columns - 0.5) * pixelMm };
  grid.ColumnStep = { 0, inward * pixelMm };
  grid.RowStep = { -up * pixelMm, 0 };
  const auto pixels = static_cast<std::size_t>(grid.Columns) * static_cast<std::size_t>(grid.Rows);
  // The middle of the chest-wall edge, around which Synthesize looks for the silhouette.
  grid.BreastMask.assign(pixels, 0);
  grid.BreastMask[pixels / 2] = 1;
  grid.LogAttenuation.assign(pixels, 0);
  grid.SignedDistanceMm.assign(pixels, 0);
  return grid;
}

bool IsCutAtFront(const std::vector<float>& logAttenuation, const RegistrationTarget& grid)
{
  const auto columns = static_cast<std::size_t>(grid.Columns);
  const std::size_t front = grid.ColumnStep[1] > 0 ? columns - 1 : 0;
  for (std::size_t pixel = front; pixel < logAttenuation.size(); pixel += columns)
  {
    if (logAttenuation[pixel] > 0)
    {
      return true;
    }
  }
  return false;
}

Mammogram Develop(Mammogram header, const std::vector<float>& logAttenuation,
  const RegistrationTarget& grid, double noise, Draws& draws)
{
  std::normal_distribution<double> normal(0, noise);
  std::vector<double> seen;
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (const float attenuation : logAttenuation)
  {
    const double intensity = std::exp(-attenuation) * (1 + normal(draws.Bits()));
    seen.push_back(-std::log(std::max(intensity, 1e-6)));
    if (attenuation > 0)
    {
      sum += attenuation;
      squares += attenuation * attenuation;
      count += 1;
    }
  }
  const double centre = sum / count;
  const double deviation = std::sqrt(std::max(squares / count - centre * centre, 1e-12));
  // A window that shows the whole breast.
  const double width = 8 * deviation;
  header.Columns = grid.Columns;
  header.Rows = grid.Rows;
  for (const double attenuation : seen)
  {
    header.Pixels.push_back(
      static_cast<float>(std::round(4095 / (1 + std::exp(-4 * (attenuation - centre) / width)))));
  }
  header.BitsStored = 12;
  header.IntensitySign = -1;
  header.ColumnSpacingMm = std::hypot(grid.ColumnStep[0], grid.ColumnStep[1]);
  header.RowSpacingMm = header.ColumnSpacingMm;
  return header;
}
}
