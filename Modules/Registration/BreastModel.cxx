// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/BreastModel.h"

#include "Private/MeshVoxels.h"
#include "Private/Silhouette.h"
#include "mammoray/Foundation/Error.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#endif

#include <algorithm>
#include <string>
#include <utility>

namespace mammoray
{
PlatePair UnitPlacement::PlatesAt(const BreastPose& pose) const
{
  return PlatesOf(this->At(pose), this->Unit, pose.ThicknessMm, pose.TiltDeg);
}

std::vector<PlatePairVelocity> UnitPlacement::PlateVelocitiesAt(const BreastPose& pose) const
{
  const PlatePair plates = this->PlatesAt(pose);
  std::vector<PlatePairVelocity> velocities;
  for (const UnitVelocity& unit : UnitVelocities(this->Frame, this->Unit, pose))
  {
    const auto carried = [&](const Plate& plate)
    {
      return PlateVelocity{ unit.Shift + Cross(unit.Turn, plate.Edge - this->Frame.Anchor),
        unit.Turn };
    };
    PlatePairVelocity pair{ carried(plates.Support), carried(plates.Paddle) };
    pair.Paddle.Linear = pair.Paddle.Linear + unit.PaddleShift;
    pair.Paddle.Angular = pair.Paddle.Angular + unit.PaddleTurn;
    velocities.push_back(pair);
  }
  velocities.resize(StiffnessParameter);
  return velocities;
}

namespace
{
/// Takes the motion of the unit's own points off velocities of `positions`: rays and pixels move
/// with the unit, and the unit with its support.
void SubtractMotion(const PlateVelocity& unit, const Plate& support,
  const std::vector<double>& positions, std::span<double> velocities)
{
  for (std::size_t index = 0; index < velocities.size(); index += 3)
  {
    const Vector3 carried =
      unit.VelocityAt(support, { positions[index], positions[index + 1], positions[index + 2] });
    for (int axis = 0; axis < 3; ++axis)
    {
      velocities[index + axis] -= carried[axis];
    }
  }
}
}

BreastBody::BreastBody(CompressionSimulation simulation, std::vector<ElasticMaterial> elastic,
  std::vector<int> gland)
  : Simulated(std::move(simulation))
  , ReferenceMaterials(std::move(elastic))
  , Gland(std::move(gland))
{
  for (const int index : this->Gland)
  {
    if (index < 0 || static_cast<std::size_t>(index) >= this->ReferenceMaterials.size())
    {
      throw InputError("breast: expected a material of the " +
        std::to_string(this->ReferenceMaterials.size()) + " known to scale, found number " +
        std::to_string(index));
    }
  }
}

void BreastBody::SetElastic(std::vector<ElasticMaterial> elastic)
{
  this->Simulated.SetMaterials(elastic);
  this->ReferenceMaterials = std::move(elastic);
}

void BreastBody::SetSurface(const std::vector<double>& points)
{
  this->SurfacePoints.emplace(this->Simulated, points);
}

const Embedding& BreastBody::Surface() const
{
  if (!this->SurfacePoints)
  {
    throw InputError("breast: expected a surface to X-ray, found none");
  }
  return *this->SurfacePoints;
}

/// Leaves a simulation alone that has this stiffness.
void BreastBody::SetStiffness(double factor)
{
  std::vector<ElasticMaterial> materials = this->ReferenceMaterials;
  bool differs = false;
  for (const int index : this->Gland)
  {
    materials[index].YoungsModulusKPa *= factor;
    differs = differs ||
      materials[index].YoungsModulusKPa != this->Simulated.Materials()[index].YoungsModulusKPa;
  }
  if (differs)
  {
    this->Simulated.SetMaterials(materials);
  }
}

MaterialDerivative BreastBody::StiffnessVelocity() const
{
  MaterialDerivative velocity(this->ReferenceMaterials.size());
  for (const int index : this->Gland)
  {
    velocity[index].YoungsModulusKPa = this->ReferenceMaterials[index].YoungsModulusKPa;
  }
  return velocity;
}

CompressionState BreastBody::Compress(const UnitPlacement& placement, const BreastPose& pose,
  const CompressionState* start, const ProgressCallback& progress)
{
  this->SetStiffness(pose.Stiffness);
  return this->Simulated.Compress(placement.PlatesAt(pose), start, progress,
    CompressionSimulation::Refusal::AtOnce);
}

CompressionState BreastBody::Adopt(const BreastBody& other, const CompressionState& state,
  double stiffness, const ProgressCallback& progress)
{
  this->SetStiffness(stiffness);
  return this->Simulated.Adopt(other.Simulated, state, progress);
}

VectorFields BreastBody::VelocitiesSeenFromUnit(const UnitPlacement& placement,
  const BreastPose& pose, const CompressionState& state, const Embedding& points,
  const std::vector<double>& positions, const std::vector<int>& wanted)
{
  // The last equilibrium may have been a refused step's, of another stiffness.
  this->SetStiffness(pose.Stiffness);
  const std::vector<PlatePairVelocity> all = placement.PlateVelocitiesAt(pose);
  std::vector<PlatePairVelocity> motions;
  std::vector<MaterialDerivative> stiffening;
  for (const int parameter : wanted)
  {
    if (parameter == StiffnessParameter)
    {
      stiffening.push_back(this->StiffnessVelocity());
    }
    else
    {
      motions.push_back(all[parameter]);
    }
  }
  const Plate support = placement.PlatesAt(pose).Support;
  const VectorFields nodes = this->Simulated.Sensitivities(state, motions, stiffening);
  VectorFields velocities(wanted.size(), positions.size());
  std::size_t motion = 0;
  for (std::size_t field = 0; field < wanted.size(); ++field)
  {
    if (wanted[field] == StiffnessParameter)
    {
      points.Map(nodes[nodes.Count() - 1], velocities[field]);
      continue;
    }
    points.Map(nodes[motion], velocities[field]);
    SubtractMotion(motions[motion].Support, support, positions, velocities[field]);
    ++motion;
  }
  return velocities;
}

namespace
{
/// Voxels of an anatomy without a volume, mm: finer than any simulation cell.
constexpr double VoxelMm = 1.0;
/// Up to so many linear cells a cold start takes some ten seconds on its own.
constexpr std::size_t MostCellsWithoutPredictor = 20000;

MaterialField SampledFrom(LabelVolume volume)
{
  return [shared = std::make_shared<const LabelVolume>(std::move(volume))](const Vector3& point)
  { return static_cast<int>(shared->LabelAt(point)); };
}

/// Throws InputError unless the chest wall is there.
ElasticTable TableWithChestWall(const MaterialTable& table)
{
  ElasticTable materials(table);
  if (std::find(materials.Fixed.begin(), materials.Fixed.end(), true) == materials.Fixed.end())
  {
    throw InputError("table '" + table.Name +
      "': expected a material with \"fixed\": true (the chest wall), found none");
  }
  return materials;
}
}

std::size_t MostSimulationCells(ElementType element)
{
  return element == ElementType::Quadratic ? 20000 : 150000;
}

TetrahedralMesh MakeSimulationMesh([[maybe_unused]] const LabelVolume& materials,
  [[maybe_unused]] const std::vector<bool>& fixed, [[maybe_unused]] double cellSizeMm,
  [[maybe_unused]] const ProgressCallback& progress)
{
#ifdef MAMMORAY_HAS_MESHING
  return MeshForSimulation(materials, fixed, cellSizeMm, progress).Mesh;
#else
  throw InputError("this build has no Meshing module to make a mesh for the simulation; expected "
                   "one made elsewhere, or an anatomy of at most " +
    std::to_string(MostSimulationCells(ElementType::Quadratic)) + " cells");
#endif
}

void AddColdStartPredictor(CompressionSimulation& simulation, const TetrahedralMesh& mesh,
  const ElasticTable& materials, const CompressionOptions& options,
  const ProgressCallback& progress)
{
  if (options.Element == ElementType::Quadratic ||
    mesh.NumberOfCells() <= MostCellsWithoutPredictor)
  {
    return;
  }
  CompressionOptions quadratic = options;
  quadratic.Element = ElementType::Quadratic;
  try
  {
    LabelVolume voxels = Voxelize(mesh, VoxelMm);
    const TetrahedralMesh coarse = MakeSimulationMesh(voxels, materials.Fixed, 0, progress);
    simulation.SetPredictor(std::make_unique<CompressionSimulation>(coarse, materials.Elastic,
      materials.Fixed, SampledFrom(std::move(voxels)), quadratic));
  }
  catch (const InputError&)
  {
    // The body is too small or too large for such voxels, or nothing can mesh it.
  }
}

/// The cells to simulate on and where their stiffness comes from.
struct BreastModel::Basis
{
  /// Null: the anatomy's own cells.
  std::unique_ptr<TetrahedralMesh> Mesh;
  MaterialField Field;

  /// Takes the volume and the mesh out of the options.
  Basis(const TetrahedralMesh& anatomy, const std::vector<bool>& fixed, BreastModelOptions& options,
    const ProgressCallback& progress)
    : Field(options.Field)
  {
    const bool own = !options.SimulationMesh &&
      anatomy.NumberOfCells() <= MostSimulationCells(options.Compression.Element);
    if (!own && !options.Volume && !this->Field)
    {
      options.Volume = Voxelize(anatomy, VoxelMm);
    }
    if (options.SimulationMesh)
    {
      this->Mesh = std::make_unique<TetrahedralMesh>(std::move(*options.SimulationMesh));
    }
    else if (!own)
    {
      const LabelVolume& volume =
        options.Volume ? *options.Volume : options.Volume.emplace(Voxelize(anatomy, VoxelMm));
      this->Mesh = std::make_unique<TetrahedralMesh>(
        MakeSimulationMesh(volume, fixed, options.CellSizeMm, progress));
    }
    if (options.Volume && !this->Field)
    {
      this->Field = SampledFrom(std::move(*options.Volume));
    }
  }
};

BreastModel::BreastModel(TetrahedralMesh&& anatomy, const ElasticTable& materials,
  std::vector<int> gland, const BreastModelOptions& options, const Basis& basis,
  const ProgressCallback& progress)
  : Tissue(std::move(anatomy))
  , Quadratic(CompressionSimulation(basis.Mesh ? *basis.Mesh : this->Tissue, materials.Elastic,
                materials.Fixed, basis.Field, options.Compression, options.OutsideTissue),
      materials.Elastic, gland)
{
  const TetrahedralMesh& mesh = basis.Mesh ? *basis.Mesh : this->Tissue;
  this->CellCount = mesh.NumberOfCells();
  this->Carried = basis.Mesh != nullptr;
  const bool unloaded = Norm(options.ImageGravityMPerS2) > 0;
  if (unloaded)
  {
    this->Quadratic.Simulation().Unload(options.ImageGravityMPerS2, progress);
  }
  else
  {
    AddColdStartPredictor(this->Quadratic.Simulation(), mesh, materials, options.Compression,
      progress);
  }
  if (options.Predicted)
  {
    CompressionOptions linear = options.Compression;
    linear.Element = ElementType::PatchAveragedLinear;
    this->Predicting.emplace(CompressionSimulation(mesh, materials.Elastic, materials.Fixed,
                               basis.Field, linear, options.OutsideTissue),
      materials.Elastic, std::move(gland));
    if (unloaded)
    {
      this->Predicting->Simulation().Unload(options.ImageGravityMPerS2, progress);
    }
  }
}

BreastModel::BreastModel(TetrahedralMesh anatomy, const ElasticTable& materials,
  std::vector<int> gland, BreastModelOptions options, const ProgressCallback& progress)
  : BreastModel(std::move(anatomy), materials, std::move(gland), options,
      Basis(anatomy, materials.Fixed, options, progress), progress)
{
}

BreastModel::BreastModel(TetrahedralMesh anatomy, const MaterialTable& table,
  BreastModelOptions options, const ProgressCallback& progress)
  : BreastModel(std::move(anatomy), TableWithChestWall(table), table.Glandular(),
      std::move(options), progress)
{
}

const Embedding& BreastModel::AnatomyPoints()
{
  if (!this->TissuePoints)
  {
    this->TissuePoints.emplace(this->Quadratic.Simulation(), this->Tissue.Points);
  }
  return *this->TissuePoints;
}

void BreastModel::SetXRays(SurfaceMesh surface, std::unique_ptr<PathLengthProjector> projector,
  Beam beam)
{
  if (!projector)
  {
    throw InputError("breast: expected a projector, found none");
  }
  projector->SetSurface(surface);
  this->Quadratic.SetSurface(surface.Points);
  if (this->Predicting)
  {
    this->Predicting->SetSurface(surface.Points);
  }
  this->Edges = OuterEdges(surface);
  this->Interfaces = std::move(surface);
  this->Projector = std::move(projector);
  this->Rays.emplace(std::move(beam));
}

void BreastModel::SetBeam(Beam beam)
{
  this->Rays.emplace(std::move(beam));
}

PathLengthImage BreastModel::Project(const std::vector<double>& points, const XRaySource& source,
  const XRayDetector& detector)
{
  this->Projector->UpdatePoints(points);
  return this->Projector->Project(source, detector);
}

PathLengthImage BreastModel::Project(const std::vector<double>& points, const XRaySource& source,
  const XRayDetector& detector, const VectorFields& velocities, PathLengthDerivatives& derivatives)
{
  this->Projector->UpdatePoints(points);
  return this->Projector->Project(source, detector, velocities, derivatives);
}
}
