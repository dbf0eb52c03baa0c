// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkBreastCompression.h"

#include "Private/FilterRequest.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Case/CompressionGrids.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastModel.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace
{
using namespace mammoray;

struct HeldMaterial
{
  ElasticMaterial Elastic;
  bool Held = false;
};

/// What the simulation is made of.
struct Setup
{
  /// Of input 0.
  TetrahedralMesh Anatomy;
  /// To simulate on; none: the anatomy itself.
  std::optional<TetrahedralMesh> Coarse;
  ElasticTable Materials;
  CompressionOptions Options;
  /// Of the image; 0: not to be unloaded of.
  Vector3 ImageGravity{ 0, 0, 0 };

  bool operator==(const Setup& other) const
  {
    return this->Anatomy == other.Anatomy && this->Coarse == other.Coarse &&
      this->Materials.Elastic == other.Materials.Elastic &&
      this->Materials.Held == other.Materials.Held && this->Options == other.Options &&
      this->ImageGravity == other.ImageGravity;
  }
};
}

struct vtkBreastCompression::Internals
{
  std::map<int, HeldMaterial> Given;
  Setup Made;
  std::unique_ptr<BreastModel> Model;
  std::optional<CompressionState> State;
  /// The state found last for a force, and the force with the plates it began with.
  std::optional<CompressionState> Pressed;
  std::pair<double, PlatePair> PressedFor;

  ElasticTable MaterialsOf(const TetrahedralMesh& mesh, const std::string& table) const;
  void Prepare(Setup setup, const ProgressCallback& progress);
  void Compress(const PlatePair& plates, const ProgressCallback& progress);
  void CompressToForce(const PlatePair& plates, const PlatePair& closer, double forceN,
    const ProgressCallback& progress);
};

/// The table's materials, and before them what SetMaterial said.
ElasticTable vtkBreastCompression::Internals::MaterialsOf(const TetrahedralMesh& mesh,
  const std::string& table) const
{
  ElasticTable materials;
  if (table.empty())
  {
    materials.Elastic.resize(1); // air
    materials.Held.resize(1);
  }
  else
  {
    materials = ElasticTable(FindMaterialTable(table));
  }
  std::vector<bool> known(materials.Held.size(), true);
  for (const auto& [index, material] : this->Given)
  {
    const auto size = std::max(known.size(), static_cast<std::size_t>(index) + 1);
    materials.Elastic.resize(size);
    materials.Held.resize(size);
    known.resize(size, false);
    materials.Elastic[index] = material.Elastic;
    materials.Held[index] = material.Held;
    known[index] = true;
  }
  for (const int material : mesh.Materials)
  {
    if (material < 0 || static_cast<std::size_t>(material) >= known.size() || !known[material])
    {
      throw InputError("material " + std::to_string(material) +
        " has no elastic constants; set them by MaterialTable or SetMaterial");
    }
  }
  return materials;
}

void vtkBreastCompression::Internals::Prepare(Setup setup, const ProgressCallback& progress)
{
  if (this->Model && setup == this->Made)
  {
    return;
  }
  this->State.reset();
  this->Pressed.reset();
  this->Model.reset(); // should this throw, nothing is taken for current
  const std::vector<int> noGland;
  this->Model = std::make_unique<BreastModel>(setup.Anatomy, setup.Materials, noGland,
    BreastModelOptions{ .SimulationMesh = setup.Coarse,
      .Compression = setup.Options,
      .ImageGravityMPerS2 = setup.ImageGravity },
    progress);
  this->Made = std::move(setup);
}

void vtkBreastCompression::Internals::Compress(const PlatePair& plates,
  const ProgressCallback& progress)
{
  if (this->State && this->Made.Options.Friction == 0)
  {
    try
    {
      this->State = this->Model->Body().Simulation().Compress(plates, &*this->State, progress);
      return;
    }
    catch (const ConvergenceError&)
    {
      // The way from there was blocked; the one from outside may not be.
    }
  }
  this->State.reset();
  this->State = this->Model->Body().Simulation().Compress(plates, nullptr, progress);
}

void vtkBreastCompression::Internals::CompressToForce(const PlatePair& plates,
  const PlatePair& closer, double forceN, const ProgressCallback& progress)
{
  if (!this->Pressed || this->PressedFor != std::pair(forceN, plates))
  {
    this->Pressed.reset();
    this->Pressed = this->Model->Body().Simulation().CompressToForce(plates,
      PlateMotion(plates, closer), forceN, progress);
    this->PressedFor = { forceN, plates };
  }
  this->State = this->Pressed;
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
  bool held, double fungExponent, double densityGPerCm3)
{
  if (material < 1 || material > 65535)
  {
    vtkErrorMacro(<< "SetMaterial: expected a material in [1, 65535], found " << material);
    return;
  }
  this->Internal->Given[material] = {
    { youngsModulusKPa, poissonRatio, fungExponent, densityGPerCm3 }, held
  };
  this->Modified();
}

void vtkBreastCompression::ClearMaterials()
{
  this->Internal->Given.clear();
  this->Modified();
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
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  vtkInformation* information = outputs->GetInformationObject(0);
  Internals& internal = *this->Internal;
  try
  {
    if (!(this->ThicknessMm > 0) || !(this->EdgeRadiusMm >= 0) || !(this->ForceN >= 0))
    {
      throw InputError(
        "expected a positive ThicknessMm, and an EdgeRadiusMm and a ForceN of at least 0");
    }
    const ProgressCallback progress = [this](double fraction, const char*)
    {
      this->UpdateProgress(fraction);
      return this->GetAbortExecute() == 0;
    };
    const AnatomicalAxes axes = AnatomicalAxes::FromCode(this->Orientation);
    Setup setup;
    setup.Anatomy = FromGrid(input);
    setup.Anatomy.Validate("vtkBreastCompression's input");
    setup.Materials = internal.MaterialsOf(setup.Anatomy, this->MaterialTable);
    if (vtkUnstructuredGrid* coarse = vtkUnstructuredGrid::GetData(inputs[1]))
    {
      setup.Coarse = FromGrid(coarse);
      setup.Coarse->Validate("vtkBreastCompression's simulation mesh");
    }
    setup.Options.Element =
      this->Element == LINEAR ? ElementType::PatchAveragedLinear : ElementType::Quadratic;
    setup.Options.ChestWall = static_cast<ChestWallMode>(this->ChestWall);
    setup.Options.Wall = { this->WallStiffness[0], this->WallStiffness[1] };
    setup.Options.Friction = this->Friction;
    setup.Options.PullN = this->PullN * axes.Anterior;
    if (this->ImagePosition != NONE)
    {
      setup.ImageGravity = GravityIn(
        this->ImagePosition == PRONE ? PatientPosition::Prone : PatientPosition::Supine, axes);
    }
    if (this->Gravity || this->ImagePosition != NONE)
    {
      setup.Options.GravityMPerS2 = GravityIn(PatientPosition::Upright, axes);
    }
    internal.Prepare(std::move(setup), progress);

    BreastPose pose;
    pose.RollDeg = this->RollDeg;
    pose.LateralMm = this->LateralMm;
    pose.AnteriorMm = this->AnteriorMm;
    pose.VerticalMm = this->VerticalMm;
    MammographyUnit unit;
    unit.SupportEdgeMm = this->SupportEdgeMm;
    unit.PaddleEdgeMm = this->PaddleEdgeMm;
    unit.EdgeRadiusMm = this->EdgeRadiusMm;
    const Vector3 anchor =
      FindPoseAnchor(internal.Made.Anatomy, internal.Made.Materials.Held, axes);
    const auto platesAt = [&](double thicknessMm)
    {
      pose.ThicknessMm = thicknessMm;
      return PlatesOf(PlaceUnit(axes, anchor, unit, pose), unit, thicknessMm, this->TiltDeg);
    };
    double time = 1;
    if (this->NumberOfTimeSteps > 1)
    {
      if (information->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
      {
        time = std::clamp(information->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()),
          0.0, 1.0);
      }
    }
    PlatePair closed = platesAt(this->ThicknessMm);
    if (this->ForceN > 0)
    {
      internal.CompressToForce(closed, platesAt(0.9 * this->ThicknessMm), this->ForceN, progress);
      closed = internal.State->Plates;
    }
    if (time < 1)
    {
      const PlatePair open = internal.Model->Body().Simulation().OpenedPlates(closed, progress);
      internal.Compress(MovedPlates(open, PlateMotion(open, closed), time), progress);
    }
    else if (!(this->ForceN > 0))
    {
      internal.Compress(closed, progress);
    }
    const bool given = time == 1 && !(this->ForceN > 0);
    const CompressionGrids breast = internal.Model->IsCarried()
      ? CompressionGrids(input, internal.Made.Anatomy, internal.Model->Body().Simulation())
      : CompressionGrids(input, internal.Model->Body().Simulation());
    output->ShallowCopy(
      breast.At(*internal.State, given ? std::optional<double>(this->ThicknessMm) : std::nullopt));
    pose.ThicknessMm = output->GetFieldData()->GetArray("ThicknessMm")->GetTuple1(0);
    AddPlacement(output, PlaceUnit(axes, anchor, unit, pose));
    if (this->NumberOfTimeSteps > 1)
    {
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    }
    return 1;
  }
  catch (...)
  {
    return FailedRequest(this, output);
  }
}

void vtkBreastCompression::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialTable: " << this->MaterialTable << "\n";
  os << indent << "Orientation: " << this->Orientation << "\n";
  os << indent << "Element: " << (this->Element == LINEAR ? "linear" : "quadratic") << "\n";
  os << indent << "ThicknessMm: " << this->ThicknessMm << "\n";
  os << indent << "ForceN: " << this->ForceN << "\n";
  os << indent << "TiltDeg: " << this->TiltDeg << "\n";
  os << indent << "RollDeg: " << this->RollDeg << "\n";
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
}
