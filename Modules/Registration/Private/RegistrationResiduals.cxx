// SPDX-License-Identifier: Apache-2.0
#include "Private/RegistrationResiduals.h"

#include "Private/PictureResiduals.h"
#include "mammoray/Foundation/Error.h"

#include <cmath>
#include <limits>
#include <utility>

namespace mammoray
{
RegistrationResiduals::RegistrationResiduals(const RegistrationTarget& target,
  std::vector<RegistrationParameter> parameters, const RegistrationOptions& options)
  : RegistrationResiduals({ { &target, std::nullopt } }, std::move(parameters), options)
{
}

RegistrationResiduals::RegistrationResiduals(std::vector<ComparedProjection> projections,
  std::vector<RegistrationParameter> parameters, const RegistrationOptions& options)
  : Projections(std::move(projections))
  , Parameters(std::move(parameters))
  , RobustWidth(options.RobustWidth)
{
  const double share = 1 / static_cast<double>(this->Projections.size());
  for (const ComparedProjection& projection : this->Projections)
  {
    this->Compared.push_back(
      std::make_shared<PictureResiduals>(*projection.Target, options, share));
  }
}

std::size_t RegistrationResiduals::NumberOfResiduals() const
{
  std::size_t count = this->NumberOfPriors();
  for (const auto& picture : this->Compared)
  {
    count += picture->NumberOfResiduals();
  }
  return count;
}

std::vector<double> RegistrationResiduals::RobustWidths() const
{
  std::vector<double> widths;
  for (const auto& picture : this->Compared)
  {
    // Residuals are times the root of their share: the same ones are beyond the width.
    widths.insert(widths.end(), picture->NumberOfResiduals(),
      std::sqrt(picture->Share()) * this->RobustWidth);
  }
  widths.insert(widths.end(), this->NumberOfPriors(), std::numeric_limits<double>::infinity());
  return widths;
}

PosedBreast& RegistrationResiduals::Seen(PosedBreast& breast, std::size_t projection) const
{
  const std::optional<Vector3>& spot = this->Projections[projection].FocalSpotMm;
  return spot ? breast.SeenFrom(*spot) : breast;
}

std::vector<double> RegistrationResiduals::Weigh(const std::vector<double>& factors)
{
  std::vector<double> changes;
  changes.reserve(this->NumberOfResiduals());
  for (std::size_t number = 0; number < this->Compared.size(); ++number)
  {
    PictureResiduals& picture = *this->Compared[number];
    const double outline = factors[2 * number];
    const double intensity = factors[2 * number + 1];
    changes.insert(changes.end(), picture.NumberOfOutlineResiduals(),
      outline / picture.OutlineFactor());
    changes.insert(changes.end(), picture.NumberOfIntensityResiduals(),
      intensity / picture.IntensityFactor());
    picture.Weigh(outline, intensity);
  }
  changes.insert(changes.end(), this->NumberOfPriors(), 1.0);
  return changes;
}

std::vector<double> RegistrationResiduals::Evaluate(PosedBreast& breast) const
{
  std::vector<double> residuals;
  this->Append(breast, residuals);
  return residuals;
}

void RegistrationResiduals::Append(PosedBreast& breast, std::vector<double>& residuals) const
{
  residuals.reserve(residuals.size() + this->NumberOfResiduals());
  for (std::size_t number = 0; number < this->Compared.size(); ++number)
  {
    this->Compared[number]->Append(this->Seen(breast, number), residuals);
  }
  const std::vector<double> values = ValuesOf(breast.Pose());
  for (std::size_t index = 0; index < this->Parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = this->Parameters[index];
    residuals.push_back(parameter.PriorSigma > 0
        ? PriorWeight * (values[index] - parameter.Start) / parameter.PriorSigma
        : 0.0);
  }
}

RegistrationCosts RegistrationResiduals::Costs(std::span<const double> residuals) const
{
  RegistrationCosts costs;
  auto residual = residuals.begin();
  const auto add = [&](double& cost, std::size_t count, double width)
  {
    for (const auto end = residual + static_cast<std::ptrdiff_t>(count); residual != end;
         ++residual)
    {
      const double r = std::abs(*residual);
      cost += r <= width ? 0.5 * r * r : width * r - 0.5 * width * width;
    }
  };
  for (const auto& picture : this->Compared)
  {
    const double width = std::sqrt(picture->Share()) * this->RobustWidth;
    add(costs.Outline, picture->NumberOfOutlineResiduals(), width);
    add(costs.Intensity, picture->NumberOfIntensityResiduals(), width);
  }
  add(costs.Prior, this->NumberOfPriors(), std::numeric_limits<double>::infinity());
  return costs;
}

RegistrationResiduals::Jacobian RegistrationResiduals::Differentiate(PosedBreast& breast,
  const std::vector<int>& wanted) const
{
  Jacobian jacobian;
  jacobian.Columns.resize(this->Parameters.size());
  if (wanted.empty())
  {
    return jacobian;
  }
  std::vector<std::vector<double>*> columns;
  for (const int parameter : wanted)
  {
    columns.push_back(&jacobian.Columns[parameter]);
    columns.back()->reserve(this->NumberOfResiduals());
  }
  // The unit goes on standing where it stands: of all projections the same.
  const VectorFields velocities = breast.Velocities(wanted);
  for (std::size_t number = 0; number < this->Compared.size(); ++number)
  {
    this->Compared[number]->AppendRates(this->Seen(breast, number), velocities, columns);
  }
  for (const int parameter : wanted)
  {
    for (std::size_t index = 0; index < this->Parameters.size(); ++index)
    {
      const double sigma = this->Parameters[index].PriorSigma;
      jacobian.Columns[parameter].push_back(
        static_cast<int>(index) == parameter && sigma > 0 ? PriorWeight / sigma : 0.0);
    }
  }
  return jacobian;
}
}
