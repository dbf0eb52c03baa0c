// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkXRayProjector.h"

#include "Private/FilterRequest.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/Shadow.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

namespace
{
using namespace mammoray;

mammoray::Vector3 ToVector(const double (&values)[3])
{
  return { values[0], values[1], values[2] };
}

/// Throws InputError unless both are of length 1 and at right angles.
void CheckDirections(const Vector3& column, const Vector3& row)
{
  // 1e-6: directions computed in float.
  if (!(std::abs(Norm(column) - 1) < 1e-6 && std::abs(Norm(row) - 1) < 1e-6 &&
        std::abs(Dot(column, row)) < 1e-6))
  {
    throw InputError(
      "detector: expected ColumnDirection and RowDirection to be unit vectors at right angles");
  }
}

/// What the interfaces of a grid depend on besides its points.
struct TopologyStamp
{
  explicit TopologyStamp(vtkUnstructuredGrid* grid = nullptr)
  {
    if (grid)
    {
      vtkDataArray* materials = grid->GetCellData()->GetArray(MaterialArrayName);
      this->Cells = grid->GetCells();
      this->Materials = materials;
      this->CellsTime = grid->GetCells() ? grid->GetCells()->GetMTime() : 0;
      this->MaterialsTime = materials ? materials->GetMTime() : 0;
      this->Points = grid->GetNumberOfPoints();
    }
  }
  bool operator==(const TopologyStamp&) const = default;

  const void* Cells = nullptr;
  const void* Materials = nullptr;
  vtkMTimeType CellsTime = 0;
  vtkMTimeType MaterialsTime = 0;
  vtkIdType Points = 0;
};
}

struct vtkXRayProjector::Internals
{
  struct Attenuation
  {
    std::string Table; ///< Empty: MuPerMm at all energies.
    double DensityGPerCm3 = 1.0;
    double MuPerMm = 0.0;
    bool operator==(const Attenuation&) const = default;
  };

  mammoray::Spectrum Photons = mammoray::Spectrum::Monochromatic(20);
  /// By index of the material.
  std::map<int, Attenuation> Attenuations;
  std::shared_ptr<const ScatterKernels> Kernels;
  std::unique_ptr<Exposer> Device;
  ProjectorOptions Options;
  vtkIdType TracesOfOthers = 0;

  /// Of the last input.
  std::shared_ptr<const SurfaceMesh> Surface;
  std::vector<std::string> MaterialNames;
  std::vector<std::int32_t> PointIds;
  TopologyStamp Topology;

  void SetPhotons(vtkXRayProjector* filter, mammoray::Spectrum photons)
  {
    SetProperty(filter, this->Photons, std::move(photons));
  }
  Exposer& Open(const ProjectorOptions& options);
  void SetSurface(vtkDataObject* input);
  void SetMaterials(const std::string& table, Scene& scene) const;
};

Exposer& vtkXRayProjector::Internals::Open(const ProjectorOptions& options)
{
  if (!this->Device || this->Options.Device != options.Device ||
    this->Options.Projection != options.Projection)
  {
    this->TracesOfOthers +=
      this->Device ? static_cast<vtkIdType>(this->Device->NumberOfTraces()) : 0;
    this->Device = std::make_unique<Exposer>(options);
    this->Options = options;
  }
  return *this->Device;
}

/// Extracts interfaces only where cells or their materials are others than at the last update.
void vtkXRayProjector::Internals::SetSurface(vtkDataObject* input)
{
  if (auto* polyData = vtkPolyData::SafeDownCast(input))
  {
    this->Topology = TopologyStamp();
    this->Surface =
      std::make_shared<const SurfaceMesh>(FromPolyData(polyData, &this->MaterialNames));
    return;
  }
  auto* grid = vtkUnstructuredGrid::SafeDownCast(input);
  const TopologyStamp topology(grid);
  if (!(topology == this->Topology) || !this->Surface)
  {
    this->Topology = TopologyStamp();
    this->Surface = std::make_shared<const SurfaceMesh>(
      ExtractInterfaces(FromGrid(grid, &this->MaterialNames), &this->PointIds));
    this->Topology = topology;
    return;
  }
  std::vector<double> points(this->Surface->Points.size());
  for (std::size_t point = 0; point < this->PointIds.size(); ++point)
  {
    grid->GetPoint(this->PointIds[point], &points[3 * point]);
  }
  if (points != this->Surface->Points)
  {
    auto moved = std::make_shared<SurfaceMesh>(*this->Surface);
    moved->Points = std::move(points);
    this->Surface = std::move(moved);
  }
}

/// Takes materials that were set one by one, and the others from the table: by name where the input
/// names them, else by index.
void vtkXRayProjector::Internals::SetMaterials(const std::string& table, Scene& scene) const
{
  const mammoray::MaterialTable known =
    table.empty() ? mammoray::MaterialTable() : FindMaterialTable(table);
  const auto count = static_cast<std::size_t>(this->Surface->NumberOfMaterials());
  scene.Materials.Materials.resize(count);
  scene.Attenuations.resize(count);
  for (std::size_t index = 1; index < count; ++index)
  {
    Material& material = scene.Materials.Materials[index];
    const bool isNamed = index < this->MaterialNames.size() && !this->MaterialNames[index].empty();
    const auto own = this->Attenuations.find(static_cast<int>(index));
    const std::size_t inTable = own == this->Attenuations.end() && isNamed && !table.empty()
      ? static_cast<std::size_t>(known.IndexOf(this->MaterialNames[index]))
      : index;
    if (own != this->Attenuations.end())
    {
      material.Attenuation = own->second.Table;
      material.DensityGPerCm3 = own->second.DensityGPerCm3;
    }
    else if (inTable < known.Materials.size())
    {
      material = known.Materials[inTable];
    }
    material.Name = isNamed ? this->MaterialNames[index] : std::to_string(index);
    if (!material.Attenuation.empty())
    {
      scene.Attenuations[index] = FindAttenuation(material);
      material.DensityGPerCm3 = scene.Attenuations[index].DensityOf(material.DensityGPerCm3);
    }
    else if (own != this->Attenuations.end())
    {
      const std::vector<double>& energies = scene.XRays.EnergiesKeV;
      scene.Attenuations[index] = { material.Name, 1.0, energies,
        std::vector<double>(energies.size(), own->second.MuPerMm) };
    }
  }
}

vtkStandardNewMacro(vtkXRayProjector);

vtkXRayProjector::vtkXRayProjector()
  : Internal(new Internals)
{
  this->SetNumberOfInputPorts(1);
}

vtkXRayProjector::~vtkXRayProjector()
{
  delete this->Internal;
}

mammorayCxxSetTextMacro(vtkXRayProjector, SceneFile);
mammorayCxxSetTextMacro(vtkXRayProjector, DeviceName);
mammorayCxxSetTextMacro(vtkXRayProjector, MaterialTable);
mammorayCxxSetTextMacro(vtkXRayProjector, MaterialTableFile);
mammorayCxxSetTextMacro(vtkXRayProjector, Spectrum);
mammorayCxxSetTextMacro(vtkXRayProjector, SpectrumFile);

void vtkXRayProjector::SetMonochromatic(double energyKeV)
{
  mammoray::Spectrum line;
  line.EnergiesKeV = { energyKeV };
  line.Weights = { 1.0 };
  this->Internal->SetPhotons(this, std::move(line));
}

void vtkXRayProjector::ClearSpectrum()
{
  this->Internal->SetPhotons(this, {});
}

void vtkXRayProjector::AddSpectrumLine(double energyKeV, double photons)
{
  this->Internal->Photons.EnergiesKeV.push_back(energyKeV);
  this->Internal->Photons.Weights.push_back(photons);
  this->Modified();
}

void vtkXRayProjector::SetAttenuationTable(int material, const std::string& table,
  double densityGPerCm3)
{
  auto attenuations = this->Internal->Attenuations;
  attenuations[material] = { table, densityGPerCm3, 0.0 };
  SetProperty(this, this->Internal->Attenuations, std::move(attenuations));
}

void vtkXRayProjector::SetLinearAttenuation(int material, double muPerMm)
{
  auto attenuations = this->Internal->Attenuations;
  attenuations[material] = { "", 1.0, muPerMm };
  SetProperty(this, this->Internal->Attenuations, std::move(attenuations));
}

void vtkXRayProjector::ClearAttenuation()
{
  SetProperty(this, this->Internal->Attenuations, {});
}

int vtkXRayProjector::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkXRayProjector::RequestInformation(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  XRayDetector detector{ ToVector(this->DetectorOrigin), ToVector(this->ColumnDirection),
    ToVector(this->RowDirection), this->DetectorSize[0], this->DetectorSize[1] };
  double spacing[3] = { this->PixelSpacing[0], this->PixelSpacing[1], 1.0 };
  if (!this->SceneFile.empty())
  {
    try
    {
      const SceneDescription scene = ReadScene(this->SceneFile);
      detector = scene.Fixed.Detector;
      spacing[0] = spacing[1] = scene.PixelSpacingMm;
    }
    catch (const std::exception&)
    {
      // RequestData raises it.
    }
  }
  vtkInformation* info = outputs->GetInformationObject(0);
  const int extent[6] = { 0, detector.Columns - 1, 0, detector.Rows - 1, 0, 0 };
  const Vector3& u = detector.ColumnStep;
  const Vector3& v = detector.RowStep;
  const Vector3 n = Cross(u, v);
  const double direction[9] = { u[0], v[0], n[0], u[1], v[1], n[1], u[2], v[2], n[2] };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  info->Set(vtkDataObject::ORIGIN(), detector.Origin.data(), 3);
  info->Set(vtkDataObject::DIRECTION(), direction, 9);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  return 1;
}

int vtkXRayProjector::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
  vtkInformationVector*)
{
  return 1; // the whole mesh, which has no extent
}

void vtkXRayProjector::PlaceBeam(vtkDataObject* input, Scene& scene) const
{
  if (!(this->PixelSpacing[0] > 0 && this->PixelSpacing[1] > 0))
  {
    throw InputError("detector: expected a positive PixelSpacing");
  }
  XRaySource& source = scene.Source;
  XRayDetector& detector = scene.Detector;
  if (this->PlacedByInput)
  {
    const std::optional<VolumeFromGantry> placed = FindPlacement(input);
    if (!placed || !(this->SourceToDetectorMm > 0))
    {
      throw InputError("PlacedByInput: expected a positive SourceToDetectorMm and an input with "
                       "the field array 'Placement', as vtkBreastCompression gives it");
    }
    CheckDirections(placed->Y, placed->X);
    detector = DetectorOfUnit(*placed, this->DetectorSize[0], this->DetectorSize[1],
      { this->PixelSpacing[0], this->PixelSpacing[1] });
    source.Position = placed->Point({ 0, 0, this->SourceToDetectorMm });
  }
  else
  {
    const Vector3 u = ToVector(this->ColumnDirection);
    const Vector3 v = ToVector(this->RowDirection);
    CheckDirections(u, v);
    detector = { ToVector(this->DetectorOrigin), this->PixelSpacing[0] * u,
      this->PixelSpacing[1] * v, this->DetectorSize[0], this->DetectorSize[1] };
    source.Type = this->ParallelBeam ? XRaySource::Kind::Parallel : XRaySource::Kind::Point;
    source.Position = ToVector(this->SourcePosition);
    source.Direction = ToVector(this->BeamDirection);
  }
  detector.Samples = this->Samples;
}

int vtkXRayProjector::RequestData(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector* outputs)
{
  this->NumberOfInconsistentPixels = 0;
  vtkImageData* output = vtkImageData::GetData(outputs);
  return AnswerRequest(this, output,
    [&]()
    {
      this->Project(vtkDataObject::GetData(inputs[0]), output);
      if (this->PlacedByInput && this->SceneFile.empty())
      {
        // Not known before the input was.
        vtkInformation* info = outputs->GetInformationObject(0);
        info->Set(vtkDataObject::ORIGIN(), output->GetOrigin(), 3);
        info->Set(vtkDataObject::DIRECTION(), output->GetDirectionMatrix()->GetData(), 9);
      }
    });
}

void vtkXRayProjector::DescribeDetection(Scene& scene) const
{
  scene.Response =
    this->PhotonCounting ? DetectorResponse::PhotonCounting : DetectorResponse::EnergyIntegrating;
  scene.Detection.PhotonsPerPixel = this->PhotonsPerPixel;
  scene.Detection.Seed = static_cast<std::uint64_t>(this->NoiseSeed);
  if (this->Scatter)
  {
    std::shared_ptr<const ScatterKernels>& kernels = this->Internal->Kernels;
    if (!kernels)
    {
      kernels = std::make_shared<const ScatterKernels>(FindScatterKernels());
    }
    scene.Scatter.Method = SceneScatter::Model::Kernels;
    scene.Scatter.Kernels = kernels;
    scene.Scatter.AirGapMm = this->AirGapMm;
  }
  if (this->Grid[0] != 0)
  {
    scene.Scatter.Grid = AntiscatterGridOptions::OfLead(ToVector(this->Grid));
  }
  if (this->Refraction != NO_REFRACTION)
  {
    scene.Refraction = this->Refraction == GEOMETRIC ? RefractionOptions::Law::Geometric
                                                     : RefractionOptions::Law::NearField;
    scene.BendDistanceMm = this->BendDistanceMm;
  }
}

Scene vtkXRayProjector::Describe(vtkDataObject* input)
{
  Internals& internal = *this->Internal;
  if (!this->SceneFile.empty())
  {
    Scene scene = LoadScene(this->SceneFile);
    // The names are the scene's then, so that those of an input are read again afterwards.
    internal.Topology = TopologyStamp();
    internal.MaterialNames = scene.Materials.Names();
    return scene;
  }
  if (!input)
  {
    throw InputError("expected an input or a SceneFile, found neither");
  }
  Scene scene;
  this->PlaceBeam(input, scene);
  this->DescribeDetection(scene);
  internal.SetSurface(input);
  const std::string& spectrum = FileOrName(this->SpectrumFile, this->Spectrum);
  scene.XRays = spectrum.empty() ? internal.Photons : FindSpectrum(spectrum);
  internal.SetMaterials(FileOrName(this->MaterialTableFile, this->MaterialTable), scene);
  scene.Samples = { { internal.Surface } };
  return scene;
}

void vtkXRayProjector::Project(vtkDataObject* input, vtkImageData* output)
{
  Internals& internal = *this->Internal;
  const Scene scene = this->Describe(input);
  ReportProgress(ProgressOf(this), 0.4, "projecting");
  Exposer& exposer =
    internal.Open({ .Projection = static_cast<ProjectorOptions::Method>(this->ProjectionMethod),
      .Device = this->DeviceName });
  const Exposure exposure = exposer.Expose(scene, ProgressOf(this, 0.4, 0.8));
  this->NumberOfTraces = internal.TracesOfOthers + static_cast<vtkIdType>(exposer.NumberOfTraces());
  this->UpdateProgress(0.8);
  output->ShallowCopy(ToImage(exposure, scene.Detector, internal.MaterialNames));
  if (!exposure.Deflection.empty())
  {
    output->GetPointData()->AddArray(
      ToDeflectionImage(exposure, scene.Detector)->GetPointData()->GetArray("Deflection"));
  }
  this->NumberOfInconsistentPixels =
    static_cast<vtkIdType>(exposure.Lengths->NumberOfInconsistentRays());
  if (this->NumberOfInconsistentPixels > 0)
  {
    vtkWarningMacro(<< exposure.Lengths->InconsistencyWarning());
  }
  else if (const std::string warning = ShadowWarning(scene, exposure); !warning.empty())
  {
    vtkWarningMacro(<< warning);
  }
}

void vtkXRayProjector::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&](const char* name, const auto& value)
  {
    os << indent << name << ":";
    if constexpr (requires { std::begin(value); })
    {
      std::for_each(std::begin(value), std::end(value),
        [&](const auto& each) { os << " " << each; });
    }
    else
    {
      os << " " << value;
    }
    os << "\n";
  };
  print("SceneFile", this->SceneFile.c_str());
  print("PlacedByInput", this->PlacedByInput);
  print("SourceToDetectorMm", this->SourceToDetectorMm);
  print("SourcePosition", this->SourcePosition);
  print("ParallelBeam", this->ParallelBeam);
  print("BeamDirection", this->BeamDirection);
  print("DetectorOrigin", this->DetectorOrigin);
  print("ColumnDirection", this->ColumnDirection);
  print("RowDirection", this->RowDirection);
  print("PixelSpacing", this->PixelSpacing);
  print("DetectorSize", this->DetectorSize);
  print("Samples", this->Samples);
  print("PhotonCounting", this->PhotonCounting);
  print("PhotonsPerPixel", this->PhotonsPerPixel);
  print("NoiseSeed", this->NoiseSeed);
  print("Scatter", this->Scatter);
  print("AirGapMm", this->AirGapMm);
  print("Grid", this->Grid);
  print("Refraction", this->Refraction);
  print("BendDistanceMm", this->BendDistanceMm);
  print("MaterialTable", this->MaterialTable.c_str());
  print("MaterialTableFile", this->MaterialTableFile.c_str());
  print("Spectrum", this->Spectrum.c_str());
  print("SpectrumFile", this->SpectrumFile.c_str());
  print("DeviceName", this->DeviceName.c_str());
  print("ProjectionMethod", this->ProjectionMethod);
  print("Energies", this->Internal->Photons.EnergiesKeV);
  print("NumberOfInconsistentPixels", this->NumberOfInconsistentPixels);
  print("NumberOfTraces", this->NumberOfTraces);
}
