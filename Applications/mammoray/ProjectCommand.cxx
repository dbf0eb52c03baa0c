// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "MaterialChanges.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ProjectOptions.h"
#include "SceneOptions.h"
#include "SharedOptions.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Display.h"
#include "mammoray/XRay/DualEnergy.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/OpenField.h"
#include "mammoray/XRay/OverlapMeasure.h"
#include "mammoray/XRay/Refraction.h"
#include "mammoray/XRay/Tube.h"

#include "vtkImageData.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>

namespace mammoray
{
namespace
{
/// Of length 1.
Vector3 ToUnitVector(const Vector3& vector, const char* option)
{
  const double length = Norm(vector);
  if (!(length > 0) || !std::isfinite(length))
  {
    throw InputError(std::string(option) + ": expected a direction, found a vector without length");
  }
  return (1 / length) * vector;
}

/// What reaches the pixels in air; empty where it is the same everywhere.
std::vector<float> ToOpenField(const ProjectArguments& arguments, const XRaySource& source,
  const XRayDetector& detector, const Spectrum& spectrum, const DetectorResponse& response)
{
  OpenFieldOptions options = arguments.Field;
  if (arguments.Heel)
  {
    options.Heel.TargetAngleDeg = (*arguments.Heel)[0];
    options.Heel.DepthMm = 1e-3 * (*arguments.Heel)[1];
    options.Heel.Target =
      arguments.XRays.Anode.empty() ? options.Heel.Target : arguments.XRays.Anode;
  }
  return arguments.Heel || options.InverseSquare
    ? OpenField(source, detector, spectrum, response, options)
    : std::vector<float>();
}

ExposureOptions ToExposure(const ProjectArguments& arguments)
{
  ExposureOptions options = arguments.Exposure;
  if (arguments.FocalSpot)
  {
    options.FocalSpotColumnMm = (*arguments.FocalSpot)[0];
    options.FocalSpotRowMm = (*arguments.FocalSpot)[1];
  }
  options.Validate();
  return options;
}

/// Whether no position is given explicitly.
bool IsPlacedByUnit(const ProjectArguments& arguments)
{
  return !arguments.Source && !arguments.BeamDirection && !arguments.DetectorOrigin &&
    !arguments.ColumnDirection && !arguments.RowDirection;
}

/// The picture turned by 180 degrees: a right breast is hung with its chest wall at the right.
void TurnHalf(XRayDetector& detector)
{
  detector.Origin = detector.Origin + (detector.Columns - 1.0) * detector.ColumnStep +
    (detector.Rows - 1.0) * detector.RowStep;
  detector.ColumnStep = -1.0 * detector.ColumnStep;
  detector.RowStep = -1.0 * detector.RowStep;
}

/// Detector and source as a mammography unit has them, or as the explicit options say; mesh frame.
/// Where the unit stands.
VolumeFromGantry PlaceBeam(const ProjectArguments& arguments, const SurfaceMesh& surface,
  const MaterialTable& table, XRaySource& source, XRayDetector& detector)
{
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.Orientation);
  const Vector3 anchor =
    arguments.Anchor ? *arguments.Anchor : FindPoseAnchor(surface, table.Fixed(), axes);
  const VolumeFromGantry gantry = PlaceUnit(axes, anchor, arguments.Unit, arguments.Pose);
  const double spacing = arguments.PixelSpacingMm;
  detector = DetectorOfUnit(gantry, arguments.Columns, arguments.Rows, { spacing, spacing });
  detector.Samples = arguments.Samples;
  detector.Origin = arguments.DetectorOrigin.value_or(detector.Origin);
  if (arguments.ColumnDirection)
  {
    detector.ColumnStep = spacing * ToUnitVector(*arguments.ColumnDirection, "--column-direction");
  }
  if (arguments.RowDirection)
  {
    detector.RowStep = spacing * ToUnitVector(*arguments.RowDirection, "--row-direction");
  }
  if (IsDicomPath(arguments.Output) && arguments.Laterality == 'R' && IsPlacedByUnit(arguments))
  {
    TurnHalf(detector);
  }
  source.Position =
    arguments.Source.value_or(gantry.Point({ 0, 0, arguments.Unit.SourceToDetectorMm }));
  if (arguments.BeamDirection)
  {
    source.Type = XRaySource::Kind::Parallel;
    source.Direction = *arguments.BeamDirection;
  }
  return gantry;
}

/// Detector and patient as a mammogram's header says them; throws where it could not.
Mammogram DescribeMammogram(const ProjectArguments& arguments, const XRaySource& source,
  const XRayDetector& detector)
{
  Mammogram mammogram = DescribeProjection(source, detector,
    AnatomicalAxes::FromCode(arguments.Orientation), *arguments.Laterality);
  mammogram.View = arguments.View.empty() ? mammogram.View : arguments.View;
  if (mammogram.View.empty())
  {
    throw InputError("output " + arguments.Output +
      ": expected --view for a DICOM mammogram of this roll, found none");
  }
  if (IsPlacedByUnit(arguments))
  {
    mammogram.BodyPartThicknessMm = arguments.Pose.ThicknessMm;
    mammogram.SourceToPatientMm =
      arguments.Unit.SourceToDetectorMm - arguments.Unit.SupportHeightMm;
  }
  return mammogram;
}

/// From the middle of the mesh to the detector's plane, mm.
double DistanceToDetector(const SurfaceMesh& surface, const XRaySource& source,
  const XRayDetector& detector)
{
  const Vector3 normal = DetectorPlane(source, detector).Normal;
  const Extent extent = ExtentsAlong<1>({ normal }, surface.Points)[0];
  return std::abs(extent.Middle() - Dot(normal, detector.Origin));
}

/// The image with rays that are bent; writes their deflection where it is wanted.
Exposure ExposeRefracted(const ProjectArguments& arguments, PathLengthProjector& projector,
  const SurfaceMesh& surface, const XRaySource& source, const XRayDetector& detector,
  const Beam& beam, const std::vector<double>& decrements, const ProgressCallback& progress)
{
  RefractionOptions options;
  options.Method = arguments.RefractionLaw == "geometric" ? RefractionOptions::Law::Geometric
                                                          : RefractionOptions::Law::NearField;
  options.DistanceMm =
    arguments.BendDistanceMm.value_or(DistanceToDetector(surface, source, detector));
  const RefractedImage refracted = Refract(projector, surface.NumberOfPoints(), source, detector,
    beam, decrements, options, progress);
  if (!arguments.Deflection.empty())
  {
    WriteProjection(ToDeflectionImage(refracted, detector), arguments.Deflection);
  }
  return ToExposure(refracted);
}

/// Refuses what refraction does not go together with.
void CheckRefraction(const ProjectArguments& arguments)
{
  if (arguments.RefractionLaw.empty())
  {
    if (!arguments.Deflection.empty())
    {
      throw InputError("--deflection: expected --refraction beside it, found none");
    }
    return;
  }
  const ExposureOptions& exposure = arguments.Exposure;
  if (exposure.PhotonsPerPixel > 0 || exposure.HalfModulationPerMm > 0 || arguments.FocalSpot ||
    arguments.Heel || arguments.Field.InverseSquare || !arguments.Scatter.Method.empty())
  {
    throw InputError("--refraction: expected no noise, blur, focal spot, heel, inverse square or "
                     "scatter beside it, found some");
  }
  if (!arguments.Deflection.empty())
  {
    const std::string extension = std::filesystem::path(arguments.Deflection).extension().string();
    if (extension == ".png" || extension == ".tif")
    {
      throw InputError("--deflection: expected .mha, .nrrd or .vti, found " + arguments.Deflection);
    }
    CheckProjectionExtension(arguments.Deflection);
    CheckOutputFile(arguments.Deflection, arguments.Overwrite);
  }
}

void CheckInputs(const ProjectArguments& arguments)
{
  if (arguments.Mesh.empty() == arguments.SurfaceSamples.empty())
  {
    throw InputError(
      std::string(
        "project: expected either --mesh or --surface, or a --scene with samples, found ") +
      (arguments.Mesh.empty() ? "neither" : "both"));
  }
  if (!arguments.Mesh.empty())
  {
    CheckInputFile(arguments.Mesh);
    if (arguments.Materials.empty())
    {
      throw InputError("--mesh: expected --materials beside it, found none");
    }
  }
}

void CheckOutputs(const ProjectArguments& arguments)
{
  CheckRefraction(arguments);
  CheckScatter(arguments.Scatter, IsPlacedByUnit(arguments));
  if (arguments.Display &&
    (arguments.ForProcessing || arguments.Series.IsAsked() || arguments.DualEnergy.IsAsked()))
  {
    throw InputError("--display: expected one picture, not For Processing, found another");
  }
  CheckSeries(arguments.Series, arguments.Output);
  CheckDualEnergy(arguments.DualEnergy);
  if (arguments.DualEnergy.IsAsked())
  {
    const std::string extension = std::filesystem::path(arguments.Output).extension().string();
    if (arguments.Series.IsAsked() || !arguments.RefractionLaw.empty() || extension == ".png" ||
      IsDicomPath(arguments.Output))
    {
      throw InputError("dual energy: expected one picture (.mha .nrrd .tif .vti) without "
                       "--refraction, found another");
    }
    CheckOutputBeside(BesideOutput(arguments.Output, "_low"), arguments.Overwrite);
    CheckOutputBeside(BesideOutput(arguments.Output, "_high"), arguments.Overwrite);
  }
  const bool isDicom = IsDicomPath(arguments.Output);
  if (arguments.Series.IsAsked() &&
    (!arguments.PathLengths.empty() || !arguments.Deflection.empty()))
  {
    throw InputError("series: expected no --path-lengths or --deflection beside it, found one");
  }
  if (arguments.Series.IsAsked() && !isDicom)
  {
    CheckOutputBeside(SeriesDescriptionPath(arguments.Output), arguments.Overwrite);
    if (arguments.Series.FlatFields > 0)
    {
      CheckOutputBeside(FlatFieldPath(arguments.Output), arguments.Overwrite);
    }
  }
  else if (isDicom)
  {
    if (arguments.Series.IsAsked() && !IsPlacedByUnit(arguments))
    {
      throw InputError("output " + arguments.Output +
        ": expected source and detector of a mammography unit, found explicit positions");
    }
    if (!arguments.Laterality)
    {
      throw InputError("output " + arguments.Output +
        ": expected --side left or right for a DICOM mammogram, found none");
    }
    arguments.Patient.Identity();
  }
  else
  {
    CheckProjectionExtension(arguments.Output);
  }
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  if (!arguments.PathLengths.empty())
  {
    CheckProjectionExtension(arguments.PathLengths, true);
    CheckOutputFile(arguments.PathLengths, arguments.Overwrite);
  }
}

Mammogram::Intent IntentOf(const ProjectArguments& arguments)
{
  return arguments.ForProcessing ? Mammogram::Intent::ForProcessing
                                 : Mammogram::Intent::ForPresentation;
}

DicomMammogramOptions DicomOptions(const ProjectArguments& arguments)
{
  DicomMammogramOptions options;
  options.Identity = arguments.Patient.Identity();
  options.Derivation = SyntheticDerivation(arguments.ForProcessing, "a breast");
  return options;
}

void WriteMammogramFile(const ProjectArguments& arguments, Mammogram mammogram,
  const Exposure& exposure, const XRayDetector& detector)
{
  if (arguments.Display)
  {
    SetDisplayPixels(mammogram, DisplayValues(exposure, detector));
  }
  else
  {
    SetPixels(mammogram, exposure.LogAttenuation, IntentOf(arguments));
  }
  WriteMammogram(mammogram, DicomOptions(arguments), arguments.Output);
}

/// What makes pictures from anywhere.
struct Camera
{
  const ProjectArguments& Arguments;
  PathLengthProjector& Projector;
  const SurfaceMesh& Surface;
  const Beam& XRays;
  const std::vector<double>& Decrements;
  const Spectrum& Energies;
  const DetectorResponse& Response;
  const ScatterSource& Scatter;
  /// What reaches the pixels in air, where it is known already.
  const std::vector<float>* KnownField = nullptr;

  /// The `number`-th of a series, with noise of its own.
  ExposureOptions Options(const XRaySource& source, const XRayDetector& detector, int number,
    const ProgressCallback& progress) const
  {
    ExposureOptions options = ToExposure(this->Arguments);
    options.OpenField = this->KnownField
      ? *this->KnownField
      : ToOpenField(this->Arguments, source, detector, this->Energies, this->Response);
    options.Seed += static_cast<std::uint64_t>(number);
    options.Secondary = this->Scatter.Onto(source, detector, this->Arguments.Field.InverseSquare,
      options.Seed, progress);
    return options;
  }

  Exposure Take(const XRaySource& source, const XRayDetector& detector, int number,
    const ProgressCallback& progress) const
  {
    return this->Arguments.RefractionLaw.empty()
      ? Expose(this->Projector, source, detector, this->XRays,
          this->Options(source, detector, number, progress), progress)
      : ExposeRefracted(this->Arguments, this->Projector, this->Surface, source, detector,
          this->XRays, this->Decrements, progress);
  }
};

/// Writes one picture; what is to be warned of, or nothing.
std::string RunOne(const Camera& camera, const XRaySource& source, const XRayDetector& detector,
  const MaterialTable& table, std::optional<Mammogram> mammogram, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = camera.Arguments;
  const Exposure exposure = camera.Take(source, detector, 0, ShareOf(progress, 0.2, 0.8));
  ReportProgress(progress, 0.8, "writing");
  const auto image = ToImage(exposure, detector, table.Names());
  if (mammogram)
  {
    WriteMammogramFile(arguments, std::move(*mammogram), exposure, detector);
  }
  else if (arguments.Display)
  {
    WriteProjection(ToImage(DisplayValues(exposure, detector), "Display", detector),
      arguments.Output);
  }
  else
  {
    WriteProjection(image, arguments.Output);
  }
  if (!arguments.PathLengths.empty())
  {
    WriteProjection(image, arguments.PathLengths, true);
  }
  return exposure.Lengths.InconsistencyWarning();
}

/// Writes two exposures and what they are recombined to; what is to be warned of, or nothing.
std::string RunDualEnergy(const Camera& camera, const XRaySource& source,
  const XRayDetector& detector, const MaterialTable& table, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = camera.Arguments;
  const std::vector<std::string> pair = arguments.DualEnergy.Cancel.empty()
    ? std::vector<std::string>{ "fat", "gland" }
    : arguments.DualEnergy.Cancel;
  const Spectrum spectrum = ToHighSpectrum(arguments.DualEnergy, arguments.XRays);
  const Beam high = MakeBeam(table, spectrum, camera.Response);
  const double weight = CancellingWeight(camera.XRays, high, table.IndexOf(pair[0]),
    table.IndexOf(pair[1]), arguments.DualEnergy.ThicknessMm);
  const ScatterSource scatter = camera.Scatter.Of(spectrum);
  const Camera second{ arguments, camera.Projector, camera.Surface, high, camera.Decrements,
    spectrum, camera.Response, scatter };
  const Exposure atLow = camera.Take(source, detector, 0, ShareOf(progress, 0.2, 0.5));
  const Exposure atHigh = second.Take(source, detector, 1, ShareOf(progress, 0.5, 0.8));
  ReportProgress(progress, 0.8, "writing");
  WriteProjection(ToImage(Recombine(atLow, atHigh, weight), "Recombined", detector),
    arguments.Output);
  WriteProjection(ToImage(atLow, detector, table.Names()), BesideOutput(arguments.Output, "_low"));
  const auto image = ToImage(atHigh, detector, table.Names());
  WriteProjection(image, BesideOutput(arguments.Output, "_high"));
  if (!arguments.PathLengths.empty())
  {
    WriteProjection(image, arguments.PathLengths, true);
  }
  std::printf("%s, mean %.1f keV, less %.4f times the first: %s and %s of %g mm look the same\n",
    spectrum.Name.c_str(), spectrum.MeanEnergyKeV(), weight, pair[0].c_str(), pair[1].c_str(),
    arguments.DualEnergy.ThicknessMm);
  return atLow.Lengths.InconsistencyWarning();
}

/// The middle of a box around the surface.
Vector3 MiddleOf(const SurfaceMesh& surface)
{
  Vector3 middle{ 0, 0, 0 };
  const auto extents =
    ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, surface.Points);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    middle[axis] = extents[axis].Middle();
  }
  return middle;
}

using TakeProjection = std::function<void(const ProjectionView& view, const Exposure& exposure)>;

/// Takes all projections of a series; the first warning of one, or nothing.
std::string TakeSeries(const Camera& camera, const ProjectionSeries& series,
  const ProgressCallback& progress, const TakeProjection& take)
{
  std::string warning;
  const int count = static_cast<int>(series.Views.size());
  int number = 0;
  for (const ProjectionView& view : series.Views)
  {
    const double begin = 0.2 + 0.6 * number / count;
    ReportProgress(progress, begin, "projecting");
    const Exposure exposure = camera.Take(view.Source, view.Detector, number,
      ShareOf(progress, begin, 0.2 + 0.6 * (number + 1) / count));
    const std::string found = exposure.Lengths.InconsistencyWarning();
    if (warning.empty() && !found.empty())
    {
      warning = "projection " + std::to_string(number) + ": " + found;
    }
    take(view, exposure);
    ++number;
  }
  return warning;
}

/// Writes a series as a stack and what stands beside it; what is to be warned of, or nothing.
std::string RunStack(const Camera& camera, const ProjectionSeries& series, const XRaySource& source,
  const XRayDetector& detector, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = camera.Arguments;
  ProjectionStack stack{ .Columns = detector.Columns,
    .Rows = detector.Rows,
    .ColumnSpacingMm = Norm(detector.ColumnStep),
    .RowSpacingMm = Norm(detector.RowStep) };
  ProjectionStack flats = stack;
  const auto add = [](ProjectionStack& to, const Exposure& exposure)
  {
    to.Values.insert(to.Values.end(), exposure.Transmission.begin(), exposure.Transmission.end());
    ++to.Number;
  };
  // Where the sample turns, source and detector stand to each other as in the flat fields.
  const std::vector<float> field =
    ToOpenField(arguments, source, detector, camera.Energies, camera.Response);
  Camera standing = camera;
  standing.KnownField = &field;
  std::string warning = TakeSeries(arguments.Series.Turn > 0 ? standing : camera, series, progress,
    [&](const ProjectionView&, const Exposure& exposure) { add(stack, exposure); });
  while (flats.Number < arguments.Series.FlatFields)
  {
    ReportProgress(progress, 0.8, "flat fields");
    add(flats,
      ExposeAir(source, detector, camera.XRays,
        standing.Options(source, detector, stack.Number + flats.Number, {})));
  }
  ReportProgress(progress, 0.85, "writing");
  WriteProjectionStack(stack, arguments.Output);
  if (flats.Number > 0)
  {
    WriteProjectionStack(flats, FlatFieldPath(arguments.Output));
  }
  WriteAtomicFile(SeriesDescriptionPath(arguments.Output),
    DescribeSeries(arguments.Series, series, source, detector));
  return warning;
}

/// Writes a tomosynthesis as one DICOM object; what is to be warned of, or nothing.
std::string RunBreastProjections(const Camera& camera, const ProjectionSeries& series,
  const Mammogram& described, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = camera.Arguments;
  std::vector<Mammogram> projections;
  std::string warning = TakeSeries(camera, series, progress,
    [&](const ProjectionView& view, const Exposure& exposure)
    {
      Mammogram& projection = projections.emplace_back(described);
      const DetectorPlane plane(view.Source, view.Detector);
      projection.SourceToDetectorMm = plane.HeightMm;
      projection.SourceToPatientMm =
        *projection.SourceToDetectorMm - arguments.Unit.SupportHeightMm;
      projection.SourceFootPixel = { plane.FootColumn, plane.FootRow };
      SetPixels(projection, exposure.LogAttenuation, IntentOf(arguments));
    });
  ReportProgress(progress, 0.85, "writing");
  WriteProjections(projections, DicomOptions(arguments), arguments.Series.PivotHeightMm,
    arguments.Output);
  return warning;
}

/// Writes a series; what is to be warned of, or nothing. `mammogram`: the header of a DICOM object.
std::string RunSeries(const Camera& camera, const ProjectionSeries& series,
  const XRaySource& source, const XRayDetector& detector, const std::optional<Mammogram>& mammogram,
  const ProgressCallback& progress)
{
  return mammogram ? RunBreastProjections(camera, series, *mammogram, progress)
                   : RunStack(camera, series, source, detector, progress);
}

void Run(ProjectArguments& arguments)
{
  ApplyScene(arguments);
  ApplyUnit(arguments);
  CheckInputs(arguments);
  CheckOutputs(arguments);
  const ProgressCallback progress = MakeProgressBar();
  MaterialTable known =
    arguments.Materials.empty() ? MaterialTable() : FindMaterialTable(arguments.Materials);
  ReplaceAttenuations(arguments.Attenuations, arguments.AcceptUnusual, known);
  AddIodine(arguments.DualEnergy.Iodine, known);
  const Spectrum spectrum = ToSpectrum(arguments.XRays);
  ReportProgress(progress, 0.0, "reading the mesh");
  const SurfaceScene scene = arguments.Mesh.empty()
    ? ReadSurfaces(arguments.SurfaceSamples, std::move(known))
    : ReadMeshScene(arguments.Mesh, known);
  const MaterialTable& table = scene.Materials;
  const SurfaceMesh& surface = scene.Surface;
  const DetectorResponse response = ToResponse(arguments.Response);
  const Beam beam = MakeBeam(table, spectrum, response);
  const std::vector<double> decrements =
    arguments.RefractionLaw.empty() ? std::vector<double>() : RefractiveDecrements(spectrum, table);
  XRaySource source;
  XRayDetector detector;
  const VolumeFromGantry gantry = PlaceBeam(arguments, surface, table, source, detector);
  std::optional<Mammogram> mammogram;
  if (IsDicomPath(arguments.Output))
  {
    mammogram = DescribeMammogram(arguments, source, detector);
    mammogram->PeakKilovoltage = spectrum.PeakEnergyKeV();
  }

  const std::string overlap = arguments.OverlapPriority.empty()
    ? MeasureOverlap(surface, source, detector, ShareOf(progress, 0.1, 0.2)).Warning(table.Names())
    : std::string();
  ReportProgress(progress, 0.2, "tracing rays");
  ProjectorOptions options = arguments.Projector;
  for (const std::string& name : arguments.OverlapPriority)
  {
    options.Priority.push_back(table.IndexOf(name));
  }
  const auto projector = MakeProjector(options);
  projector->SetSurface(surface);
  const std::shared_ptr<const VoxelScene> voxels = arguments.Scatter.NeedsVoxels()
    ? MakeVoxelScene(arguments.Scatter, surface, table, ShareOf(progress, 0.2, 0.3))
    : nullptr;
  const ScatterSource scatter(arguments.Scatter, arguments.Unit.SupportHeightMm, spectrum, response,
    voxels);
  const Camera camera{ arguments, *projector, surface, beam, decrements, spectrum, response,
    scatter };
  const std::string warning = arguments.Series.IsAsked()
    ? RunSeries(camera, MakeSeries(arguments.Series, source, detector, MiddleOf(surface), gantry),
        source, detector, mammogram, progress)
    : arguments.DualEnergy.IsAsked()
    ? RunDualEnergy(camera, source, detector, table, progress)
    : RunOne(camera, source, detector, table, std::move(mammogram), progress);
  const std::string dose = arguments.Scatter.Dose
    ? DescribeDose(arguments.Scatter, *voxels, table, source, detector, spectrum,
        arguments.Exposure.PhotonsPerPixel,
        IsPlacedByUnit(arguments)
          ? std::optional(arguments.Unit.SupportHeightMm + arguments.Pose.ThicknessMm)
          : std::nullopt,
        ShareOf(progress, 0.85, 1.0))
    : std::string();
  ReportProgress(progress, 1.0, "done");
  if (!dose.empty())
  {
    std::printf("%s\n", dose.c_str());
  }
  if (arguments.Series.IsAsked())
  {
    std::printf("%d projections of ", arguments.Series.Number());
  }
  std::printf(
    "%d x %d pixels, %zu triangles, %s, mean %.1f keV, half-value layer %.3g mm Al, on %s, %s\n",
    detector.Columns, detector.Rows, surface.NumberOfTriangles(), spectrum.Name.c_str(),
    spectrum.MeanEnergyKeV(), HalfValueLayerMm(spectrum), projector->DeviceName().c_str(),
    MethodName(projector->Method()).c_str());
  if (!warning.empty())
  {
    std::fprintf(stderr, "mammoray: warning: %s\n", warning.c_str());
  }
  if (!overlap.empty())
  {
    std::fprintf(stderr, "mammoray: warning: %s; --overlap-priority counts them once\n",
      overlap.c_str());
  }
}
}

void AddProjectCommand(CLI::App& application)
{
  AddCommand<ProjectArguments>(application, "project",
    "Synthetic X-ray of a mesh.\nAll positions are mm in the mesh's frame. The mammography unit is "
    "placed "
    "by --orientation and the pose options: the gantry frame has its origin at the middle of the "
    "receptor's chest-wall edge, +x along it (patient left in CC), +y to the nipple, +z to the "
    "source; "
    "columns run along +y, rows along -x (of a right breast's .dcm against them, as it is hung). "
    "Explicit positions replace that.",
    DeclareProject, Run);
}
}
