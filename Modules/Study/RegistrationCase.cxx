// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegistrationCase.h"

#include "Private/AskedPlaces.h"
#include "Private/CaseChecks.h"
#include "Private/Checkpoint.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/StudyCase.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace mammoray
{
namespace
{
/// Measures stages, by the names that progress is reported with, into a list.
class Stopwatch
{
public:
  Stopwatch(std::vector<std::pair<std::string, double>>& stages, const char* first)
    : Stages(stages)
    , Stage(first)
  {
  }
  /// That stage, or a detail of it behind a StageSeparator, goes on or begins now.
  void Note(const std::string& told)
  {
    std::string stage = told.substr(0, told.find(StageSeparator));
    if (stage != this->Stage)
    {
      this->End();
      this->Stage = std::move(stage);
    }
  }
  void End()
  {
    const auto now = std::chrono::steady_clock::now();
    this->Stages.emplace_back(this->Stage, std::chrono::duration<double>(now - this->Last).count());
    this->Last = now;
  }

private:
  std::vector<std::pair<std::string, double>>& Stages;
  std::string Stage;
  std::chrono::steady_clock::time_point Last = std::chrono::steady_clock::now();
};

TetrahedralMesh ReadTetrahedra(const std::string& path, const MaterialTable& table)
{
  TetrahedralMesh mesh = FitGrid(ReadMesh(path), table, path);
  mesh.Validate(path);
  return mesh;
}

/// Throws InputError unless there is one for each mammogram, or none.
void CheckCount(std::size_t count, const RegistrationCase& input, const std::string& what)
{
  if (count > 0 && count != input.Mammograms.size())
  {
    throw InputError("expected a " + what + " for each of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found " + std::to_string(count));
  }
}

/// The case's start of a parameter. Absent if the case does not give it.
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
  CheckCount(values.size(), input, parameter.Name);
  return values[mammogram];
}

BreastPose StartOf(const RegistrationCase& input, std::size_t number, const Mammogram& mammogram,
  std::vector<std::string>& warnings)
{
  BreastPose start;
  for (const PoseParameter& parameter : PoseParameters)
  {
    const std::optional<double> given = GivenStart(input, number, parameter);
    const std::optional<double> header = parameter.Index == ThicknessParameter
      ? mammogram.BodyPartThicknessMm
      : parameter.Index == RollParameter ? NominalRollDeg(mammogram)
                                         : std::nullopt;
    start.*parameter.Value = given ? *given : header.value_or(parameter.Start);
    if (parameter.InHeader && !given && !header)
    {
      warnings.push_back(parameter.Index == ThicknessParameter
          ? "The header does not say the compressed thickness; " +
            std::to_string(static_cast<int>(start.ThicknessMm)) + " mm is where the search starts."
          : "The header does not say the view and side; the search starts from a cranio-caudal "
            "view.");
    }
  }
  if (!(start.ThicknessMm > 0))
  {
    throw InputError("start: expected a positive compressed thickness, found " +
      std::to_string(start.ThicknessMm) + " mm");
  }
  CheckUsual(input, ValidRanges::Thickness, start.ThicknessMm, input.Mammograms[number],
    "ThicknessMm");
  return start;
}

/// Frees the case's parameters, or those that are found by default, and fixes the others.
void FreeParametersOf(const RegistrationCase& input, const MaterialTable& materials,
  std::vector<RegistrationParameter>& parameters)
{
  std::vector<std::string> names = input.Free.empty() ? FreePoseParameterNames() : input.Free;
  if (input.Free.empty() && input.Mammograms.size() > 1 && !materials.Glandular().empty())
  {
    names.emplace_back(PoseParameters[StiffnessParameter].Name);
  }
  for (RegistrationParameter& parameter : parameters)
  {
    parameter.Fixed = true;
  }
  for (const std::string& name : names)
  {
    parameters[FindPoseParameter(name).Index].Fixed = false;
  }
}

/// Begins where an earlier search was, with its starts and bounds, which it may have had to open.
/// Throws InputError that names the file when it is one of other inputs.
void ResumeFrom(const RegistrationCase& input, const SearchPoint& earlier,
  const std::string& mammogram, View& view)
{
  const std::vector<ResultInput> inputs = InputsOf(input, mammogram);
  const auto hasLabels = [](const std::vector<ResultInput>& entries)
  {
    return std::any_of(entries.begin(), entries.end(),
      [](const ResultInput& entry) { return entry.Role == LabelRole; });
  };
  if (hasLabels(inputs) != hasLabels(earlier.Inputs))
  {
    throw InputError(input.Resume + ": expected a result " +
      (hasLabels(inputs) ? "of labels, found one of a segmented MRI"
                         : "of a segmented MRI, found one of labels"));
  }
  for (const ResultInput& given : inputs)
  {
    const auto isOther = [&given](const ResultInput& entry)
    { return entry.Role == given.Role && entry.Sha256 != given.Sha256; };
    // What is asked and shown may change: the search does not depend on it.
    const bool isShown = given.Role == "Lesions" || (given.Role == "MRI" && !input.Study);
    if (!isShown && std::any_of(earlier.Inputs.begin(), earlier.Inputs.end(), isOther))
    {
      throw InputError(input.Resume + ": expected a result of the same " + given.Role +
        ", found one of another file");
    }
  }
  for (RegistrationParameter& parameter : view.Parameters)
  {
    const auto known = std::find_if(earlier.Parameters.begin(), earlier.Parameters.end(),
      [&](const ResultParameter& entry) { return entry.Name == parameter.Name; });
    if (known == earlier.Parameters.end())
    {
      view.From.push_back(parameter.Start);
      continue;
    }
    view.From.push_back(known->Value);
    if (!parameter.Fixed && known->Lower <= known->Start && known->Start <= known->Upper)
    {
      parameter.Start = known->Start;
      parameter.Lower = known->Lower;
      parameter.Upper = known->Upper;
      view.From.back() = std::clamp(known->Value, known->Lower, known->Upper);
    }
  }
}

/// Reads the mammograms into the result, each with its start.
void ReadMammograms(const RegistrationCase& input, RegistrationCaseResult& result)
{
  CheckCount(input.Masks.size(), input, "mask");
  CheckCount(input.MammogramViews.size(), input, "view");
  const std::vector<SearchPoint> resumed =
    input.Resume.empty() ? std::vector<SearchPoint>{} : ReadSearchPoints(input.Resume);
  if (!input.Resume.empty() && resumed.size() != input.Mammograms.size())
  {
    throw InputError(input.Resume + ": expected a result of " +
      std::to_string(input.Mammograms.size()) + " mammogram(s), found one of " +
      std::to_string(resumed.size()));
  }
  for (const std::string& path : input.Mammograms)
  {
    const std::size_t number = result.Views.size();
    RegisteredView& registered = result.Views.emplace_back();
    registered.Path = path;
    ReadCasePictures(input, result.Views);
    View& view = registered.View;
    view.Parameters =
      DefaultParameters(StartOf(input, number, registered.Mammogram, registered.Warnings));
    view.Parameters[RollParameter].PriorSigma = input.RollSigmaDeg;
    FreeParametersOf(input, result.Materials, view.Parameters);
    if (!input.Resume.empty())
    {
      ResumeFrom(input, resumed[number], path, view);
    }
  }
  if (result.Views.empty())
  {
    throw InputError("registration: expected a mammogram, found none");
  }
}

/// Keeps each step of the search in the case's checkpoint and tells it on. Where keeping fails, a
/// sentence says so.
SearchObserver KeepSteps(const RegistrationCase& input, std::string& failure,
  const SearchObserver& observer)
{
  if (input.Checkpoint.empty())
  {
    return observer;
  }
  std::vector<SearchPoint> points;
  for (const std::string& mammogram : input.Mammograms)
  {
    points.push_back({ InputsOf(input, mammogram), {} });
  }
  return [&input, &failure, &observer, points](const std::vector<SearchedView>& views) mutable
  {
    for (std::size_t number = 0; number < points.size(); ++number)
    {
      points[number].Parameters = ParametersOf(views[number].Result);
    }
    try
    {
      WriteCheckpoint(points, input.Checkpoint);
    }
    catch (const InputError& error) // what is found is not lost for that
    {
      failure = std::string("Steps of the search could not be kept: ") + error.what() + ".";
    }
    if (observer)
    {
      observer(views);
    }
  };
}

/// Registers the views together, each with its own unit.
void Search(const RegistrationCase& input, RegistrationProblem& problem,
  RegistrationCaseResult& result, const ProgressCallback& progress, const SearchObserver& observer)
{
  problem.Options = input.Options;
  for (RegisteredView& registered : result.Views)
  {
    problem.Views.push_back(std::move(registered.View));
  }
  std::string failure;
  RegistrationResult found = Register(problem, progress, KeepSteps(input, failure, observer));
  if (!failure.empty())
  {
    result.Views.front().Warnings.push_back(failure);
  }
  result.FreeParameters = std::move(found.FreeParameters);
  result.Covariance = std::move(found.Covariance);
  for (std::size_t number = 0; number < result.Views.size(); ++number)
  {
    RegisteredView& registered = result.Views[number];
    registered.View = std::move(problem.Views[number]);
    registered.Registration = std::move(found.Views[number]);
    if (result.Tissue && !result.Tissue->Doubt.empty())
    {
      Assessment& trust = registered.Registration.Trust;
      trust.Level = std::max(trust.Level, Trust::Doubtful);
      trust.Reasons.push_back("In the MRI " + result.Tissue->Doubt + ".");
    }
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
  result.Tissue = std::make_shared<const StudyTissue>(input.Labels.Path.empty()
      ? SegmentStudy(*input.Study, result.Materials, progress, input.Labels.AcceptUnusual)
      : LabelStudy(*input.Study, input.Labels, result.Materials, progress));
  return result.Tissue->Breast;
}

/// Readers' notes for results, each once: a mammogram is read more than once.
std::vector<std::string> NotesOf(const std::vector<InputNote>& notes, bool named)
{
  std::vector<std::string> lines;
  for (const InputNote& note : notes)
  {
    std::string line = ShownName(note.File, named) + ": " + note.Text;
    if (std::find(lines.begin(), lines.end(), line) == lines.end())
    {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

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

RegistrationCaseResult RunRegistrationCase(const RegistrationCase& input,
  const ProgressCallback& whole, const SearchObserver& observer)
{
  // What a study's MRI takes of the time before the rest begins as it does with labels.
  const double segmenting = !input.Study ? 0.0 : input.Labels.Path.empty() ? 0.25 : 0.05;
  RegistrationCaseResult result;
  NoteKeeper notes(NoteKeeper::Others::Told);
  Stopwatch stopwatch(result.Timings, "read");
  const ProgressCallback progress =
    [&stopwatch, told = ShareOf(whole, segmenting, 1)](double fraction, const char* stage)
  {
    stopwatch.Note(stage);
    return !told || told(fraction, stage);
  };

  // Everything that can be refused is read before anything is computed.
  BreastInput breast;
  breast.Axes = result.Axes = AnatomicalAxes::FromCode(input.Orientation);
  CheckHanded(input, result.Axes);
  breast.Materials = result.Materials = FindMaterialTable(input.Materials);
  const std::vector<bool> fixed = result.Materials.Fixed();
  if (std::find(fixed.begin(), fixed.end(), true) == fixed.end())
  {
    throw InputError(input.Materials +
      ": expected a material with \"fixed\": true (the chest wall), "
      "found none");
  }
  ReadMammograms(input, result);
  breast.XRays =
    MakeBeam(result.Materials, FindSpectrum(input.Spectrum), DetectorResponse::EnergyIntegrating);
  breast.Scatter = MakeScatter(input, result.Views.front().View.Unit.SupportHeightMm);
  breast.Projector = MakeProjector(input.Projector);
  result.Device = breast.Projector->DeviceName() + ", " + MethodName(breast.Projector->Method());
  ReportProgress(progress, 0, "read");
  ReadAsked(input, result);
  breast.Labels = ReadTissue(input, result, ShareOf(whole, 0, segmenting));
  CheckAsked(input, *breast.Labels, result);
  CheckTissue(input, *breast.Labels, fixed, result.Axes, result.Views.front().Mammogram.Laterality);
  CheckSizes(input, result.Tissue ? result.Tissue->BreastCm3 : 0, result.Views);

  if (!input.AnatomyMesh.empty())
  {
    breast.Anatomy = ReadTetrahedra(input.AnatomyMesh, result.Materials);
  }
  if (!input.SimulationMesh.empty())
  {
    breast.Mechanics.SimulationMesh = ReadTetrahedra(input.SimulationMesh, result.Materials);
  }
  breast.AnatomyCellSizeMm = input.AnatomyCellSizeMm;
  breast.Mechanics.CellSizeMm = input.SimulationCellSizeMm;
  breast.Mechanics.OutsideTissue = result.Tissue
    ? InCutTissue(result.Tissue->Cut)
    : InCutTissue(*breast.Labels, result.Materials, input.Labels.CutSides);
  breast.Mechanics.Predicted = true;
  breast.Mechanics.Compression.ChestWall = input.ChestWall;
  if (input.ImagePosition)
  {
    breast.Mechanics.Compression.GravityMPerS2 = GravityIn(PatientPosition::Upright, result.Axes);
    breast.Mechanics.ImageGravityMPerS2 = GravityIn(*input.ImagePosition, result.Axes);
  }
  RegistrationProblem problem = MakeProblem(std::move(breast), ShareOf(progress, 0.05, 0.25));
  result.Anchor = problem.Frame.Anchor;
  result.Anatomy = problem.Model->Anatomy();
  result.SimulationCells = problem.Model->NumberOfSimulationCells();
  result.SurfaceTriangles = problem.Model->Surface().NumberOfTriangles();
  Search(input, problem, result, PartOf(progress, 0.25, 1, "register"), observer);
  result.Notes = NotesOf(notes.Notes, input.NameInputs);
  stopwatch.End();
  return result;
}
}
