// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/CompressionCase.h"

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Study/CompressionGrids.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace mammoray
{
namespace
{
/// Roll of a standard view, degrees; 0 where none is given.
double RollOfView(const CompressionCase& input)
{
  if (input.View.empty())
  {
    return 0;
  }
  Mammogram mammogram;
  mammogram.View = input.View;
  mammogram.Laterality = input.Side.value_or('?');
  const std::optional<double> roll = NominalRollDeg(mammogram);
  if (!roll)
  {
    throw InputError("view " + input.View + ": expected the side of the breast beside it",
      { "View", input.View, { "Side" } });
  }
  return *roll;
}

BreastModelOptions ModelOptions(const CompressionCase& input, const MaterialTable& materials,
  const AnatomicalAxes& axes, const std::optional<LabelVolume>& volume)
{
  BreastModelOptions options;
  options.Volume = volume;
  if (!input.SimulationMesh.empty())
  {
    options.SimulationMesh =
      FitGrid(ReadMesh(input.SimulationMesh), materials, input.SimulationMesh);
  }
  options.CellSizeMm = input.SimulationCellSizeMm;
  options.Compression = input.Loading;
  options.Compression.PullN = input.PullN * axes.Anterior;
  if (input.ImagePosition)
  {
    options.Compression.GravityMPerS2 = GravityIn(PatientPosition::Upright, axes);
    options.ImageGravityMPerS2 = GravityIn(*input.ImagePosition, axes);
  }
  return options;
}

CompressionState Compress(CompressionSimulation& simulation, const UnitPlacement& placement,
  const BreastPose& pose, const std::optional<double>& forceN, const ProgressCallback& progress)
{
  if (!forceN)
  {
    return simulation.Compress(placement.PlatesAt(pose), nullptr, progress);
  }
  // Any two thicknesses show how the plates close.
  BreastPose closer = pose;
  closer.ThicknessMm -= 1;
  const PlatePair plates = placement.PlatesAt(pose);
  return simulation.CompressToForce(plates, PlateMotion(plates, placement.PlatesAt(closer)),
    *forceN, progress);
}

/// The breast from open plates to those of `closed`, which it ends with.
std::vector<vtkSmartPointer<vtkUnstructuredGrid>> SeriesOf(const CompressionState& closed,
  CompressionSimulation& simulation, const CompressionGrids& breast, int stepCount,
  const ProgressCallback& progress)
{
  const PlatePair open = simulation.OpenedPlates(closed.Plates);
  const PlatePairVelocity closing = PlateMotion(open, closed.Plates);
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> grids;
  CompressionState state;
  for (int step = 0; step + 1 < stepCount; ++step)
  {
    const double time = TimeOf(step, stepCount);
    const ProgressCallback stepProgress = [&](double fraction, const char*)
    { return !progress || progress((step + fraction) / stepCount, "series"); };
    state = simulation.Compress(MovedPlates(open, closing, time), step > 0 ? &state : nullptr,
      stepProgress);
    grids.push_back(breast.At(state));
  }
  grids.push_back(breast.At(closed));
  return grids;
}

/// The plate in the plane through its edge's reference point and normal to that edge.
std::vector<Vector3> OutlineOf(const Plate& plate)
{
  constexpr double DepthMm = 300;
  constexpr double BackMm = 30;
  constexpr int ArcSteps = 12;
  const double radius = plate.EdgeRadiusMm;
  const Vector3 centre = plate.Edge + radius * plate.Inward - radius * plate.Normal;
  std::vector<Vector3> line{ plate.Edge + DepthMm * plate.Inward };
  for (int step = 0; step <= ArcSteps; ++step)
  {
    const double angle = 0.5 * std::numbers::pi * step / ArcSteps;
    line.push_back(
      centre + radius * (std::cos(angle) * plate.Normal - std::sin(angle) * plate.Inward));
  }
  line.push_back(plate.Edge - BackMm * plate.Normal);
  return line;
}
}

CompressionCaseResult RunCompressionCase(const CompressionCase& input,
  const ProgressCallback& progress)
{
  CompressionCaseResult result;
  result.Materials = FindMaterialTable(input.Materials);
  result.Rest = ReadMesh(input.Mesh);
  const TetrahedralMesh mesh = FitGrid(result.Rest, result.Materials, input.Mesh);
  mesh.Validate(input.Mesh);
  std::optional<LabelVolume> volume;
  if (!input.Labels.Path.empty())
  {
    volume = ReadMaterials(input.Labels, result.Materials);
  }
  UnitPlacement placement;
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(input.Orientation);
  placement.Unit = input.Unit;
  const std::vector<bool> fixed = result.Materials.Fixed();
  placement.Frame = volume ? FindPoseFrame(*volume, fixed, axes) : FindPoseFrame(mesh, fixed, axes);
  BreastPose pose = input.Pose;
  pose.RollDeg += RollOfView(input);

  BreastModel model(mesh, ElasticTable(result.Materials), {},
    ModelOptions(input, result.Materials, axes, volume), progress);
  CompressionSimulation& simulation = model.Body().Simulation();
  result.SimulationCells = model.NumberOfSimulationCells();
  result.Unknowns = simulation.NumberOfUnknowns();
  result.State = Compress(simulation, placement, pose, input.ForceN, progress);
  pose.ThicknessMm = input.ForceN ? GapMm(result.State.Plates) : pose.ThicknessMm;
  result.ThicknessMm = pose.ThicknessMm;
  result.Placed = placement.At(pose);

  const CompressionGrids breast(result.Rest, mesh, simulation);
  result.Compressed = breast.At(result.State, pose.ThicknessMm);
  if (input.SeriesSteps > 0)
  {
    result.Series = SeriesOf(result.State, simulation, breast, input.SeriesSteps, progress);
  }
  AddPlacement(result.Compressed, result.Placed);
  for (const auto& step : result.Series)
  {
    AddPlacement(step, result.Placed);
  }
  return result;
}

void WriteCompressionPicture(const CompressionCaseResult& result, const std::string& path)
{
  const PlatePair& plates = result.State.Plates;
  Vector3 middle;
  result.Compressed->GetCenter(middle.data());
  Vector3 restMiddle;
  result.Rest->GetCenter(restMiddle.data());
  const Vector3& up = plates.Support.Normal;
  const Vector3& forward = plates.Support.Inward;
  char thickness[64];
  std::snprintf(thickness, sizeof thickness, "compressed to %.1f mm", GapMm(plates));
  WriteCutPicture({ { result.Rest, restMiddle, forward, up, "uncompressed", {} },
                    { result.Compressed, middle, forward, up, thickness,
                      { OutlineOf(plates.Support), OutlineOf(plates.Paddle) } },
                    { result.Compressed, middle, result.Placed.X, up, "from the front", {} } },
    result.Materials.Names(), path);
}
}
