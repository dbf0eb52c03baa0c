// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "DicomOptions.h"
#include "mammoray/IO/DicomMammogramWriter.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/IO/SurfaceConversion.h"
#include "mammoray/XRay/Exposure.h"

#include "vtkImageData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

namespace mammoray
{
namespace
{
struct ProjectArguments
{
  std::string Mesh;
  std::string Materials;
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  double EnergyKeV = 0;
  std::string Response = "energy";
  std::string Orientation = "LPS";
  MammographyUnit Unit;
  BreastPose Pose;
  std::vector<double> Anchor;
  std::vector<double> Source;
  std::vector<double> BeamDirection;
  std::vector<double> DetectorOrigin;
  std::vector<double> ColumnDirection;
  std::vector<double> RowDirection;
  int Columns = 720;
  int Rows = 1080;
  double PixelSpacingMm = 0.1;
  int Samples = 1;
  std::vector<std::string> Attenuations;
  std::vector<double> FocalSpot;
  ExposureOptions Exposure;
  std::string Device;
  std::string Projector = "auto";
  std::string Laterality;
  std::string View;
  bool ForProcessing = false;
  DicomPatient Patient;
  std::string Output;
  std::string PathLengths;
  bool Overwrite = false;
};

Vector3 ToVector(const std::vector<double>& values)
{
  return { values[0], values[1], values[2] };
}

Vector3 ToUnitVector(const std::vector<double>& values, const char* option)
{
  const Vector3 vector = ToVector(values);
  const double length = Norm(vector);
  if (!(length > 0) || !std::isfinite(length))
  {
    throw InputError(std::string(option) + ": expected a direction, found a vector without length");
  }
  return (1 / length) * vector;
}

/// Each of them "material=attenuation" or "material=attenuation@density".
void ReplaceAttenuations(const std::vector<std::string>& texts, MaterialTable& table)
{
  for (const std::string& text : texts)
  {
    const std::size_t equals = text.find('=');
    const std::size_t at = std::min(text.rfind('@'), text.size());
    double density = 1;
    bool usable = equals != std::string::npos && equals > 0 && at > equals + 1;
    if (usable && at < text.size())
    {
      const char* const end = text.data() + text.size();
      const auto parsed = std::from_chars(text.data() + at + 1, end, density);
      usable = parsed.ec == std::errc() && parsed.ptr == end && density > 0;
    }
    if (!usable)
    {
      throw InputError(
        "--attenuation: expected MATERIAL=ATTENUATION[@DENSITY], found '" + text + "'");
    }
    Material& material =
      table.Materials[static_cast<std::size_t>(table.IndexOf(text.substr(0, equals)))];
    material.Attenuation = text.substr(equals + 1, at - equals - 1);
    material.DensityGPerCm3 = at < text.size() ? density : material.DensityGPerCm3;
  }
}

ExposureOptions ToExposure(const ProjectArguments& arguments)
{
  ExposureOptions options = arguments.Exposure;
  if (!arguments.FocalSpot.empty())
  {
    options.FocalSpotColumnMm = arguments.FocalSpot[0];
    options.FocalSpotRowMm = arguments.FocalSpot[1];
  }
  options.Validate();
  return options;
}

SurfaceMesh ReadInterfaces(const std::string& path, std::vector<std::string>& names)
{
  if (std::filesystem::path(path).extension() == ".vtu")
  {
    return ExtractInterfaces(FromGrid(ReadMesh(path), &names));
  }
  return FromPolyData(ReadSurface(path), &names);
}

/// Detector and source as a mammography unit has them, or as the explicit options say; mesh frame.
void PlaceBeam(const ProjectArguments& arguments, const SurfaceMesh& surface,
  const MaterialTable& table, XRaySource& source, XRayDetector& detector)
{
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.Orientation);
  const std::vector<bool> held = table.Held();
  const Vector3 anchor =
    arguments.Anchor.empty() ? FindPoseAnchor(surface, held, axes) : ToVector(arguments.Anchor);
  const VolumeFromGantry gantry = PlaceUnit(axes, anchor, arguments.Unit, arguments.Pose);
  const double spacing = arguments.PixelSpacingMm;
  const Vector3 columnDirection = arguments.ColumnDirection.empty()
    ? gantry.Y
    : ToUnitVector(arguments.ColumnDirection, "--column-direction");
  const Vector3 rowDirection = arguments.RowDirection.empty()
    ? -1.0 * gantry.X
    : ToUnitVector(arguments.RowDirection, "--row-direction");
  detector.Columns = arguments.Columns;
  detector.Rows = arguments.Rows;
  detector.Samples = arguments.Samples;
  detector.ColumnStep = spacing * columnDirection;
  detector.RowStep = spacing * rowDirection;
  detector.Origin = arguments.DetectorOrigin.empty()
    ? gantry.Point({ 0.5 * (arguments.Rows - 1) * spacing, 0.5 * spacing, 0 })
    : ToVector(arguments.DetectorOrigin);
  source.Position = arguments.Source.empty()
    ? gantry.Point({ 0, 0, arguments.Unit.SourceToDetectorMm })
    : ToVector(arguments.Source);
  if (!arguments.BeamDirection.empty())
  {
    source.Type = XRaySource::Kind::Parallel;
    source.Direction = ToVector(arguments.BeamDirection);
  }
}

/// Detector and patient as a mammogram's header says them; throws where it could not.
Mammogram DescribeMammogram(const ProjectArguments& arguments, const XRaySource& source,
  const XRayDetector& detector)
{
  Mammogram mammogram = DescribeProjection(source, detector,
    AnatomicalAxes::FromCode(arguments.Orientation), arguments.Laterality.front());
  mammogram.View = arguments.View.empty() ? mammogram.View : arguments.View;
  if (mammogram.View.empty())
  {
    throw InputError("output " + arguments.Output +
      ": expected --view for a DICOM mammogram of this roll, found none");
  }
  const bool placedByUnit = arguments.Source.empty() && arguments.BeamDirection.empty() &&
    arguments.DetectorOrigin.empty() && arguments.ColumnDirection.empty() &&
    arguments.RowDirection.empty();
  if (placedByUnit)
  {
    mammogram.BodyPartThicknessMm = arguments.Pose.ThicknessMm;
    mammogram.SourceToPatientMm =
      arguments.Unit.SourceToDetectorMm - arguments.Unit.SupportHeightMm;
  }
  return mammogram;
}

void CheckOutputs(const ProjectArguments& arguments)
{
  if (IsDicomPath(arguments.Output))
  {
    if (arguments.Laterality.empty())
    {
      throw InputError("output " + arguments.Output +
        ": expected --laterality L or R for a DICOM mammogram, found none");
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

void WriteMammogramFile(const ProjectArguments& arguments, Mammogram mammogram,
  const Exposure& exposure)
{
  SetPixels(mammogram, exposure.LogAttenuation,
    arguments.ForProcessing ? Mammogram::Intent::ForProcessing
                            : Mammogram::Intent::ForPresentation);
  DicomMammogramOptions options;
  options.Identity = arguments.Patient.Identity();
  options.Derivation = SyntheticDerivation(arguments.ForProcessing, "a breast");
  WriteComplete(arguments.Output,
    [&](const std::string& temporary) { WriteMammogram(mammogram, options, temporary); });
}

void RunProject(const ProjectArguments& arguments)
{
  CheckInputFile(arguments.Mesh);
  CheckOutputs(arguments);
  const ProgressCallback progress = MakeProgressBar();
  MaterialTable table = FindMaterialTable(arguments.Materials);
  ReplaceAttenuations(arguments.Attenuations, table);
  const Spectrum spectrum = arguments.EnergyKeV > 0 ? Spectrum::Monochromatic(arguments.EnergyKeV)
                                                    : FindSpectrum(arguments.Spectrum);
  const Beam beam = MakeBeam(table, spectrum,
    arguments.Response == "counting" ? DetectorResponse::PhotonCounting
                                     : DetectorResponse::EnergyIntegrating);
  ReportProgress(progress, 0.0, "reading the mesh");
  std::vector<std::string> names;
  const SurfaceMesh surface = ReadInterfaces(arguments.Mesh, names);
  table.CheckMesh(surface, names, arguments.Mesh);
  XRaySource source;
  XRayDetector detector;
  PlaceBeam(arguments, surface, table, source, detector);
  std::optional<Mammogram> mammogram;
  if (IsDicomPath(arguments.Output))
  {
    mammogram = DescribeMammogram(arguments, source, detector);
  }

  ReportProgress(progress, 0.2, "tracing rays");
  ProjectorOptions projectorOptions;
  projectorOptions.Projection = MethodFromName(arguments.Projector);
  projectorOptions.Device = arguments.Device;
  const auto projector = MakeProjector(projectorOptions);
  projector->SetSurface(surface);
  const Exposure exposure = Expose(*projector, source, detector, beam, ToExposure(arguments),
    [&](double fraction, const char* stage)
    { return !progress || progress(0.2 + 0.6 * fraction, stage); });
  const PathLengthImage& lengths = exposure.Lengths;
  ReportProgress(progress, 0.8, "writing");
  const auto image = ToImage(exposure, detector, table.Names());
  if (mammogram)
  {
    WriteMammogramFile(arguments, std::move(*mammogram), exposure);
  }
  else
  {
    WriteComplete(arguments.Output,
      [&](const std::string& temporary) { WriteProjection(image, temporary); });
  }
  if (!arguments.PathLengths.empty())
  {
    WriteComplete(arguments.PathLengths,
      [&](const std::string& temporary) { WriteProjection(image, temporary, true); });
  }
  ReportProgress(progress, 1.0, "done");
  std::printf("%d x %d pixels, %zu triangles, %s, mean %.1f keV, on %s, %s\n", lengths.Columns,
    lengths.Rows, surface.NumberOfTriangles(), spectrum.Name.c_str(), spectrum.MeanEnergyKeV(),
    projector->DeviceName().c_str(), MethodName(projector->Method()).c_str());
  if (const std::string warning = lengths.InconsistencyWarning(); !warning.empty())
  {
    std::fprintf(stderr, "mammoray: warning: %s\n", warning.c_str());
  }
}
}

void AddProjectCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("project",
    "Synthetic X-ray of a mesh.\nAll positions are mm in the mesh's frame. The mammography unit is "
    "placed "
    "by --orientation and the pose options: the gantry frame has its origin at the middle of the "
    "receptor's chest-wall edge, +x along it (patient left in CC), +y to the nipple, +z to the "
    "source; "
    "columns run along +y, rows along -x. Explicit positions replace that.");
  auto arguments = std::make_shared<ProjectArguments>();
  const auto add = [&](const char* name, auto& value, const char* help)
  { return command->add_option(name, value, help)->capture_default_str(); };
  const auto addVector = [&](const char* name, std::vector<double>& value, const char* help)
  { return command->add_option(name, value, help)->expected(3)->type_name("X Y Z"); };
  command
    ->add_option("--mesh", arguments->Mesh,
      "tetrahedra (.vtu, cell array Material) or triangles (.vtp, .stl, .ply, .obj)")
    ->required();
  AddMaterialsOption(*command, arguments->Materials)->required();
  command
    ->add_option("--attenuation", arguments->Attenuations,
      "another attenuation of a material of the table, and density, g/cm3: a shipped table's name, "
      "a "
      "NIST compound, a formula, or mass fractions ('gland=H:0.102 C:0.184 N:0.032 O:0.682@1.04')")
    ->type_name("MATERIAL=ATTENUATION[@DENSITY]")
    ->allow_extra_args(false);
  command
    ->add_option("-o,--output", arguments->Output,
      "transmission, 0 to 1 (.mha .nrrd .png); .vti holds path lengths and consistency too; .dcm: "
      "a "
      "DICOM mammogram")
    ->required();
  command->add_option("--path-lengths", arguments->PathLengths,
    "write path lengths there, mm, one channel per material but air (.mha .nrrd .vti)");
  add("--spectrum", arguments->Spectrum, "spectrum file (.spc), or a shipped one's name");
  command
    ->add_option("--kev", arguments->EnergyKeV,
      "a single photon energy, keV, instead of a spectrum")
    ->check(PositiveNumber());
  add("--response", arguments->Response,
    "what the detector adds up: energy, or photons by counting")
    ->check(CLI::IsMember({ "energy", "counting" }));
  add("--orientation", arguments->Orientation,
    "patient directions of the mesh's +x +y +z: LPS, RAS, ALS, ...");
  add("--source-to-detector", arguments->Unit.SourceToDetectorMm, "source to receptor plane, mm")
    ->check(PositiveNumber());
  add("--support-height", arguments->Unit.SupportHeightMm, "breast support above the receptor, mm")
    ->check(NonNegativeNumber());
  add("--thickness", arguments->Pose.ThicknessMm,
    "between support and paddle, mm; the anchor lies in the middle")
    ->check(PositiveNumber());
  add("--roll", arguments->Pose.RollDeg,
    "unit about the anterior axis, degrees; 0 is CC, positive turns the source to the patient's "
    "left");
  add("--shift-lateral", arguments->Pose.LateralMm, "shift of the receptor along gantry +x, mm");
  add("--shift-anterior", arguments->Pose.AnteriorMm, "shift of the receptor along gantry +y, mm");
  add("--shift-vertical", arguments->Pose.VerticalMm, "shift of the unit along gantry +z, mm");
  addVector("--anchor", arguments->Anchor,
    "point the pose refers to; default: middle of the mesh at the chest wall");
  addVector("--source", arguments->Source, "position of the source, instead of the unit's");
  addVector("--beam-direction", arguments->BeamDirection,
    "parallel X-rays that travel in this direction, instead of a point source");
  addVector("--detector-origin", arguments->DetectorOrigin,
    "centre of the pixel in column 0 and row 0, instead of the unit's");
  addVector("--column-direction", arguments->ColumnDirection,
    "from a pixel to that of the next column");
  addVector("--row-direction", arguments->RowDirection, "from a pixel to that of the next row");
  add("--columns", arguments->Columns, "pixels per row")->check(NumberFrom(1, 65535));
  add("--rows", arguments->Rows, "pixels per column")->check(NumberFrom(1, 65535));
  add("--pixel-spacing", arguments->PixelSpacingMm, "distance of pixel centres, mm")
    ->check(PositiveNumber());
  add("--samples", arguments->Samples,
    "samples x samples rays per pixel; their transmissions are averaged")
    ->check(NumberFrom(1, 16));
  command
    ->add_option("--focal-spot", arguments->FocalSpot,
      "edges of the focal spot along columns and rows, mm; default: a point")
    ->expected(2)
    ->type_name("W H")
    ->check(NumberFrom(0.0, 100.0));
  add("--focal-spot-samples", arguments->Exposure.FocalSpotSamples,
    "n x n source points for the focal spot; each costs a projection")
    ->check(NumberFrom(1, 32));
  add("--photons", arguments->Exposure.PhotonsPerPixel,
    "photons that meet a pixel without the object, on average; adds quantum noise, 0 adds none")
    ->check(NumberFrom(0.0, 1e12));
  add("--seed", arguments->Exposure.Seed, "of the noise: the same seed, the same image");
  command->add_option("--device", arguments->Device,
    "part of the wanted Vulkan device's name; see mammoray devices");
  AddProjectorOption(*command, arguments->Projector);
  command
    ->add_option("--laterality", arguments->Laterality, "the breast's side; needed for a mammogram")
    ->check(CLI::IsMember({ "L", "R" }))
    ->group("DICOM");
  command
    ->add_option("--view", arguments->View, "the mammogram's view; default: the one of the roll")
    ->check(CLI::IsMember({ "CC", "MLO", "ML", "LM", "LMO", "FB" }))
    ->group("DICOM");
  command
    ->add_flag("--for-processing", arguments->ForProcessing,
      "store the transmission, linear, instead of a picture For Presentation")
    ->group("DICOM");
  AddDicomPatientOptions(*command, arguments->Patient, false);
  command->add_flag("--overwrite", arguments->Overwrite, "replace output files");
  AddConfigurationOptions(*command);
  command->callback([arguments] { RunProject(*arguments); });
}
}
