// SPDX-License-Identifier: Apache-2.0
#include "Private/ValidateRegistration.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/Registration.h"

#include <algorithm>
#include <string>

namespace mammoray
{
namespace
{
void ValidateParameters(const std::vector<RegistrationParameter>& parameters)
{
  if (parameters.size() != ParameterCount)
  {
    throw InputError("registration: expected " + std::to_string(ParameterCount) +
      " parameters, found " + std::to_string(parameters.size()));
  }
  for (const RegistrationParameter& parameter : parameters)
  {
    if (!(parameter.Lower <= parameter.Start && parameter.Start <= parameter.Upper) ||
      !(parameter.Scale > 0))
    {
      throw InputError("registration: parameter " + parameter.Name +
        ": expected lower <= start <= "
        "upper and a positive scale, found " +
        std::to_string(parameter.Lower) + ", " + std::to_string(parameter.Start) + ", " +
        std::to_string(parameter.Upper) + ", " + std::to_string(parameter.Scale));
    }
  }
}

void ValidateBeginning(const View& view)
{
  if (view.From.size() != ParameterCount)
  {
    throw InputError("registration: expected " + std::to_string(ParameterCount) +
      " values to begin at, found " + std::to_string(view.From.size()));
  }
  for (int index = 0; index < ParameterCount; ++index)
  {
    const RegistrationParameter& parameter = view.Parameters[index];
    if (!parameter.Fixed &&
      !(parameter.Lower <= view.From[index] && view.From[index] <= parameter.Upper))
    {
      throw InputError("registration: parameter " + parameter.Name +
        ": expected a beginning from " + std::to_string(parameter.Lower) + " to " +
        std::to_string(parameter.Upper) + ", found " + std::to_string(view.From[index]));
    }
  }
}

void ValidateLevels(const std::vector<RegistrationTarget>& levels,
  const RegistrationOptions& options)
{
  if (levels.size() != options.PixelSizesMm.size())
  {
    throw InputError("registration: expected a target for each of " +
      std::to_string(options.PixelSizesMm.size()) + " pixel sizes (MakeLevels), found " +
      std::to_string(levels.size()));
  }
  std::for_each(levels.begin(), levels.end(), ValidateTarget);
}

void ValidateView(const View& view, const View& first, const RegistrationProblem& problem)
{
  ValidateParameters(view.Parameters);
  if (!view.Parameters[StiffnessParameter].Fixed && !problem.Model->Body().HasGland())
  {
    throw InputError("registration: expected a material whose stiffness is to be found, such as "
                     "gland, found none");
  }
  if (!view.From.empty())
  {
    ValidateBeginning(view);
  }
  ValidateTarget(view.Target);
  ValidateLevels(view.Levels, problem.Options);
  for (const ViewProjection& projection : view.Projections)
  {
    if (!(projection.FocalSpotMm[2] > 0))
    {
      throw InputError(
        "registration: expected the focal spot of each projection above the receptor");
    }
    ValidateLevels(projection.Levels, problem.Options);
  }
  for (int index = 0; index < ParameterCount; ++index)
  {
    if (IsShared(index) &&
      (view.Parameters[index].Fixed != first.Parameters[index].Fixed ||
        view.Parameters[index].Start != first.Parameters[index].Start))
    {
      throw InputError("registration: parameter " + view.Parameters[index].Name +
        ": expected the same start of all mammograms, and free in all or none");
    }
  }
  if (view.From.empty() != first.From.empty())
  {
    throw InputError("registration: expected a beginning for each mammogram or for none");
  }
}
}

void ValidateProblem(const RegistrationProblem& problem)
{
  if (problem.Views.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  if (!problem.Model || !problem.Model->HasXRays())
  {
    throw InputError("registration: expected a model with a projector and a beam, found none");
  }
  const RegistrationOptions& options = problem.Options;
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10 ||
    !(options.WindowMm > 0))
  {
    throw InputError("registration: expected at least one pixel size, one sample, ten outline "
                     "directions and a positive window");
  }
  for (const View& view : problem.Views)
  {
    ValidateView(view, problem.Views.front(), problem);
  }
}
}
