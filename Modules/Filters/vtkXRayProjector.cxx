// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkXRayProjector.h"

#include "Private/FilterRequest.h"
#include "Private/ScatterProperties.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Refraction.h"

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

#include <cmath>
#include <map>
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
  const void* Cells = nullptr;
  const void* Materials = nullptr;
  vtkMTimeType CellsTime = 0;
  vtkMTimeType MaterialsTime = 0;
  vtkIdType Points = 0;
  bool operator==(const TopologyStamp&) const = default;
};

/**
 * A projector that remembers the path lengths of its last views as long as the surface stands, so
 * that another beam or material does not trace again. Views beyond MostBytes are not kept.
 */
class RememberingProjector : public PathLengthProjector
{
public:
  static constexpr std::size_t MostBytes = std::size_t{ 512 } << 20;

  RememberingProjector(std::unique_ptr<PathLengthProjector> projector, vtkIdType& traces)
    : Projector(std::move(projector))
    , Traces(traces)
  {
  }

  void SetSurface(const SurfaceMesh& surface) override
  {
    this->Forget();
    this->Projector->SetSurface(surface);
  }
  void UpdatePoints(const std::vector<double>& points) override
  {
    this->Forget();
    this->Projector->UpdatePoints(points);
  }
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) override
  {
    for (const View& view : this->Views)
    {
      if (view.Source == source && view.Detector == detector)
      {
        return view.Image;
      }
    }
    PathLengthImage image = this->Projector->Project(source, detector);
    ++this->Traces;
    const std::size_t bytes = image.Lengths.size() * sizeof(float) + image.Inconsistent.size();
    if (this->Bytes + bytes <= MostBytes)
    {
      this->Bytes += bytes;
      this->Views.push_back({ source, detector, image });
    }
    return image;
  }
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, PathLengthDerivatives& derivatives) override
  {
    return this->Projector->Project(source, detector, velocities, fields, derivatives);
  }
  std::vector<float> Transmission(const Beam& beam) override
  {
    return this->Projector->Transmission(beam);
  }
  std::string DeviceName() const override { return this->Projector->DeviceName(); }
  ProjectorOptions::Method Method() const override { return this->Projector->Method(); }

  /// To be called when views of another source or detector are wanted.
  void Forget()
  {
    this->Views.clear();
    this->Bytes = 0;
  }

private:
  struct View
  {
    XRaySource Source;
    XRayDetector Detector;
    PathLengthImage Image;
  };
  std::unique_ptr<PathLengthProjector> Projector;
  vtkIdType& Traces;
  std::vector<View> Views;
  std::size_t Bytes = 0;
};
}

struct vtkXRayProjector::Internals
{
  struct Attenuation
  {
    std::string Table; ///< empty: the constant coefficient counts
    double DensityGPerCm3 = 1.0;
    double MuPerMm = 0.0;
    double IodineMgPerMl = 0.0;

    bool operator==(const Attenuation&) const = default;
  };

  mammoray::Spectrum Photons = mammoray::Spectrum::Monochromatic(20);
  std::map<int, Attenuation> Attenuations;
  ScatterProperties Secondary;
  std::unique_ptr<RememberingProjector> Projector;
  /// Of the last update.
  XRaySource Source;
  XRayDetector Detector;
  std::string ProjectorDevice;
  ProjectorOptions::Method ProjectorMethod = ProjectorOptions::Method::Auto;
  /// What is on the device.
  SurfaceMesh Surface;
  std::vector<std::string> MaterialNames;
  std::vector<std::int32_t> PointIds;
  TopologyStamp Topology;

  void SetPhotons(vtkXRayProjector* filter, mammoray::Spectrum photons);
  void Upload(SurfaceMesh surface);
  void UploadGrid(vtkUnstructuredGrid* grid);
  std::string NameOf(int material) const;
  std::map<int, Attenuation> AttenuationsOf(const std::string& table, int materialCount) const;
  /// What refracts, by the same.
  std::vector<double> DecrementsFor(int materialCount,
    const std::map<int, Attenuation>& attenuations, const mammoray::Spectrum& photons) const;
  Beam MakeBeamFor(int materialCount, const std::map<int, Attenuation>& attenuations,
    const mammoray::Spectrum& photons, const DetectorResponse& response) const;
};

void vtkXRayProjector::Internals::SetPhotons(vtkXRayProjector* filter, mammoray::Spectrum photons)
{
  if (this->Photons.EnergiesKeV != photons.EnergiesKeV || this->Photons.Weights != photons.Weights)
  {
    this->Photons = std::move(photons);
    filter->Modified();
  }
}

void vtkXRayProjector::Internals::Upload(SurfaceMesh surface)
{
  const bool sameTriangles = this->Surface.Triangles == surface.Triangles &&
    this->Surface.FrontMaterials == surface.FrontMaterials &&
    this->Surface.BackMaterials == surface.BackMaterials &&
    this->Surface.Points.size() == surface.Points.size();
  if (sameTriangles && !surface.Triangles.empty())
  {
    if (this->Surface.Points != surface.Points)
    {
      this->Projector->UpdatePoints(surface.Points);
    }
  }
  else
  {
    this->Surface = {}; // should this throw, nothing on the device is taken for current
    this->Projector->SetSurface(surface);
  }
  this->Surface = std::move(surface);
}

void vtkXRayProjector::Internals::UploadGrid(vtkUnstructuredGrid* grid)
{
  vtkDataArray* materials = grid->GetCellData()->GetArray(MaterialArrayName);
  const TopologyStamp topology{ grid->GetCells(), materials,
    grid->GetCells() ? grid->GetCells()->GetMTime() : 0, materials ? materials->GetMTime() : 0,
    grid->GetNumberOfPoints() };
  if (topology == this->Topology && !this->Surface.Triangles.empty())
  {
    std::vector<double> points(this->Surface.Points.size());
    for (std::size_t point = 0; point < this->PointIds.size(); ++point)
    {
      grid->GetPoint(this->PointIds[point], &points[3 * point]);
    }
    if (points != this->Surface.Points)
    {
      this->Projector->UpdatePoints(points);
      this->Surface.Points = std::move(points);
    }
    return;
  }
  this->Topology = {};
  this->Upload(ExtractInterfaces(FromGrid(grid, &this->MaterialNames), &this->PointIds));
  this->Topology = topology;
}

std::string vtkXRayProjector::Internals::NameOf(int material) const
{
  const auto index = static_cast<std::size_t>(material);
  return index < this->MaterialNames.size() && !this->MaterialNames[index].empty()
    ? this->MaterialNames[index]
    : std::to_string(material);
}

/// What was said of single materials, and of the others what the table says.
std::map<int, vtkXRayProjector::Internals::Attenuation> vtkXRayProjector::Internals::AttenuationsOf(
  const std::string& table, int materialCount) const
{
  std::map<int, Attenuation> attenuations = this->Attenuations;
  if (table.empty())
  {
    return attenuations;
  }
  const mammoray::MaterialTable materials = FindMaterialTable(table);
  for (int material = 1; material < materialCount; ++material)
  {
    const auto index = static_cast<std::size_t>(material);
    const bool named = index < this->MaterialNames.size() && !this->MaterialNames[index].empty();
    const auto found =
      named ? static_cast<std::size_t>(materials.IndexOf(this->MaterialNames[index])) : index;
    if (found < materials.Materials.size())
    {
      const Material& entry = materials.Materials[found];
      attenuations.insert(
        { material, { entry.Attenuation, entry.DensityGPerCm3, 0.0, entry.IodineMgPerMl } });
    }
  }
  return attenuations;
}

Beam vtkXRayProjector::Internals::MakeBeamFor(int materialCount,
  const std::map<int, Attenuation>& attenuations, const mammoray::Spectrum& photons,
  const DetectorResponse& response) const
{
  std::vector<AttenuationTable> tables(static_cast<std::size_t>(materialCount));
  std::vector<const AttenuationTable*> pointers(tables.size(), nullptr);
  std::vector<double> densities(tables.size(), 1.0);
  std::vector<bool> used(tables.size(), false);
  for (const auto* side : { &this->Surface.FrontMaterials, &this->Surface.BackMaterials })
  {
    for (const std::uint16_t material : *side)
    {
      used[material] = true;
    }
  }
  for (int material = 1; material < materialCount; ++material)
  {
    const auto index = static_cast<std::size_t>(material);
    const auto found = attenuations.find(material);
    if (found == attenuations.end() && used[index])
    {
      throw InputError("material '" + this->NameOf(material) + "' (" + std::to_string(material) +
        ") has no attenuation; set it by MaterialTable, SetAttenuationTable or "
        "SetLinearAttenuation");
    }
    if (found != attenuations.end() && !found->second.Table.empty())
    {
      tables[index] = FindAttenuationTable(found->second.Table);
      densities[index] = found->second.DensityGPerCm3;
      if (found->second.IodineMgPerMl > 0)
      {
        tables[index] = WithIodine(tables[index], densities[index], found->second.IodineMgPerMl);
      }
    }
    else
    {
      // A material that no triangle has has length 0, whatever its attenuation.
      const double mu = used[index] ? found->second.MuPerMm : 1.0;
      const auto& energies = photons.EnergiesKeV;
      tables[index] = { this->NameOf(material), 1.0, energies,
        std::vector<double>(energies.size(), mu) };
    }
    pointers[index] = &tables[index];
  }
  return Beam(photons, response, pointers, densities);
}

std::vector<double> vtkXRayProjector::Internals::DecrementsFor(int materialCount,
  const std::map<int, Attenuation>& attenuations, const mammoray::Spectrum& photons) const
{
  mammoray::MaterialTable table;
  for (int material = 0; material < materialCount; ++material)
  {
    Material& entry = table.Materials.emplace_back();
    entry.Name = this->NameOf(material);
    const auto found = attenuations.find(material);
    if (material > 0 && found != attenuations.end())
    {
      entry.Attenuation = found->second.Table;
      entry.DensityGPerCm3 = found->second.DensityGPerCm3;
    }
  }
  return RefractiveDecrements(photons, table);
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

void vtkXRayProjector::SetDeviceName(const char* name)
{
  SetProperty(this, this->DeviceName, std::string(name ? name : ""));
}

void vtkXRayProjector::SetMaterialTable(const char* pathOrName)
{
  SetProperty(this, this->MaterialTable, std::string(pathOrName ? pathOrName : ""));
}

void vtkXRayProjector::SetMaterialTableFile(const char* path)
{
  SetProperty(this, this->MaterialTableFile, std::string(path ? path : ""));
}

void vtkXRayProjector::SetSpectrum(const char* pathOrName)
{
  SetProperty(this, this->Spectrum, std::string(pathOrName ? pathOrName : ""));
}

void vtkXRayProjector::SetSpectrumFile(const char* path)
{
  SetProperty(this, this->SpectrumFile, std::string(path ? path : ""));
}

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
  attenuations[material] = { table, densityGPerCm3, 0.0, 0.0 };
  SetProperty(this, this->Internal->Attenuations, std::move(attenuations));
}

void vtkXRayProjector::SetLinearAttenuation(int material, double muPerMm)
{
  auto attenuations = this->Internal->Attenuations;
  attenuations[material] = { "", 1.0, muPerMm, 0.0 };
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
  return 1;
}

int vtkXRayProjector::RequestInformation(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  const int extent[6] = { 0, this->DetectorSize[0] - 1, 0, this->DetectorSize[1] - 1, 0, 0 };
  const double spacing[3] = { this->PixelSpacing[0], this->PixelSpacing[1], 1.0 };
  const Vector3 u = ToVector(this->ColumnDirection);
  const Vector3 v = ToVector(this->RowDirection);
  const Vector3 n = Cross(u, v);
  const double direction[9] = { u[0], v[0], n[0], u[1], v[1], n[1], u[2], v[2], n[2] };
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  info->Set(vtkDataObject::ORIGIN(), this->DetectorOrigin, 3);
  info->Set(vtkDataObject::DIRECTION(), direction, 9);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  return 1;
}

int vtkXRayProjector::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
  vtkInformationVector*)
{
  return 1; // the whole mesh, which has no extent
}

/// As the properties say, or the input.
void vtkXRayProjector::PlaceBeam(vtkDataObject* input, XRaySource& source,
  XRayDetector& detector) const
{
  if (!(this->PixelSpacing[0] > 0 && this->PixelSpacing[1] > 0))
  {
    throw InputError("detector: expected a positive PixelSpacing");
  }
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
    detector.Samples = this->Samples;
    source.Position = placed->Point({ 0, 0, this->SourceToDetectorMm });
    return;
  }
  detector.Columns = this->DetectorSize[0];
  detector.Rows = this->DetectorSize[1];
  detector.Samples = this->Samples;
  detector.Origin = ToVector(this->DetectorOrigin);
  source.Type = this->ParallelBeam ? XRaySource::Kind::Parallel : XRaySource::Kind::Point;
  source.Position = ToVector(this->SourcePosition);
  source.Direction = ToVector(this->BeamDirection);
  const Vector3 u = ToVector(this->ColumnDirection);
  const Vector3 v = ToVector(this->RowDirection);
  CheckDirections(u, v);
  detector.ColumnStep = this->PixelSpacing[0] * u;
  detector.RowStep = this->PixelSpacing[1] * v;
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
      if (this->PlacedByInput)
      {
        // Not known before the input was.
        vtkInformation* info = outputs->GetInformationObject(0);
        info->Set(vtkDataObject::ORIGIN(), output->GetOrigin(), 3);
        info->Set(vtkDataObject::DIRECTION(), output->GetDirectionMatrix()->GetData(), 9);
      }
    });
}

ExposureOptions vtkXRayProjector::MakeExposureOptions(const XRaySource& source,
  const XRayDetector& detector, const mammoray::Spectrum& photons,
  const DetectorResponse& response) const
{
  ExposureOptions options;
  options.PhotonsPerPixel = this->PhotonsPerPixel;
  options.Seed = static_cast<std::uint64_t>(this->NoiseSeed);
  options.Validate();
  if (this->Refraction != NO_REFRACTION && (this->Scatter || this->PhotonsPerPixel > 0))
  {
    throw InputError("Refraction: expected neither Scatter nor PhotonsPerPixel, found one");
  }
  const std::optional<ScatterModel> model = this->Internal->Secondary.ModelOf(this->Scatter,
    this->AirGapMm, ToVector(this->Grid), photons, response);
  if (model)
  {
    options.Secondary =
      [source, detector, model](const PathLengthImage& lengths, const std::vector<double>& primary)
    { return model->Scatter(source, detector, TissueThickness(lengths), primary); };
  }
  return options;
}

void vtkXRayProjector::Project(vtkDataObject* input, vtkImageData* output)
{
  XRaySource source;
  XRayDetector detector;
  this->PlaceBeam(input, source, detector);
  Internals& internal = *this->Internal;
  const auto method = static_cast<ProjectorOptions::Method>(this->ProjectionMethod);
  if (!internal.Projector || internal.ProjectorDevice != this->DeviceName ||
    internal.ProjectorMethod != method)
  {
    internal.Surface = {};
    internal.Projector = std::make_unique<RememberingProjector>(
      MakeProjector({ .Projection = method, .Device = this->DeviceName }), this->NumberOfTraces);
    internal.ProjectorDevice = this->DeviceName;
    internal.ProjectorMethod = method;
  }
  this->UpdateProgress(0.1);
  if (auto* polyData = vtkPolyData::SafeDownCast(input))
  {
    internal.Topology = {};
    internal.Upload(FromPolyData(polyData, &internal.MaterialNames));
  }
  else
  {
    internal.UploadGrid(vtkUnstructuredGrid::SafeDownCast(input));
  }
  ReportProgress(ProgressOf(this), 0.4, "projecting");
  if (!(source == internal.Source && detector == internal.Detector))
  {
    internal.Projector->Forget();
    internal.Source = source;
    internal.Detector = detector;
  }
  const int materialCount = internal.Surface.NumberOfMaterials();
  const std::string& spectrum = FileOrName(this->SpectrumFile, this->Spectrum);
  const mammoray::Spectrum photons = spectrum.empty() ? internal.Photons : FindSpectrum(spectrum);
  const DetectorResponse response =
    this->PhotonCounting ? DetectorResponse::PhotonCounting : DetectorResponse::EnergyIntegrating;
  const auto attenuations = internal.AttenuationsOf(
    FileOrName(this->MaterialTableFile, this->MaterialTable), materialCount);
  const Beam beam = internal.MakeBeamFor(materialCount, attenuations, photons, response);
  const ExposureOptions options = this->MakeExposureOptions(source, detector, photons, response);
  RefractedImage refracted;
  if (this->Refraction != NO_REFRACTION)
  {
    const RefractionOptions bend{ this->Refraction == GEOMETRIC ? RefractionOptions::Law::Geometric
                                                                : RefractionOptions::Law::NearField,
      this->BendDistanceMm };
    refracted = Refract(*internal.Projector, internal.Surface.NumberOfPoints(), source, detector,
      beam, internal.DecrementsFor(materialCount, attenuations, photons), bend,
      ProgressOf(this, 0.4, 0.8));
  }
  const Exposure exposure = this->Refraction != NO_REFRACTION
    ? ToExposure(refracted)
    : Expose(*internal.Projector, source, detector, beam, options, ProgressOf(this, 0.4, 0.8));
  this->UpdateProgress(0.8);
  output->ShallowCopy(ToImage(exposure, detector, internal.MaterialNames));
  if (this->Refraction != NO_REFRACTION)
  {
    output->GetPointData()->AddArray(
      ToDeflectionImage(refracted, detector)->GetPointData()->GetArray("Deflection"));
  }
  this->NumberOfInconsistentPixels =
    static_cast<vtkIdType>(exposure.Lengths.NumberOfInconsistentRays());
  if (this->NumberOfInconsistentPixels > 0)
  {
    vtkWarningMacro(<< exposure.Lengths.InconsistencyWarning());
  }
}

void vtkXRayProjector::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&](const char* name, const auto& values)
  {
    os << indent << name << ":";
    for (const auto value : values)
    {
      os << " " << value;
    }
    os << "\n";
  };
  os << indent << "PlacedByInput: " << this->PlacedByInput << "\n";
  os << indent << "SourceToDetectorMm: " << this->SourceToDetectorMm << "\n";
  print("SourcePosition", this->SourcePosition);
  os << indent << "ParallelBeam: " << this->ParallelBeam << "\n";
  print("BeamDirection", this->BeamDirection);
  print("DetectorOrigin", this->DetectorOrigin);
  print("ColumnDirection", this->ColumnDirection);
  print("RowDirection", this->RowDirection);
  print("PixelSpacing", this->PixelSpacing);
  print("DetectorSize", this->DetectorSize);
  os << indent << "Samples: " << this->Samples << "\n";
  os << indent << "PhotonCounting: " << this->PhotonCounting << "\n";
  os << indent << "PhotonsPerPixel: " << this->PhotonsPerPixel << "\n";
  os << indent << "NoiseSeed: " << this->NoiseSeed << "\n";
  os << indent << "Scatter: " << this->Scatter << "\n";
  os << indent << "AirGapMm: " << this->AirGapMm << "\n";
  print("Grid", this->Grid);
  os << indent << "Refraction: " << this->Refraction << "\n";
  os << indent << "BendDistanceMm: " << this->BendDistanceMm << "\n";
  os << indent << "MaterialTable: " << this->MaterialTable << "\n";
  os << indent << "MaterialTableFile: " << this->MaterialTableFile << "\n";
  os << indent << "Spectrum: " << this->Spectrum << "\n";
  os << indent << "SpectrumFile: " << this->SpectrumFile << "\n";
  os << indent << "DeviceName: " << this->DeviceName << "\n";
  os << indent << "ProjectionMethod: " << this->ProjectionMethod << "\n";
  print("Energies", this->Internal->Photons.EnergiesKeV);
  os << indent << "NumberOfInconsistentPixels: " << this->NumberOfInconsistentPixels << "\n";
  os << indent << "NumberOfTraces: " << this->NumberOfTraces << "\n";
}
