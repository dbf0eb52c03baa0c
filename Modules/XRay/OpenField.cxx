// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/OpenField.h"

#include "Private/ProjectionChecks.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/DetectorPlane.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

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
      this->Mu.push_back(target.MuAt(energy, target.NominalDensityGPerCm3));
      this->Whole += this->Weights.back();
    }
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
  const std::size_t pixelCount = static_cast<std::size_t>(detector.Columns) * detector.Rows;
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
  std::optional<TargetAbsorption> absorption;
  if (hasHeel)
  {
    absorption.emplace(options.Heel, spectrum, response);
  }
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    const auto columns = static_cast<std::size_t>(detector.Columns);
    const std::size_t row = pixel / columns;
    const Vector3 way = offset + static_cast<double>(pixel % columns) * detector.ColumnStep +
      static_cast<double>(row) * detector.RowStep;
    const double length = Norm(way);
    double signal = options.InverseSquare ? std::pow(plane.HeightMm / length, 3) : 1.0;
    if (hasHeel)
    {
      const double leaving = Dot(way, surface) / length;
      signal *= leaving > 0 ? absorption->Signal(options.Heel.DepthMm * std::cos(angle) *
                                (1 / leaving - 1 / std::sin(angle)))
                            : 0.0;
    }
    field[pixel] = static_cast<float>(signal);
  }
  if (*std::max_element(field.begin(), field.end()) <= 0)
  {
    throw InputError("heel effect: expected rays that leave the target, found that all pixels lie "
                     "below its surface");
  }
  return field;
}
}
