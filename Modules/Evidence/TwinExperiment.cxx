// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/TwinExperiment.h"

#include "Private/ImitatedMammogram.h"
#include "Private/PatientTissue.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Case/RegistrationCase.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Registration/Annealing.h"
#include "mammoray/Registration/TargetPreparation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mammoray
{
namespace
{
constexpr double WrongFatFactor = 1.5;
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
    : Model(MeshAnatomy(materials, table, anatomyMm, progress), table,
        { .Volume = materials,
          .SimulationMesh = MakeSimulationMesh(materials, table.Held(), cellSizeMm, progress),
          .Compression = { .Element = element },
          .Predicted = search == Search::Predicted },
        progress)
    , Placement{ axes, FindPoseAnchor(materials, table.Held(), axes), {} }
    , Elastic(this->Model.Body().Elastic())
  {
    this->Model.SetXRays(ExtractInterfaces(this->Model.Anatomy()), MakeProjector(),
      MakeBeam(table, FindSpectrum(spectrum), DetectorResponse::EnergyIntegrating));
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

  BreastModel Model;
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
  truth[StiffnessParameter] = 1;
  if (kind == TwinKind::EveryParameter)
  {
    truth[PitchParameter] = draws.Between(-10, 10);
    truth[YawParameter] = draws.Between(-10, 10);
    truth[TiltParameter] = draws.Between(-4, 4);
    truth[StiffnessParameter] = std::exp2(draws.Between(-1, 1));
  }
  return truth;
}

std::vector<RegistrationParameter> DrawParameters(Draws& draws, TwinKind kind,
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
  }
  std::vector<RegistrationParameter> parameters = DefaultParameters(start);
  if (kind == TwinKind::EveryParameter)
  {
    for (const int index : { PitchParameter, YawParameter, TiltParameter, StiffnessParameter })
    {
      parameters[index].Fixed = false;
    }
  }
  return parameters;
}

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
    default:
      return "every-parameter";
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
    const AnatomicalAxes& axes, const TwinOptions& options, const ProgressCallback& progress)
    : Phantom(phantom)
    , Volume(materials)
    , Table(table)
    , Options(options)
    , Model(this->Volume, table, axes,
        options.ModelFineness > 0 ? EdgeOf(materials) / options.ModelFineness : 0.0,
        options.ModelAnatomyMm, ElementType::Quadratic, Search::Predicted, options.ModelSpectrum,
        progress)
    , Target(this->Volume, table, axes, EdgeOf(materials) / options.TargetFineness,
        options.TargetAnatomyMm, ElementType::PatchAveragedLinear, Search::Direct,
        options.TargetSpectrum, progress)
    , HeightMm(mammoray::HeightMm(materials, table.Held(), axes.Superior))
  {
    this->Model.Placement.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
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

  /// Centres of voxels of the breast whose points are between the plates and in the picture.
  void DrawPoints(TwinProblem& problem, const CompressionState& state, Draws& draws) const
  {
    const BreastPose pose = PoseOf(problem.Truth);
    const std::vector<bool> held = this->Table.Held();
    while (static_cast<int>(problem.TruePositions.size()) < this->Options.NumberOfPoints)
    {
      const auto along = [&](int axis)
      { return static_cast<int>(draws.Between(0, this->Volume.Size[axis])); };
      const int i = along(0);
      const int j = along(1);
      const int k = along(2);
      const int material = this->Volume.Voxels[this->Volume.Index(i, j, k)];
      if (material == 0 || held[material])
      {
        continue;
      }
      const Vector3 point = this->Volume.PointAt(i, j, k);
      const std::vector<double> rest(point.begin(), point.end());
      const Vector3 gantry = this->Target.ToGantry(pose, state, rest).front();
      if (gantry[1] > 0)
      {
        problem.Points.insert(problem.Points.end(), rest.begin(), rest.end());
        problem.TruePositions.push_back(gantry);
      }
    }
  }

  std::vector<double> Errors(const TwinProblem& problem, const RegistrationResult& result) const
  {
    const std::vector<Vector3> found =
      this->Model.ToGantry(result.Pose, result.State, problem.Points);
    std::vector<double> errors;
    for (std::size_t index = 0; index < found.size(); ++index)
    {
      errors.push_back(Norm(found[index] - problem.TruePositions[index]));
    }
    return errors;
  }

  std::string Phantom;
  LabelVolume Volume;
  MaterialTable Table;
  TwinOptions Options;
  Side Model;
  Side Target;
  double HeightMm;
};

TwinExperiment::TwinExperiment(const std::string& phantom, const LabelVolume& materials,
  const MaterialTable& table, const AnatomicalAxes& axes, const TwinOptions& options,
  const ProgressCallback& progress)
  : Internal(std::make_unique<Internals>(phantom, materials, table, axes, options, progress))
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
      problem.Parameters = DrawParameters(draws, kind, problem.Truth);
      self.DrawPoints(problem, state, draws);
      const RegistrationTarget grid = ImitatedDetector(self.Options.PixelMm);
      EvaluatedState breast(model, model.Body(), self.Target.Placement, pose, state);
      const SyntheticMammogram synthetic = Synthesize(breast, grid, 2);
      const Mammogram header{ .View = "CC",
        .Laterality = 'L',
        .RowDirection = "A",
        .ColumnDirection = "R" };
      problem.Target =
        PrepareTarget(Develop(header, synthetic.LogAttenuation, grid, self.Options.Noise, draws));
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
  RegistrationOptions options = self.Options.Registration;
  options.Parameters = problem.Parameters;
  if (search != TwinSearch::Register)
  {
    for (const RegistrationParameter& parameter : problem.Parameters)
    {
      options.From.push_back(parameter.Start);
    }
    options.PixelSizesMm = { options.PixelSizesMm.back() };
  }
  if (search == TwinSearch::CentralDifferences)
  {
    options.Derivatives = RegistrationDerivatives::CentralDifferences;
  }
  const RegistrationResult result = search == TwinSearch::Annealing
    ? Anneal(self.Model.Model, self.Model.Placement, problem.Target, options,
        { .Equilibria = budget, .Seed = self.Options.Seed }, progress)
    : mammoray::Register(self.Model.Model, self.Model.Placement, problem.Target, options, progress);
  ReportProgress(progress, 1, "registered");

  TwinRun run;
  run.Phantom = self.Phantom;
  run.Kind = NameOf(problem.Kind);
  run.Search = NameOf(search);
  run.Number = problem.Number;
  run.Redrawn = problem.Redrawn;
  run.ModelCells = self.Model.Model.NumberOfSimulationCells();
  run.TargetCells = self.Target.Model.NumberOfSimulationCells();
  run.Truth = problem.Truth;
  for (const RegistrationParameter& parameter : problem.Parameters)
  {
    run.Names.push_back(parameter.Name);
    run.Start.push_back(parameter.Start);
  }
  run.Found = result.Values;
  run.Sigma = result.StandardDeviations;
  const ErrorSummary errors = Summarise(self.Errors(problem, result));
  run.MedianErrorMm = errors.Median;
  run.LargestErrorMm = errors.Largest;
  run.MeanOutlineMm = result.After.MeanOutlineDistanceMm;
  run.Correlation = result.After.Correlation;
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
