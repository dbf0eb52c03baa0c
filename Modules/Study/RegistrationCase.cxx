// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegistrationCase.h"

#include "Private/AskedPlaces.h"
#include "Private/CaseChecks.h"
#include "Private/CasePictures.h"
#include "Private/Checkpoint.h"
#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/TargetPreparation.h"
#include "mammoray/Study/CutTissue.h"
#include "mammoray/Study/StudyCase.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#endif

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

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
#else
TetrahedralMesh MeshAnatomy(const LabelVolume&, const std::vector<int>&, double,
  const ProgressCallback&)
{
  throw InputError("registration: this build has no Meshing module; expected an anatomy mesh and a "
                   "simulation mesh made elsewhere");
}
#endif

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
  CheckUsual(input, ValidRanges::Thickness, start.ThicknessMm, input.Mammograms[number],
    "ThicknessMm");
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
    if (input.Mammograms.size() > 1 && !materials.Glandular().empty())
    {
      names.emplace_back(PoseParameters[StiffnessParameter].Name);
    }
  }
  return names;
}

/// Begins where an earlier search was, with its starts and bounds, which it may have had to open.
/// Throws InputError that names the file when it is one of other inputs.
void ResumeFrom(const RegistrationCase& input, const SearchPoint& earlier,
  const std::string& mammogram, JointMammogram& searched)
{
  for (const CaseInput& given : CaseInputs(input, mammogram))
  {
    if (given.Role == "Lesions" || (given.Role == "MRI" && !input.Study))
    {
      continue; // what is asked and shown may change, the search does not know it
    }
    for (const ResultInput& entry : earlier.Inputs)
    {
      if (entry.Role == given.Role && entry.Sha256 != given.Sha256())
      {
        throw InputError(input.Resume + ": expected a result of " + given.Files.front() +
          ", found one of another file");
      }
    }
  }
  for (RegistrationParameter& parameter : searched.Parameters)
  {
    const auto known = std::find_if(earlier.Parameters.begin(), earlier.Parameters.end(),
      [&](const ResultParameter& entry) { return entry.Name == parameter.Name; });
    if (known == earlier.Parameters.end())
    {
      searched.From.push_back(parameter.Start);
      continue;
    }
    searched.From.push_back(known->Value);
    if (!parameter.Fixed && known->Lower <= known->Start && known->Start <= known->Upper)
    {
      parameter.Start = known->Start;
      parameter.Lower = known->Lower;
      parameter.Upper = known->Upper;
      searched.From.back() = std::clamp(known->Value, known->Lower, known->Upper);
    }
  }
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
 * Reads the mammograms into the result, each with its start; models, placements and targets of the
 * mammograms that are answered are still to be set.
 */
std::vector<JointMammogram> ReadMammograms(const RegistrationCase& input,
  RegistrationCaseResult& result)
{
  CheckCount(input.Masks, input, "mask");
  CheckCount(input.MammogramViews, input, "view");
  const std::vector<std::string> free = FreeNames(input, result.Materials);
  std::vector<SearchPoint> resumed;
  if (!input.Resume.empty())
  {
    resumed = ReadSearchPoints(input.Resume);
  }
  if (!input.Resume.empty() && resumed.size() != input.Mammograms.size())
  {
    throw InputError(input.Resume + ": expected a result of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found one of " +
      std::to_string(resumed.size()));
  }
  std::vector<JointMammogram> mammograms;
  for (const std::string& path : input.Mammograms)
  {
    const std::size_t number = mammograms.size();
    RegisteredView& view = result.Views.emplace_back();
    view.Path = path;
    ReadCasePictures(input, result.Views);
    JointMammogram& searched = mammograms.emplace_back();
    searched.Parameters = DefaultParameters(StartOf(input, number, view.Mammogram, view.Warnings));
    searched.Parameters[RollParameter].PriorSigma = input.RollSigmaDeg;
    FreeParameters(free, searched.Parameters);
    if (!input.Resume.empty())
    {
      ResumeFrom(input, resumed[number], path, searched);
    }
  }
  if (mammograms.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
  return mammograms;
}

/// Keeps each step of the search in the case's checkpoint; where that fails, a sentence says so.
SearchObserver KeepSteps(const RegistrationCase& input, std::string& failure)
{
  if (input.Checkpoint.empty())
  {
    return {};
  }
  std::vector<SearchPoint> points;
  for (const std::string& mammogram : input.Mammograms)
  {
    points.push_back({ HashedInputs(input, mammogram), {} });
  }
  return [&input, &failure, points](const std::vector<const RegistrationResult*>& found) mutable
  {
    for (std::size_t number = 0; number < points.size(); ++number)
    {
      points[number].Parameters = ParametersOf(*found[number]);
    }
    try
    {
      WriteCheckpoint(points, input.Checkpoint);
    }
    catch (const InputError& error) // what is found is not lost for that
    {
      failure = std::string("Steps of the search could not be kept: ") + error.what() + ".";
    }
  };
}

/// Registers the mammograms together, each with its own unit.
void Search(const RegistrationCase& input, BreastModel& model,
  std::vector<JointMammogram>& mammograms, RegistrationCaseResult& result,
  const ProgressCallback& progress)
{
  for (std::size_t number = 0; number < mammograms.size(); ++number)
  {
    JointMammogram& mammogram = mammograms[number];
    mammogram.Model = &model;
    mammogram.Placement = { result.Axes, result.Anchor, result.Views[number].Unit };
    mammogram.Target = &result.Views[number].Target;
    for (const RegisteredProjection& other : result.Views[number].Others)
    {
      mammogram.Others.push_back({ &other.Target, other.FocalSpotMm });
    }
  }
  std::string failure;
  JointRegistrationResult found =
    RegisterTogether(mammograms, input.Options, progress, KeepSteps(input, failure));
  if (!failure.empty())
  {
    result.Views.front().Warnings.push_back(failure);
  }
  result.Unknowns = std::move(found.Unknowns);
  result.Covariance = std::move(found.Covariance);
  for (std::size_t number = 0; number < mammograms.size(); ++number)
  {
    RegisteredView& registered = result.Views[number];
    registered.Registration = std::move(found.Mammograms[number]);
    registered.Warnings.insert(registered.Warnings.end(), registered.Registration.Warnings.begin(),
      registered.Registration.Warnings.end());
    const std::string note = StiffnessNote(registered.Registration.State.StiffnessFactor);
    if (!note.empty())
    {
      registered.Warnings.push_back(note + ".");
    }
  }
}

/// The volume of material indices, of labels that were given or of a study's MRI.
LabelVolume ReadTissue(const RegistrationCase& input, RegistrationCaseResult& result,
  const ProgressCallback& progress)
{
  if (!input.Study)
  {
    return ReadMaterials(input.Labels, result.Materials);
  }
  result.Tissue = std::make_shared<const StudyTissue>(
    SegmentStudy(input.Study->Choice, result.Materials, progress, input.Labels.AcceptUnusual));
  return result.Tissue->Breast;
}
}

std::string CaseInput::Sha256() const
{
  return this->Files.size() == 1 ? Sha256OfFile(this->Files.front()) : Sha256OfFiles(this->Files);
}

std::string ShownName(const std::string& path, bool named)
{
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::path whole = fs::weakly_canonical(path, code);
  // A folder may be named with a slash at its end.
  const fs::path file = whole.has_filename() ? whole : whole.parent_path();
  const fs::path within = file.lexically_relative(fs::weakly_canonical(DataDirectory(), code));
  const bool isShipped = !within.empty() && *within.begin() != "..";
  return named || isShipped ? file.filename().string() : '*' + file.extension().string();
}

std::vector<CaseInput> CaseInputs(const RegistrationCase& input, const std::string& mammogram)
{
  std::vector<CaseInput> inputs;
  const auto add = [&](const char* role, const std::string& path) {
    inputs.push_back({ role, ShownName(path, input.NameInputs), { path } });
  };
  if (input.Study)
  {
    const StudyChoice& choice = input.Study->Choice;
    for (const auto& [role, series] : { std::pair{ "MRI without fat suppression", &choice.Plain },
           { "MRI with fat suppression", &choice.FatSuppressed }, { "MRI", &choice.Undetermined } })
    {
      if (*series)
      {
        inputs.push_back({ role, (*series)->Description, (*series)->Files });
      }
    }
  }
  else
  {
    add("Label volume", input.Labels.Path);
  }
  add(MaterialTableRole, FindMaterialTablePath(input.Materials));
  add(MammogramRole, mammogram);
  for (const auto& [role, path] :
    { std::pair{ "MRI", &input.Image }, { "Lesions", &input.Lesions } })
  {
    if (!path->empty())
    {
      add(role, *path);
    }
  }
  if (!input.AnatomyMesh.empty())
  {
    add("Anatomy mesh", input.AnatomyMesh);
  }
  if (!input.SimulationMesh.empty())
  {
    add("Simulation mesh", input.SimulationMesh);
  }
  return inputs;
}

namespace
{
/// What the case says of scatter, for its beam.
std::optional<ScatterModel> MakeScatter(const RegistrationCase& input, double supportHeightMm)
{
  if (!input.Scatter)
  {
    return std::nullopt;
  }
  std::optional<AntiscatterGrid> grid;
  if (input.Scatter->Grid)
  {
    grid.emplace(AntiscatterGridOptions::OfLead(*input.Scatter->Grid, input.Scatter->Interspace));
  }
  return ScatterModel(FindScatterKernels(), FindSpectrum(input.Spectrum),
    DetectorResponse::EnergyIntegrating, input.Scatter->AirGapMm.value_or(supportHeightMm), grid);
}
}

RegistrationCaseResult RunRegistrationCase(const RegistrationCase& input,
  const ProgressCallback& whole)
{
  // What a study's MRI takes of the time before the rest begins as it does with labels.
  const double segmenting = input.Study ? 0.25 : 0.0;
  const ProgressCallback progress = ShareOf(whole, segmenting, 1);
  RegistrationCaseResult result;
  Stopwatch stopwatch(result.Timings);

  // Everything that can be refused is read before anything is computed.
  result.Axes = AnatomicalAxes::FromCode(input.Orientation);
  CheckHanded(input, result.Axes);
  result.Materials = FindMaterialTable(input.Materials);
  const ElasticTable mechanics(result.Materials);
  const std::vector<bool>& held = mechanics.Fixed;
  if (std::find(held.begin(), held.end(), true) == held.end())
  {
    throw InputError(input.Materials +
      ": expected a material with \"held\": true (the chest wall), "
      "found none");
  }
  std::vector<JointMammogram> mammograms = ReadMammograms(input, result);
  Beam beam =
    MakeBeam(result.Materials, FindSpectrum(input.Spectrum), DetectorResponse::EnergyIntegrating);
  std::optional<ScatterModel> scatter =
    MakeScatter(input, result.Views.front().Unit.SupportHeightMm);
  auto projector =
    MakeProjector({ .Projection = MethodFromName(input.Projector), .Device = input.Device });
  result.Device = projector->DeviceName() + ", " + MethodName(projector->Method());
  ReportProgress(progress, 0, "read");
  ReadAsked(input, result);
  BreastModelOptions options;
  options.Volume = ReadTissue(input, result, ShareOf(whole, 0, segmenting));
  CheckAsked(input, *options.Volume, result);
  result.Anchor = FindPoseAnchor(*options.Volume, held, result.Axes);
  CheckTissue(input, *options.Volume, held, result.Axes, result.Views.front().Mammogram.Laterality);
  CheckSizes(input, result.Tissue ? result.Tissue->BreastCm3 : 0, result.Views);
  stopwatch.Stage("read");

  result.Anatomy = input.AnatomyMesh.empty()
    ? MeshAnatomy(*options.Volume, result.Materials.Thin(), input.AnatomyCellSizeMm,
        PartOf(progress, 0.05, 0.1, "mesh the anatomy"))
    : ReadTetrahedra(input.AnatomyMesh, result.Materials);
  stopwatch.Stage("mesh the anatomy");
  options.SimulationMesh = input.SimulationMesh.empty()
    ? MakeSimulationMesh(*options.Volume, held, input.SimulationCellSizeMm,
        PartOf(progress, 0.1, 0.15, "mesh for the mechanics"))
    : ReadTetrahedra(input.SimulationMesh, result.Materials);
  result.SimulationCells = options.SimulationMesh->NumberOfCells();
  stopwatch.Stage("mesh for the mechanics");

  options.OutsideTissue = result.Tissue
    ? InCutTissue(result.Tissue->Cut)
    : InCutTissue(*options.Volume, result.Materials, input.Labels.CutSides);
  options.Predicted = true;
  options.Compression.ChestWall = input.ChestWall;
  if (input.ImagePosition)
  {
    options.Compression.GravityMPerS2 = GravityIn(PatientPosition::Upright, result.Axes);
    options.ImageGravityMPerS2 = GravityIn(*input.ImagePosition, result.Axes);
  }
  BreastModel model(result.Anatomy, result.Materials, std::move(options),
    PartOf(progress, 0.15, 0.25, "prepare the mechanics"));
  SurfaceMesh surface = ExtractInterfaces(result.Anatomy);
  result.SurfaceTriangles = surface.NumberOfTriangles();
  model.SetXRays(std::move(surface), std::move(projector), std::move(beam));
  model.SetScatter(std::move(scatter));
  stopwatch.Stage("prepare");
  Search(input, model, mammograms, result, PartOf(progress, 0.25, 1, "register"));
  stopwatch.Stage("register");
  return result;
}
}
