// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkXRayProjector.h"

#include "Private/FilterRequest.h"
#include "Private/InputSurface.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SurfaceMesher.h"
#endif
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/Shadow.h"

#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
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
}

struct vtkXRayProjector::Internals
{
  std::map<std::string, std::string> Keys;
  std::unique_ptr<Exposer> Device;
  ProjectorOptions Options;
  InputSurface Input;
};

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
mammorayCxxSetTextMacro(vtkXRayProjector, Spectrum);

void vtkXRayProjector::SetKey(const char* key, const char* value)
{
  auto keys = this->Internal->Keys;
  const std::string name = key ? key : "";
  const std::string text = value ? value : "";
  keys[name] = text;
  try
  {
    SceneDescription tried;
    SetQuantity({ "SetKey " + name, name, { text } }, tried);
  }
  catch (const InputError& error)
  {
    if (!text.empty())
    {
      vtkErrorMacro(<< error.what());
      return;
    }
    keys.erase(name);
  }
  SetProperty(this, this->Internal->Keys, std::move(keys));
}

int vtkXRayProjector::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

SceneDescription vtkXRayProjector::Describe() const
{
  const bool isOfFile = !this->SceneFile.empty();
  SceneDescription scene = isOfFile ? ReadScene(this->SceneFile) : SceneDescription();
  if (!isOfFile)
  {
    if (!(this->PixelSpacing[0] > 0 && this->PixelSpacing[1] > 0))
    {
      throw InputError("detector: expected a positive PixelSpacing");
    }
    const Vector3 u = ToVector(this->ColumnDirection);
    const Vector3 v = ToVector(this->RowDirection);
    // 1e-6: directions computed in float.
    if (std::abs(Norm(u) - 1) > 1e-6 || std::abs(Norm(v) - 1) > 1e-6 || std::abs(Dot(u, v)) > 1e-6)
    {
      throw InputError(
        "detector: expected ColumnDirection and RowDirection to be unit vectors at right angles");
    }
    scene.PixelSpacingMm = this->PixelSpacing[0];
    scene.Fixed.Source.Position = ToVector(this->SourcePosition);
    scene.Fixed.Detector = { ToVector(this->DetectorOrigin), u,
      (this->PixelSpacing[1] / this->PixelSpacing[0]) * v, this->DetectorSize[0],
      this->DetectorSize[1] };
    scene.Materials = this->MaterialTable;
  }
  for (const auto& [key, value] : this->Internal->Keys)
  {
    SetQuantity({ "SetKey " + key, key, { value } }, scene);
  }
  const bool hasBeam = scene.Has("beam.kev") || scene.Has("beam.energies") ||
    scene.Has("beam.spectrum") || scene.Has("beam.tube");
  if (!isOfFile && !hasBeam && !this->Spectrum.empty())
  {
    SetQuantity({ "Spectrum", "beam.spectrum", { this->Spectrum } }, scene);
  }
  else if (!isOfFile && !hasBeam && !scene.IsRealistic)
  {
    scene.EnergyKeV = 20;
  }
  return scene;
}

int vtkXRayProjector::RequestInformation(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  try
  {
    const SceneDescription scene = this->Describe();
    XRayDetector detector = scene.Fixed.Detector;
    detector.ColumnStep = scene.PixelSpacingMm * detector.ColumnStep;
    detector.RowStep = scene.PixelSpacingMm * detector.RowStep;
    const auto image = MakeDetectorImage(detector);
    vtkInformation* info = outputs->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), image->GetExtent(), 6);
    info->Set(vtkDataObject::SPACING(), image->GetSpacing(), 3);
    info->Set(vtkDataObject::ORIGIN(), image->GetOrigin(), 3);
    info->Set(vtkDataObject::DIRECTION(), image->GetDirectionMatrix()->GetData(), 9);
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  }
  catch (const std::exception&)
  {
    // RequestData raises it.
  }
  return 1;
}

int vtkXRayProjector::RequestUpdateExtent(vtkInformation*, vtkInformationVector**,
  vtkInformationVector*)
{
  return 1; // the whole mesh, which has no extent
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

Scene vtkXRayProjector::MakeScene(vtkDataObject* input)
{
  SceneDescription description = this->Describe();
  const bool isPlaced = description.HasSource() && description.HasDetector();
  if (!this->SceneFile.empty() && !isPlaced && !this->PlacedByInput)
  {
    throw InputError(this->SceneFile +
      ": expected source.position or source.beam-direction, and "
      "detector.origin, found not both");
  }
  std::shared_ptr<const SurfaceMesh> surface;
  if (description.Mesh.empty() && description.Samples.empty())
  {
    if (!input)
    {
      throw InputError("expected an input or a SceneFile with samples, found neither");
    }
    surface = this->Internal->Input.Update(input);
    description.Table = this->Internal->Input.MaterialsOf(description);
  }
  Scene scene = LoadScene(description);
  if (surface)
  {
    scene.Samples = { { surface } };
  }
  if (this->PlacedByInput)
  {
    const auto placed = input ? FindPlacement(input) : std::nullopt;
    if (!placed || !(this->SourceToDetectorMm > 0))
    {
      throw InputError("PlacedByInput: expected a positive SourceToDetectorMm and an input with "
                       "the field array 'Placement', as vtkBreastCompression gives it");
    }
    const XRayDetector& of = scene.Detector;
    const int samples = of.Samples;
    scene.Detector =
      DetectorOfUnit(*placed, of.Columns, of.Rows, { Norm(of.ColumnStep), Norm(of.RowStep) });
    scene.Detector.Samples = samples;
    scene.Source.Type = XRaySource::Kind::Point;
    scene.Source.Position = placed->Point({ 0, 0, this->SourceToDetectorMm });
  }
  scene.Dose = false;
  if (scene.Scatter.Method == SceneScatter::Model::MonteCarlo)
  {
#ifdef MAMMORAY_HAS_MESHING
    scene.Scatter.Voxels = std::make_shared<VoxelScene>(
      LabelSurfaces(*Assemble(scene), description.VoxelMm), MakePhotonMaterials(scene.Materials));
#else
    throw InputError("scatter.method: expected a build with the Meshing module");
#endif
  }
  return scene;
}

void vtkXRayProjector::Project(vtkDataObject* input, vtkImageData* output)
{
  Internals& internal = *this->Internal;
  const Scene scene = this->MakeScene(input);
  ReportProgress(ProgressOf(this), 0.4, "projecting");
  const ProjectorOptions options{ .Projection =
                                    static_cast<ProjectorOptions::Method>(this->ProjectionMethod),
    .Device = this->DeviceName };
  if (!internal.Device || internal.Options.Device != options.Device ||
    internal.Options.Projection != options.Projection)
  {
    internal.Device = std::make_unique<Exposer>(options);
    internal.Options = options;
  }
  const Exposure exposure = internal.Device->Expose(scene, ProgressOf(this, 0.4, 0.8));
  this->NumberOfTraces = static_cast<vtkIdType>(internal.Device->NumberOfTraces());
  this->UpdateProgress(0.8);
  output->ShallowCopy(ToImage(exposure, scene.Detector, scene.Materials.Names()));
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
  os << indent << "SceneFile: " << this->SceneFile << "\n"
     << indent << "PlacedByInput: " << this->PlacedByInput << "\n"
     << indent << "DeviceName: " << this->DeviceName << "\n";
  for (const auto& [key, value] : this->Internal->Keys)
  {
    os << indent << key << ": " << value << "\n";
  }
  os << indent << "NumberOfInconsistentPixels: " << this->NumberOfInconsistentPixels << "\n"
     << indent << "NumberOfTraces: " << this->NumberOfTraces << "\n";
}
