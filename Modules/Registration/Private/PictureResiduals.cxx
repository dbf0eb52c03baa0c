// SPDX-License-Identifier: Apache-2.0
#include "Private/PictureResiduals.h"

#include "Private/PictureFeatures.h"
#include "Private/Silhouette.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace mammoray
{
PictureResiduals::PictureResiduals(const RegistrationTarget& target,
  const RegistrationOptions& options, double share)
  : Target(target)
  , Options(options)
  , ShareOfSquares(share)
{
  this->ChooseOutlineSamples();
  this->ChoosePixels();
}

void PictureResiduals::ChooseOutlineSamples()
{
  this->Centre = ChestWallCentre(this->Target);
  const std::vector<ReceptorPoint> directions =
    HalfCircleDirections(this->Options.OutlineDirections);
  const auto outline = OutlineAlong(this->Target, this->Centre, directions);
  double length = 0;
  std::optional<ReceptorPoint> previous;
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    if (const std::optional<ReceptorPoint>& end = outline[index])
    {
      this->Directions.push_back(directions[index]);
      if (previous)
      {
        length += std::hypot((*end)[0] - (*previous)[0], (*end)[1] - (*previous)[1]);
      }
      previous = end;
    }
  }
  if (this->Directions.size() < 5)
  {
    throw InputError("mammogram: the breast's outline lies outside the image in all but " +
      std::to_string(this->Directions.size()) + " of " +
      std::to_string(this->Options.OutlineDirections) + " directions");
  }
  const double spacing = length / this->Directions.size();
  this->OutlineWeight =
    std::sqrt(this->ShareOfSquares * std::min(1.0, spacing / this->Options.CorrelationLengthMm)) /
    this->Options.OutlineSigmaMm;
}

void PictureResiduals::ChoosePixels()
{
  for (std::size_t pixel = 0; pixel < this->Target.BreastMask.size(); ++pixel)
  {
    if (this->Target.BreastMask[pixel] != 0 && !IsExcluded(this->Target, pixel) &&
      this->Target.SignedDistanceMm[pixel] < -this->Options.IntensityMarginMm)
    {
      this->Pixels.push_back(pixel);
    }
  }
  if (this->Pixels.size() < FewestComparedPixels)
  {
    throw InputError("mammogram: only " + std::to_string(this->Pixels.size()) +
      " pixels of the compared size lie inside the breast, expected at least " +
      std::to_string(FewestComparedPixels));
  }
  this->Features = std::make_shared<const PictureFeatures>(this->Options.Comparison,
    this->Target.Grid, this->Pixels, this->Options.WindowMm);
  this->TargetFeatures = this->Features->Of(this->Target.LogAttenuation).Values;
  double square = 0;
  for (const double feature : this->TargetFeatures)
  {
    square += feature * feature / static_cast<double>(this->TargetFeatures.size());
  }
  this->FeatureRms = std::sqrt(std::max(square, 1e-12));
  const double alike = this->Options.CorrelationLengthMm * this->Options.CorrelationLengthMm;
  this->IntensityWeight =
    std::sqrt(this->ShareOfSquares * std::min(1.0, this->AreaPerFeature() / alike)) /
    (this->Options.IntensitySigma * this->FeatureRms);
}

double PictureResiduals::AreaPerFeature() const
{
  return this->Target.Grid.PixelAreaMm2() * static_cast<double>(this->Pixels.size()) /
    static_cast<double>(this->TargetFeatures.size());
}

ReceptorPoint PictureResiduals::OnOutline(std::size_t direction, double radius) const
{
  return { this->Centre[0] + radius * this->Directions[direction][0],
    this->Centre[1] + radius * this->Directions[direction][1] };
}

void PictureResiduals::Append(PosedBreast& seen, std::vector<double>& residuals) const
{
  residuals.reserve(residuals.size() + this->NumberOfResiduals());
  const std::vector<double>& radii = seen.SilhouetteFrom(this->Centre, this->Directions).Radii;
  for (std::size_t index = 0; index < radii.size(); ++index)
  {
    residuals.push_back(
      this->OutlineWeight * SignedDistanceAt(this->Target, this->OnOutline(index, radii[index])));
  }
  const PosedBreast::Picture& picture = seen.PictureOn(this->Target.Grid, this->Options.Samples);
  const std::vector<double> features = this->Features->Of(picture.LogAttenuation).Values;
  for (std::size_t index = 0; index < features.size(); ++index)
  {
    residuals.push_back(this->IntensityWeight * (features[index] - this->TargetFeatures[index]));
  }
}

std::vector<ReceptorPoint> PictureResiduals::OutlinePlaces(PosedBreast& seen) const
{
  const std::vector<double>& radii = seen.SilhouetteFrom(this->Centre, this->Directions).Radii;
  std::vector<ReceptorPoint> places;
  places.reserve(radii.size());
  for (std::size_t index = 0; index < radii.size(); ++index)
  {
    places.push_back(this->OnOutline(index, radii[index]));
  }
  return places;
}

std::vector<ReceptorPoint> PictureResiduals::IntensityPlaces() const
{
  std::vector<ReceptorPoint> places;
  places.reserve(this->TargetFeatures.size());
  for (const std::size_t index : this->Features->Places())
  {
    const auto columns = static_cast<std::size_t>(this->Target.Grid.Columns);
    const std::size_t pixel = this->Pixels[index];
    const std::size_t row = pixel / columns;
    places.push_back(this->Target.Grid.PositionOf(static_cast<double>(pixel - row * columns),
      static_cast<double>(row)));
  }
  return places;
}

void PictureResiduals::AddOutlineRates(PosedBreast& seen, std::span<const double> velocities,
  std::vector<double>& column) const
{
  const PosedBreast::Silhouette& silhouette = seen.SilhouetteFrom(this->Centre, this->Directions);
  const std::vector<double> rates = SilhouetteDerivatives(seen.SurfaceOnReceptor(),
    ReceptorVelocities(seen.SurfacePoints(), velocities, seen.Placed(), seen.Placement().Unit),
    seen.Model().SurfaceEdges(), this->Centre, this->Directions, silhouette.Crossed);
  for (std::size_t index = 0; index < rates.size(); ++index)
  {
    const ReceptorPoint gradient =
      SignedDistanceGradient(this->Target, this->OnOutline(index, silhouette.Radii[index]));
    column.push_back(this->OutlineWeight * rates[index] *
      (gradient[0] * this->Directions[index][0] + gradient[1] * this->Directions[index][1]));
  }
}

void PictureResiduals::AppendRates(PosedBreast& seen, const VectorFields& velocities,
  const std::vector<std::vector<double>*>& columns) const
{
  const std::vector<std::vector<double>> derivatives =
    seen.DifferentiatePicture(this->Target.Grid, this->Options.Samples, velocities);
  const PosedBreast::Picture& picture = seen.PictureOn(this->Target.Grid, this->Options.Samples);
  const PictureFeatures::Found features = this->Features->Of(picture.LogAttenuation);
  for (std::size_t field = 0; field < columns.size(); ++field)
  {
    std::vector<double>& column = *columns[field];
    column.reserve(column.size() + this->NumberOfResiduals());
    this->AddOutlineRates(seen, velocities[field], column);

    std::vector<double> rates;
    rates.reserve(this->Pixels.size());
    for (const std::size_t pixel : this->Pixels)
    {
      rates.push_back(derivatives[field][pixel]);
    }
    for (const double rate : this->Features->Differentiate(features, std::move(rates)))
    {
      column.push_back(this->IntensityWeight * rate);
    }
  }
}
}
