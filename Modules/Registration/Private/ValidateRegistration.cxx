// SPDX-License-Identifier: Apache-2.0
#include "Private/ValidateRegistration.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/TargetImage.h"

#include <string>

namespace mammoray
{
void ValidateViews(const std::vector<RegistrationView>& views, const RegistrationOptions& options)
{
  if (views.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  for (const RegistrationView& view : views)
  {
    if (!view.Model || !view.Target)
    {
      throw InputError("registration: expected a model and a target, found one missing");
    }
    RegistrationOptions own = options;
    own.Parameters = view.Parameters;
    own.From = view.From;
    ValidateRegistration(*view.Model, own);
    ValidateTarget(*view.Target);
    for (int index = 0; index < ParameterCount; ++index)
    {
      if (IsShared(index) &&
        (view.Parameters[index].Fixed != views.front().Parameters[index].Fixed ||
          view.Parameters[index].Start != views.front().Parameters[index].Start))
      {
        throw InputError("registration: parameter " + view.Parameters[index].Name +
          ": expected the same start in all views, and free in all or none");
      }
    }
    if (view.From.empty() != views.front().From.empty())
    {
      throw InputError("registration: expected a beginning for each view or for none");
    }
  }
}

void ValidateRegistration(const RegistrationModel& model, const RegistrationOptions& options)
{
  if (!model.Simulation || !model.Surface || !model.SurfaceEmbedding || !model.Projector ||
    !model.XRays)
  {
    throw InputError("registration: expected a simulation, a surface with its embedding, a "
                     "projector and a beam, found one missing");
  }
  if (!model.Scout != !model.ScoutEmbedding)
  {
    throw InputError("registration: expected the surface's embedding in the cheap simulation, and "
                     "only with one");
  }
  if (options.Parameters.size() != ParameterCount)
  {
    throw InputError("registration: expected " + std::to_string(ParameterCount) +
      " parameters, found " + std::to_string(options.Parameters.size()));
  }
  for (const RegistrationParameter& parameter : options.Parameters)
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
  if (!options.Parameters[StiffnessParameter].Fixed && model.ScaledMaterials.empty())
  {
    throw InputError("registration: expected a material whose stiffness is to be found, such as "
                     "gland, found none");
  }
  for (const int index : model.ScaledMaterials)
  {
    if (index < 0 || static_cast<std::size_t>(index) >= model.Elastic.size())
    {
      throw InputError("registration: expected a material of the " +
        std::to_string(model.Elastic.size()) + " known to scale, found number " +
        std::to_string(index));
    }
  }
  if (!options.From.empty())
  {
    if (options.From.size() != ParameterCount)
    {
      throw InputError("registration: expected " + std::to_string(ParameterCount) +
        " values to begin at, found " + std::to_string(options.From.size()));
    }
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = options.Parameters[index];
      if (!parameter.Fixed &&
        !(parameter.Lower <= options.From[index] && options.From[index] <= parameter.Upper))
      {
        throw InputError("registration: parameter " + parameter.Name +
          ": expected a beginning from " + std::to_string(parameter.Lower) + " to " +
          std::to_string(parameter.Upper) + ", found " + std::to_string(options.From[index]));
      }
    }
  }
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10 ||
    !(options.DifferenceStep > 0) || !(options.WindowMm > 0))
  {
    throw InputError("registration: expected at least one pixel size, one sample, ten outline "
                     "directions, a positive window and a positive step of differences");
  }
}
}
