// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/AntiscatterGrid.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
AntiscatterGridOptions AntiscatterGridOptions::OfLead(const std::array<double, 3>& numbers,
  const std::string& interspace)
{
  AntiscatterGridOptions options;
  options.Ratio = numbers[0];
  options.LinesPerMm = 0.1 * numbers[1];
  options.SeptumMm = 1e-3 * numbers[2];
  if (interspace == "air")
  {
    options.Interspace = "Air, Dry (near sea level)";
    options.InterspaceDensityGPerCm3 = 0.001205;
  }
  else if (interspace == "aluminium")
  {
    options.Interspace = "Al";
    options.InterspaceDensityGPerCm3 = 2.699;
  }
  else if (interspace != "fibre")
  {
    throw InputError(
      "grid: expected fibre, air or aluminium between its septa, found '" + interspace + "'");
  }
  return options;
}

AntiscatterGrid::AntiscatterGrid(const AntiscatterGridOptions& options)
  : Options(options)
  , Septa(options.Septa, options.SeptaDensityGPerCm3)
  , Interspace(options.Interspace, options.InterspaceDensityGPerCm3)
{
  RequireBetween("grid", "a ratio", options.Ratio, 1, 30);
  RequireBetween("grid", "lines per mm", options.LinesPerMm, 0.5, 20);
  RequireBetween("grid", "a septum (mm)", options.SeptumMm, 1e-3, 0.95 / options.LinesPerMm);
  this->Gap = 1 / options.LinesPerMm - options.SeptumMm;
  this->Height = options.Ratio * this->Gap;
}

double AntiscatterGrid::Transmission(double energyKeV, double columnSlope, double rowSlope) const
{
  const double septum = this->Options.SeptumMm;
  const double period = septum + this->Gap;
  const double inSeptum = this->Septa.At(energyKeV).Total();
  const double between = this->Interspace.At(energyKeV).Total();
  const double way = this->Height * std::sqrt(1 + columnSlope * columnSlope + rowSlope * rowSlope);
  const double across =
    this->Height * std::abs(this->Options.AlongChestWall ? columnSlope : rowSlope);
  if (across < 1e-9 * period)
  {
    return (this->Gap * std::exp(-between * way) + septum * std::exp(-inSeptum * way)) / period;
  }
  // `across` covers whole periods and a rest; of the rest, what lies over septa changes with the
  // place between `least` and `most`, by ramps of slope 1 with flat parts between.
  const double whole = std::floor(across / period);
  const double rest = across - whole * period;
  const double most = std::min(septum, rest);
  const double least = std::max(rest - this->Gap, 0.0);
  const double slant = way / across;
  const auto passed = [&](double overSeptum)
  {
    const double lead = whole * septum + overSeptum;
    return std::exp(-slant * (inSeptum * lead + between * (across - lead)));
  };
  const double rate = slant * (inSeptum - between);
  const double ramp = std::abs(rate) * (most - least) > 1e-8 ? (passed(least) - passed(most)) / rate
                                                             : (most - least) * passed(least);
  return (std::abs(septum - rest) * passed(most) + std::abs(this->Gap - rest) * passed(least) +
           2 * ramp) /
    period;
}

double AntiscatterGrid::PrimaryTransmission(double energyKeV) const
{
  return this->Transmission(energyKeV, 0, 0);
}

double AntiscatterGrid::TransmissionAt(double energyKeV, double angle) const
{
  constexpr int Sides = 64;
  const double slope = std::tan(angle);
  double sum = 0;
  // A quarter of the circle tells of all.
  for (int side = 0; side < Sides; ++side)
  {
    const double azimuth = 0.5 * std::numbers::pi * (side + 0.5) / Sides;
    sum += this->Transmission(energyKeV, slope * std::cos(azimuth), slope * std::sin(azimuth));
  }
  return sum / Sides;
}
}
