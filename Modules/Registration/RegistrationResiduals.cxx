// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationResiduals.h"

#include "Private/PictureFeatures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mammoray
{
PictureComparison ComparisonFromName(const std::string& name)
{
  if (name == "global")
  {
    return PictureComparison::Global;
  }
  if (name == "local")
  {
    return PictureComparison::Local;
  }
  if (name == "gradient")
  {
    return PictureComparison::Gradient;
  }
  throw InputError("comparison '" + name + "': expected global, local or gradient");
}

std::vector<RegistrationParameter> DefaultParameters(const BreastPose& start)
{
  std::vector<RegistrationParameter> parameters;
  for (const PoseParameter& parameter : PoseParameters)
  {
    const double at = start.*parameter.Value;
    parameters.push_back({ .Name = parameter.Name,
      .Unit = parameter.Unit,
      .Start = at,
      .Lower = parameter.Lower(at),
      .Upper = parameter.Upper(at),
      .Scale = parameter.Scale,
      .PriorSigma = parameter.PriorSigma,
      .Fixed = !parameter.Free });
  }
  return parameters;
}

RegistrationResiduals::RegistrationResiduals(const RegistrationTarget& target,
  const RegistrationOptions& options)
  : Target(target)
  , Options(options)
{
  this->ChooseOutlineSamples();
  this->ChoosePixels();
}

std::size_t RegistrationResiduals::NumberOfResiduals() const
{
  return this->Directions.size() + this->TargetFeatures.size() + this->Options.Parameters.size();
}

void RegistrationResiduals::ChooseOutlineSamples()
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
  this->OutlineWeight = std::sqrt(std::min(1.0, spacing / this->Options.CorrelationLengthMm)) /
    this->Options.OutlineSigmaMm;
}

void RegistrationResiduals::ChoosePixels()
{
  for (std::size_t pixel = 0; pixel < this->Target.BreastMask.size(); ++pixel)
  {
    if (this->Target.BreastMask[pixel] != 0 && !IsExcluded(this->Target, pixel) &&
      this->Target.SignedDistanceMm[pixel] < -this->Options.IntensityMarginMm)
    {
      this->Pixels.push_back(pixel);
    }
  }
  if (this->Pixels.size() < 10)
  {
    throw InputError("mammogram: only " + std::to_string(this->Pixels.size()) +
      " pixels of the compared size lie inside the breast, expected at least 10");
  }
  this->Features = std::make_shared<const PictureFeatures>(this->Options.Comparison, this->Target,
    this->Pixels, this->Options.WindowMm);
  this->TargetFeatures = this->Features->Of(this->Target.LogAttenuation).Values;
  double square = 0;
  for (const double feature : this->TargetFeatures)
  {
    square += feature * feature / static_cast<double>(this->TargetFeatures.size());
  }
  this->FeatureRms = std::sqrt(std::max(square, 1e-12));
  const double area = std::abs(this->Target.ColumnStep[0] * this->Target.RowStep[1] -
    this->Target.ColumnStep[1] * this->Target.RowStep[0]);
  const double alike = this->Options.CorrelationLengthMm * this->Options.CorrelationLengthMm;
  this->IntensityWeight = std::sqrt(std::min(1.0, this->PixelsPerFeature() * area / alike)) /
    (this->Options.IntensitySigma * this->FeatureRms);
}

double RegistrationResiduals::PixelsPerFeature() const
{
  return static_cast<double>(this->Pixels.size()) /
    static_cast<double>(this->TargetFeatures.size());
}

ReceptorPoint RegistrationResiduals::OnOutline(std::size_t direction, double radius) const
{
  return { this->Centre[0] + radius * this->Directions[direction][0],
    this->Centre[1] + radius * this->Directions[direction][1] };
}

std::vector<double> RegistrationResiduals::Evaluate(EvaluatedState& breast) const
{
  std::vector<double> residuals;
  residuals.reserve(this->NumberOfResiduals());
  const std::vector<double>& radii = breast.SilhouetteFrom(this->Centre, this->Directions).Radii;
  for (std::size_t index = 0; index < radii.size(); ++index)
  {
    residuals.push_back(
      this->OutlineWeight * SignedDistanceAt(this->Target, this->OnOutline(index, radii[index])));
  }

  const EvaluatedState::Picture& picture = breast.PictureOn(this->Target, this->Options.Samples);
  const std::vector<double> features = this->Features->Of(picture.LogAttenuation).Values;
  for (std::size_t index = 0; index < features.size(); ++index)
  {
    residuals.push_back(this->IntensityWeight * (features[index] - this->TargetFeatures[index]));
  }

  const std::vector<double> values = ValuesOf(breast.Pose());
  for (std::size_t index = 0; index < this->Options.Parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = this->Options.Parameters[index];
    residuals.push_back(
      parameter.PriorSigma > 0 ? (values[index] - parameter.Start) / parameter.PriorSigma : 0.0);
  }
  return residuals;
}

std::vector<ReceptorPoint> RegistrationResiduals::OutlinePlaces(EvaluatedState& breast) const
{
  const std::vector<double>& radii = breast.SilhouetteFrom(this->Centre, this->Directions).Radii;
  std::vector<ReceptorPoint> places;
  places.reserve(radii.size());
  for (std::size_t index = 0; index < radii.size(); ++index)
  {
    places.push_back(this->OnOutline(index, radii[index]));
  }
  return places;
}

std::vector<ReceptorPoint> RegistrationResiduals::IntensityPlaces() const
{
  std::vector<ReceptorPoint> places;
  places.reserve(this->TargetFeatures.size());
  for (const std::size_t index : this->Features->Places())
  {
    const auto columns = static_cast<std::size_t>(this->Target.Columns);
    const std::size_t pixel = this->Pixels[index];
    const std::size_t row = pixel / columns;
    places.push_back(PixelPosition(this->Target, static_cast<double>(pixel - row * columns),
      static_cast<double>(row)));
  }
  return places;
}

RegistrationCosts RegistrationResiduals::Costs(const std::vector<double>& residuals) const
{
  RegistrationCosts costs;
  const double width = this->Options.RobustWidth;
  const std::size_t pictures = this->Directions.size() + this->TargetFeatures.size();
  for (std::size_t index = 0; index < residuals.size(); ++index)
  {
    const double r = std::abs(residuals[index]);
    const double robust = r <= width ? 0.5 * r * r : width * r - 0.5 * width * width;
    if (index < this->Directions.size())
    {
      costs.Outline += robust;
    }
    else if (index < pictures)
    {
      costs.Intensity += robust;
    }
    else
    {
      costs.Prior += 0.5 * r * r;
    }
  }
  return costs;
}

void RegistrationResiduals::AddOutlineRates(EvaluatedState& breast, const double* velocities,
  std::vector<double>& column) const
{
  const EvaluatedState::Silhouette& silhouette =
    breast.SilhouetteFrom(this->Centre, this->Directions);
  const std::vector<double> rates = SilhouetteDerivatives(breast.SurfaceOnReceptor(),
    ReceptorVelocities(breast.SurfacePoints(), velocities, breast.Placed(),
      breast.Placement().Unit),
    breast.Model().SurfaceEdges(), this->Centre, this->Directions, silhouette.Crossed);
  for (std::size_t index = 0; index < rates.size(); ++index)
  {
    const ReceptorPoint gradient =
      SignedDistanceGradient(this->Target, this->OnOutline(index, silhouette.Radii[index]));
    column.push_back(this->OutlineWeight * rates[index] *
      (gradient[0] * this->Directions[index][0] + gradient[1] * this->Directions[index][1]));
  }
}

RegistrationResiduals::Jacobian RegistrationResiduals::Differentiate(EvaluatedState& breast,
  const std::vector<int>& wanted) const
{
  Jacobian jacobian;
  jacobian.Columns.resize(this->Options.Parameters.size());
  if (wanted.empty())
  {
    return jacobian;
  }
  const EvaluatedState::Derivatives derivatives =
    breast.Differentiate(this->Target, this->Options.Samples, wanted);
  const EvaluatedState::Picture& picture = breast.PictureOn(this->Target, this->Options.Samples);
  const PictureFeatures::Found features = this->Features->Of(picture.LogAttenuation);
  const int fields = static_cast<int>(wanted.size());
  for (int field = 0; field < fields; ++field)
  {
    std::vector<double>& column = jacobian.Columns[wanted[field]];
    column.reserve(this->NumberOfResiduals());
    this->AddOutlineRates(breast, &derivatives.Velocities[field * breast.SurfacePoints().size()],
      column);

    std::vector<double> rates;
    rates.reserve(this->Pixels.size());
    for (const std::size_t pixel : this->Pixels)
    {
      rates.push_back(derivatives.LogAttenuation[static_cast<std::size_t>(field)][pixel]);
    }
    for (const double rate : this->Features->Differentiate(features, std::move(rates)))
    {
      column.push_back(this->IntensityWeight * rate);
    }

    for (std::size_t index = 0; index < this->Options.Parameters.size(); ++index)
    {
      const double sigma = this->Options.Parameters[index].PriorSigma;
      column.push_back(static_cast<int>(index) == wanted[field] && sigma > 0 ? 1 / sigma : 0.0);
    }
  }
  return jacobian;
}
}
