// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "SurfaceView.h"
#include "mammoray/App/BreastViewer.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/OverlapMeasure.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
struct ViewArguments
{
  ViewInput Input;
  /// In place of the breast.
  SurfaceViewInput Surfaces;
  const CLI::App* Command = nullptr;
  ViewerOptions Viewer;
  std::array<int, 2> Size{ 1280, 800 };
  std::optional<Vector3> Source;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::string Screenshot;
  bool Overwrite = false;
  std::optional<int> BenchmarkFrames;
};

void DeclareInput(const OptionList& add, ViewInput& input, SurfaceViewInput& surfaces)
{
  CLI::Option_group* what = add.App().add_option_group("what", "what to look at, one of");
  const OptionList addWhat(*what);
  AddResultOption(addWhat, input.Result);
  addWhat.Input("--mesh", input.Mesh,
    "tetrahedra with materials (.vtu), also as 'mammoray compress' wrote them");
  addWhat.Input("--series", input.Series,
    "series of 'mammoray compress' (.pvd): the thickness slider goes through it");
  addWhat("--surface", surfaces.Surfaces,
    "closed surfaces of one material each, as 'mammoray project' has them; source and detector are "
    "placed around them")
    ->type_name("MATERIAL=FILE ...");
  addWhat.Input("--scene", surfaces.Scene,
    "surfaces before a source and a detector (.json, docs/scene.md)");
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
  add("--kev", surfaces.EnergyKeV, Positive("keV"),
    "a single photon energy instead of a spectrum; of surfaces");
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
  arguments.Command = &add.App();
  DeclareInput(add, arguments.Input, arguments.Surfaces);
  add("--blend", arguments.Viewer.Blend, Between(0, 1),
    "share of the real mammogram at the beginning, 0 to 1");
  add("--kvp", arguments.Viewer.Kilovoltage, "kV",
    "tube voltage at the beginning (photon energy, keV, where it is a single one); default: the "
    "spectrum's");
  add.Numbers("--source", arguments.Source, "X Y Z",
    "of the source beside its place at the beginning, gantry x, y and z (of surfaces: of their "
    "scene), mm");
  add.Numbers("--point", arguments.Point, "X Y Z",
    "mark this point of the uncompressed breast, mm");
  add.Numbers("--pixel", arguments.Pixel, "COLUMN ROW",
    "mark what lies behind this pixel of the mammogram, or tell what it sees of surfaces");
  add.Numbers("--size", arguments.Size, "W H", "width and height of the window, pixels")
    ->check(*Between(400, 8192).Range);
  add("--pictures", arguments.Viewer.PictureFolder, "folder where the key s saves pictures");
  add("--screenshot", arguments.Screenshot,
    "write the window's picture there (.png) and stop; nothing is shown");
  AddOverwriteFlag(add, arguments.Overwrite, "the picture of --screenshot");
  add("--benchmark", arguments.BenchmarkFrames, Between(1, 100000),
    "move the source, then the paddle, for so many frames each, print how many a second, and stop");
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

ViewerOptions ToViewerOptions(const ViewArguments& arguments)
{
  ViewerOptions options = arguments.Viewer;
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
  return options;
}

/// What either viewer is asked for.
template <typename Viewer>
void Show(const ViewArguments& arguments, Viewer& viewer, const char* moves)
{
  if (arguments.BenchmarkFrames)
  {
    std::printf("%.1f frames per second at half resolution while the %s (%d frames)\n",
      viewer.Benchmark(*arguments.BenchmarkFrames), moves, *arguments.BenchmarkFrames);
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

void RunBreast(const ViewArguments& arguments)
{
  if (arguments.Surfaces.EnergyKeV)
  {
    throw InputError("--kev: expected --surface or --scene beside it, found neither");
  }
  const std::vector<ViewedBreast> viewed = ReadViewedBreasts(arguments.Input);
  for (const ViewedBreast& one : viewed)
  {
    WarnOfDistrust((std::filesystem::path(arguments.Input.Result) / one.View).string(), one.Trust);
  }
  BreastViewer viewer(viewed, ToViewerOptions(arguments));
  const bool marked = (!arguments.Point || viewer.MarkPoint(*arguments.Point)) &&
    (!arguments.Pixel || viewer.MarkPixel((*arguments.Pixel)[0], (*arguments.Pixel)[1]));
  if (!marked)
  {
    throw InputError(viewer.Message());
  }
  Show(arguments, viewer, "source moves");
  if (const auto motion = arguments.BenchmarkFrames
      ? viewer.BenchmarkPaddle(*arguments.BenchmarkFrames)
      : std::nullopt)
  {
    std::printf("%.1f equilibria per second while the paddle moves, from those of both ends; the "
                "exact one after %.2f s, %.2f mm from what was shown (median; 95 %%: %.2f)\n",
      motion->PerSecond, motion->ExactSeconds, motion->MedianMm, motion->PercentileMm95);
  }
}

/// Refuses what is of breasts only.
void CheckSurfaceOptions(const CLI::App& command)
{
  const std::vector<std::string> known{ "surface", "scene", "materials", "spectrum", "kev", "kvp",
    "source", "pixel", "size", "pictures", "screenshot", "overwrite", "benchmark", "device",
    "projector", "config" };
  for (const CLI::Option* option : command.get_options({}))
  {
    const std::string name =
      option->get_lnames().empty() ? std::string() : option->get_lnames().front();
    if (option->count() > 0 && std::find(known.begin(), known.end(), name) == known.end())
    {
      throw InputError("--" + name + ": expected a breast to look at, found surfaces");
    }
  }
}

void RunSurfaces(const ViewArguments& arguments)
{
  CheckSurfaceOptions(*arguments.Command);
  SurfaceViewInput input = arguments.Surfaces;
  input.Spectrum = arguments.Input.Spectrum;
  input.Materials = arguments.Input.Materials;
  ViewerOptions options = ToViewerOptions(arguments);
  const auto isGiven = [&arguments](const std::string& option)
  {
    // Others have another meaning here.
    const bool isShared = option == "--kev" || option == "--spectrum" || option == "--materials";
    return isShared && arguments.Command->count(option) > 0;
  };
  const ViewedScene viewed = ReadViewedScene(input, isGiven);
  const Scene& scene = viewed.Scene;
  if (scene.OverlapPriority.empty())
  {
    const std::string overlap =
      MeasureOverlap(*scene.Samples.front().Surface, scene.Source, scene.Detector)
        .Warning(scene.Materials.Names());
    if (!overlap.empty())
    {
      std::fprintf(stderr,
        "mammoray: warning: %s; \"overlap-priority\" of a scene counts them once\n",
        overlap.c_str());
    }
  }
  SurfaceViewer viewer(viewed, options);
  if (arguments.Pixel && !viewer.MarkPixel((*arguments.Pixel)[0], (*arguments.Pixel)[1]))
  {
    throw InputError("--pixel: " + viewer.Message());
  }
  Show(arguments, viewer, "samples turn");
}

void Run(ViewArguments& arguments)
{
  CheckInputs(arguments);
  arguments.Surfaces.IsAsked() ? RunSurfaces(arguments) : RunBreast(arguments);
}
}

void AddViewCommand(CLI::App& application)
{
  AddCommand<ViewArguments>(application, "view",
    "A window on a breast between the plates, its live synthetic mammogram and the real one; or on "
    "surfaces that turn before a source and a detector, and their live X-ray.\n"
    "Sliders for thickness, roll, tube voltage and the blend of both; the yellow ball is the X-ray "
    "source. Positions are mm in the frame of the mesh.\n" +
      ViewerHelpText() + "\nOf surfaces:\n" + SurfaceViewerHelpText(),
    Declare, Run);
}
}
