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
#include "mammoray/IO/ShippedExamples.h"
#include "mammoray/XRay/Exposer.h"

#include "vtkImageData.h"
#include "vtkPolyData.h"

#include <cstdio>
#include <filesystem>
#include <memory>

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
bool IsFolderToBeMade(const std::string& folder, const ExampleFiles& files)
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
    CheckOutputFile(file);
  }
  return false;
}

void Declare(const OptionList& add, ExampleArguments& arguments)
{
  add("name", arguments.Name, "test, boxes, veins or breast")->required();
  add("-o,--output", arguments.Output, "folder for the three files, made if need be")->required();
  add.Expert()(Shared::Spectrum, arguments.Spectrum);
}

void Run(ExampleArguments& arguments)
{
  const ProgressCallback progress = MakeProgressBar();
  Scene exposed;
  exposed.XRays = FindSpectrum(arguments.Spectrum);
  ReportProgress(progress, 0.0, "making the mesh");
  const ExampleScene scene = MakeExampleScene(arguments.Name);
  const std::vector<std::string> names = scene.Materials.Names();
  exposed.Samples = { { std::make_shared<const SurfaceMesh>(scene.Surface) } };
  exposed.Materials = scene.Materials;
  exposed.Attenuations = FindAttenuations(scene.Materials);
  exposed.Source = scene.Source;
  exposed.Detector = scene.Detector;
  const ExampleFiles files(arguments.Output, scene.Name);
  const bool makesFolder = IsFolderToBeMade(arguments.Output, files);

  ReportProgress(progress, 0.3, "projecting");
  Exposer exposer(Program().Projector);
  const Exposure exposure = exposer.Expose(exposed);
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
    scene.Detector.Columns, scene.Detector.Rows, exposer.DeviceName().c_str(),
    MethodName(exposer.Method()).c_str(), files.Mesh.c_str(), files.Image.c_str(),
    files.Picture.c_str());
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
    "to 1) and NAME.png (logarithmic attenuation, dense is bright).",
    "example breast -o example", Declare, Run);
}
}
