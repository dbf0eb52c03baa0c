// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/Case/ExampleData.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"

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
};

/// Makes the folder, if its parent is there; throws InputError where it or a file in it cannot be.
void PrepareFolder(const std::string& folder, const std::vector<std::string>& files, bool overwrite)
{
  std::error_code failure;
  if (!fs::is_directory(folder) && (!fs::create_directory(folder, failure) || failure))
  {
    throw InputError(
      "output " + folder + ": expected a folder, or a name for one in a folder that exists");
  }
  for (const std::string& file : files)
  {
    CheckOutputFile(file, overwrite);
  }
}

void Declare(const OptionList& add, ExampleArguments& arguments)
{
  add("name", arguments.Name, "test, boxes, veins or breast")->required();
  add("-o,--output", arguments.Output, "folder for the three files; made if need be")->required();
  AddSpectrumOption(add, arguments.Spectrum);
  AddProjectorOptions(add, arguments.Projector);
  AddOverwriteFlag(add, arguments.Overwrite);
}

void Run(ExampleArguments& arguments)
{
  const ProgressCallback progress = MakeProgressBar();
  const Spectrum spectrum = FindSpectrum(arguments.Spectrum);
  ReportProgress(progress, 0.0, "making the mesh");
  const ExampleScene scene = MakeExampleScene(arguments.Name);
  const std::vector<std::string> names = scene.Materials.Names();
  const Beam beam = MakeBeam(scene.Materials, spectrum, DetectorResponse::EnergyIntegrating);
  const std::string stem = (fs::path(arguments.Output) / scene.Name).string();
  const std::string meshPath = stem + ".vtp";
  const std::string imagePath = stem + ".mha";
  const std::string picturePath = stem + ".png";
  PrepareFolder(arguments.Output, { meshPath, imagePath, picturePath }, arguments.Overwrite);

  ReportProgress(progress, 0.3, "projecting");
  const auto projector = MakeProjector(arguments.Projector);
  projector->SetSurface(scene.Surface);
  const Exposure exposure = Expose(*projector, scene.Source, scene.Detector, beam);
  const auto image = ToImage(exposure, scene.Detector, names);

  // One within the other: none takes its final name before all of them are written.
  ReportProgress(progress, 0.4, "writing");
  WriteComplete(meshPath,
    [&](const std::string& temporaryMesh)
    {
      WriteMesh(ToPolyData(scene.Surface, names), temporaryMesh);
      ReportProgress(progress, 0.9, "writing");
      WriteComplete(imagePath,
        [&](const std::string& temporaryImage)
        {
          WriteProjection(image, temporaryImage);
          WriteComplete(picturePath,
            [&](const std::string& temporaryPicture) { WriteRadiograph(image, temporaryPicture); });
        });
    });
  ReportProgress(progress, 1.0, "done");
  std::printf("%s: %zu triangles, %zu materials, %d x %d pixels, on %s, %s\n%s\n%s\n%s\n",
    scene.Name.c_str(), scene.Surface.NumberOfTriangles(), scene.Materials.Materials.size() - 1,
    scene.Detector.Columns, scene.Detector.Rows, projector->DeviceName().c_str(),
    MethodName(projector->Method()).c_str(), meshPath.c_str(), imagePath.c_str(),
    picturePath.c_str());
}
}

void AddExampleCommand(CLI::App& application)
{
  AddCommand<ExampleArguments>(application, "example",
    "Makes an example: a mesh and its synthetic X-ray.\n"
    "  test    a plate, 15,626 triangles, 150 x 200 pixels\n"
    "  boxes   3965 boxes of three materials, 47,580 triangles, 250 x 200 pixels\n"
    "  veins   97 tubes, 215,728 triangles, 1681 x 2071 pixels\n"
    "  breast  the FDA's phantom 1, stretched to 50 mm thickness, 5,185,458 triangles, 1080 x 1080 "
    "pixels\n"
    "Writes NAME.vtp (mm, material on each triangle's front and back), NAME.mha (transmission, 0 "
    "to "
    "1) and\nNAME.png (logarithmic attenuation, dense is bright).",
    Declare, Run);
}
}
