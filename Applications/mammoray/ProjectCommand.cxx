// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ProjectOptions.h"
#include "ScatterAndDose.h"
#include "SharedOptions.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Display.h"
#include "mammoray/XRay/DualEnergy.h"
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/OverlapMeasure.h"
#include "mammoray/XRay/Shadow.h"
#include "mammoray/XRay/Tube.h"

#include "vtkImageData.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <regex>
#include <utility>

namespace mammoray
{
namespace
{
/// The picture turned by 180 degrees: a right breast is hung with its chest wall at the right.
void TurnHalf(XRayDetector& detector)
{
  detector.Origin = detector.Origin + (detector.Columns - 1.0) * detector.ColumnStep +
    (detector.Rows - 1.0) * detector.RowStep;
  detector.ColumnStep = -1.0 * detector.ColumnStep;
  detector.RowStep = -1.0 * detector.RowStep;
}

/// Places source and detector as the scene's file or explicit options give them, or as the
/// mammography unit has them; frame of the mesh. Gives the place of the unit.
VolumeFromGantry PlaceBeam(const ProjectArguments& arguments, const SurfaceMesh& surface,
  Scene& scene)
{
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.Orientation);
  const PoseFrame frame = arguments.Anchor ? PoseFrame{ axes, *arguments.Anchor }
                                           : FindPoseFrame(surface, scene.Materials.Fixed(), axes);
  const VolumeFromGantry gantry = PlaceUnit(frame, arguments.Unit, arguments.Pose);
  const SceneDescription& description = arguments.Scene;
  if (!description.HasDetector())
  {
    XRayDetector& detector = scene.Detector;
    const int samples = detector.Samples;
    const double spacing = description.PixelSpacingMm;
    detector = DetectorOfUnit(gantry, detector.Columns, detector.Rows, { spacing, spacing });
    detector.Samples = samples;
  }
  if (IsDicomPath(arguments.Output) && arguments.Laterality == 'R' && arguments.IsPlacedByUnit())
  {
    TurnHalf(scene.Detector);
  }
  if (!description.HasSource())
  {
    scene.Source.Position = gantry.Point({ 0, 0, arguments.Unit.SourceToDetectorMm });
  }
  return gantry;
}

/// The description with the places that the unit gave.
SceneDescription WithPlaces(SceneDescription description, const Scene& scene)
{
  XRayDetector& detector = description.Fixed.Detector;
  description.Fixed.Source = scene.Source;
  detector = scene.Detector;
  description.PixelSpacingMm = Norm(detector.ColumnStep);
  detector.ColumnStep = (1 / description.PixelSpacingMm) * detector.ColumnStep;
  detector.RowStep = (1 / Norm(detector.RowStep)) * detector.RowStep;
  const bool isPoint = scene.Source.Type == XRaySource::Kind::Point;
  description.Keys.insert(description.Keys.end(),
    { isPoint ? "source.position" : "source.beam-direction", "detector.origin",
      "detector.column-direction", "detector.row-direction", "detector.columns", "detector.rows",
      "detector.pixel-spacing" });
  if (scene.Scatter.Method == SceneScatter::Model::Kernels)
  {
    description.Keys.emplace_back("scatter.air-gap");
  }
  return description;
}

/// What the options say of a mammogram.
SceneMammogram MammogramOf(const ProjectArguments& arguments)
{
  SceneMammogram mammogram{ .Axes = AnatomicalAxes::FromCode(arguments.Orientation),
    .Laterality = *arguments.Laterality,
    .View = arguments.View,
    .ForProcessing = arguments.ForProcessing,
    .Display = arguments.Display };
  if (arguments.IsPlacedByUnit())
  {
    mammogram.ThicknessMm = arguments.Pose.ThicknessMm;
    mammogram.SourceToPatientMm =
      arguments.Unit.SourceToDetectorMm - arguments.Unit.SupportHeightMm;
  }
  return mammogram;
}

void CheckDeflection(const ProjectArguments& arguments)
{
  if (arguments.Deflection.empty())
  {
    return;
  }
  if (!arguments.Scene.Fixed.Refraction)
  {
    throw InputError("--deflection: expected refraction.law beside it, found none");
  }
  const std::string extension = std::filesystem::path(arguments.Deflection).extension().string();
  if (extension == ".png" || extension == ".tif")
  {
    throw InputError("--deflection: expected .mha, .nrrd or .vti, found " + arguments.Deflection);
  }
  CheckProjectionExtension(arguments.Deflection);
  CheckOutputFile(arguments.Deflection);
}

void CheckInputs(const ProjectArguments& arguments)
{
  const SceneDescription& scene = arguments.Scene;
  if (scene.Mesh.empty() == scene.Samples.empty())
  {
    throw InputError(
      std::string(
        "project: expected either --mesh or --surface, or a --scene with samples, found ") +
      (scene.Mesh.empty() ? "neither" : "both"));
  }
  if (!scene.Mesh.empty() && scene.Materials.empty())
  {
    throw InputError("--mesh: expected --materials beside it, found none");
  }
}

void CheckOutputs(const ProjectArguments& arguments)
{
  CheckDeflection(arguments);
  if (arguments.Display &&
    (arguments.ForProcessing || arguments.Series.IsAsked() || arguments.DualEnergy.IsAsked()))
  {
    throw InputError("--display: expected one picture, not For Processing, found another");
  }
  CheckSeries(arguments.Series, arguments.Output);
  if (!arguments.DualEnergy.IsAsked() && !arguments.DualEnergy.Cancel.empty())
  {
    throw InputError("--cancel: expected --high beside it, found none");
  }
  if (arguments.DualEnergy.IsAsked())
  {
    const std::string extension = std::filesystem::path(arguments.Output).extension().string();
    if (arguments.Series.IsAsked() || arguments.Scene.Fixed.Refraction || extension == ".png" ||
      IsDicomPath(arguments.Output))
    {
      throw InputError("dual energy: expected one picture (.mha .nrrd .tif .vti) without "
                       "refraction, found another");
    }
    CheckOutputFile(BesideOutput(arguments.Output, "_low"));
    CheckOutputFile(BesideOutput(arguments.Output, "_high"));
  }
  const bool isDicom = IsDicomPath(arguments.Output);
  if (arguments.Series.IsAsked() &&
    (!arguments.PathLengths.empty() || !arguments.Deflection.empty()))
  {
    throw InputError("series: expected no --path-lengths or --deflection beside it, found one");
  }
  if (arguments.Series.IsAsked() && !isDicom)
  {
    CheckOutputFile(SeriesDescriptionPath(arguments.Output));
    if (arguments.Series.FlatFields > 0)
    {
      CheckOutputFile(FlatFieldPath(arguments.Output));
    }
  }
  else if (isDicom)
  {
    if (arguments.Series.IsAsked() && !arguments.IsPlacedByUnit())
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
  CheckOutputFile(arguments.Output);
  if (!arguments.MakeKernels.empty())
  {
    if (arguments.DualEnergy.IsAsked())
    {
      throw InputError("--make-kernels: expected one beam, found --high beside it");
    }
    CheckOutputFile(arguments.MakeKernels);
  }
  if (!arguments.PathLengths.empty())
  {
    CheckProjectionExtension(arguments.PathLengths, true);
    CheckOutputFile(arguments.PathLengths);
  }
}

DicomMammogramOptions DicomOptions(const ProjectArguments& arguments)
{
  DicomMammogramOptions options;
  options.Identity = arguments.Patient.Identity();
  options.Derivation = SyntheticDerivation(arguments.ForProcessing, "a breast");
  return options;
}

/// A scene before an exposer, and the views that the command wants of it.
struct ProjectionJob
{
  const ProjectArguments& Arguments;
  Exposer& Device;
  const SurfaceMesh& Surface;
  Scene Standing;
  /// The samples that make up the surface.
  std::vector<SceneSample> Parts;

  /// What is wrong with a picture, in lines, or nothing. Between explicit source and detector a
  /// part is meant to be seen whole; a breast never is.
  std::string WarningOf(const Scene& scene, const Exposure& exposure) const
  {
    std::string holes = exposure.Lengths->InconsistencyWarning();
    const SceneDescription& given = this->Arguments.Scene;
    if (!holes.empty())
    {
      return holes;
    }
    Scene inParts = scene;
    inParts.Samples = this->Parts;
    const std::vector<bool> fixed = scene.Materials.Fixed();
    const bool isBreast =
      given.Samples.empty() && std::find(fixed.begin(), fixed.end(), true) != fixed.end();
    const std::string shadow =
      ShadowWarning(inParts, exposure, !isBreast && given.HasSource() && given.HasDetector());
    return std::regex_replace(shadow, std::regex("\\?(?=\n|$)"), "? (--unit)");
  }

  /// The `number`-th of a series from elsewhere, with noise of its own.
  Exposure Take(Scene& scene, int number, const ProgressCallback& progress) const
  {
    scene.Detection.Seed = this->Standing.Detection.Seed + static_cast<std::uint64_t>(number);
    return this->Device.Expose(scene, progress);
  }
};

/// Writes one picture. Gives a warning, or nothing.
std::string RunOne(const ProjectionJob& job, const std::optional<SceneMammogram>& mammogram,
  const ProgressCallback& progress)
{
  const ProjectArguments& arguments = job.Arguments;
  Scene scene = job.Standing;
  const XRayDetector& detector = scene.Detector;
  const Exposure exposure = job.Take(scene, 0, ShareOf(progress, 0.2, 0.8));
  ReportProgress(progress, 0.8, "writing");
  const auto image = ToImage(exposure, detector, scene.Materials.Names());
  if (mammogram)
  {
    WriteMammogram(MakeMammogram(exposure, scene, *mammogram), DicomOptions(arguments),
      arguments.Output);
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
  if (!arguments.Deflection.empty())
  {
    WriteProjection(ToDeflectionImage(exposure, detector), arguments.Deflection);
  }
  return job.WarningOf(scene, exposure);
}

/// Writes two exposures and their recombination. Gives a warning, or nothing.
std::string RunDualEnergy(const ProjectionJob& job, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = job.Arguments;
  Scene low = job.Standing;
  Scene high = job.Standing;
  high.XRays = ToHighSpectrum(arguments.DualEnergy, arguments.Scene);
  const XRayDetector& detector = low.Detector;
  const MaterialTable& table = low.Materials;
  const std::vector<std::string> pair = arguments.DualEnergy.Cancel.empty()
    ? std::vector<std::string>{ "fat", "gland" }
    : arguments.DualEnergy.Cancel;
  const double weight = CancellingWeight(MakeBeam(low), MakeBeam(high), table.IndexOf(pair[0]),
    table.IndexOf(pair[1]), arguments.DualEnergy.ThicknessMm);
  const Exposure atLow = job.Take(low, 0, ShareOf(progress, 0.2, 0.5));
  const Exposure atHigh = job.Take(high, 1, ShareOf(progress, 0.5, 0.8));
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
    high.XRays.Name.c_str(), high.XRays.MeanEnergyKeV(), weight, pair[0].c_str(), pair[1].c_str(),
    arguments.DualEnergy.ThicknessMm);
  return job.WarningOf(low, atLow);
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

/// Each line of the text behind the prefix.
std::string PrefixedLines(const std::string& text, const std::string& prefix)
{
  return prefix + std::regex_replace(text, std::regex("\n"), "\n" + prefix);
}

using TakeProjection = std::function<void(const ProjectionView& view, const Exposure& exposure)>;

/// Takes all projections of a series. Gives the first warning of one, or nothing.
std::string TakeSeries(const ProjectionJob& job, Scene scene, const ProjectionSeries& series,
  const ProgressCallback& progress, const TakeProjection& take)
{
  std::string warning;
  const int count = static_cast<int>(series.Views.size());
  int number = 0;
  int empty = 0;
  for (const ProjectionView& view : series.Views)
  {
    const double begin = 0.2 + 0.6 * number / count;
    ReportProgress(progress, begin, "projecting");
    scene.Source = view.Source;
    scene.Detector = view.Detector;
    const Exposure exposure =
      job.Take(scene, number, ShareOf(progress, begin, 0.2 + 0.6 * (number + 1) / count));
    // Shadows are measured until there is something to say of one.
    const std::string found = warning.empty() ? job.WarningOf(scene, exposure) : std::string();
    if (!found.empty())
    {
      warning = PrefixedLines(found, "projection " + std::to_string(number) + ": ");
    }
    const std::vector<float>& lengths = exposure.Lengths->Lengths;
    empty += std::none_of(lengths.begin(), lengths.end(), [](float length) { return length != 0; });
    take(view, exposure);
    ++number;
  }
  if (empty > 0)
  {
    warning += (warning.empty() ? "" : "\n") + std::to_string(empty) + " of " +
      std::to_string(count) + " projections show nothing of the object";
  }
  return warning;
}

/// Writes a series as a stack and the files beside it. Gives a warning, or nothing.
std::string RunStack(const ProjectionJob& job, const ProjectionSeries& series,
  const ProgressCallback& progress)
{
  const ProjectArguments& arguments = job.Arguments;
  const XRayDetector& detector = job.Standing.Detector;
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
  Scene standing = job.Standing;
  if (standing.HasField())
  {
    standing.Detection.OpenField =
      OpenField(standing.Source, detector, standing.XRays, standing.Response, standing.Field);
  }
  std::string warning = TakeSeries(job, arguments.Series.Turn > 0 ? standing : job.Standing, series,
    progress, [&](const ProjectionView&, const Exposure& exposure) { add(stack, exposure); });
  while (flats.Number < arguments.Series.FlatFields)
  {
    ReportProgress(progress, 0.8, "flat fields");
    standing.Detection.Seed =
      job.Standing.Detection.Seed + static_cast<std::uint64_t>(stack.Number + flats.Number);
    add(flats, Exposer::ExposeAir(standing));
  }
  ReportProgress(progress, 0.85, "writing");
  WriteProjectionStack(stack, arguments.Output);
  if (flats.Number > 0)
  {
    WriteProjectionStack(flats, FlatFieldPath(arguments.Output));
  }
  WriteAtomicFile(SeriesDescriptionPath(arguments.Output),
    DescribeSeries(arguments.Series, series, standing.Source, detector));
  return warning;
}

/// Writes a tomosynthesis as one DICOM object. Gives a warning, or nothing.
std::string RunBreastProjections(const ProjectionJob& job, const ProjectionSeries& series,
  const SceneMammogram& mammogram, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = job.Arguments;
  const Mammogram described = DescribeMammogram(job.Standing, mammogram);
  std::vector<Mammogram> projections;
  std::string warning = TakeSeries(job, job.Standing, series, progress,
    [&](const ProjectionView& view, const Exposure& exposure)
    {
      Mammogram& projection = projections.emplace_back(described);
      const DetectorPlane plane(view.Source, view.Detector);
      projection.SourceToDetectorMm = plane.HeightMm;
      projection.SourceToPatientMm =
        *projection.SourceToDetectorMm - arguments.Unit.SupportHeightMm;
      projection.SourceFootPixel = { plane.FootColumn, plane.FootRow };
      SetPixels(projection, exposure.LogAttenuation,
        arguments.ForProcessing ? Mammogram::Intent::ForProcessing
                                : Mammogram::Intent::ForPresentation);
    });
  ReportProgress(progress, 0.85, "writing");
  WriteProjections(projections, DicomOptions(arguments), arguments.Series.PivotHeightMm,
    arguments.Output);
  return warning;
}

/// Writes what is asked for. Gives a warning, or nothing.
std::string RunAsked(const ProjectionJob& job, const VolumeFromGantry& gantry,
  const std::optional<SceneMammogram>& mammogram, const ProgressCallback& progress)
{
  const ProjectArguments& arguments = job.Arguments;
  if (arguments.DualEnergy.IsAsked())
  {
    return RunDualEnergy(job, progress);
  }
  if (!arguments.Series.IsAsked())
  {
    return RunOne(job, mammogram, progress);
  }
  const ProjectionSeries series = MakeSeries(arguments.Series, job.Standing.Source,
    job.Standing.Detector, MiddleOf(job.Surface), gantry);
  return mammogram ? RunBreastProjections(job, series, *mammogram, progress)
                   : RunStack(job, series, progress);
}

void PrintProjected(const ProjectArguments& arguments, const ProjectionJob& job)
{
  const Scene& scene = job.Standing;
  if (arguments.Series.IsAsked())
  {
    std::printf("%d projections of ", arguments.Series.Number());
  }
  std::printf(
    "%d x %d pixels, %zu triangles, %s, mean %.1f keV, half-value layer %.3g mm Al, on %s, %s\n",
    scene.Detector.Columns, scene.Detector.Rows, job.Surface.NumberOfTriangles(),
    scene.XRays.Name.c_str(), scene.XRays.MeanEnergyKeV(), HalfValueLayerMm(scene.XRays),
    job.Device.DeviceName().c_str(), MethodName(job.Device.Method()).c_str());
}

/// Makes kernels of scatter for the scene, writes them, and gives them to it.
void MakeKernels(const ProjectArguments& arguments, Exposer& exposer, Scene& scene,
  const ProgressCallback& progress)
{
  if (arguments.MakeKernels.empty())
  {
    return;
  }
  Scene plain = scene;
  plain.Scatter.Method = SceneScatter::Model::None;
  plain.Scatter.Grid.reset();
  plain.Detection = {};
  plain.Field = {};
  plain.Refraction.reset();
  plain.BendDistanceMm.reset();
  const Exposure seen = exposer.Expose(plain);
  ScatterKernels kernels = KernelAxesOf(scene, *seen.Lengths);
  FillScatterKernels(kernels, PhotonsPerSlab(kernels, scene.Scatter.Photons), 0, progress);
  WriteScatterKernels(kernels, "made by mammoray project --make-kernels", arguments.MakeKernels);
  scene.Scatter.Kernels = std::make_shared<const ScatterKernels>(std::move(kernels));
}

void Run(ProjectArguments& arguments)
{
  CompleteScene(arguments);
  CheckInputs(arguments);
  CheckOutputs(arguments);
  const ProgressCallback progress = MakeProgressBar();
  ReportProgress(progress, 0.0, "reading the mesh");
  Scene scene = LoadScene(arguments.Scene);
  scene.Validate();
  const std::shared_ptr<const SurfaceMesh> surface = Assemble(scene);
  const std::vector<SceneSample> parts =
    std::exchange(scene.Samples, std::vector<SceneSample>{ { surface } });
  const VolumeFromGantry gantry = PlaceBeam(arguments, *surface, scene);
  if (arguments.PrintScene)
  {
    std::fputs(WriteScene(WithPlaces(arguments.Scene, scene)).c_str(), stdout);
    return;
  }
  std::optional<SceneMammogram> mammogram;
  if (IsDicomPath(arguments.Output))
  {
    mammogram = MammogramOf(arguments);
    DescribeMammogram(scene, *mammogram); // refuses a geometry that no mammogram has
  }
  const std::string overlap = scene.OverlapPriority.empty()
    ? MeasureOverlap(*surface, scene.Source, scene.Detector, ShareOf(progress, 0.1, 0.2))
        .Warning(scene.Materials.Names())
    : std::string();
  const bool wantsDose = std::exchange(scene.Dose, false);
  if (wantsDose || scene.Scatter.Method == SceneScatter::Model::MonteCarlo)
  {
    scene.Scatter.Voxels = MakeVoxelScene(arguments.Scene.VoxelMm, *surface, scene.Materials,
      ShareOf(progress, 0.2, 0.3));
  }
  if (arguments.IsPlacedByUnit())
  {
    scene.DoseHeightMm = arguments.Unit.SupportHeightMm + arguments.Pose.ThicknessMm;
  }
  ReportProgress(progress, 0.2, "tracing rays");
  Exposer exposer(Program().Projector);
  MakeKernels(arguments, exposer, scene, ShareOf(progress, 0.2, 0.4));
  const ProjectionJob job{ arguments, exposer, *surface, std::move(scene), parts };
  const std::string warning = RunAsked(job, gantry, mammogram, progress);
  const std::string dose = wantsDose
    ? DescribeDose(ComputeDose(job.Standing, ShareOf(progress, 0.85, 1.0)), job.Standing.Materials,
        job.Standing.Detection.PhotonsPerPixel)
    : std::string();
  ReportProgress(progress, 1.0, "done");
  if (wantsDose)
  {
    std::printf("%s\n", dose.c_str());
  }
  PrintProjected(arguments, job);
  if (!warning.empty())
  {
    std::fprintf(stderr, "%s\n", PrefixedLines(warning, "mammoray: warning: ").c_str());
  }
  WarnOfOverlap(overlap);
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
    "project --mesh breast.vtu --materials victre --orientation ALS -o breast.mha", DeclareProject,
    Run);
}
}
