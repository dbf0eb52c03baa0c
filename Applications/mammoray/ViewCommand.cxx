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
  SceneArguments Surfaces;
  /// A single energy in place of a spectrum.
  std::optional<double> EnergyKeV;
  const mammoray::Command* Command = nullptr;
  ViewerOptions Viewer;
  std::array<int, 2> Size{ 1280, 800 };
  std::optional<Vector3> Source;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::string Screenshot;
  std::optional<int> BenchmarkFrames;
};

void DeclareInput(const OptionList& add, ViewArguments& arguments)
{
  ViewInput& input = arguments.Input;
  const OptionList what = add.OneOf("What to look at, one of");
  what(Shared::Result, input.Result);
  what.File("--mesh", input.Mesh,
    "tetrahedra (.vtu .vtk .msh), or a series of 'mammoray compress' (.pvd) that the thickness "
    "slider goes through\n(cell array Material: those of the material table)");
  what(Shared::Surface, arguments.Surfaces.Surfaces);
  what(Shared::Scene, arguments.Surfaces.File);
  AddUnitOption(add, arguments.Surfaces.Unit);
  add(Shared::Mammograms, input.Mammograms);
  CLI::Option* image = add(Shared::Image, input.Image);
  add(Shared::Series, input.ImageSeries)->needs(image);
  add(Shared::Lesion, input.Lesions);
  add(Shared::Materials, input.Materials);
  add(Shared::Orientation, input.Orientation);
  add(Shared::Pose(PoseParameters[ThicknessParameter]), input.Pose[ThicknessParameter]);
  const OptionList expert = add.Expert();
  for (const PoseParameterIndex index : { RollParameter, LateralParameter, AnteriorParameter })
  {
    expert(Shared::Pose(PoseParameters[index]), input.Pose[index]);
  }
  expert(Shared::Spectrum, input.Spectrum);
  expert(Shared::Energy, arguments.EnergyKeV);
  expert(Shared::PixelSpacing, input.PixelSpacingMm);
  expert(Shared::Labels, input.Labels.Path);
  expert(Shared::SimulationMesh, input.SimulationMesh);
}

void Declare(const OptionList& add, ViewArguments& arguments)
{
  arguments.Command = &add.App();
  DeclareInput(add, arguments);
  add(Shared::Point, arguments.Point);
  add(Shared::Pixel, arguments.Pixel);
  add("--screenshot", arguments.Screenshot,
    "write the window's picture there (.png) and stop; nothing is shown");
  const OptionList expert = add.Expert();
  expert("--blend", arguments.Viewer.Blend, Between(0, 1), "share of the target at the beginning");
  expert("--kvp", arguments.Viewer.Kilovoltage, "kV",
    "tube voltage at the beginning\n(photon energy, keV, where it is a single one; default: the "
    "spectrum's)");
  expert.Numbers("--source", arguments.Source, "X Y Z",
    "of the source beside its place at the beginning, mm\n(gantry x, y and z; of surfaces: of "
    "their scene)");
  expert.Numbers("--size", arguments.Size, "W H", "width and height of the window, pixels",
    Between(400, 8192));
  expert("--benchmark", arguments.BenchmarkFrames, Between(1, 100000),
    "move source, then paddle, for so many frames, print the rates, and stop");
}

ViewerOptions ToViewerOptions(const ViewArguments& arguments)
{
  ViewerOptions options = arguments.Viewer;
  options.Projector = Program().Projector;
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

/// Runs what the options request of either viewer.
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
  if (arguments.EnergyKeV)
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
void CheckSurfaceOptions(const Command& command)
{
  const std::vector<std::string> known{ "surface", "scene", "materials", "spectrum", "kev", "kvp",
    "source", "pixel", "size", "screenshot", "benchmark" };
  for (const Declaration& declaration : command.Declarations)
  {
    const std::string name = declaration.Name();
    if (declaration.Option->count() > 0 && !declaration.IsOfProgram() &&
      std::find(known.begin(), known.end(), name) == known.end())
    {
      throw InputError("--" + name + ": expected a breast to look at, found surfaces");
    }
  }
}

void RunSurfaces(const ViewArguments& arguments)
{
  CheckSurfaceOptions(*arguments.Command);
  const ViewerOptions options = ToViewerOptions(arguments);
  SceneArguments surfaces = arguments.Surfaces;
  // Options that mean the same for a breast.
  for (const auto& [key, option] : { std::pair("beam.spectrum", "--spectrum"),
         { "beam.kev", "--kev" }, { "materials", "--materials" } })
  {
    if (const CLI::Option* given = arguments.Command->get_option(option); given->count() > 0)
    {
      surfaces.Settings.push_back({ option, key, given->results() });
    }
  }
  const ViewedScene viewed = ReadViewedScene(surfaces);
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
  Program().ApplyTo(arguments.Input.Labels);
  CheckPictureFile(arguments.Screenshot);
  const bool hasBreast = arguments.Surfaces.Surfaces.empty() && arguments.Surfaces.File.empty();
  hasBreast ? RunBreast(arguments) : RunSurfaces(arguments);
}
}

void AddViewCommand(CLI::App& application)
{
  AddCommand<ViewArguments>(application, "view",
    "A window on a breast between the plates, its live synthetic mammogram and the target; or on "
    "surfaces that turn before a source and a detector, and their live X-ray.\n"
    "Sliders for thickness, roll, tube voltage and the blend of both; the yellow ball is the X-ray "
    "source. Positions are mm in the frame of the mesh.\n" +
      ViewerHelpText() + "\nOf surfaces:\n" + SurfaceViewerHelpText(),
    "view --result result", Declare, Run);
}
}
