// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkBreastCompression.h"

#include "Private/FilterRequest.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Study/CompressionGrids.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace
{
using namespace mammoray;

struct ElasticEntry
{
  ElasticMaterial Elastic;
  bool Fixed = false;

  bool operator==(const ElasticEntry&) const = default;
};

/// Everything that the model is made from.
struct CompressionSetup
{
  /// Mesh of input 0.
  TetrahedralMesh Anatomy;
  /// To simulate on; none: the anatomy itself where it is coarse enough.
  std::optional<TetrahedralMesh> Coarse;
  AnatomicalAxes Axes;
  ElasticTable Materials;
  CompressionOptions Options;
  /// Gravity in the image, m/s^2; 0: the image shows the shape without load.
  Vector3 ImageGravity{ 0, 0, 0 };

  bool operator==(const CompressionSetup& other) const
  {
    return this->Anatomy == other.Anatomy && this->Coarse == other.Coarse &&
      this->Axes == other.Axes && this->Materials.Elastic == other.Materials.Elastic &&
      this->Materials.Fixed == other.Materials.Fixed && this->Options == other.Options &&
      this->ImageGravity == other.ImageGravity;
  }
};

void AddDoubles(vtkFieldData* data, const char* name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  data->AddArray(array);
}

/// The requested time; 1, closed, without a request.
double TimeAsked(vtkInformation* information)
{
  return information->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
    ? std::clamp(information->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()), 0.0, 1.0)
    : 1;
}
}

struct vtkBreastCompression::Internals
{
  /// Constants of SetMaterial, by material.
  std::map<int, ElasticEntry> OwnMaterials;
  CompressionSetup Made;
  std::unique_ptr<BreastModel> Model;
  std::optional<CompressionState> State;
  /// The state found last for a force, and the force with the plates it began with.
  std::optional<CompressionState> Pressed;
  std::pair<double, PlatePair> PressedFor;
  /// The unit and its pose in the last update, if that closed the plates.
  std::optional<std::pair<UnitPlacement, BreastPose>> Closed;

  CompressionSimulation& Simulation() { return this->Model->Body().Simulation(); }
  ElasticTable MaterialsOf(const TetrahedralMesh& mesh, const std::vector<std::string>& names,
    const std::string& table) const;
  CompressionSetup SetupOf(const vtkBreastCompression& filter, vtkUnstructuredGrid* input,
    vtkUnstructuredGrid* coarse) const;
  void Prepare(CompressionSetup setup, const ProgressCallback& progress);
  /// Leaves the state at a time of the compression to the pose's thickness, or to a force above 0.
  void CompressTo(const UnitPlacement& placement, const BreastPose& pose, double forceN,
    double time, const ProgressCallback& progress);
  void Compress(const PlatePair& plates, const ProgressCallback& progress);
  void CompressToForce(const PlatePair& plates, const PlatePair& closer, double forceN,
    const ProgressCallback& progress);
  vtkSmartPointer<vtkUnstructuredGrid> Compressed(vtkUnstructuredGrid* input,
    const std::optional<double>& thicknessMm);
  CompressionSimulation::LossGradient Backward(vtkDataArray* loss);
};

/// Constants of the mesh's materials: what SetMaterial said of their numbers, else the table's by
/// their names (MaterialTable::FitMesh).
ElasticTable vtkBreastCompression::Internals::MaterialsOf(const TetrahedralMesh& mesh,
  const std::vector<std::string>& names, const std::string& table) const
{
  const std::set<int> used(mesh.Materials.begin(), mesh.Materials.end());
  TetrahedralMesh others; // one of each material that the table tells
  for (const int material : used)
  {
    if (this->OwnMaterials.count(material) == 0)
    {
      others.Materials.push_back(material);
    }
  }
  const std::vector<std::int32_t> numbers = others.Materials;
  ElasticTable known;
  if (!table.empty())
  {
    const mammoray::MaterialTable found = FindMaterialTable(table);
    found.FitMesh(others, names, "vtkBreastCompression's input");
    known = ElasticTable(found);
  }
  else if (!numbers.empty())
  {
    throw InputError("material " + std::to_string(numbers.front()) +
      " has no elastic constants; set them by MaterialTable or SetMaterial");
  }
  ElasticTable materials;
  const std::size_t count = static_cast<std::size_t>(used.empty() ? 0 : *used.rbegin()) + 1;
  materials.Elastic.resize(count);
  materials.Fixed.resize(count);
  for (const auto& [index, material] : this->OwnMaterials)
  {
    if (static_cast<std::size_t>(index) < count)
    {
      materials.Elastic[index] = material.Elastic;
      materials.Fixed[index] = material.Fixed;
    }
  }
  for (std::size_t other = 0; other < numbers.size(); ++other)
  {
    materials.Elastic[numbers[other]] = known.Elastic[others.Materials[other]];
    materials.Fixed[numbers[other]] = known.Fixed[others.Materials[other]];
  }
  return materials;
}

CompressionSetup vtkBreastCompression::Internals::SetupOf(const vtkBreastCompression& filter,
  vtkUnstructuredGrid* input, vtkUnstructuredGrid* coarse) const
{
  CompressionSetup setup;
  setup.Axes = AnatomicalAxes::FromCode(filter.Orientation);
  std::vector<std::string> names;
  setup.Anatomy = FromGrid(input, &names);
  setup.Anatomy.Validate("vtkBreastCompression's input");
  setup.Materials = this->MaterialsOf(setup.Anatomy, names,
    FileOrName(filter.MaterialTableFile, filter.MaterialTable));
  if (coarse)
  {
    setup.Coarse = FromGrid(coarse);
    setup.Coarse->Validate("vtkBreastCompression's simulation mesh");
  }
  setup.Options.Element =
    filter.Element == LINEAR ? ElementType::PatchAveragedLinear : ElementType::Quadratic;
  setup.Options.ChestWall = static_cast<ChestWallMode>(filter.ChestWall);
  setup.Options.Wall = { filter.WallStiffness[0], filter.WallStiffness[1] };
  setup.Options.Friction = filter.Friction;
  setup.Options.PullN = filter.PullN * setup.Axes.Anterior;
  if (filter.ImagePosition != NONE)
  {
    setup.ImageGravity = GravityIn(
      filter.ImagePosition == PRONE ? PatientPosition::Prone : PatientPosition::Supine, setup.Axes);
  }
  if (filter.Gravity || filter.ImagePosition != NONE)
  {
    setup.Options.GravityMPerS2 = GravityIn(PatientPosition::Upright, setup.Axes);
  }
  return setup;
}

void vtkBreastCompression::Internals::Prepare(CompressionSetup setup,
  const ProgressCallback& progress)
{
  if (this->Model && setup == this->Made)
  {
    return;
  }
  this->State.reset();
  this->Pressed.reset();
  this->Model.reset(); // should this throw, nothing is taken for current
  BreastModelOptions options;
  options.SimulationMesh = setup.Coarse;
  options.Compression = setup.Options;
  options.ImageGravityMPerS2 = setup.ImageGravity;
  this->Model = std::make_unique<BreastModel>(setup.Anatomy, setup.Materials, std::vector<int>{},
    std::move(options), progress);
  this->Made = std::move(setup);
}

void vtkBreastCompression::Internals::CompressTo(const UnitPlacement& placement,
  const BreastPose& pose, double forceN, double time, const ProgressCallback& progress)
{
  PlatePair closed = placement.PlatesAt(pose);
  if (forceN > 0)
  {
    BreastPose closer = pose;
    closer.ThicknessMm *= 0.9;
    this->CompressToForce(closed, placement.PlatesAt(closer), forceN, progress);
    closed = this->State->Plates;
  }
  if (time < 1)
  {
    const PlatePair open = this->Simulation().OpenedPlates(closed, progress);
    this->Compress(MovedPlates(open, PlateMotion(open, closed), time), progress);
  }
  else if (!(forceN > 0))
  {
    this->Compress(closed, progress);
  }
}

void vtkBreastCompression::Internals::Compress(const PlatePair& plates,
  const ProgressCallback& progress)
{
  if (this->State && this->Made.Options.Friction == 0)
  {
    try
    {
      this->State = this->Simulation().Compress(plates, &*this->State, progress);
      return;
    }
    catch (const ConvergenceError&)
    {
      // The way from there was blocked; the one from outside may not be.
    }
  }
  this->State.reset();
  this->State = this->Simulation().Compress(plates, nullptr, progress);
}

void vtkBreastCompression::Internals::CompressToForce(const PlatePair& plates,
  const PlatePair& closer, double forceN, const ProgressCallback& progress)
{
  if (!this->Pressed || this->PressedFor != std::pair(forceN, plates))
  {
    this->Pressed.reset();
    this->Pressed =
      this->Simulation().CompressToForce(plates, PlateMotion(plates, closer), forceN, progress);
    this->PressedFor = { forceN, plates };
  }
  this->State = this->Pressed;
}

/// `thicknessMm`: value of the field array; if empty, the distance of the plates.
vtkSmartPointer<vtkUnstructuredGrid> vtkBreastCompression::Internals::Compressed(
  vtkUnstructuredGrid* input, const std::optional<double>& thicknessMm)
{
  const CompressionGrids breast = this->Model->IsCarried()
    ? CompressionGrids(input, this->Made.Anatomy, this->Simulation())
    : CompressionGrids(input, this->Simulation());
  return breast.At(*this->State, thicknessMm);
}

CompressionSimulation::LossGradient vtkBreastCompression::Internals::Backward(vtkDataArray* loss)
{
  if (!this->State || !this->Closed)
  {
    throw InputError("Backward: expected an update with closed plates before, found none");
  }
  const vtkIdType points = static_cast<vtkIdType>(this->Made.Anatomy.Points.size()) / 3;
  if (!loss || loss->GetNumberOfComponents() != 3 || loss->GetNumberOfTuples() != points)
  {
    throw InputError("Backward: expected three derivatives for each of " + std::to_string(points) +
      " points, found " + std::to_string(loss ? loss->GetNumberOfValues() : 0) + " values");
  }
  std::vector<double> nodes;
  for (vtkIdType value = 0; value < loss->GetNumberOfValues(); ++value)
  {
    nodes.push_back(loss->GetComponent(value / 3, static_cast<int>(value % 3)));
  }
  if (this->Model->IsCarried())
  {
    nodes = this->Model->AnatomyPoints().Gather(nodes, this->Simulation().NumberOfNodes());
  }
  // The first nodes are the mesh's points.
  nodes.resize(this->State->Positions.size(), 0.0);
  return this->Simulation().Backward(*this->State, nodes,
    this->Closed->first.PlateVelocitiesAt(this->Closed->second));
}

vtkStandardNewMacro(vtkBreastCompression);

vtkBreastCompression::vtkBreastCompression()
  : Internal(new Internals)
{
  this->SetNumberOfInputPorts(2);
}

vtkBreastCompression::~vtkBreastCompression()
{
  delete this->Internal;
}

mammorayCxxSetTextMacro(vtkBreastCompression, MaterialTable);
mammorayCxxSetTextMacro(vtkBreastCompression, MaterialTableFile);
mammorayCxxSetTextMacro(vtkBreastCompression, Orientation);

void vtkBreastCompression::SetSimulationMeshConnection(vtkAlgorithmOutput* mesh)
{
  this->SetInputConnection(1, mesh);
}

int vtkBreastCompression::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

void vtkBreastCompression::SetMaterial(int material, double youngsModulusKPa, double poissonRatio,
  bool fixed, double fungExponent, double densityGPerCm3)
{
  if (material < 1 || material > 65535)
  {
    vtkErrorMacro(<< "SetMaterial: expected a material in [1, 65535], found " << material);
    return;
  }
  auto materials = this->Internal->OwnMaterials;
  materials[material] = { { .YoungsModulusKPa = youngsModulusKPa,
                            .PoissonRatio = poissonRatio,
                            .FungExponent = fungExponent,
                            .DensityGPerCm3 = densityGPerCm3 },
    fixed };
  SetProperty(this, this->Internal->OwnMaterials, std::move(materials));
}

void vtkBreastCompression::ClearMaterials()
{
  SetProperty(this, this->Internal->OwnMaterials, {});
}

int vtkBreastCompression::RequestInformation(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  vtkInformation* information = outputs->GetInformationObject(0);
  information->Remove(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  information->Remove(vtkStreamingDemandDrivenPipeline::TIME_RANGE());
  if (this->NumberOfTimeSteps > 1)
  {
    std::vector<double> times;
    times.reserve(this->NumberOfTimeSteps);
    for (int step = 0; step < this->NumberOfTimeSteps; ++step)
    {
      times.push_back(TimeOf(step, this->NumberOfTimeSteps));
    }
    const double range[2] = { 0, 1 };
    information->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), times.data(),
      this->NumberOfTimeSteps);
    information->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

int vtkBreastCompression::RequestData(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  return AnswerRequest(this, output,
    [&]()
    {
      const bool series = this->NumberOfTimeSteps > 1;
      const double time = series ? TimeAsked(outputs->GetInformationObject(0)) : 1;
      this->Compress(vtkUnstructuredGrid::GetData(inputs[0]),
        vtkUnstructuredGrid::GetData(inputs[1]), time, output);
      if (series)
      {
        output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
      }
    });
}

void vtkBreastCompression::Compress(vtkUnstructuredGrid* input, vtkUnstructuredGrid* coarse,
  double time, vtkUnstructuredGrid* output)
{
  const bool rounded = this->EdgeRadiusMm >= 0 && this->EdgeRadiusMm <= MostEdgeRadiusMm;
  if (!(this->ThicknessMm > 0) || !rounded || !(this->ForceN >= 0))
  {
    throw InputError("expected a positive ThicknessMm, an EdgeRadiusMm from 0 to " +
      std::to_string(static_cast<int>(MostEdgeRadiusMm)) + " and a ForceN of at least 0");
  }
  if (!this->AcceptUnusual && !(this->ForceN > 0))
  {
    CheckValidRange(ValidRanges::Thickness, this->ThicknessMm, "ThicknessMm");
  }
  Internals& internal = *this->Internal;
  internal.Prepare(internal.SetupOf(*this, input, coarse), ProgressOf(this));
  UnitPlacement placement;
  placement.Frame =
    FindPoseFrame(internal.Made.Anatomy, internal.Made.Materials.Fixed, internal.Made.Axes);
  placement.Unit.SupportEdgeMm = this->SupportEdgeMm;
  placement.Unit.PaddleEdgeMm = this->PaddleEdgeMm;
  placement.Unit.EdgeRadiusMm = this->EdgeRadiusMm;
  BreastPose pose;
  pose.ThicknessMm = this->ThicknessMm;
  pose.RollDeg = this->RollDeg;
  pose.PitchDeg = this->PitchDeg;
  pose.YawDeg = this->YawDeg;
  pose.LateralMm = this->LateralMm;
  pose.AnteriorMm = this->AnteriorMm;
  pose.VerticalMm = this->VerticalMm;
  pose.TiltDeg = this->TiltDeg;
  internal.Closed.reset();
  internal.CompressTo(placement, pose, this->ForceN, time, ProgressOf(this));
  const bool given = time == 1 && !(this->ForceN > 0);
  output->ShallowCopy(
    internal.Compressed(input, given ? std::optional<double>(this->ThicknessMm) : std::nullopt));
  pose.ThicknessMm = output->GetFieldData()->GetArray("ThicknessMm")->GetTuple1(0);
  AddPlacement(output, placement.At(pose));
  if (time == 1)
  {
    internal.Closed.emplace(placement, pose);
  }
}

bool vtkBreastCompression::Backward(vtkDataArray* loss, vtkFieldData* gradient)
{
  try
  {
    Internals& internal = *this->Internal;
    const CompressionSimulation::LossGradient found = internal.Backward(loss);
    gradient->Initialize();
    if (!internal.Model->IsCarried())
    {
      AddDoubles(gradient, "Stiffness", found.Cells);
    }
    AddDoubles(gradient, "Materials", found.Materials);
    AddDoubles(gradient, "Pose", found.Plates);
    return true;
  }
  catch (const std::exception& error)
  {
    vtkErrorMacro(<< TextOf(error));
    return false;
  }
}

void vtkBreastCompression::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialTable: " << this->MaterialTable << "\n";
  os << indent << "MaterialTableFile: " << this->MaterialTableFile << "\n";
  os << indent << "Orientation: " << this->Orientation << "\n";
  os << indent << "Element: " << (this->Element == LINEAR ? "linear" : "quadratic") << "\n";
  os << indent << "ThicknessMm: " << this->ThicknessMm << "\n";
  os << indent << "ForceN: " << this->ForceN << "\n";
  os << indent << "TiltDeg: " << this->TiltDeg << "\n";
  os << indent << "RollDeg: " << this->RollDeg << "\n";
  os << indent << "PitchDeg: " << this->PitchDeg << "\n";
  os << indent << "YawDeg: " << this->YawDeg << "\n";
  os << indent << "LateralMm: " << this->LateralMm << "\n";
  os << indent << "AnteriorMm: " << this->AnteriorMm << "\n";
  os << indent << "VerticalMm: " << this->VerticalMm << "\n";
  os << indent << "SupportEdgeMm: " << this->SupportEdgeMm << "\n";
  os << indent << "PaddleEdgeMm: " << this->PaddleEdgeMm << "\n";
  os << indent << "EdgeRadiusMm: " << this->EdgeRadiusMm << "\n";
  os << indent << "ChestWall: " << this->ChestWall << "\n";
  os << indent << "WallStiffness: " << this->WallStiffness[0] << " " << this->WallStiffness[1]
     << "\n";
  os << indent << "PullN: " << this->PullN << "\n";
  os << indent << "Friction: " << this->Friction << "\n";
  os << indent << "ImagePosition: " << this->ImagePosition << "\n";
  os << indent << "Gravity: " << this->Gravity << "\n";
  os << indent << "NumberOfTimeSteps: " << this->NumberOfTimeSteps << "\n";
  os << indent << "AcceptUnusual: " << this->AcceptUnusual << "\n";
}
