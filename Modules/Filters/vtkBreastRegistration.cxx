// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkBreastRegistration.h"

#include "Private/FilterRequest.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/ImageConversion.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
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
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

namespace
{
using namespace mammoray;

/// Everything that the model is made from: meshes or labels.
struct RegistrationSetup
{
  std::optional<TetrahedralMesh> Anatomy;
  std::optional<TetrahedralMesh> Coarse;
  /// The image of labels and its time.
  const vtkImageData* Labels = nullptr;
  vtkMTimeType LabelsTime = 0;
  std::string Table;
  AnatomicalAxes Axes;
  std::string Device;

  bool operator==(const RegistrationSetup&) const = default;
};

/// Voxel size to which finer labels are resampled, mm, as in 'mammoray register'.
constexpr double LabelSpacingMm = 0.5;

LabelVolume MaterialsOf(vtkImageData* image, const MaterialTable& table, bool acceptUnusual)
{
  const LabelVolume labels = ToLabelVolume(image);
  if (!acceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, labels.Spacing, "input");
  }
  LabelVolume materials = table.ToMaterials(labels, "input");
  return LabelSpacingMm > *std::max_element(labels.Spacing.begin(), labels.Spacing.end())
    ? ResampleLabels(materials, LabelSpacingMm)
    : materials;
}

vtkSmartPointer<vtkDoubleArray> ToArray(const std::string& name, std::span<const double> values,
  int components = 1)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
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

/// Moves the points of the grid and adds their displacement from `rest`.
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
  output->GetPointData()->AddArray(ToArray("Displacement", displacement, 3));
}

/// Adds the derivatives of the moved points with each estimated parameter, seen from the unit.
void AddSensitivities(vtkUnstructuredGrid* output, const ViewResult& result)
{
  for (std::size_t index = 0; index < result.Parameters.size(); ++index)
  {
    if (!result.Parameters[index].Fixed)
    {
      output->GetPointData()->AddArray(ToArray(
        SensitivityArrayPrefix + result.Parameters[index].Name, result.Sensitivities[index], 3));
    }
  }
}

/// Fixes all parameters except those named.
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

void AddResult(vtkUnstructuredGrid* output, const ViewResult& result)
{
  vtkFieldData* fields = output->GetFieldData();
  std::vector<std::string> names;
  for (const RegistrationParameter& parameter : result.Parameters)
  {
    names.push_back(parameter.Name);
  }
  AddStrings(fields, "ParameterNames", names);
  AddStrings(fields, "StopReason", { result.StopReason });
  fields->AddArray(ToArray("Parameters", result.Values));
  fields->AddArray(ToArray("ParameterDeviations", result.StandardDeviations));
  fields->AddArray(ToArray("Covariance", result.Covariance, static_cast<int>(names.size())));
  AddPlacement(output, result.Placed);
  const std::pair<const char*, double> numbers[] = {
    { "Correlation", result.After.Correlation },
    { "TissueCorrelation", result.After.TissueCorrelation },
    { "MeanOutlineDistanceMm", result.After.MeanOutlineDistanceMm },
    { "LargestOutlineDistanceMm", result.After.LargestOutlineDistanceMm },
    { "PaddleForceN", result.State.PaddleForceN },
    { "Converged", result.Converged ? 1.0 : 0.0 },
  };
  for (const auto& [name, value] : numbers)
  {
    fields->AddArray(ToArray(name, { &value, 1 }));
  }
  AddStrings(fields, "Trust", { NameOf(result.Trust.Level) });
  AddStrings(fields, "TrustReasons", result.Trust.Reasons);
  fields->AddArray(ToArray("ExpectedErrorMm",
    result.Expected ? std::vector{ result.Expected->MedianMm, result.Expected->Most95Mm }
                    : std::vector<double>()));
}
}

struct vtkBreastRegistration::Internals
{
  /// Read when first needed, and kept.
  std::optional<ScatterKernels> Kernels;
  RegistrationSetup Setup;
  /// Made of Setup, without views.
  RegistrationProblem Problem;
  /// Mammogram and Target are those of the image with this pointer and time.
  const vtkImageData* MammogramImage = nullptr;
  vtkMTimeType MammogramTime = 0;
  mammoray::Mammogram Mammogram;
  RegistrationTarget Target;

  /// Throws InputError where the properties of scatter do not fit.
  std::optional<ScatterModel> ScatterOf(const vtkBreastRegistration& filter,
    const mammoray::Spectrum& spectrum);
  void Prepare(vtkImageData* mammogram);
  /// Makes the model if the setup differs from the present one; returns whether it did. `labels` is
  /// read where the setup has no anatomy.
  bool PrepareModel(RegistrationSetup setup, vtkImageData* labels,
    const mammoray::MaterialTable& materials, const Beam& beam, bool acceptUnusual,
    const ProgressCallback& progress);
};

std::optional<ScatterModel> vtkBreastRegistration::Internals::ScatterOf(
  const vtkBreastRegistration& filter, const mammoray::Spectrum& spectrum)
{
  const double* numbers = filter.Grid;
  if (!filter.Scatter)
  {
    if (numbers[0] != 0)
    {
      throw InputError("Grid: expected Scatter beside it, found none");
    }
    return std::nullopt;
  }
  std::optional<AntiscatterGrid> grid;
  if (numbers[0] != 0)
  {
    grid.emplace(AntiscatterGridOptions::OfLead({ numbers[0], numbers[1], numbers[2] }));
  }
  if (!this->Kernels)
  {
    this->Kernels = FindScatterKernels();
  }
  return ScatterModel(*this->Kernels, spectrum, DetectorResponse::EnergyIntegrating,
    filter.AirGapMm, grid);
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

bool vtkBreastRegistration::Internals::PrepareModel(RegistrationSetup setup, vtkImageData* labels,
  const mammoray::MaterialTable& materials, const Beam& beam, bool acceptUnusual,
  const ProgressCallback& progress)
{
  if (this->Problem.Model && this->Setup == setup)
  {
    return false;
  }
  this->Problem = {};
  BreastInput breast{ .Materials = materials,
    .Axes = setup.Axes,
    .Anatomy = setup.Anatomy,
    .Mechanics = { .SimulationMesh = setup.Coarse, .Predicted = true },
    .Projector = MakeProjector({ .Device = setup.Device }),
    .XRays = beam };
  if (!setup.Anatomy)
  {
    breast.Labels = MaterialsOf(labels, materials, acceptUnusual);
  }
  this->Problem = MakeProblem(std::move(breast), progress);
  this->Setup = std::move(setup);
  return true;
}

vtkStandardNewMacro(vtkBreastRegistration);

vtkBreastRegistration::vtkBreastRegistration()
  : AnteriorMm(DefaultStart().AnteriorMm)
  , EdgeRadiusMm(SearchedEdgeRadiusMm)
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

mammorayCxxSetTextMacro(vtkBreastRegistration, MaterialTable);
mammorayCxxSetTextMacro(vtkBreastRegistration, MaterialTableFile);
mammorayCxxSetTextMacro(vtkBreastRegistration, Spectrum);
mammorayCxxSetTextMacro(vtkBreastRegistration, SpectrumFile);
mammorayCxxSetTextMacro(vtkBreastRegistration, Orientation);
mammorayCxxSetTextMacro(vtkBreastRegistration, FreeParameters);
mammorayCxxSetTextMacro(vtkBreastRegistration, DeviceName);

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
  RequestWholeExtent(inputs[0]->GetInformationObject(0));
  RequestWholeExtent(inputs[1]->GetInformationObject(0));
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
    std::optional<ScatterModel> scatter = internal.ScatterOf(*this, spectrum);
    const std::string& table = FileOrName(this->MaterialTableFile, this->MaterialTable);
    if (table.empty())
    {
      throw InputError("expected a MaterialTable, found none");
    }
    internal.Prepare(vtkImageData::GetData(inputs[1]));
    BreastPose start = DefaultStart();
    start.ThicknessMm = this->ThicknessMm > 0
      ? this->ThicknessMm
      : internal.Mammogram.BodyPartThicknessMm.value_or(start.ThicknessMm);
    start.RollDeg = NominalRollDeg(internal.Mammogram).value_or(0) + this->RollDeg;
    start.AnteriorMm = this->AnteriorMm;
    View view;
    view.Parameters = DefaultParameters(start);
    Free(this->FreeParameters, view.Parameters);
    RegistrationOptions options;
    options.PixelSizesMm = { this->PixelSizesMm[0], this->PixelSizesMm[1] };
    options.MaximumIterations = this->MaximumIterations;
    view.Unit.SourceToDetectorMm = this->SourceToDetectorMm > 0
      ? this->SourceToDetectorMm
      : internal.Mammogram.SourceToDetectorMm.value_or(view.Unit.SourceToDetectorMm);
    view.Unit.EdgeRadiusMm = this->EdgeRadiusMm;
    // Pixels of images in a pipeline may be binned to any size.
    if (!this->AcceptUnusual)
    {
      CheckValidRange(ValidRanges::Thickness, start.ThicknessMm, "ThicknessMm");
      CheckValidRange(ValidRanges::SourceDistance, view.Unit.SourceToDetectorMm,
        "SourceToDetectorMm");
    }
    view.Target = internal.Target;
    view.Levels = MakeLevels(view.Target, options.PixelSizesMm);

    const mammoray::MaterialTable materials = FindMaterialTable(table);
    RegistrationSetup setup{ .Table = table, .Axes = axes, .Device = this->DeviceName };
    vtkSmartPointer<vtkUnstructuredGrid> grid = vtkUnstructuredGrid::GetData(inputs[0]);
    vtkImageData* labels = vtkImageData::GetData(inputs[0]);
    if (grid)
    {
      std::vector<std::string> names;
      setup.Anatomy = FromGrid(grid, &names);
      materials.FitMesh(*setup.Anatomy, names, "vtkBreastRegistration's input");
      setup.Anatomy->Validate("vtkBreastRegistration's input");
    }
    else
    {
      setup.Labels = labels;
      setup.LabelsTime = labels->GetMTime();
    }
    if (vtkUnstructuredGrid* coarse = vtkUnstructuredGrid::GetData(inputs[2]))
    {
      setup.Coarse = FromGrid(coarse);
    }
    Beam beam = MakeBeam(materials, spectrum, DetectorResponse::EnergyIntegrating);
    RegistrationProblem& problem = internal.Problem;
    if (internal.PrepareModel(std::move(setup), labels, materials, beam, this->AcceptUnusual,
          progress))
    {
      ++this->NumberOfSetups;
    }
    problem.Model->SetBeam(std::move(beam));
    problem.Model->SetScatter(std::move(scatter));
    problem.Options = options;
    problem.Views = { std::move(view) };
    const RegistrationResult found = mammoray::Register(problem, progress);
    const ViewResult& result = found.Views.front();
    const TetrahedralMesh& anatomy = problem.Model->Anatomy();
    if (!grid)
    {
      grid = ToGrid(anatomy, materials.Names());
    }
    AddDisplaced(output, grid, result.Points, anatomy.Points);
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
