// SPDX-License-Identifier: Apache-2.0
#include "Private/ValidateRegistration.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <string>

namespace mammoray
{
void ValidateMammograms(const std::vector<JointMammogram>& mammograms,
  const RegistrationOptions& options)
{
  if (mammograms.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  for (const JointMammogram& mammogram : mammograms)
  {
    if (!mammogram.Model || !mammogram.Target)
    {
      throw InputError("registration: expected a model and a target, found one missing");
    }
    RegistrationOptions own = options;
    own.Parameters = mammogram.Parameters;
    own.From = mammogram.From;
    ValidateRegistration(*mammogram.Model, own);
    ValidateTarget(*mammogram.Target);
    for (const ProjectionTarget& other : mammogram.Others)
    {
      if (!other.Target || !(other.FocalSpotMm[2] > 0))
      {
        throw InputError("registration: expected a target and a focal spot above the receptor of "
                         "each projection, found one missing");
      }
      ValidateTarget(*other.Target);
    }
    for (int index = 0; index < ParameterCount; ++index)
    {
      if (IsShared(index) &&
        (mammogram.Parameters[index].Fixed != mammograms.front().Parameters[index].Fixed ||
          mammogram.Parameters[index].Start != mammograms.front().Parameters[index].Start))
      {
        throw InputError("registration: parameter " + mammogram.Parameters[index].Name +
          ": expected the same start of all mammograms, and free in all or none");
      }
    }
    if (mammogram.From.empty() != mammograms.front().From.empty())
    {
      throw InputError("registration: expected a beginning for each mammogram or for none");
    }
  }
}

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

void ValidateBeginning(const RegistrationOptions& options)
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
}

void ValidateRegistration(const BreastModel& model, const RegistrationOptions& options)
{
  if (!model.HasXRays())
  {
    throw InputError("registration: expected a model with a projector and a beam, found none");
  }
  ValidateParameters(options.Parameters);
  if (!options.Parameters[StiffnessParameter].Fixed && !model.Body().HasGland())
  {
    throw InputError("registration: expected a material whose stiffness is to be found, such as "
                     "gland, found none");
  }
  if (!options.From.empty())
  {
    ValidateBeginning(options);
  }
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10 ||
    !(options.DifferenceStep > 0) || !(options.WindowMm > 0))
  {
    throw InputError("registration: expected at least one pixel size, one sample, ten outline "
                     "directions, a positive window and a positive step of differences");
  }
}
}
