// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkBreastRegistration.h"

#include "Private/FilterRequest.h"
#include "Private/ScatterProperties.h"
#include "mammoray/Filters/vtkBreastMesher.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/ImageConversion.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/TargetPreparation.h"
#include "mammoray/Registration/UnitPlacement.h"
#include "mammoray/Study/RegisteredBreast.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

namespace
{
using namespace mammoray;

/// What meshes, simulation and what is on the device are made of.
struct RegistrationSetup
{
  TetrahedralMesh Anatomy;
  std::optional<TetrahedralMesh> Coarse;
  std::string Table;
  std::string Device;

  bool operator==(const RegistrationSetup&) const = default;
};

/// A breast ready to be registered.
struct PreparedBreast
{
  PreparedBreast(RegistrationSetup setup, const mammoray::Spectrum& spectrum,
    const ProgressCallback& progress)
    : Made(std::move(setup))
    , Table(FindMaterialTable(this->Made.Table))
    , Model(this->Made.Anatomy, this->Table,
        { .SimulationMesh = this->Made.Coarse, .Predicted = true }, progress)
  {
    this->Model.SetXRays(ExtractInterfaces(this->Made.Anatomy),
      MakeProjector({ .Device = this->Made.Device }), this->BeamOf(spectrum));
  }

  Beam BeamOf(const mammoray::Spectrum& spectrum) const
  {
    return MakeBeam(this->Table, spectrum, DetectorResponse::EnergyIntegrating);
  }

  RegistrationSetup Made;
  MaterialTable Table;
  BreastModel Model;
};

void AddDoubles(vtkFieldData* fields, const char* name, const std::vector<double>& values,
  int components = 1)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  fields->AddArray(array);
}

void AddStrings(vtkFieldData* fields, const char* name, const std::vector<std::string>& values)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& value : values)
  {
    array->InsertNextValue(value);
  }
  fields->AddArray(array);
}

void AddVectors(vtkUnstructuredGrid* grid, const std::string& name, std::span<const double> values)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size() / 3));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  grid->GetPointData()->AddArray(array);
}

/// The grid with its points moved, and how far from where they were at rest.
void AddDisplaced(vtkUnstructuredGrid* output, vtkUnstructuredGrid* grid,
  const std::vector<double>& points, const std::vector<double>& rest)
{
  output->ShallowCopy(grid);
  vtkNew<vtkPoints> moved;
  moved->SetDataTypeToDouble();
  moved->SetNumberOfPoints(grid->GetNumberOfPoints());
  std::vector<double> displacement(points.size());
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    displacement[index] = points[index] - rest[index];
  }
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    moved->SetPoint(id, &points[3 * static_cast<std::size_t>(id)]);
  }
  output->SetPoints(moved);
  AddVectors(output, "Displacement", displacement);
}

/// How the moved points change with each parameter that was found, seen from the unit.
void AddSensitivities(vtkUnstructuredGrid* output, const RegistrationResult& result)
{
  for (std::size_t index = 0; index < result.Parameters.size(); ++index)
  {
    if (!result.Parameters[index].Fixed)
    {
      AddVectors(output, SensitivityArrayPrefix + result.Parameters[index].Name,
        result.Sensitivities[index]);
    }
  }
}

/// Fixes all parameters but those named.
void Free(const std::string& names, std::vector<RegistrationParameter>& parameters)
{
  for (RegistrationParameter& parameter : parameters)
  {
    parameter.Fixed = true;
  }
  std::istringstream words(names);
  for (std::string name; words >> name;)
  {
    parameters[FindPoseParameter(name).Index].Fixed = false;
  }
}

void AddResult(vtkUnstructuredGrid* output, const RegistrationResult& result)
{
  vtkFieldData* fields = output->GetFieldData();
  std::vector<std::string> names;
  for (const RegistrationParameter& parameter : result.Parameters)
  {
    names.push_back(parameter.Name);
  }
  AddStrings(fields, "ParameterNames", names);
  AddStrings(fields, "StopReason", { result.StopReason });
  AddDoubles(fields, "Parameters", result.Values);
  AddDoubles(fields, "ParameterDeviations", result.StandardDeviations);
  AddDoubles(fields, "Covariance", result.Covariance, static_cast<int>(names.size()));
  AddPlacement(output, result.Placed);
  AddDoubles(fields, "Correlation", { result.After.Correlation });
  AddDoubles(fields, "TissueCorrelation", { result.After.TissueCorrelation });
  AddDoubles(fields, "MeanOutlineDistanceMm", { result.After.MeanOutlineDistanceMm });
  AddDoubles(fields, "LargestOutlineDistanceMm", { result.After.LargestOutlineDistanceMm });
  AddDoubles(fields, "PaddleForceN", { result.State.PaddleForceN });
  AddDoubles(fields, "Converged", { result.Converged ? 1.0 : 0.0 });
  AddStrings(fields, "Trust", { NameOf(result.Trust.Level) });
  AddStrings(fields, "TrustReasons", result.Trust.Reasons);
  AddDoubles(fields, "ExpectedErrorMm",
    result.Expected ? std::vector{ result.Expected->MedianMm, result.Expected->Most95Mm }
                    : std::vector<double>());
}
}

struct vtkBreastRegistration::Internals
{
  ScatterProperties Secondary;
  /// Of labels at input 0.
  vtkNew<vtkBreastMesher> Mesher;
  vtkImageData* Labels = nullptr;
  std::unique_ptr<PreparedBreast> Breast;
  /// Of the image with this pointer and time.
  const vtkImageData* MammogramImage = nullptr;
  vtkMTimeType MammogramTime = 0;
  mammoray::Mammogram Mammogram;
  RegistrationTarget Target;

  vtkSmartPointer<vtkUnstructuredGrid> MeshLabels(vtkImageData* labels, const std::string& table);
  void Prepare(vtkImageData* mammogram);
};

/// The mesher does nothing while labels and table stay as they are.
vtkSmartPointer<vtkUnstructuredGrid> vtkBreastRegistration::Internals::MeshLabels(
  vtkImageData* labels, const std::string& table)
{
  if (this->Labels != labels)
  {
    this->Mesher->SetInputDataObject(labels);
    this->Labels = labels;
  }
  if (table != this->Mesher->GetMaterialTable())
  {
    this->Mesher->SetMaterialTable(table.c_str());
  }
  this->Mesher->Update();
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->ShallowCopy(this->Mesher->GetOutput());
  if (grid->GetNumberOfCells() == 0)
  {
    throw InputError("the labels could not be meshed");
  }
  return grid;
}

void vtkBreastRegistration::Internals::Prepare(vtkImageData* mammogram)
{
  if (this->MammogramImage == mammogram && this->MammogramTime == mammogram->GetMTime())
  {
    return;
  }
  this->MammogramImage = nullptr; // should this throw, nothing is taken for current
  this->Mammogram = ToMammogram(mammogram);
  this->Target = PrepareTarget(this->Mammogram);
  this->MammogramImage = mammogram;
  this->MammogramTime = mammogram->GetMTime();
}

vtkStandardNewMacro(vtkBreastRegistration);

vtkBreastRegistration::vtkBreastRegistration()
  : EdgeRadiusMm(SearchedEdgeRadiusMm)
  , Internal(new Internals)
{
  this->SetNumberOfInputPorts(3);
  for (const std::string& name : FreePoseParameterNames())
  {
    this->FreeParameters += (this->FreeParameters.empty() ? "" : " ") + name;
  }
}

vtkBreastRegistration::~vtkBreastRegistration()
{
  delete this->Internal;
}

void vtkBreastRegistration::SetMaterialTable(const char* pathOrName)
{
  SetProperty(this, this->MaterialTable, std::string(pathOrName ? pathOrName : ""));
}

void vtkBreastRegistration::SetMaterialTableFile(const char* path)
{
  SetProperty(this, this->MaterialTableFile, std::string(path ? path : ""));
}

void vtkBreastRegistration::SetSpectrum(const char* pathOrName)
{
  SetProperty(this, this->Spectrum, std::string(pathOrName ? pathOrName : ""));
}

void vtkBreastRegistration::SetSpectrumFile(const char* path)
{
  SetProperty(this, this->SpectrumFile, std::string(path ? path : ""));
}

void vtkBreastRegistration::SetOrientation(const char* axes)
{
  SetProperty(this, this->Orientation, std::string(axes ? axes : ""));
}

void vtkBreastRegistration::SetFreeParameters(const char* names)
{
  SetProperty(this, this->FreeParameters, std::string(names ? names : ""));
}

void vtkBreastRegistration::SetDeviceName(const char* name)
{
  SetProperty(this, this->DeviceName, std::string(name ? name : ""));
}

void vtkBreastRegistration::SetMammogramConnection(vtkAlgorithmOutput* mammogram)
{
  this->SetInputConnection(1, mammogram);
}

void vtkBreastRegistration::SetSimulationMeshConnection(vtkAlgorithmOutput* mesh)
{
  this->SetInputConnection(2, mesh);
}

int vtkBreastRegistration::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    return 1;
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  if (port == 0)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  }
  else
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkBreastRegistration::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector*)
{
  for (int port = 0; port < 2; ++port)
  {
    vtkInformation* input = inputs[port]->GetInformationObject(0);
    if (input->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
    {
      int whole[6];
      input->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
      input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), whole, 6);
    }
  }
  return 1;
}

int vtkBreastRegistration::RequestData(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  Internals& internal = *this->Internal;
  const auto work = [&]
  {
    const ProgressCallback progress = ProgressOf(this);
    // Everything that can be refused comes before anything is computed.
    const AnatomicalAxes axes = AnatomicalAxes::FromCode(this->Orientation);
    const mammoray::Spectrum spectrum =
      FindSpectrum(FileOrName(this->SpectrumFile, this->Spectrum));
    std::optional<ScatterModel> scatter = internal.Secondary.ModelOf(this->Scatter, this->AirGapMm,
      { this->Grid[0], this->Grid[1], this->Grid[2] }, spectrum,
      DetectorResponse::EnergyIntegrating);
    const std::string& table = FileOrName(this->MaterialTableFile, this->MaterialTable);
    if (table.empty())
    {
      throw InputError("expected a MaterialTable, found none");
    }
    internal.Prepare(vtkImageData::GetData(inputs[1]));
    BreastPose start;
    start.ThicknessMm = this->ThicknessMm > 0
      ? this->ThicknessMm
      : internal.Mammogram.BodyPartThicknessMm.value_or(start.ThicknessMm);
    // Pixels of images in a pipeline may be binned to any size.
    if (!this->AcceptUnusual)
    {
      CheckValidRange(ValidRanges::Thickness, start.ThicknessMm, "ThicknessMm");
    }
    start.RollDeg = NominalRollDeg(internal.Mammogram).value_or(0) + this->RollDeg;
    start.AnteriorMm = this->AnteriorMm;
    RegistrationOptions options;
    options.Parameters = DefaultParameters(start);
    Free(this->FreeParameters, options.Parameters);
    options.PixelSizesMm = { this->PixelSizesMm[0], this->PixelSizesMm[1] };
    options.MaximumIterations = this->MaximumIterations;

    vtkSmartPointer<vtkUnstructuredGrid> grid = vtkUnstructuredGrid::GetData(inputs[0]);
    if (!grid)
    {
      internal.Mesher->SetAcceptUnusual(this->AcceptUnusual);
      grid = internal.MeshLabels(vtkImageData::GetData(inputs[0]), table);
    }
    RegistrationSetup setup{ FromGrid(grid), {}, table, this->DeviceName };
    setup.Anatomy.Validate("vtkBreastRegistration's input");
    if (vtkUnstructuredGrid* coarse = vtkUnstructuredGrid::GetData(inputs[2]))
    {
      setup.Coarse = FromGrid(coarse);
    }
    if (!internal.Breast || !(internal.Breast->Made == setup))
    {
      internal.Breast.reset();
      internal.Breast = std::make_unique<PreparedBreast>(std::move(setup), spectrum, progress);
      ++this->NumberOfSetups;
    }
    PreparedBreast& breast = *internal.Breast;
    BreastModel& model = breast.Model;
    model.SetBeam(breast.BeamOf(spectrum));
    model.SetScatter(std::move(scatter));
    UnitPlacement placement{ axes, FindPoseAnchor(breast.Made.Anatomy, breast.Table.Fixed(), axes),
      {} };
    placement.Unit.SourceToDetectorMm = this->SourceToDetectorMm > 0
      ? this->SourceToDetectorMm
      : internal.Mammogram.SourceToDetectorMm.value_or(placement.Unit.SourceToDetectorMm);
    placement.Unit.EdgeRadiusMm = this->EdgeRadiusMm;
    if (!this->AcceptUnusual)
    {
      CheckValidRange(ValidRanges::SourceDistance, placement.Unit.SourceToDetectorMm,
        "SourceToDetectorMm");
    }
    const RegistrationResult result =
      mammoray::Register(model, placement, internal.Target, options, progress);

    AddDisplaced(output, grid, result.Points, breast.Made.Anatomy.Points);
    AddSensitivities(output, result);
    AddResult(output, result);
  };
  return AnswerRequest(this, output, work);
}

void vtkBreastRegistration::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialTable: " << this->MaterialTable << "\n";
  os << indent << "MaterialTableFile: " << this->MaterialTableFile << "\n";
  os << indent << "Spectrum: " << this->Spectrum << "\n";
  os << indent << "SpectrumFile: " << this->SpectrumFile << "\n";
  os << indent << "Scatter: " << this->Scatter << "\n";
  os << indent << "AirGapMm: " << this->AirGapMm << "\n";
  os << indent << "Grid: " << this->Grid[0] << " " << this->Grid[1] << " " << this->Grid[2] << "\n";
  os << indent << "Orientation: " << this->Orientation << "\n";
  os << indent << "FreeParameters: " << this->FreeParameters << "\n";
  os << indent << "ThicknessMm: " << this->ThicknessMm << "\n";
  os << indent << "RollDeg: " << this->RollDeg << "\n";
  os << indent << "AnteriorMm: " << this->AnteriorMm << "\n";
  os << indent << "SourceToDetectorMm: " << this->SourceToDetectorMm << "\n";
  os << indent << "EdgeRadiusMm: " << this->EdgeRadiusMm << "\n";
  os << indent << "PixelSizesMm: " << this->PixelSizesMm[0] << " " << this->PixelSizesMm[1] << "\n";
  os << indent << "MaximumIterations: " << this->MaximumIterations << "\n";
  os << indent << "DeviceName: " << this->DeviceName << "\n";
  os << indent << "NumberOfSetups: " << this->NumberOfSetups << "\n";
  os << indent << "AcceptUnusual: " << this->AcceptUnusual << "\n";
}
