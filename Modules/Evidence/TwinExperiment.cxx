// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/TwinExperiment.h"

#include "Private/ImitatedMammogram.h"
#include "Private/PatientTissue.h"
#include "Private/PointCoverage.h"
#include "Private/WrongLabels.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Registration/Annealing.h"
#include "mammoray/Registration/TargetPreparation.h"
#include "mammoray/Study/BreastInUnit.h"
#include "mammoray/Study/RegistrationCase.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

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

TetrahedralMesh MeshAnatomy(const LabelVolume& materials, const MaterialTable& table,
  double cellSizeMm, const ProgressCallback& progress)
{
  MeshingOptions options = MeshingOptions::Anatomy(table.Thin());
  // The facets' sizes belong to a cell size of 4 mm.
  options.FacetSizeMm *= cellSizeMm / 4;
  options.CellSizeMm = cellSizeMm;
  return MeshMaterials(materials, options, progress).Mesh;
}

/// Edge of a cube as large as the tissue, mm.
double EdgeOf(const LabelVolume& materials)
{
  const auto tissue = materials.Voxels.size() -
    static_cast<std::size_t>(std::count(materials.Voxels.begin(), materials.Voxels.end(), 0));
  return std::cbrt(static_cast<double>(tissue) * materials.VoxelVolume());
}

/// Whether a side has the predictor with which a search begins.
enum class Search
{
  Direct,
  Predicted
};

/// One of the two: what compresses and pictures the phantom.
struct Side
{
  Side(const LabelVolume& materials, const MaterialTable& table, const AnatomicalAxes& axes,
    double cellSizeMm, double anatomyMm, ElementType element, Search search,
    const std::string& spectrum, const ProgressCallback& progress)
    : Problem(MakeProblem(
        { .Materials = table,
          .Axes = axes,
          .Labels = materials,
          .Anatomy = MeshAnatomy(materials, table, anatomyMm, progress),
          .Mechanics = { .CellSizeMm = cellSizeMm,
            .Compression = { .Element = element },
            .Predicted = search == Search::Predicted },
          .Projector = MakeProjector(),
          .XRays = MakeBeam(table, FindSpectrum(spectrum), DetectorResponse::EnergyIntegrating) },
        progress))
    , Model(*this->Problem.Model)
    , Placement{ axes, this->Problem.Anchor, {} }
    , Elastic(this->Model.Body().Elastic())
  {
  }

  /// Points of the phantom at rest, 3 x pointCount, where a state moves them to, in the gantry.
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
  BreastPose start;
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
    start.AnteriorMm = 5;
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

/// The half of a picture, hung with its rows along the chest wall from larger to smaller x; what is
/// shown lies so much farther along x in the frame of the half's middle, mm.
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

/// A result as 'locate' has it.
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
  switch (kind)
  {
    case TwinKind::Plain:
      return "plain";
    case TwinKind::WrongMaterial:
      return "wrong-material";
    case TwinKind::WrongStart:
      return "wrong-start";
    case TwinKind::EveryParameter:
      return "every-parameter";
    case TwinKind::OtherBreast:
      return "other-breast";
    case TwinKind::OtherSide:
      return "other-side";
    case TwinKind::WrongSize:
      return "wrong-size";
    case TwinKind::LostTissue:
      return "lost-tissue";
    case TwinKind::WrongThickness:
      return "wrong-thickness";
    default:
      return "half-picture";
  }
}

const char* NameOf(PictureKind kind)
{
  switch (kind)
  {
    case PictureKind::Display:
      return "display";
    case PictureKind::Equalised:
      return "equalised";
    case PictureKind::Raw:
      return "raw";
    default:
      return "scattered";
  }
}

const char* NameOf(TwinSearch search)
{
  switch (search)
  {
    case TwinSearch::Register:
      return "register";
    case TwinSearch::Exact:
      return "exact";
    case TwinSearch::CentralDifferences:
      return "central-differences";
    default:
      return "annealing";
  }
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
    , Target(this->Volume, table, axes, EdgeOf(materials) / options.TargetFineness,
        options.TargetAnatomyMm, ElementType::PatchAveragedLinear, Search::Direct,
        options.TargetSpectrum, progress)
    , HeightMm(mammoray::HeightMm(materials, table.Fixed(), axes.Superior))
  {
    this->ModelOf(TwinKind::Plain, 0, progress);
  }

  /// What is registered: the pictured breast, unless the kind says otherwise.
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

  /// Made when first asked for.
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
        fineness > 0 ? EdgeOf(labels) / fineness : 0.0, this->Options.ModelAnatomyMm,
        ElementType::Quadratic, Search::Predicted, this->Options.ModelSpectrum, progress);
      model->Placement.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
    }
    return *model;
  }

  /// Materials of the target for a kind: the model knows nothing of the wrong one.
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

  /// Centres of voxels of the breast whose points are between the plates and in the picture, which
  /// lies `shiftMm` farther along x in its own frame.
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

  /// Where the points are found, into the run.
  void MeasurePoints(const TwinProblem& problem, Side& model, const ViewResult& result,
    TwinRun& run) const
  {
    run.MedianErrorMm = std::numeric_limits<double>::quiet_NaN();
    run.LargestErrorMm = run.MedianErrorMm;
    run.CoordinatesWithin = run.MedianErrorMm;
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
    run.CoordinatesWithin = coverage.Share();
    const ErrorSummary summary = Summarise(std::move(errors));
    run.MedianErrorMm = summary.Median;
    run.LargestErrorMm = summary.Largest;
  }

  std::string Phantom;
  LabelVolume Volume;
  std::optional<LabelVolume> Other;
  MaterialTable Table;
  AnatomicalAxes Axes;
  TwinOptions Options;
  /// By the kinds that have one of their own, and their version.
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
      const ReceptorGrid grid = ImitatedDetector(self.Options.PixelMm);
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

TwinRun TwinExperiment::Run(const TwinProblem& problem, TwinSearch search, int budget,
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
  }
  if (search == TwinSearch::CentralDifferences)
  {
    options.Derivatives = RegistrationDerivatives::CentralDifferences;
  }
  view.Target = problem.Target;
  view.Levels = MakeLevels(view.Target, options.PixelSizesMm);
  const ViewResult result = search == TwinSearch::Annealing
    ? Anneal(searched, { .Equilibria = budget, .Seed = self.Options.Seed }, progress)
    : mammoray::Register(searched, progress).Views.front();
  ReportProgress(progress, 1, "registered");

  TwinRun run;
  run.Phantom = self.Phantom;
  run.Kind = NameOf(problem.Kind);
  run.Search = NameOf(search);
  run.Number = problem.Number;
  run.Redrawn = problem.Redrawn;
  run.ModelCells = model.Model.NumberOfSimulationCells();
  run.TargetCells = self.Target.Model.NumberOfSimulationCells();
  run.Truth = problem.Truth;
  for (const RegistrationParameter& parameter : problem.Parameters)
  {
    run.Names.push_back(parameter.Name);
    run.Start.push_back(parameter.Start);
  }
  run.Found = result.Values;
  run.Sigma = result.StandardDeviations;
  self.MeasurePoints(problem, model, result, run);
  run.MeanOutlineMm = result.After.MeanOutlineDistanceMm;
  run.LargestOutlineMm = result.After.LargestOutlineDistanceMm;
  run.Correlation = result.After.Correlation;
  run.TissueCorrelation = result.After.TissueCorrelation;
  const Assessment& trust = result.Trust;
  run.Trust = NameOf(trust.Level);
  run.Reasons = trust.Reasons;
  run.Iterations = static_cast<int>(result.Iterations.size());
  run.Equilibria = result.Evaluations;
  run.Seconds = result.Seconds;
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    run.IterationSeconds.push_back(iteration.Seconds);
    run.IterationCosts.push_back(iteration.Cost);
  }
  run.Converged = result.Converged;
  run.StopReason = result.StopReason;
  return run;
}
}
