// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Exposure.h"

#include "Private/ProjectionChecks.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/DetectorPlane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mammoray
{
namespace
{
void CheckHeel(const HeelEffect& heel)
{
  const bool good = heel.TargetAngleDeg > 0 && heel.TargetAngleDeg < 90 && heel.DepthMm >= 0 &&
    std::isfinite(heel.DepthMm);
  if (!good)
  {
    throw InputError(
      "heel effect: expected a target angle between 0 and 90 degrees and a depth that is not "
      "negative, found " +
      NumberText(heel.TargetAngleDeg) + " degrees and " + NumberText(heel.DepthMm) + " mm");
  }
}

/// Signal behind a length of the target, relative to that on the central ray.
class TargetAbsorption
{
public:
  TargetAbsorption(const HeelEffect& heel, const Spectrum& spectrum,
    const DetectorResponse& response)
  {
    const AttenuationTable target = RequireComposition(heel.Target, "heel effect's target");
    for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
    {
      const double energy = spectrum.EnergiesKeV[bin];
      this->Weights.push_back(spectrum.Weights[bin] * response.Signal(energy));
      this->Mu.push_back(target.MuAt(energy, target.DensityOf(0)));
      this->Whole += this->Weights.back();
    }
  }
  /// Tabulates the signal from `least` on, so finely that straight lines between miss it by less
  /// than 1e-7: the second derivative is at most (largest mu)^2.
  void Tabulate(double least, double most)
  {
    constexpr double StepOverFreePath = 5e-4;
    constexpr double MostSteps = 20000;
    const double mu = *std::max_element(this->Mu.begin(), this->Mu.end());
    this->Least = least;
    this->PerStep = mu / StepOverFreePath;
    if (!std::isfinite(least))
    {
      return; // nothing leaves the target
    }
    const double steps = std::min(std::ceil((most - least) * this->PerStep), MostSteps);
    for (double step = 0; step <= steps + 1; ++step)
    {
      this->Table.push_back(this->Signal(least + step / this->PerStep));
    }
  }
  /// The same from the table; beyond it summed up.
  double Tabulated(double length) const
  {
    const double place = (length - this->Least) * this->PerStep;
    if (!(place + 1 < static_cast<double>(this->Table.size())))
    {
      return this->Signal(length);
    }
    const auto before = static_cast<std::size_t>(place);
    const double beyond = place - static_cast<double>(before);
    return (1 - beyond) * this->Table[before] + beyond * this->Table[before + 1];
  }
  /// `length`: mm more than on the central ray, whose absorption is in the spectrum.
  double Signal(double length) const
  {
    double sum = 0;
    for (std::size_t bin = 0; bin < this->Mu.size(); ++bin)
    {
      sum += this->Weights[bin] * std::exp(-this->Mu[bin] * length);
    }
    return sum / this->Whole;
  }

private:
  std::vector<double> Weights;
  std::vector<double> Mu;
  double Whole = 0;
  double Least = 0;
  double PerStep = 0;
  std::vector<double> Table;
};
}

std::vector<float> OpenField(const XRaySource& source, const XRayDetector& detector,
  const Spectrum& spectrum, const DetectorResponse& response, const OpenFieldOptions& options)
{
  CheckGeometry(source, detector);
  spectrum.Validate();
  const bool hasHeel = options.Heel.TargetAngleDeg != 0;
  if (hasHeel)
  {
    CheckHeel(options.Heel);
  }
  const std::size_t pixelCount = detector.NumberOfPixels();
  std::vector<float> field(pixelCount, 1.0f);
  if (!hasHeel && !options.InverseSquare)
  {
    return field;
  }
  if (source.Type != XRaySource::Kind::Point)
  {
    throw InputError("open field: expected a point source, found a parallel beam");
  }
  const DetectorPlane plane(source, detector);
  const Vector3 offset = detector.Origin - source.Position;
  const Vector3 central = -1.0 * plane.Normal;
  const Vector3 toAnode = (1 / Norm(detector.ColumnStep)) * detector.ColumnStep;
  const double angle = options.Heel.TargetAngleDeg * std::numbers::pi / 180;
  const Vector3 surface = std::sin(angle) * central - std::cos(angle) * toAnode;
  // Way through the target beside that on the central ray, mm.
  std::vector<double> extra(hasHeel ? pixelCount : 0);
  ParallelFor(static_cast<std::size_t>(detector.Rows),
    [&](std::size_t row)
    {
      const auto columns = static_cast<std::size_t>(detector.Columns);
      for (std::size_t column = 0; column < columns; ++column)
      {
        const Vector3 way = offset + static_cast<double>(column) * detector.ColumnStep +
          static_cast<double>(row) * detector.RowStep;
        const double length = Norm(way);
        const double nearer = plane.HeightMm / length;
        field[row * columns + column] =
          options.InverseSquare ? static_cast<float>(nearer * nearer * nearer) : 1.0F;
        if (hasHeel)
        {
          const double leaving = Dot(way, surface) / length;
          extra[row * columns + column] = leaving > 0
            ? options.Heel.DepthMm * std::cos(angle) * (1 / leaving - 1 / std::sin(angle))
            : std::numeric_limits<double>::infinity();
        }
      }
    });
  if (hasHeel)
  {
    TargetAbsorption absorption(options.Heel, spectrum, response);
    const auto [least, most] = std::minmax_element(extra.begin(), extra.end());
    absorption.Tabulate(*least, *most);
    ParallelRanges(pixelCount, 16384,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t pixel = begin; pixel < end; ++pixel)
        {
          field[pixel] *= static_cast<float>(absorption.Tabulated(extra[pixel]));
        }
      });
  }
  if (*std::max_element(field.begin(), field.end()) <= 0)
  {
    throw InputError("heel effect: expected rays that leave the target, found that all pixels lie "
                     "below its surface");
  }
  return field;
}
}
