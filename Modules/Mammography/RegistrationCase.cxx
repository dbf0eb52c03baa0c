// SPDX-License-Identifier: Apache-2.0
#include "RegistrationCase.h"

#include "ElasticTable.h"
#include "MammogramIO.h"
#include "MammogramTarget.h"
#include "MeshConversion.h"
#include "MeshIO.h"
#include "PhysicsData.h"
#include "Sha256.h"

#ifdef MAMMORAY_HAS_MESHING
#include "SimulationMesh.h"
#endif

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

namespace mammoray
{
namespace
{
/// Appends the time since it was made, or since the last call, to a list of stages.
class Stopwatch
{
public:
  explicit Stopwatch(std::vector<std::pair<std::string, double>>& stages)
    : Stages(stages)
  {
  }
  void Stage(const std::string& name)
  {
    const auto now = std::chrono::steady_clock::now();
    this->Stages.emplace_back(name, std::chrono::duration<double>(now - this->Last).count());
    this->Last = now;
  }

private:
  std::vector<std::pair<std::string, double>>& Stages;
  std::chrono::steady_clock::time_point Last = std::chrono::steady_clock::now();
};

TetrahedralMesh ReadTetrahedra(const std::string& path, const MaterialTable& table)
{
  TetrahedralMesh mesh = FromGrid(ReadMesh(path));
  mesh.Validate(path);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const int material = mesh.Materials[cell];
    if (material < 1 || material >= static_cast<int>(table.Materials.size()))
    {
      throw InputError(path + ": cell " + std::to_string(cell) + " has material " +
        std::to_string(material) + ", expected 1 to " + std::to_string(table.Materials.size() - 1) +
        " of the table '" + table.Name + "'");
    }
  }
  return mesh;
}

#ifdef MAMMORAY_HAS_MESHING
TetrahedralMesh MeshAnatomy(const LabelVolume& materials, const std::vector<int>& thin,
  double cellSizeMm, const ProgressCallback& progress)
{
  MeshingOptions options = MeshingOptions::Anatomy(thin);
  options.CellSizeMm = cellSizeMm;
  return MeshMaterials(materials, options, progress).Mesh;
}

TetrahedralMesh MeshTissue(const LabelVolume& materials, const std::vector<bool>& held,
  double cellSizeMm, const ProgressCallback& progress)
{
  return MeshForSimulation(materials, held, cellSizeMm, progress).Mesh;
}
#else
TetrahedralMesh MeshAnatomy(const LabelVolume&, const std::vector<int>&, double,
  const ProgressCallback&)
{
  throw InputError("registration: this build has no Meshing module; expected an anatomy mesh and a "
                   "simulation mesh made elsewhere");
}

TetrahedralMesh MeshTissue(const LabelVolume& materials, const std::vector<bool>&,
  double cellSizeMm, const ProgressCallback& progress)
{
  return MeshAnatomy(materials, {}, cellSizeMm, progress);
}
#endif

MammographyUnit UnitOf(const RegistrationCase& input, const Mammogram& mammogram,
  std::vector<std::string>& warnings)
{
  MammographyUnit unit;
  if (input.SourceToDetectorMm)
  {
    unit.SourceToDetectorMm = *input.SourceToDetectorMm;
  }
  else if (mammogram.SourceToDetectorMm)
  {
    unit.SourceToDetectorMm = *mammogram.SourceToDetectorMm;
  }
  else
  {
    warnings.push_back("The header does not say the source to detector distance; " +
      std::to_string(static_cast<int>(unit.SourceToDetectorMm)) + " mm is assumed.");
  }
  if (input.SupportHeightMm)
  {
    unit.SupportHeightMm = *input.SupportHeightMm;
  }
  if (!(unit.SourceToDetectorMm > 0) || !(unit.SupportHeightMm >= 0))
  {
    throw InputError(
      "unit: expected a positive source to detector distance and a support height of at "
      "least 0, found " +
      std::to_string(unit.SourceToDetectorMm) + " and " + std::to_string(unit.SupportHeightMm) +
      " mm");
  }
  unit.SupportEdgeMm = input.SupportEdgeMm;
  unit.PaddleEdgeMm = input.PaddleEdgeMm;
  unit.EdgeRadiusMm = input.EdgeRadiusMm;
  return unit;
}

BreastPose StartOf(const RegistrationCase& input, const Mammogram& mammogram,
  std::vector<std::string>& warnings)
{
  BreastPose start;
  if (input.StartThicknessMm)
  {
    start.ThicknessMm = *input.StartThicknessMm;
  }
  else if (mammogram.BodyPartThicknessMm)
  {
    start.ThicknessMm = *mammogram.BodyPartThicknessMm;
  }
  else
  {
    warnings.push_back("The header does not say the compressed thickness; " +
      std::to_string(static_cast<int>(start.ThicknessMm)) + " mm is where the search starts.");
  }
  if (!(start.ThicknessMm > 0))
  {
    throw InputError("start: expected a positive compressed thickness, found " +
      std::to_string(start.ThicknessMm) + " mm");
  }
  if (input.StartRollDeg)
  {
    start.RollDeg = *input.StartRollDeg;
  }
  else if (const std::optional<double> nominal = NominalRollDeg(mammogram))
  {
    start.RollDeg = *nominal;
  }
  else
  {
    warnings.push_back("The header does not say the view and side; the search starts from a "
                       "cranio-caudal view.");
  }
  start.ShiftLateralMm = input.StartLateralMm;
  start.ShiftAnteriorMm = input.StartAnteriorMm;
  start.ShiftVerticalMm = input.StartVerticalMm;
  start.PitchDeg = input.StartPitchDeg;
  start.YawDeg = input.StartYawDeg;
  start.PaddleTiltDeg = input.StartTiltDeg;
  return start;
}

void FreeParameters(const std::vector<std::string>& names,
  std::vector<RegistrationParameter>& parameters)
{
  std::string known;
  for (RegistrationParameter& parameter : parameters)
  {
    parameter.Fixed = std::find(names.begin(), names.end(), parameter.Name) == names.end();
    known += (known.empty() ? "" : ", ") + parameter.Name;
  }
  for (const std::string& name : names)
  {
    if (std::none_of(parameters.begin(), parameters.end(),
          [&](const RegistrationParameter& parameter) { return parameter.Name == name; }))
    {
      throw InputError("parameter '" + name + "': expected one of " + known);
    }
  }
}

/**
 * The parameters' values in an earlier result. Throws InputError that names the file when it is
 * none, or one of other inputs.
 */
std::vector<double> ResumeFrom(const RegistrationCase& input,
  const std::vector<RegistrationParameter>& parameters)
{
  const std::string path = input.Resume + "/result.json";
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  std::vector<double> values;
  try
  {
    const nlohmann::json result = nlohmann::json::parse(file);
    for (const auto& [role, name] : CaseInputs(input))
    {
      for (const nlohmann::json& entry : result.at("inputs"))
      {
        if (entry.at("role") == role && entry.at("sha256") != Sha256OfFile(name))
        {
          throw InputError(path + ": expected a result of " + name + ", found one of another file");
        }
      }
    }
    for (const RegistrationParameter& parameter : parameters)
    {
      values.push_back(parameter.Start);
      for (const nlohmann::json& entry : result.at("parameters"))
      {
        if (entry.at("name") == parameter.Name)
        {
          values.back() = entry.at("value").get<double>();
        }
      }
    }
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected the result of 'mammoray register': " + error.what());
  }
  return values;
}
}

std::vector<std::pair<std::string, std::string>> CaseInputs(const RegistrationCase& input)
{
  std::vector<std::pair<std::string, std::string>> inputs{ { "Label volume", input.Labels.Path },
    { "Material table", FindMaterialTablePath(input.Materials) },
    { "Mammogram", input.Mammogram } };
  if (!input.AnatomyMesh.empty())
  {
    inputs.emplace_back("Anatomy mesh", input.AnatomyMesh);
  }
  if (!input.SimulationMesh.empty())
  {
    inputs.emplace_back("Simulation mesh", input.SimulationMesh);
  }
  return inputs;
}

RegistrationCaseResult RunRegistrationCase(const RegistrationCase& input,
  const ProgressCallback& progress)
{
  RegistrationCaseResult result;
  Stopwatch stopwatch(result.Timings);

  // Everything that can be refused is read before anything is computed.
  result.Axes = AnatomicalAxes::FromCode(input.Orientation);
  result.Materials = FindMaterialTable(input.Materials);
  const ElasticTable mechanics(result.Materials);
  const std::vector<bool>& held = mechanics.Held;
  if (std::find(held.begin(), held.end(), true) == held.end())
  {
    throw InputError(input.Materials +
      ": expected a material with \"held\": true (the chest wall), "
      "found none");
  }
  result.Mammogram = ReadMammogram(input.Mammogram);
  result.Target = PrepareTarget(result.Mammogram);
  result.Warnings = result.Target.Warnings;
  result.Unit = UnitOf(input, result.Mammogram, result.Warnings);
  const BreastPose start = StartOf(input, result.Mammogram, result.Warnings);
  RegistrationOptions options = input.Options;
  options.Parameters = DefaultParameters(start);
  FreeParameters(input.Free, options.Parameters);
  if (!input.Resume.empty())
  {
    options.From = ResumeFrom(input, options.Parameters);
  }
  const Spectrum spectrum = FindSpectrum(input.Spectrum);
  const Beam beam = MakeBeam(result.Materials, spectrum, DetectorResponse::EnergyIntegrating);
  ProjectorOptions projectorOptions;
  projectorOptions.Device = input.Device;
  projectorOptions.Projection = MethodFromName(input.Projector);
  const auto projector = MakeProjector(projectorOptions);
  result.Device = projector->DeviceName() + ", " + MethodName(projector->Method());
  const LabelVolume materials = ReadMaterials(input.Labels, result.Materials);
  result.Anchor = FindPoseAnchor(materials, held, result.Axes);
  stopwatch.Stage("read");

  result.Anatomy = input.AnatomyMesh.empty()
    ? MeshAnatomy(materials, result.Materials.Thin(), input.AnatomyCellSizeMm, progress)
    : ReadTetrahedra(input.AnatomyMesh, result.Materials);
  stopwatch.Stage("mesh the anatomy");
  const TetrahedralMesh coarse = input.SimulationMesh.empty()
    ? MeshTissue(materials, held, input.SimulationCellSizeMm, progress)
    : ReadTetrahedra(input.SimulationMesh, result.Materials);
  result.SimulationCells = coarse.NumberOfCells();
  stopwatch.Stage("mesh for the mechanics");

  const MaterialField field = [&materials](const Vector3& point)
  { return static_cast<int>(materials.LabelAt(point)); };
  CompressionSimulation simulation(coarse, mechanics.Elastic, held, field);
  CompressionSimulation scout(coarse, mechanics.Elastic, held, field,
    { .Element = ElementType::PatchAveragedLinear });
  const SurfaceMesh surface = ExtractInterfaces(result.Anatomy);
  result.SurfaceTriangles = surface.NumberOfTriangles();
  projector->SetSurface(surface);
  const Embedding surfaceEmbedding(simulation, surface.Points);
  const Embedding scoutEmbedding(scout, surface.Points);
  stopwatch.Stage("prepare");

  RegistrationModel model;
  model.Simulation = &simulation;
  model.Elastic = mechanics.Elastic;
  model.ScaledMaterials = result.Materials.Glandular();
  model.Surface = &surface;
  model.SurfaceEmbedding = &surfaceEmbedding;
  model.Scout = &scout;
  model.ScoutEmbedding = &scoutEmbedding;
  model.Projector = projector.get();
  model.XRays = &beam;
  model.Axes = result.Axes;
  model.Anchor = result.Anchor;
  model.Unit = result.Unit;
  result.Registration = Register(model, result.Target, options, progress);
  result.Warnings.insert(result.Warnings.end(), result.Registration.Warnings.begin(),
    result.Registration.Warnings.end());
  stopwatch.Stage("register");

  const BreastPose& pose = result.Registration.Pose;
  result.Placed = PlaceUnit(result.Axes, result.Anchor, result.Unit, pose);
  result.Synthetic = Synthesize(model, pose, result.Registration.State, result.Target, 1);
  result.Registration.After = Compare(result.Synthetic, result.Target);
  if (result.Synthetic.InconsistentRays > 0)
  {
    result.Warnings.push_back(std::to_string(result.Synthetic.InconsistentRays) +
      " rays of the synthetic mammogram crossed a surface that does not close.");
  }
  const Embedding anatomy(simulation, result.Anatomy.Points);
  result.CompressedPoints = anatomy.Map(result.Registration.State.Positions);
  std::vector<int> free;
  for (std::size_t index = 0; index < result.Registration.Parameters.size(); ++index)
  {
    if (!result.Registration.Parameters[index].Fixed)
    {
      free.push_back(static_cast<int>(index));
    }
  }
  std::vector<std::vector<double>> velocities =
    VelocitiesSeenFromUnit(model, pose, result.Registration.State, anatomy, free);
  result.Sensitivities.resize(result.Registration.Parameters.size());
  for (std::size_t index = 0; index < free.size(); ++index)
  {
    result.Sensitivities[free[index]] = std::move(velocities[index]);
  }
  stopwatch.Stage("synthetic mammogram");
  return result;
}
}
