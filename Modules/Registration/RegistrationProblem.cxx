// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationProblem.h"

#include "mammoray/Foundation/Error.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#endif

#include <utility>

namespace mammoray
{
namespace
{
#ifdef MAMMORAY_HAS_MESHING
TetrahedralMesh MeshAnatomy(const LabelVolume& labels, const std::vector<int>& thin,
  double cellSizeMm, const ProgressCallback& progress)
{
  MeshingOptions options = MeshingOptions::Anatomy(thin);
  options.CellSizeMm = cellSizeMm;
  return MeshMaterials(labels, options, progress).Mesh;
}
#else
TetrahedralMesh MeshAnatomy(const LabelVolume&, const std::vector<int>&, double,
  const ProgressCallback&)
{
  throw InputError("registration: this build has no Meshing module; expected an anatomy mesh and a "
                   "simulation mesh made elsewhere");
}
#endif
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
  problem.Axes = input.Axes;
  const std::vector<bool> fixed = input.Materials.Fixed();
  problem.Anchor = input.Labels ? FindPoseAnchor(*input.Labels, fixed, input.Axes)
                                : FindPoseAnchor(*input.Anatomy, fixed, input.Axes);
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
}
