// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Viewer/BreastViewer.h"

#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
struct ViewArguments
{
  ViewInput Input;
  ViewerOptions Viewer;
  std::array<int, 2> Size{ 1280, 800 };
  std::optional<Vector3> Source;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::string Screenshot;
  bool Overwrite = false;
  std::optional<int> BenchmarkFrames;
};

void DeclareInput(const OptionList& add, ViewInput& input)
{
  CLI::Option_group* what = add.App().add_option_group("what", "what to look at, one of");
  const OptionList addWhat(*what);
  AddResultOption(addWhat, input.Result);
  addWhat.Input("--mesh", input.Mesh,
    "tetrahedra with materials (.vtu), also as 'mammoray compress' wrote them");
  addWhat.Input("--series", input.Series,
    "series of 'mammoray compress' (.pvd): the thickness slider goes through it");
  what->require_option(1);
  add.Input("--mammogram", input.Mammograms,
    "mammogram (DICOM MG), of a result the registered one; repeated where several were registered "
    "together");
  add.Input("--image", input.Image,
    "MRI in the frame of the mesh, shown in three slices (.nrrd .mha .nii .nii.gz, DICOM series); "
    "default: the result's own, else the tissues of --labels");
  AddLesionOption(add, input.Lesions, ": lesions, to go to each");
  AddMaterialsOption(add, input.Materials)
    ->description("material table: a file (.json) or a shipped one's name; default: the result's");
  AddSpectrumOption(add, input.Spectrum, "; default: the result's, or W28kVp_Rh50um_Be1mm");
  AddOrientationOption(add, input.Orientation, "the mesh (a result knows its own)");
  for (const PoseParameter& parameter : PoseParameters)
  {
    AddPoseOption(add, parameter, input.Pose[parameter.Index],
      parameter.Index == ThicknessParameter
        ? ": compresses to it; default: as the input is compressed, or 50"
        : "; default: the result's, or " + parameter.Format(BreastPose().*parameter.Value, 0));
  }
  add("--pixel-spacing", input.PixelSpacingMm, Positive("mm"),
    "of the picture where there is no mammogram");
  AddLabelOptions(add, input.Labels)
    ->description("label volume whose materials the mechanics feel and the slices show; default: "
                  "the mesh's own");
  add.Input("--simulation-mesh", input.SimulationMesh,
    "coarse mesh for the mechanics (.vtu); default: made from the labels or the mesh");
}

void Declare(const OptionList& add, ViewArguments& arguments)
{
  DeclareInput(add, arguments.Input);
  add("--blend", arguments.Viewer.Blend, Between(0, 1),
    "share of the real mammogram at the beginning, 0 to 1");
  add("--kvp", arguments.Viewer.Kilovoltage, "kV",
    "tube voltage at the beginning; default: the spectrum's");
  add.Numbers("--source", arguments.Source, "X Y Z",
    "of the source beside its place at the beginning, gantry x, y and z, mm");
  add.Numbers("--point", arguments.Point, "X Y Z",
    "mark this point of the uncompressed breast, mm");
  add.Numbers("--pixel", arguments.Pixel, "COLUMN ROW",
    "mark what lies behind this pixel of the mammogram");
  add.Numbers("--size", arguments.Size, "W H", "width and height of the window, pixels")
    ->check(*Between(400, 8192).Range);
  add("--pictures", arguments.Viewer.PictureFolder, "folder where the key s saves pictures");
  add("--screenshot", arguments.Screenshot,
    "write the window's picture there (.png) and stop; nothing is shown");
  AddOverwriteFlag(add, arguments.Overwrite, "the picture of --screenshot");
  add("--benchmark", arguments.BenchmarkFrames, Between(1, 100000),
    "move the source for so many frames, print how many a second, and stop");
  AddProjectorOptions(add, arguments.Viewer.Projector);
}

/// Bad input is told before the display is looked for.
void CheckInputs(const ViewArguments& arguments)
{
  const ViewInput& input = arguments.Input;
  for (const std::string& path : { input.Mesh, input.Series, input.SimulationMesh })
  {
    CheckInputFileIfAny(path);
  }
  for (const std::string& path : input.Mammograms)
  {
    CheckInputFile(path);
  }
  CheckPictureFile(arguments.Screenshot, arguments.Overwrite);
  if (!std::filesystem::is_directory(arguments.Viewer.PictureFolder))
  {
    throw InputError("--pictures " + arguments.Viewer.PictureFolder + ": there is no such folder");
  }
}

void Run(ViewArguments& arguments)
{
  CheckInputs(arguments);
  const std::vector<ViewedBreast> viewed = ReadViewedBreasts(arguments.Input);
  for (const ViewedBreast& one : viewed)
  {
    WarnOfDistrust((std::filesystem::path(arguments.Input.Result) / one.View).string(), one.Trust);
  }
  ViewerOptions& options = arguments.Viewer;
  options.OffScreen = !arguments.Screenshot.empty() || arguments.BenchmarkFrames;
  options.Stop = InterruptRequested;
  if (!options.OffScreen)
  {
    options.Marked = [](const std::string& found)
    {
      std::printf("%s\n", found.c_str());
      std::fflush(stdout);
    };
  }
  options.SourceOffset = arguments.Source.value_or(options.SourceOffset);
  options.Width = arguments.Size[0];
  options.Height = arguments.Size[1];
  BreastViewer viewer(viewed, options);
  const bool marked = (!arguments.Point || viewer.MarkPoint(*arguments.Point)) &&
    (!arguments.Pixel || viewer.MarkPixel((*arguments.Pixel)[0], (*arguments.Pixel)[1]));
  if (!marked)
  {
    throw InputError(viewer.Message());
  }
  if (arguments.BenchmarkFrames)
  {
    std::printf("%.1f frames per second at half resolution while the source moves (%d frames)\n",
      viewer.Benchmark(*arguments.BenchmarkFrames), *arguments.BenchmarkFrames);
  }
  if (!arguments.Screenshot.empty())
  {
    viewer.WriteScreenshot(arguments.Screenshot);
    std::printf("%swrote %s\n", viewer.Status().empty() ? "" : (viewer.Status() + "\n").c_str(),
      arguments.Screenshot.c_str());
  }
  else if (!arguments.BenchmarkFrames)
  {
    viewer.Run();
  }
}
}

void AddViewCommand(CLI::App& application)
{
  AddCommand<ViewArguments>(application, "view",
    "A window on a breast between the plates, its live synthetic mammogram and the real one.\n"
    "Sliders for thickness, roll, tube voltage and the blend of both; the yellow ball is the X-ray "
    "source. Positions are mm in the frame of the mesh.\n" +
      ViewerHelpText(),
    Declare, Run);
}
}
