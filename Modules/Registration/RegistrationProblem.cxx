// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationProblem.h"

#include "mammoray/Foundation/Error.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#endif

#include <algorithm>
#include <string>
#include <utility>

namespace mammoray
{
namespace
{
TetrahedralMesh MeshAnatomy([[maybe_unused]] const LabelVolume& labels,
  [[maybe_unused]] const std::vector<int>& thin, [[maybe_unused]] double cellSizeMm,
  [[maybe_unused]] const ProgressCallback& progress)
{
#ifdef MAMMORAY_HAS_MESHING
  MeshingOptions options = MeshingOptions::Anatomy(thin);
  options.CellSizeMm = cellSizeMm;
  return MeshMaterials(labels, options, progress).Mesh;
#else
  throw InputError("registration: this build has no Meshing module; expected an anatomy mesh and a "
                   "simulation mesh made elsewhere");
#endif
}

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

const char* NameOf(PictureComparison comparison)
{
  switch (comparison)
  {
    case PictureComparison::Local:
      return "local";
    case PictureComparison::Gradient:
      return "gradient";
    default:
      return "global";
  }
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

std::vector<RegistrationTarget> MakeLevels(const RegistrationTarget& target,
  const std::vector<double>& pixelSizesMm)
{
  std::vector<RegistrationTarget> levels;
  levels.reserve(pixelSizesMm.size());
  for (const double pixelSizeMm : pixelSizesMm)
  {
    levels.push_back(CoarsenTo(target, pixelSizeMm));
  }
  return levels;
}

RegistrationProblem MakeProblem(BreastInput input, const ProgressCallback& progress)
{
  if (!input.Labels && !input.Anatomy)
  {
    throw InputError("registration: expected labels or an anatomy mesh, found neither");
  }
  if (!input.XRays)
  {
    throw InputError("registration: expected a beam, found none");
  }
  RegistrationProblem problem;
  const std::vector<bool> fixed = input.Materials.Fixed();
  problem.Frame = input.Labels ? FindPoseFrame(*input.Labels, fixed, input.Axes)
                               : FindPoseFrame(*input.Anatomy, fixed, input.Axes);
  if (!input.Anatomy)
  {
    input.Anatomy = MeshAnatomy(*input.Labels, input.Materials.Thin(), input.AnatomyCellSizeMm,
      PartOf(progress, 0, 0.25, "mesh the anatomy"));
  }
  if (input.Labels && !input.Mechanics.SimulationMesh)
  {
    input.Mechanics.SimulationMesh = MakeSimulationMesh(*input.Labels, fixed,
      input.Mechanics.CellSizeMm, PartOf(progress, 0.25, 0.5, "mesh for the mechanics"));
  }
  input.Mechanics.Volume = std::move(input.Labels);
  problem.Model = std::make_shared<BreastModel>(std::move(*input.Anatomy), input.Materials,
    std::move(input.Mechanics), PartOf(progress, 0.5, 1, "prepare the mechanics"));
  problem.Model->SetXRays(ExtractInterfaces(problem.Model->Anatomy()), std::move(input.Projector),
    std::move(*input.XRays));
  problem.Model->SetScatter(std::move(input.Scatter));
  return problem;
}

bool IsShared(int parameter)
{
  return parameter == StiffnessParameter;
}

void RegistrationProblem::Validate() const
{
  if (this->Views.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  if (!this->Model || !this->Model->HasXRays())
  {
    throw InputError("registration: expected a model with a projector and a beam, found none");
  }
  const RegistrationOptions& options = this->Options;
  if (options.PixelSizesMm.empty() || options.Samples < 1 || options.OutlineDirections < 10 ||
    !(options.WindowMm > 0))
  {
    throw InputError("registration: expected at least one pixel size, one sample, ten outline "
                     "directions and a positive window");
  }
  for (const View& view : this->Views)
  {
    ValidateView(view, this->Views.front(), *this);
  }
}
}
