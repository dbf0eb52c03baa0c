// SPDX-License-Identifier: Apache-2.0
#include "vtkBreastCompression.h"

#include "CompressionSimulation.h"
#include "MammographyGeometry.h"
#include "MeshConversion.h"
#include "PhysicsData.h"
#include "PlacedPlates.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

namespace
{
using namespace mammoray;

struct HeldMaterial
{
  ElasticMaterial Elastic;
  bool Held = false;
};

void AddValue(vtkFieldData* data, const char* name, double value)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  data->AddArray(array);
}
}

struct vtkBreastCompression::Internals
{
  std::map<int, HeldMaterial> Given;
  /// What the simulation was made of.
  TetrahedralMesh Mesh;
  std::vector<ElasticMaterial> Elastic;
  std::vector<bool> Held;
  ElementType Element = ElementType::Quadratic;
  std::unique_ptr<CompressionSimulation> Simulation;
  std::optional<CompressionState> State;

  void Prepare(vtkUnstructuredGrid* grid, const std::string& table, ElementType element);
  void Compress(const PlatePair& plates, const ProgressCallback& progress);
};

void vtkBreastCompression::Internals::Prepare(vtkUnstructuredGrid* grid, const std::string& table,
  ElementType element)
{
  TetrahedralMesh mesh = FromGrid(grid);
  mesh.Validate("vtkBreastCompression's input");
  std::vector<HeldMaterial> materials(1);
  std::vector<bool> known(1, true);
  if (!table.empty())
  {
    materials.clear();
    for (const Material& material : FindMaterialTable(table).Materials)
    {
      materials.push_back(
        { { material.YoungsModulusKPa, material.PoissonRatio, material.FungExponent },
          material.Held });
    }
    known.assign(materials.size(), true);
  }
  for (const auto& [index, material] : this->Given)
  {
    const auto size = std::max(materials.size(), static_cast<std::size_t>(index) + 1);
    materials.resize(size);
    known.resize(size, false);
    materials[index] = material;
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
  std::vector<ElasticMaterial> elastic;
  std::vector<bool> held;
  for (const HeldMaterial& material : materials)
  {
    elastic.push_back(material.Elastic);
    held.push_back(material.Held);
  }
  const auto sameElastic = [](const ElasticMaterial& a, const ElasticMaterial& b)
  {
    return a.YoungsModulusKPa == b.YoungsModulusKPa && a.PoissonRatio == b.PoissonRatio &&
      a.FungExponent == b.FungExponent;
  };
  if (this->Simulation && mesh.Points == this->Mesh.Points && mesh.Cells == this->Mesh.Cells &&
    mesh.Materials == this->Mesh.Materials && held == this->Held &&
    element == this->Element &&
    std::equal(elastic.begin(), elastic.end(), this->Elastic.begin(), this->Elastic.end(),
      sameElastic))
  {
    return;
  }
  this->State.reset();
  this->Simulation.reset(); // should this throw, nothing is taken for current
  CompressionOptions options;
  options.Element = element;
  this->Simulation =
    std::make_unique<CompressionSimulation>(mesh, elastic, held, MaterialField(), options);
  this->Element = element;
  this->Mesh = std::move(mesh);
  this->Elastic = std::move(elastic);
  this->Held = std::move(held);
}

void vtkBreastCompression::Internals::Compress(const PlatePair& plates,
  const ProgressCallback& progress)
{
  if (this->State)
  {
    try
    {
      this->State = this->Simulation->Compress(plates, &*this->State, progress);
      return;
    }
    catch (const ConvergenceError&)
    {
      // The way from there was blocked; the one from outside may not be.
    }
  }
  this->State.reset();
  this->State = this->Simulation->Compress(plates, nullptr, progress);
}

vtkStandardNewMacro(vtkBreastCompression);

vtkBreastCompression::vtkBreastCompression()
  : Internal(new Internals)
{
}

vtkBreastCompression::~vtkBreastCompression()
{
  delete this->Internal;
}

void vtkBreastCompression::SetMaterial(int material, double youngsModulusKPa, double poissonRatio,
  bool held, double fungExponent)
{
  if (material < 1 || material > 65535)
  {
    vtkErrorMacro(<< "SetMaterial: expected a material in [1, 65535], found " << material);
    return;
  }
  this->Internal->Given[material] = { { youngsModulusKPa, poissonRatio, fungExponent }, held };
  this->Modified();
}

void vtkBreastCompression::ClearMaterials()
{
  this->Internal->Given.clear();
  this->Modified();
}

int vtkBreastCompression::RequestData(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* input = vtkUnstructuredGrid::GetData(inputs[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  Internals& internal = *this->Internal;
  try
  {
    if (!(this->ThicknessMm > 0) || !(this->EdgeRadiusMm >= 0) || !(this->ForceN >= 0))
    {
      throw InputError(
        "expected a positive ThicknessMm, and an EdgeRadiusMm and a ForceN of at least 0");
    }
    const AnatomicalAxes axes = AnatomicalAxes::FromCode(this->Orientation);
    internal.Prepare(input, this->MaterialTable,
      this->Element == LINEAR ? ElementType::PatchAveragedLinear : ElementType::Quadratic);
    BreastPose pose;
    pose.ThicknessMm = this->ThicknessMm;
    pose.RollDeg = this->RollDeg;
    pose.ShiftLateralMm = this->ShiftLateralMm;
    pose.ShiftAnteriorMm = this->ShiftAnteriorMm;
    pose.ShiftVerticalMm = this->ShiftVerticalMm;
    MammographyUnit unit;
    unit.SupportEdgeMm = this->SupportEdgeMm;
    unit.PaddleEdgeMm = this->PaddleEdgeMm;
    unit.EdgeRadiusMm = this->EdgeRadiusMm;
    const Vector3 anchor = FindPoseAnchor(internal.Mesh, internal.Held, axes);
    const auto platesAt = [&](double thicknessMm)
    {
      pose.ThicknessMm = thicknessMm;
      return PlatesOf(PlaceUnit(axes, anchor, unit, pose), unit, thicknessMm, this->PaddleTiltDeg);
    };
    const ProgressCallback progress = [this](double fraction, const char*)
    {
      this->UpdateProgress(fraction);
      return this->GetAbortExecute() == 0;
    };
    if (this->ForceN > 0)
    {
      const PlatePair plates = platesAt(this->ThicknessMm);
      const PlatePairVelocity closing = PlateMotion(plates, platesAt(0.9 * this->ThicknessMm));
      internal.State.reset();
      internal.State =
        internal.Simulation->CompressToForce(plates, closing, this->ForceN, progress);
    }
    else
    {
      internal.Compress(platesAt(this->ThicknessMm), progress);
    }
    const CompressionState& state = *internal.State;

    const vtkIdType pointCount = input->GetNumberOfPoints();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(pointCount);
    vtkNew<vtkDoubleArray> displacement;
    displacement->SetName("Displacement");
    displacement->SetNumberOfComponents(3);
    displacement->SetNumberOfTuples(pointCount);
    for (vtkIdType p = 0; p < pointCount; ++p)
    {
      const double* to = &state.Positions[3 * p];
      const Vector3 from = internal.Mesh.Point(p);
      points->SetPoint(p, to);
      displacement->SetTuple3(p, to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    }
    vtkNew<vtkDoubleArray> volumeRatio;
    volumeRatio->SetName("J");
    vtkNew<vtkDoubleArray> stress;
    stress->SetName("VonMisesStressKPa");
    for (const CellMeasures& measures : internal.Simulation->MeasuresOf(state))
    {
      volumeRatio->InsertNextValue(measures.J);
      stress->InsertNextValue(measures.VonMisesKPa);
    }
    output->ShallowCopy(input);
    output->SetPoints(points);
    output->GetPointData()->AddArray(displacement);
    output->GetCellData()->AddArray(volumeRatio);
    output->GetCellData()->AddArray(stress);
    vtkFieldData* data = output->GetFieldData();
    AddValue(data, "PaddleForceN", state.PaddleForceN);
    AddValue(data, "SupportForceN", state.SupportForceN);
    AddValue(data, "ThicknessMm", this->ForceN > 0 ? GapMm(state.Plates) : this->ThicknessMm);
    AddValue(data, "LargestPenetrationMm", state.LargestPenetrationMm);
    AddValue(data, "SmallestJ", state.SmallestJ);
    AddValue(data, "VolumeRatio", state.VolumeRatio);
    return 1;
  }
  catch (const Interrupted&)
  {
    output->Initialize();
    return 1;
  }
  catch (const std::exception& error) // bad_alloc must not cross the pipeline either
  {
    output->Initialize();
    vtkErrorMacro(<< error.what());
    return 0;
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
  os << indent << "PaddleTiltDeg: " << this->PaddleTiltDeg << "\n";
  os << indent << "RollDeg: " << this->RollDeg << "\n";
  os << indent << "ShiftLateralMm: " << this->ShiftLateralMm << "\n";
  os << indent << "ShiftAnteriorMm: " << this->ShiftAnteriorMm << "\n";
  os << indent << "ShiftVerticalMm: " << this->ShiftVerticalMm << "\n";
  os << indent << "SupportEdgeMm: " << this->SupportEdgeMm << "\n";
  os << indent << "PaddleEdgeMm: " << this->PaddleEdgeMm << "\n";
  os << indent << "EdgeRadiusMm: " << this->EdgeRadiusMm << "\n";
}
