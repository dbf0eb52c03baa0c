// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SceneOptions.h"
#include "SharedOptions.h"
#include "mammoray/App/Pictures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/OverlapMeasure.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

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
  PictureOptions Picture;
  std::array<int, 2> Size{ 1280, 800 };
  std::optional<Vector3> Source;
  std::string Screenshot;
};

void DeclareInput(const OptionList& add, ViewArguments& arguments)
{
  ViewInput& input = arguments.Input;
  const OptionList what = add.OneOf("What to look at, one of");
  what(Shared::Result, input.Result);
  what.File("--mesh", input.Mesh,
    "tetrahedra (.vtu .vtk .msh)\n(cell array Material: those of the material table)");
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
  add(Shared::Point, arguments.Picture.Point);
  add(Shared::Pixel, arguments.Picture.Pixel);
  add("--screenshot", arguments.Screenshot, "picture to write (.png); required");
  const OptionList expert = add.Expert();
  expert("--blend", arguments.Picture.Blend, Between(0, 1), "share of the real mammogram");
  expert("--kvp", arguments.Picture.Energy, "kV",
    "tube voltage\n(photon energy, keV, where it is a single one; default: the spectrum's)");
  expert.Numbers("--source", arguments.Source, "X Y Z",
    "of the source beside its place, mm\n(gantry x, y and z; of surfaces: of their scene)");
  expert.Numbers("--size", arguments.Size, "W H", "width and height of the picture, pixels",
    Between(400, 8192));
}

PictureOptions ToPictureOptions(const ViewArguments& arguments)
{
  PictureOptions options = arguments.Picture;
  options.Projector = Program().Projector;
  options.Progress = MakeProgressBar();
  options.SourceOffset = arguments.Source.value_or(options.SourceOffset);
  options.Width = arguments.Size[0];
  options.Height = arguments.Size[1];
  return options;
}

std::string DrawBreast(const ViewArguments& arguments)
{
  if (arguments.EnergyKeV)
  {
    throw InputError("--kev: expected --surface or --scene beside it, found neither");
  }
  const std::vector<ViewedBreast> viewed = ReadViewedBreasts(arguments.Input);
  std::string told = WriteBreastPicture(viewed, ToPictureOptions(arguments), arguments.Screenshot);
  for (const ViewedBreast& one : viewed)
  {
    WarnOfDistrust((std::filesystem::path(arguments.Input.Result) / one.View).string(), one.Trust);
  }
  return told;
}

/// Refuses what is of breasts only.
void CheckSurfaceOptions(const Command& command)
{
  const std::vector<std::string> known{ "surface", "unit", "scene", "materials", "spectrum", "kev",
    "kvp", "source", "pixel", "size", "screenshot" };
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

std::string DrawSurfaces(const ViewArguments& arguments)
{
  CheckSurfaceOptions(*arguments.Command);
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
  Scene scene =
    LoadPlacedScene(ReadSceneArguments(surfaces), surfaces.File.empty() ? "view" : surfaces.File);
  scene.Samples = { { Assemble(scene) } }; // once, for the overlap and for the X-ray
  if (scene.OverlapPriority.empty())
  {
    WarnOfOverlap(MeasureOverlap(*scene.Samples.front().Surface, scene.Source, scene.Detector)
                    .Warning(scene.Materials.Names()));
  }
  return WriteScenePicture(scene, ToPictureOptions(arguments), arguments.Screenshot);
}

void Run(ViewArguments& arguments)
{
  if (arguments.Screenshot.empty())
  {
    throw InputError("view: expected --screenshot; 'mammoray app' opens a window");
  }
  Program().ApplyTo(arguments.Input.Labels);
  CheckPictureFile(arguments.Screenshot);
  const bool hasBreast = arguments.Surfaces.Surfaces.empty() && arguments.Surfaces.File.empty();
  const std::string found = hasBreast ? DrawBreast(arguments) : DrawSurfaces(arguments);
  std::printf("%s%swrote %s\n", found.c_str(), found.empty() ? "" : "\n",
    arguments.Screenshot.c_str());
}
}

void AddViewCommand(CLI::App& application)
{
  AddCommand<ViewArguments>(application, "view",
    "A picture of a breast between the plates and at rest, of slices of its MRI, and of its "
    "synthetic mammogram with the real one; or of surfaces before a source and a detector, and "
    "their X-ray.\n"
    "What is marked is shown in all views and printed. Positions are mm in the frame of the mesh. "
    "'mammoray app' shows results and scenes in a window.",
    "view --result result --screenshot view.png", Declare, Run);
}
}
