// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/RegistrationCase.h"

#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Case/ResultFile.h"
#include "mammoray/IO/MammogramIO.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/MammogramMask.h"
#include "mammoray/Registration/MammogramTarget.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SimulationMesh.h"
#endif

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

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
  table.CheckMesh(mesh, {}, path);
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

/// What the case says where a parameter starts; nothing where it does not.
std::optional<double> GivenStart(const RegistrationCase& input, std::size_t mammogram,
  const PoseParameter& parameter)
{
  const std::vector<double>& values = input.Start[parameter.Index];
  if (values.empty())
  {
    return std::nullopt;
  }
  if (values.size() == 1 && !parameter.InHeader)
  {
    return values.front();
  }
  if (values.size() != input.Mammograms.size())
  {
    throw InputError(std::string("start: expected a ") + parameter.Name + " for each of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found " +
      std::to_string(values.size()));
  }
  return values[mammogram];
}

BreastPose StartOf(const RegistrationCase& input, std::size_t number, const Mammogram& mammogram,
  std::vector<std::string>& warnings)
{
  BreastPose start;
  std::array<bool, ParameterCount> given{};
  for (const PoseParameter& parameter : PoseParameters)
  {
    const std::optional<double> value = GivenStart(input, number, parameter);
    given[parameter.Index] = value.has_value();
    start.*parameter.Value = value.value_or(parameter.Start);
  }
  if (!given[ThicknessParameter] && mammogram.BodyPartThicknessMm)
  {
    start.ThicknessMm = *mammogram.BodyPartThicknessMm;
  }
  else if (!given[ThicknessParameter])
  {
    warnings.push_back("The header does not say the compressed thickness; " +
      std::to_string(static_cast<int>(start.ThicknessMm)) + " mm is where the search starts.");
  }
  if (!(start.ThicknessMm > 0))
  {
    throw InputError("start: expected a positive compressed thickness, found " +
      std::to_string(start.ThicknessMm) + " mm");
  }
  const std::optional<double> nominal = NominalRollDeg(mammogram);
  if (!given[RollParameter] && nominal)
  {
    start.RollDeg = *nominal;
  }
  else if (!given[RollParameter])
  {
    warnings.push_back("The header does not say the view and side; the search starts from a "
                       "cranio-caudal view.");
  }
  return start;
}

void FreeParameters(const std::vector<std::string>& names,
  std::vector<RegistrationParameter>& parameters)
{
  for (RegistrationParameter& parameter : parameters)
  {
    parameter.Fixed = true;
  }
  for (const std::string& name : names)
  {
    parameters[FindPoseParameter(name).Index].Fixed = false;
  }
}

std::vector<std::string> FreeNames(const RegistrationCase& input, const MaterialTable& materials)
{
  std::vector<std::string> names = input.Free;
  if (names.empty())
  {
    names = FreePoseParameterNames();
    // One picture hardly tells the stiffness from the others.
    if (input.Mammograms.size() > 1 && !materials.Glandular().empty())
    {
      names.emplace_back(PoseParameters[StiffnessParameter].Name);
    }
  }
  return names;
}

/**
 * The parameters' values in an earlier result. Throws InputError that names the file when it is
 * none, or one of other inputs.
 */
std::vector<double> ResumeFrom(const RegistrationCase& input, const std::string& folder,
  const std::string& mammogram, const std::vector<RegistrationParameter>& parameters)
{
  std::vector<double> values;
  ReadResultFile(folder,
    [&](const nlohmann::json& result)
    {
      for (const auto& [role, name] : CaseInputs(input, mammogram))
      {
        for (const nlohmann::json& entry : result.at("inputs"))
        {
          if (entry.at("role") == role && entry.at("sha256") != Sha256OfFile(name))
          {
            throw InputError(folder + "/result.json: expected a result of " + name +
              ", found one of another file");
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
    });
  return values;
}

Mammogram ReadCaseMammogram(const RegistrationCase& input, std::size_t number)
{
  const std::string& path = input.Mammograms[number];
  PictureDescription given{ input.PixelSpacingMm,
    input.MammogramViews.empty() ? "" : input.MammogramViews[number],
    input.Laterality.empty() ? '?' : input.Laterality.front() };
  if (IsPicturePath(path))
  {
    return ReadMammogramPicture(path, given);
  }
  Mammogram mammogram = ReadMammogram(path);
  if (given.PixelSpacingMm)
  {
    mammogram.ColumnSpacingMm = *given.PixelSpacingMm;
    mammogram.RowSpacingMm = *given.PixelSpacingMm;
  }
  mammogram.View = given.View.empty() ? mammogram.View : given.View;
  mammogram.Laterality = given.Laterality == '?' ? mammogram.Laterality : given.Laterality;
  return mammogram;
}

/// Throws InputError unless there is one for each mammogram, or none.
void CheckCount(const std::vector<std::string>& given, const RegistrationCase& input,
  const char* what)
{
  if (!given.empty() && given.size() != input.Mammograms.size())
  {
    throw InputError("expected a " + std::string(what) + " for each of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found " +
      std::to_string(given.size()));
  }
}

/**
 * Reads the mammograms into the result, each with its start; models and targets of the views that
 * are answered are still to be set.
 */
std::vector<RegistrationView> ReadViews(const RegistrationCase& input,
  RegistrationCaseResult& result)
{
  CheckCount(input.Masks, input, "mask");
  CheckCount(input.MammogramViews, input, "view");
  const std::vector<std::string> free = FreeNames(input, result.Materials);
  const std::vector<std::string> resumed = input.Resume.empty()
    ? std::vector<std::string>(input.Mammograms.size())
    : RegistrationFolders(input.Resume);
  if (resumed.size() != input.Mammograms.size())
  {
    throw InputError(input.Resume + ": expected a result of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found one of " +
      std::to_string(resumed.size()));
  }
  std::vector<RegistrationView> views;
  for (const std::string& path : input.Mammograms)
  {
    const std::size_t number = views.size();
    RegisteredView& view = result.Views.emplace_back();
    view.Path = path;
    view.Mammogram = ReadCaseMammogram(input, number);
    const char side = result.Views.front().Mammogram.Laterality;
    if (view.Mammogram.Laterality != side && view.Mammogram.Laterality != '?' && side != '?')
    {
      throw InputError(path + ": expected a mammogram of the same breast as " +
        result.Views.front().Path + " (" + side + "), found one of the other (" +
        view.Mammogram.Laterality + ")");
    }
    view.Target = PrepareTarget(view.Mammogram, input.Targets);
    if (!input.Masks.empty())
    {
      ExcludePixels(ReadMask(input.Masks[number], view.Target.Columns, view.Target.Rows),
        view.Target);
    }
    view.Warnings = view.Target.Warnings;
    view.Unit = UnitOf(input, view.Mammogram, view.Warnings);
    RegistrationView& searched = views.emplace_back();
    searched.Parameters = DefaultParameters(StartOf(input, number, view.Mammogram, view.Warnings));
    FreeParameters(free, searched.Parameters);
    if (!input.Resume.empty())
    {
      searched.From = ResumeFrom(input, resumed[number], path, searched.Parameters);
    }
  }
  if (views.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  return views;
}

/// Registers the views together, each with its own unit.
void Search(const RegistrationCase& input, const RegistrationModel& model,
  std::vector<RegistrationView>& views, RegistrationCaseResult& result,
  const ProgressCallback& progress)
{
  std::vector<RegistrationModel> models(views.size(), model);
  for (std::size_t view = 0; view < views.size(); ++view)
  {
    models[view].Unit = result.Views[view].Unit;
    views[view].Model = &models[view];
    views[view].Target = &result.Views[view].Target;
  }
  JointRegistrationResult found = RegisterTogether(views, input.Options, progress);
  result.Unknowns = std::move(found.Unknowns);
  result.Covariance = std::move(found.Covariance);
  for (std::size_t view = 0; view < views.size(); ++view)
  {
    RegisteredView& registered = result.Views[view];
    registered.Registration = std::move(found.Views[view]);
    registered.Warnings.insert(registered.Warnings.end(), registered.Registration.Warnings.begin(),
      registered.Registration.Warnings.end());
  }
}

/// What a view shows where the search ended.
void Picture(const RegistrationModel& model, const Embedding& anatomy, RegisteredView& view)
{
  RegistrationResult& found = view.Registration;
  view.Placed = PlaceUnit(model.Axes, model.Anchor, model.Unit, found.Pose);
  view.Synthetic = Synthesize(model, found.Pose, found.State, view.Target, 1);
  found.After = Compare(view.Synthetic, view.Target);
  if (view.Synthetic.InconsistentRays > 0)
  {
    view.Warnings.push_back(std::to_string(view.Synthetic.InconsistentRays) +
      " rays of the synthetic mammogram crossed a surface that does not close.");
  }
  view.CompressedPoints = anatomy.Map(found.State.Positions);
  std::vector<int> uncertain;
  for (std::size_t index = 0; index < found.Parameters.size(); ++index)
  {
    if (!found.Parameters[index].Fixed || found.Parameters[index].PriorSigma > 0)
    {
      uncertain.push_back(static_cast<int>(index));
    }
  }
  std::vector<std::vector<double>> velocities =
    VelocitiesSeenFromUnit(model, found.Values, found.State, anatomy, uncertain);
  view.Sensitivities.resize(found.Parameters.size());
  for (std::size_t index = 0; index < uncertain.size(); ++index)
  {
    view.Sensitivities[uncertain[index]] = std::move(velocities[index]);
  }
}
}

std::vector<std::pair<std::string, std::string>> CaseInputs(const RegistrationCase& input,
  const std::string& mammogram)
{
  std::vector<std::pair<std::string, std::string>> inputs{ { "Label volume", input.Labels.Path },
    { "Material table", FindMaterialTablePath(input.Materials) }, { "Mammogram", mammogram } };
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
  std::vector<RegistrationView> views = ReadViews(input, result);
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
  Search(input, model, views, result, progress);
  stopwatch.Stage("register");
  const Embedding anatomy(simulation, result.Anatomy.Points);
  for (RegisteredView& view : result.Views)
  {
    model.Unit = view.Unit;
    Picture(model, anatomy, view);
  }
  stopwatch.Stage("synthetic mammogram");
  return result;
}
}
