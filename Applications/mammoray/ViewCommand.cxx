// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Viewer/BreastViewer.h"
#include "mammoray/Viewer/RequireDisplay.h"

#include <cstdio>
#include <filesystem>
#include <memory>

namespace mammoray
{
namespace
{
struct ViewArguments
{
  ViewInput Input;
  ViewerOptions Viewer;
  std::string Projector = "auto";
  std::vector<int> Size{ 1280, 800 };
  std::vector<double> Source;
  std::vector<double> Point;
  std::vector<double> Pixel;
  std::string Screenshot;
  bool Overwrite = false;
  int BenchmarkFrames = 0;
};

/// Bad input is told before the display is looked for.
void CheckInputs(const ViewArguments& arguments)
{
  const ViewInput& input = arguments.Input;
  for (const std::string& path :
    { input.Mesh, input.Series, input.Mammogram, input.SimulationMesh })
  {
    if (!path.empty())
    {
      CheckInputFile(path);
    }
  }
  if (!arguments.Screenshot.empty())
  {
    CheckOutputFile(arguments.Screenshot, arguments.Overwrite);
    if (std::filesystem::path(arguments.Screenshot).extension() != ".png")
    {
      throw InputError(arguments.Screenshot + ": expected the extension .png for a picture");
    }
  }
  if (!std::filesystem::is_directory(arguments.Viewer.PictureFolder))
  {
    throw InputError("--pictures " + arguments.Viewer.PictureFolder + ": there is no such folder");
  }
}

void RunView(const ViewArguments& arguments)
{
  CheckInputs(arguments);
  const ViewedBreast viewed = ReadViewedBreast(arguments.Input);
  RequireDisplay();
  ViewerOptions options = arguments.Viewer;
  options.OffScreen = !arguments.Screenshot.empty() || arguments.BenchmarkFrames > 0;
  options.Projector.Projection = MethodFromName(arguments.Projector);
  options.Stop = InterruptRequested;
  options.Width = arguments.Size[0];
  options.Height = arguments.Size[1];
  if (!arguments.Source.empty())
  {
    options.SourceOffset = { arguments.Source[0], arguments.Source[1], arguments.Source[2] };
  }
  BreastViewer viewer(viewed, options);
  const bool marked =
    (arguments.Point.empty() ||
      viewer.MarkPoint({ arguments.Point[0], arguments.Point[1], arguments.Point[2] })) &&
    (arguments.Pixel.empty() || viewer.MarkPixel(arguments.Pixel[0], arguments.Pixel[1]));
  if (!marked)
  {
    throw InputError(viewer.Message());
  }
  if (arguments.BenchmarkFrames > 0)
  {
    std::printf("%.1f frames per second at half resolution while the source moves (%d frames)\n",
      viewer.Benchmark(arguments.BenchmarkFrames), arguments.BenchmarkFrames);
  }
  if (!arguments.Screenshot.empty())
  {
    WriteComplete(arguments.Screenshot,
      [&](const std::string& temporary) { viewer.WriteScreenshot(temporary); });
    std::printf("%swrote %s\n", viewer.Status().empty() ? "" : (viewer.Status() + "\n").c_str(),
      arguments.Screenshot.c_str());
  }
  else if (arguments.BenchmarkFrames == 0)
  {
    viewer.Run();
  }
}
}

void AddViewCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("view",
    "A window on a breast between the plates, its live synthetic mammogram and the real one.\n"
    "Sliders for thickness, roll, tube voltage and the blend of both; the yellow ball is the X-ray "
    "source. Positions are mm in the frame of the mesh.\n" +
      ViewerHelpText());
  auto arguments = std::make_shared<ViewArguments>();
  ViewInput& input = arguments->Input;
  CLI::Option_group* what = command->add_option_group("what", "to look at; one of");
  what->add_option("--result", input.Result, "folder written by 'mammoray register'");
  what->add_option("--mesh", input.Mesh,
    "tetrahedra with materials (.vtu), also as 'mammoray compress' wrote them");
  what->add_option("--series", input.Series,
    "series of 'mammoray compress' (.pvd): the thickness slider goes through it");
  what->require_option(1);
  command->add_option("--mammogram", input.Mammogram,
    "mammogram (DICOM MG), of a result the registered one");
  AddMaterialsOption(*command, input.Materials)
    ->description("material table: a file (.json) or a shipped one's name; default: the result's");
  command->add_option("--spectrum", input.Spectrum,
    "X-ray spectrum: a file (.spc) or the name of a shipped one; default: the result's, or "
    "W28kVp_Rh50um_Be1mm");
  command
    ->add_option("--orientation", input.Orientation,
      "directions of the mesh's +x, +y, +z: one letter each of L/R, A/P, S/I; a result knows its "
      "own")
    ->capture_default_str();
  command
    ->add_option("--thickness", input.ThicknessMm,
      "distance of the plates, mm: compresses to it; default: as the input is compressed, or 50")
    ->check(PositiveNumber());
  command->add_option("--roll", input.RollDeg,
    "turn of the unit about the anterior axis, degrees; 0 is CC, positive to the left; default: "
    "the result's, or 0");
  const auto add = [&](const char* name, auto& value, const char* help)
  { return command->add_option(name, value, help)->capture_default_str(); };
  add("--shift-lateral", input.LateralMm, "of the receptor along gantry +x, mm; not a result");
  add("--shift-anterior", input.AnteriorMm, "of the receptor along gantry +y, mm; not a result");
  add("--shift-vertical", input.VerticalMm, "of the unit along gantry +z, mm; not a result");
  add("--pixel-spacing", input.PixelSpacingMm, "of the picture where there is no mammogram, mm")
    ->check(PositiveNumber());
  AddLabelOptions(*command, input.Labels)
    ->description("label volume whose materials the mechanics feel; default: the mesh's own");
  command->add_option("--simulation-mesh", input.SimulationMesh,
    "coarse mesh for the mechanics (.vtu); default: made from the labels or the mesh");
  add("--blend", arguments->Viewer.Blend, "share of the real mammogram at the beginning, 0 to 1")
    ->check(NumberFrom(0.0, 1.0));
  command->add_option("--kvp", arguments->Viewer.Kilovoltage,
    "tube voltage at the beginning, kV; default: the spectrum's");
  command
    ->add_option("--source", arguments->Source,
      "of the source beside its place at the beginning, gantry x, y and z, mm")
    ->expected(3)
    ->type_name("X Y Z");
  command->add_option("--point", arguments->Point, "mark this point of the uncompressed breast, mm")
    ->expected(3)
    ->type_name("X Y Z");
  command
    ->add_option("--pixel", arguments->Pixel, "mark what lies behind this pixel of the mammogram")
    ->expected(2)
    ->type_name("COLUMN ROW");
  command->add_option("--size", arguments->Size, "width and height of the window, pixels")
    ->expected(2)
    ->type_name("W H")
    ->check(NumberFrom(200, 8192))
    ->capture_default_str();
  add("--pictures", arguments->Viewer.PictureFolder, "folder where the key s saves pictures");
  command->add_option("--screenshot", arguments->Screenshot,
    "write the window's picture there (.png) and stop; nothing is shown");
  command->add_flag("--overwrite", arguments->Overwrite, "replace the picture of --screenshot");
  command
    ->add_option("--benchmark", arguments->BenchmarkFrames,
      "move the source for so many frames, print how many a second, and stop")
    ->check(NumberFrom(1, 100000));
  command->add_option("--device", arguments->Viewer.Projector.Device,
    "part of the wanted Vulkan device's name; see mammoray devices");
  AddProjectorOption(*command, arguments->Projector);
  AddConfigurationOptions(*command);
  command->callback([arguments] { RunView(*arguments); });
}
}
