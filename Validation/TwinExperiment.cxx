// SPDX-License-Identifier: Apache-2.0
#include "TwinExperiment.h"

#include "OtherSearches.h"
#include "PatientTissue.h"
#include "PointCoverage.h"
#include "WrongLabels.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace mammoray
{
namespace
{
constexpr double WrongFatFactor = 1.5;
constexpr double WrongSizes[] = { 0.85, 1.2 };
constexpr double WrongThicknessMm = 15;
constexpr int LargestNumberOfDraws = 10;

/// Compresses and X-rays the phantom, as the model or as the target. `predicted`: with the
/// predictor that a search begins with.
struct Side
{
  Side(const LabelVolume& materials, const MaterialTable& table, const AnatomicalAxes& axes,
    double cellSizeMm, double anatomyMm, ElementType element, bool predicted,
    const std::string& spectrum, const ProgressCallback& progress)
    : Problem(MakeProblem(
        { .Materials = table,
          .Axes = axes,
          .Labels = materials,
          .Anatomy = MeshAnatomy(materials, table, anatomyMm, MeshingOptions().SmallestComponentMm3,
            progress),
          .Mechanics = { .CellSizeMm = cellSizeMm,
            .Compression = { .Element = element },
            .Predicted = predicted },
          .Projector = MakeProjector(),
          .XRays = MakeBeam(table, FindSpectrum(spectrum), DetectorResponse::EnergyIntegrating) },
        progress))
    , Model(*this->Problem.Model)
    , Placement{ this->Problem.Frame, {} }
    , Elastic(this->Model.Body().Elastic())
  {
  }

  /// Positions of points of the phantom at rest (3 x pointCount, mm) in a compressed state, gantry
  /// frame.
  std::vector<Vector3> ToGantry(const BreastPose& pose, const CompressionState& state,
    const std::vector<double>& points) const
  {
    const VolumeFromGantry placed = this->Placement.At(pose);
    const std::vector<double> moved =
      Embedding(this->Model.Body().Simulation(), points).Map(state.Positions);
    std::vector<Vector3> gantry;
    for (std::size_t index = 0; index < moved.size(); index += 3)
    {
      gantry.push_back(placed.ToGantry({ moved[index], moved[index + 1], moved[index + 2] }));
    }
    return gantry;
  }

  /// Without views.
  RegistrationProblem Problem;
  BreastModel& Model;
  UnitPlacement Placement;
  /// The table's materials.
  std::vector<ElasticMaterial> Elastic;
};

std::vector<double> DrawTruth(Draws& draws, TwinKind kind, double heightMm)
{
  std::vector<double> truth(ParameterCount, 0.0);
  truth[ThicknessParameter] = draws.Between(0.52, 0.72) * heightMm;
  truth[RollParameter] = draws.Between(-30, 30);
  truth[LateralParameter] = draws.Between(-15, 15);
  truth[AnteriorParameter] = draws.Between(0, 15);
  const double far = kind == TwinKind::EveryParameter ? 2 : 1;
  truth[PitchParameter] = draws.Between(-5 * far, 5 * far);
  truth[YawParameter] = draws.Between(-5 * far, 5 * far);
  truth[TiltParameter] = draws.Between(-2 * far, 2 * far);
  truth[StiffnessParameter] =
    kind == TwinKind::EveryParameter ? std::exp2(draws.Between(-1, 1)) : 1.0;
  return truth;
}

std::vector<RegistrationParameter> DrawParameters(Draws& draws, TwinKind kind, int number,
  const std::vector<double>& truth)
{
  BreastPose start = DefaultStart();
  if (kind == TwinKind::WrongStart)
  {
    start.ThicknessMm = truth[ThicknessParameter] + 5 * draws.Sign();
    start.RollDeg = truth[RollParameter] + 20 * draws.Sign();
    start.LateralMm = truth[LateralParameter] + 15 * draws.Sign();
    // No start is behind the chest wall.
    start.AnteriorMm = truth[AnteriorParameter] + (truth[AnteriorParameter] < 15 ? 15 : -15);
  }
  else
  {
    start.ThicknessMm = truth[ThicknessParameter] + draws.Between(-3, 3);
    start.RollDeg = truth[RollParameter] + draws.Between(-10, 10);
    if (kind == TwinKind::WrongThickness)
    {
      start.ThicknessMm =
        truth[ThicknessParameter] + (number % 2 == 0 ? WrongThicknessMm : -WrongThicknessMm);
    }
  }
  std::vector<RegistrationParameter> parameters = DefaultParameters(start);
  if (kind == TwinKind::EveryParameter)
  {
    parameters[StiffnessParameter].Fixed = false;
  }
  return parameters;
}

/// Keeps half of a picture whose rows go along the chest wall from larger to smaller x. Returns how
/// far the content moves along x in the frame of the half's middle, mm.
double KeepHalf(bool upper, Mammogram& picture)
{
  const int rows = picture.Rows / 2;
  const int first = upper ? 0 : picture.Rows - rows;
  const auto begin = picture.Pixels.begin() + static_cast<std::ptrdiff_t>(first) * picture.Columns;
  picture.Pixels = std::vector(begin, begin + static_cast<std::ptrdiff_t>(rows) * picture.Columns);
  const double middle = 0.5 * picture.Rows - (first + 0.5 * rows);
  picture.Rows = rows;
  return -middle * picture.RowSpacingMm;
}

vtkSmartPointer<vtkDoubleArray> PointVectors(const std::string& name,
  std::span<const double> values)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size() / 3));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

/// The result in the form that a result folder gives.
BreastInUnit InUnit(BreastModel& model, const UnitPlacement& placement,
  const RegistrationTarget& target, const ViewResult& result)
{
  BreastInUnit breast;
  breast.Uncompressed = ToGrid(model.Anatomy(), {});
  TetrahedralMesh compressed = model.Anatomy();
  compressed.Points = model.AnatomyPoints().Map(result.State.Positions);
  breast.Compressed = ToGrid(compressed, {});
  breast.Placed = placement.At(result.Pose);
  breast.Unit = placement.Unit;
  breast.Grid = target.Grid;
  breast.Covariance = result.ConsideredCovariance;
  std::vector<int> all;
  for (const PoseParameter& parameter : PoseParameters)
  {
    breast.Parameters.emplace_back(parameter.Name);
    all.push_back(parameter.Index);
  }
  const VectorFields velocities = model.Body().VelocitiesSeenFromUnit(placement, result.Pose,
    result.State, model.AnatomyPoints(), compressed.Points, all);
  for (const PoseParameter& parameter : PoseParameters)
  {
    breast.Uncompressed->GetPointData()->AddArray(PointVectors(
      std::string(SensitivityArrayPrefix) + parameter.Name, velocities[parameter.Index]));
  }
  return breast;
}
}

bool IsWrongPair(TwinKind kind)
{
  return std::find(WrongPairs.begin(), WrongPairs.end(), kind) != WrongPairs.end();
}

const char* NameOf(TwinKind kind)
{
  constexpr const char* Names[]{ "plain", "wrong-material", "wrong-start", "every-parameter",
    "other-breast", "other-side", "wrong-size", "lost-tissue", "wrong-thickness", "half-picture" };
  return Names[static_cast<std::size_t>(kind)];
}

const char* NameOf(TwinSearch search)
{
  constexpr const char* Names[]{ "register", "exact", "central-differences", "annealing" };
  return Names[static_cast<std::size_t>(search)];
}

struct TwinExperiment::Internals
{
  Internals(const std::string& phantom, const LabelVolume& materials, const MaterialTable& table,
    const AnatomicalAxes& axes, const TwinOptions& options, const ProgressCallback& progress,
    const LabelVolume* other)
    : Phantom(phantom)
    , Volume(materials)
    , Other(other ? std::optional(*other) : std::nullopt)
    , Table(table)
    , Axes(axes)
    , Options(options)
    , Target(this->Volume, table, axes, CubeEdgeMm(materials) / options.TargetFineness,
        options.TargetAnatomyMm, ElementType::PatchAveragedLinear, false, options.TargetSpectrum,
        progress)
    , HeightMm(mammoray::HeightMm(materials, table.Fixed(), axes.Superior))
  {
    this->ModelOf(TwinKind::Plain, 0, progress);
  }

  /// The labels to register: those of the target, unless the kind is a wrong pair.
  LabelVolume LabelsOf(TwinKind kind, int number) const
  {
    const std::vector<bool> held = this->Table.Fixed();
    const bool even = number % 2 == 0;
    switch (kind)
    {
      case TwinKind::OtherBreast:
        if (!this->Other)
        {
          throw InputError("twins: expected the labels of another breast, found none");
        }
        return Resized(*this->Other,
          std::cbrt(BreastVolume(this->Volume, held) / BreastVolume(*this->Other, held)));
      case TwinKind::OtherSide:
        return Mirrored(this->Volume, this->Axes.Left);
      case TwinKind::WrongSize:
        return Resized(this->Volume, WrongSizes[even ? 0 : 1]);
      case TwinKind::LostTissue:
        return WithoutQuarter(this->Volume, held, even ? this->Axes.Anterior : this->Axes.Superior);
      default:
        return this->Volume;
    }
  }

  /// The model of a kind and number, made when it is first needed.
  Side& ModelOf(TwinKind kind, int number, const ProgressCallback& progress)
  {
    const bool own = kind == TwinKind::OtherBreast || kind == TwinKind::OtherSide ||
      kind == TwinKind::WrongSize || kind == TwinKind::LostTissue;
    const bool byNumber = kind == TwinKind::WrongSize || kind == TwinKind::LostTissue;
    std::unique_ptr<Side>& model =
      this->Models[{ own ? kind : TwinKind::Plain, byNumber ? number % 2 : 0 }];
    if (!model)
    {
      const LabelVolume labels = this->LabelsOf(kind, number);
      const double fineness = this->Options.ModelFineness;
      model = std::make_unique<Side>(labels, this->Table, this->Axes,
        fineness > 0 ? CubeEdgeMm(labels) / fineness : 0.0, this->Options.ModelAnatomyMm,
        ElementType::Quadratic, true, this->Options.ModelSpectrum, progress);
      model->Placement.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
    }
    return *model;
  }

  /// Sets the target's materials for a kind; the model keeps those of the table.
  void SetTargetMaterials(TwinKind kind)
  {
    std::vector<ElasticMaterial> elastic = this->Target.Elastic;
    if (kind == TwinKind::WrongMaterial)
    {
      for (std::size_t index = 1; index < elastic.size(); ++index)
      {
        if (this->Table.Materials[index].Attenuation == "adipose")
        {
          elastic[index].YoungsModulusKPa *= WrongFatFactor;
        }
      }
    }
    this->Target.Model.Body().SetElastic(std::move(elastic));
  }

  /// Draws centres of voxels of the breast that lie between the plates and in the picture, whose
  /// frame is shifted by `shiftMm` along x.
  void DrawPoints(TwinProblem& problem, const CompressionState& state, double shiftMm,
    Draws& draws) const
  {
    if (problem.Kind == TwinKind::OtherBreast || problem.Kind == TwinKind::OtherSide)
    {
      return;
    }
    const LabelVolume known = this->LabelsOf(problem.Kind, problem.Number);
    const double size = problem.Kind == TwinKind::WrongSize ? WrongSizes[problem.Number % 2] : 1.0;
    const BreastPose pose = PoseOf(problem.Truth);
    const std::vector<bool> held = this->Table.Fixed();
    while (static_cast<int>(problem.TruePositions.size()) < this->Options.NumberOfPoints)
    {
      const auto along = [&](int axis)
      { return static_cast<int>(draws.Between(0, this->Volume.Size[axis])); };
      const int i = along(0);
      const int j = along(1);
      const int k = along(2);
      const std::size_t voxel = this->Volume.Index(i, j, k);
      const int material = this->Volume.Voxels[voxel];
      if (material == 0 || held[material] || known.Voxels[voxel] == 0)
      {
        continue;
      }
      const Vector3 point = this->Volume.PointAt(i, j, k);
      const std::vector<double> rest(point.begin(), point.end());
      Vector3 gantry = this->Target.ToGantry(pose, state, rest).front();
      gantry[0] += shiftMm;
      const ReceptorPoint shadow = ShadowOf(gantry, this->Target.Placement.Unit);
      if (gantry[1] > 0 && problem.Target.Grid.Contains(shadow, 0))
      {
        for (const double coordinate : rest)
        {
          problem.Points.push_back(size * coordinate);
        }
        problem.TruePositions.push_back(gantry);
      }
    }
  }

  /// Errors of the points in the gantry frame: median and largest distance, mm, and the share of
  /// coordinates within two of their standard deviations; null where nothing is known.
  void MeasurePoints(const TwinProblem& problem, Side& model, const ViewResult& result,
    nlohmann::json& run) const
  {
    if (problem.TruePositions.empty())
    {
      return;
    }
    PointCoverage coverage(InUnit(model.Model, model.Placement, problem.Target, result));
    const std::vector<Vector3> found = model.ToGantry(result.Pose, result.State, problem.Points);
    std::vector<double> errors;
    for (std::size_t index = 0; index < found.size(); ++index)
    {
      const Vector3 error = found[index] - problem.TruePositions[index];
      errors.push_back(Norm(error));
      coverage.Add(
        { problem.Points[3 * index], problem.Points[3 * index + 1], problem.Points[3 * index + 2] },
        error);
    }
    run["coordinatesWithin"] = coverage.Share();
    run["medianErrorMm"] = Quantile(errors, 0.5);
    run["largestErrorMm"] = Quantile(errors, 1);
  }

  std::string Phantom;
  LabelVolume Volume;
  std::optional<LabelVolume> Other;
  MaterialTable Table;
  AnatomicalAxes Axes;
  TwinOptions Options;
  /// By kind, for kinds with a model of their own, and version.
  std::map<std::pair<TwinKind, int>, std::unique_ptr<Side>> Models;
  Side Target;
  double HeightMm;
};

TwinExperiment::TwinExperiment(const std::string& phantom, const LabelVolume& materials,
  const MaterialTable& table, const AnatomicalAxes& axes, const TwinOptions& options,
  const ProgressCallback& progress, const LabelVolume* other)
  : Internal(std::make_unique<Internals>(phantom, materials, table, axes, options, progress, other))
{
}

TwinExperiment::~TwinExperiment() = default;

TwinProblem TwinExperiment::Draw(TwinKind kind, int number, const ProgressCallback& progress)
{
  Internals& self = *this->Internal;
  self.SetTargetMaterials(kind);
  for (int attempt = 0;; ++attempt)
  {
    Draws draws(self.Options.Seed, number, attempt);
    TwinProblem problem;
    problem.Kind = kind;
    problem.Number = number;
    problem.Redrawn = attempt;
    problem.Truth = DrawTruth(draws, kind, self.HeightMm);
    try
    {
      const BreastPose pose = PoseOf(problem.Truth);
      BreastModel& model = self.Target.Model;
      const CompressionState state =
        model.Body().Compress(self.Target.Placement, pose, nullptr, progress);
      problem.Parameters = DrawParameters(draws, kind, number, problem.Truth);
      const ReceptorGrid grid = SimulatedDetector(self.Options.PixelMm);
      PosedBreast breast(model, model.Body(), self.Target.Placement, pose, state);
      const Mammogram header{ .View = "CC",
        .Laterality = 'L',
        .RowDirection = "A",
        .ColumnDirection = "R" };
      Mammogram picture = Develop(header, breast.PictureOn(grid, 2).LogAttenuation, grid,
        { .Kind = self.Options.Picture, .Noise = self.Options.Noise }, draws);
      const double shiftMm =
        kind == TwinKind::HalfPicture ? KeepHalf(number % 2 == 0, picture) : 0.0;
      problem.Target = PrepareTarget(picture);
      problem.Target.HeaderThicknessMm = problem.Parameters[ThicknessParameter].Start;
      self.DrawPoints(problem, state, shiftMm, draws);
      return problem;
    }
    catch (const ConvergenceError&)
    {
      if (attempt + 1 == LargestNumberOfDraws)
      {
        throw;
      }
    }
  }
}

nlohmann::json TwinExperiment::Run(const TwinProblem& problem, TwinSearch search, int budget,
  const ProgressCallback& progress)
{
  Internals& self = *this->Internal;
  Side& model = self.ModelOf(problem.Kind, problem.Number, progress);
  RegistrationProblem searched = model.Problem;
  RegistrationOptions& options = searched.Options;
  options = self.Options.Registration;
  View& view = searched.Views.emplace_back();
  view.Parameters = problem.Parameters;
  view.Unit = model.Placement.Unit;
  if (search != TwinSearch::Register)
  {
    for (const RegistrationParameter& parameter : problem.Parameters)
    {
      view.From.push_back(parameter.Start);
    }
    options.PixelSizesMm = { options.PixelSizesMm.back() };
    options.Comparison = PictureComparison::Global;
  }
  view.Target = problem.Target;
  view.Levels = MakeLevels(view.Target, options.PixelSizesMm);
  const ViewResult result = search == TwinSearch::Annealing
    ? Anneal(searched, { .Equilibria = budget, .Seed = self.Options.Seed }, progress)
    : search == TwinSearch::CentralDifferences
    ? SearchByDifferences(searched, progress)
    : mammoray::Register(searched, progress).Views.front();
  ReportProgress(progress, 1, "registered");

  nlohmann::json run = FailedTwin(self.Phantom, problem.Kind, search, problem.Number, "");
  for (const RegistrationParameter& parameter : problem.Parameters)
  {
    run["parameters"].push_back(parameter.Name);
    run["start"].push_back(parameter.Start);
  }
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    run["iterationSeconds"].push_back(iteration.Seconds);
    run["iterationCosts"].push_back(iteration.Cost);
  }
  const Assessment& trust = result.Trust;
  run.update(
    { { "redrawn", problem.Redrawn }, { "modelCells", model.Model.NumberOfSimulationCells() },
      { "targetCells", self.Target.Model.NumberOfSimulationCells() }, { "truth", problem.Truth },
      { "found", result.Values }, { "sigma", result.StandardDeviations },
      { "meanOutlineDistanceMm", result.After.MeanOutlineDistanceMm },
      { "largestOutlineDistanceMm", result.After.LargestOutlineDistanceMm },
      { "correlation", result.After.Correlation },
      { "tissueCorrelation", result.After.TissueCorrelation }, { "trust", NameOf(trust.Level) },
      { "reasons", trust.Reasons }, { "iterations", result.Iterations.size() },
      { "equilibria", result.Evaluations }, { "seconds", result.Seconds },
      { "converged", result.Converged }, { "stopReason", result.StopReason } });
  self.MeasurePoints(problem, model, result, run);
  return run;
}

nlohmann::json FailedTwin(const std::string& phantom, TwinKind kind, TwinSearch search, int number,
  const std::string& reason)
{
  const nlohmann::json none = nlohmann::json::array();
  return { { "phantom", phantom }, { "kind", NameOf(kind) }, { "search", NameOf(search) },
    { "number", number }, { "redrawn", 0 }, { "modelCells", 0 }, { "targetCells", 0 },
    { "parameters", none }, { "truth", none }, { "start", none }, { "found", none },
    { "sigma", none }, { "medianErrorMm", nullptr }, { "largestErrorMm", nullptr },
    { "coordinatesWithin", nullptr }, { "meanOutlineDistanceMm", nullptr },
    { "largestOutlineDistanceMm", nullptr }, { "correlation", nullptr },
    { "tissueCorrelation", nullptr }, { "trust", NameOf(Trust::None) }, { "reasons", none },
    { "iterations", 0 }, { "equilibria", 0 }, { "seconds", 0 }, { "iterationSeconds", none },
    { "iterationCosts", none }, { "converged", false }, { "stopReason", reason } };
}
}
