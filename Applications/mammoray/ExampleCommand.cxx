// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Evidence/VirtualStudy.h"
#endif

#include "vtkImageData.h"
#include "vtkPolyData.h"

#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

struct ExampleArguments
{
  std::string Name;
  std::string Output;
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  ProjectorOptions Projector;
  bool Overwrite = false;
#ifdef MAMMORAY_HAS_MESHING
  /// Of a study; without a path the shipped phantom, in whose table and frame the others are.
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
  std::string Materials = "victre";
  std::string Orientation = "ALS";
  std::string Contrast = "both";
  VirtualStudyOptions Study;
#endif
};

/// An example's files in a folder: mesh, transmission and picture.
struct ExampleFiles
{
  ExampleFiles(const std::string& folder, const std::string& name)
    : Mesh((fs::path(folder) / (name + ".vtp")).string())
    , Image((fs::path(folder) / (name + ".mha")).string())
    , Picture((fs::path(folder) / (name + ".png")).string())
  {
  }
  std::string Mesh;
  std::string Image;
  std::string Picture;
};

/// Whether the folder is to be made, with all files at once; throws InputError where it cannot be,
/// and where one is there that the files cannot be put into.
bool IsFolderToBeMade(const std::string& folder, const ExampleFiles& files, bool overwrite)
{
  std::error_code none;
  if (!folder.empty() && !fs::exists(folder, none))
  {
    ReserveFolder(folder);
    return true;
  }
  if (!fs::is_directory(folder, none))
  {
    throw InputError("output " + folder + ": expected a folder, or a name for a new one");
  }
  for (const std::string& file : { files.Mesh, files.Image, files.Picture })
  {
    CheckOutputFile(file, overwrite);
  }
  return false;
}

#ifdef MAMMORAY_HAS_MESHING
void DeclareStudy(const OptionList& add, ExampleArguments& arguments)
{
  VirtualStudyOptions& study = arguments.Study;
  add("--seed", study.Seed, "of stiffness, poses, thickness and noise");
  add.Choice<char>("--side", study.Laterality, { { "left", 'L' }, { "right", 'R' } },
    "the breast that is registered");
  const OptionList expert = add.Expert();
  AddLabelsOption(expert, arguments.Labels.Path);
  AddMaterialsOption(expert, arguments.Materials);
  AddOrientationOption(expert, arguments.Orientation);
  AddLabelSpacingOption(expert, arguments.Labels.SpacingMm);
  expert("--mri-pixel", study.MriPixelMm, Positive("mm"), "voxels of the MRI, in plane");
  expert("--mri-slice", study.MriSliceMm, Positive("mm"), "distance of its slices");
  expert("--mammogram-pixel", study.MammogramPixelMm, Positive("mm"), "pixels of the mammograms");
  expert("--gravity-fineness", study.GravityFineness, Positive(),
    "cells of the hanging breast: edge of a cube as large as the breast, over this");
  expert("--compression-fineness", study.CompressionFineness, Positive(),
    "the same of the compressed one");
  expert("--anatomy-cell", study.AnatomyMm, Positive("mm"), "cells of the anatomy that is X-rayed");
  const OptionList file = add.CaseFile();
  file.Word("--contrast", arguments.Contrast, { "both", "plain", "fat-suppressed" },
    "T1 without and with fat suppression, or one of them");
  file.FlagOff("--one-breast", study.BothBreasts, "no other breast in the field of view");
  file.Choice<ScannerStyle>("--scanner", study.Style,
    { { "by-seed", ScannerStyle::BySeed }, { "siemens", ScannerStyle::Siemens },
      { "ge", ScannerStyle::Ge }, { "philips", ScannerStyle::Philips } },
    "whose headers the MRI imitates");
  file("--snr", study.SignalToNoise, Positive(), "signal of fat over the noise, in the breast");
}

void RunStudy(ExampleArguments& arguments)
{
  VirtualStudyOptions& options = arguments.Study;
  options.Plain = arguments.Contrast != "fat-suppressed";
  options.FatSuppressed = arguments.Contrast != "plain";
  options.Spectrum = arguments.Spectrum;
  if (arguments.Labels.Path.empty())
  {
    arguments.Labels.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
  }
  const MaterialTable table = FindMaterialTable(arguments.Materials);
  const VirtualStudyTruth truth = MakeVirtualStudy(ReadMaterials(arguments.Labels, table), table,
    AnatomicalAxes::FromCode(arguments.Orientation), options, arguments.Output, MakeProgressBar());
  std::printf("%s/export: MRI of a prone patient, CC and MLO of the %s breast\n",
    arguments.Output.c_str(), truth.Laterality == 'L' ? "left" : "right");
  for (std::size_t index = 1; index < truth.Materials.size(); ++index)
  {
    std::printf("  %-8s %6.2f kPa\n", truth.Materials[index].c_str(), truth.YoungsModuliKPa[index]);
  }
  std::printf("  gravity moved the tissue by %.1f mm\n", truth.MeanHangMm);
  for (const VirtualView& view : truth.Views)
  {
    std::printf("  %-3s %.1f mm thick (header %.0f), roll %.1f degrees, %.0f N: %s\n",
      view.View.c_str(), view.Pose.ThicknessMm, view.HeaderThicknessMm, view.Pose.RollDeg,
      view.PaddleForceN, view.File.c_str());
  }
  std::printf("%s/truth.json: %zu points in the MRI and in both views\n", arguments.Output.c_str(),
    truth.MriPoints.size());
}
#endif

void Declare(const OptionList& add, ExampleArguments& arguments)
{
  add("name", arguments.Name, "test, boxes, veins, breast or study")->required();
  add("-o,--output", arguments.Output,
    "folder for the files, made if need be; of a study a new or empty one")
    ->required();
  AddOverwriteFlag(add, arguments.Overwrite);
  AddSpectrumOption(add.Expert(), arguments.Spectrum);
  AddProjectorOptions(add, arguments.Projector);
#ifdef MAMMORAY_HAS_MESHING
  DeclareStudy(add.Group("Of a study"), arguments);
#endif
}

void Run(ExampleArguments& arguments)
{
#ifdef MAMMORAY_HAS_MESHING
  if (arguments.Name == "study")
  {
    RunStudy(arguments);
    return;
  }
#endif
  const ProgressCallback progress = MakeProgressBar();
  const Spectrum spectrum = FindSpectrum(arguments.Spectrum);
  ReportProgress(progress, 0.0, "making the mesh");
  const ExampleScene scene = MakeExampleScene(arguments.Name);
  const std::vector<std::string> names = scene.Materials.Names();
  const Beam beam = MakeBeam(scene.Materials, spectrum, DetectorResponse::EnergyIntegrating);
  const ExampleFiles files(arguments.Output, scene.Name);
  const bool makesFolder = IsFolderToBeMade(arguments.Output, files, arguments.Overwrite);

  ReportProgress(progress, 0.3, "projecting");
  const auto projector = MakeProjector(arguments.Projector);
  projector->SetSurface(scene.Surface);
  const Exposure exposure = Expose(*projector, scene.Source, scene.Detector, beam);
  const auto image = ToImage(exposure, scene.Detector, names);

  const auto write = [&](const std::string& folder)
  {
    const ExampleFiles into(folder, scene.Name);
    ReportProgress(progress, 0.4, "writing");
    WriteMesh(ToPolyData(scene.Surface, names), into.Mesh);
    ReportProgress(progress, 0.9, "writing");
    WriteProjection(image, into.Image);
    WriteRadiograph(image, into.Picture);
  };
  if (makesFolder)
  {
    WriteAtomicFolder(arguments.Output, write);
  }
  else
  {
    write(arguments.Output);
  }
  ReportProgress(progress, 1.0, "done");
  std::printf("%s: %zu triangles, %zu materials, %d x %d pixels, on %s, %s\n%s\n%s\n%s\n",
    scene.Name.c_str(), scene.Surface.NumberOfTriangles(), scene.Materials.Materials.size() - 1,
    scene.Detector.Columns, scene.Detector.Rows, projector->DeviceName().c_str(),
    MethodName(projector->Method()).c_str(), files.Mesh.c_str(), files.Image.c_str(),
    files.Picture.c_str());
}
}

void AddExampleCommand(CLI::App& application)
{
  AddCommand<ExampleArguments>(application, "example",
    "Makes an example: a mesh and its synthetic X-ray, or a clinic's export.\n"
    "  test    a plate, 15,626 triangles, 150 x 200 pixels\n"
    "  boxes   3965 boxes of three materials, 47,580 triangles, 250 x 200 pixels\n"
    "  veins   97 tubes, 215,728 triangles, 1681 x 2071 pixels\n"
    "  breast  the FDA's phantom 1, stretched to 50 mm thickness, 5,185,458 triangles, 1080 x 1080 "
    "pixels\n"
    "Writes NAME.vtp (mm, material on each triangle's front and back), NAME.mha (transmission, 0 "
    "to 1) and NAME.png (logarithmic attenuation, dense is bright).\n"
    "  study   a patient's export with known truth: prone MRI among other series, CC and MLO, of a "
    "phantom\nWrites export/ (DICOM) and truth.json.",
    Declare, Run);
}
}
