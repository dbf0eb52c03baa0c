// SPDX-License-Identifier: Apache-2.0
#include "ProjectOptions.h"

#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"

#include <utility>

namespace mammoray
{
namespace
{
/// Adds the options of the quantities whose keys begin with `prefix`.
void AddQuantities(const OptionList& add, const std::string& prefix, SceneArguments& arguments)
{
  for (const SceneQuantity& quantity : SceneQuantities())
  {
    if (!OptionOf(quantity).empty() && quantity.Key.starts_with(prefix))
    {
      AddQuantityOption(add, quantity, arguments);
    }
  }
}

/// What is X-rayed, and what is written.
void DeclareInput(const OptionList& add, ProjectArguments& arguments)
{
  AddQuantities(add, "mesh", arguments.Given);
  add(Shared::Surface, arguments.Given.Surfaces);
  AddUnitOption(add, arguments.Given.Unit);
  AddQuantities(add, "materials", arguments.Given);
  add(Shared::Scene, arguments.Given.File);
  add("--set", arguments.Given.Sets,
    "a quantity of the scene by its key in scene files, 'detector.seed=5'\n"
    "(docs/reference/commands/scene-keys.md lists them; lengths are mm; goes before the file's "
    "value)")
    ->type_name("KEY=VALUE")
    ->allow_extra_args(false);
  add.Expert().Flag("--print-scene", arguments.PrintScene,
    "print the scene as a file for --scene, with the places of source and detector, and stop");
  add(Shared::Orientation, arguments.Orientation);
  add("-o,--output", arguments.Output,
    "picture (.mha .nrrd .tif .png .vti) or mammogram (.dcm)\n(transmission, 0 to 1; .vti holds "
    "path lengths and consistency, too)")
    ->required();
  add("--path-lengths", arguments.PathLengths,
    "also path lengths, mm, a channel per material (.mha .nrrd .vti)");
}

/// Where source and detector stand.
void DeclareGeometry(const OptionList& add, ProjectArguments& arguments)
{
  const OptionList geometry = add.Group("Geometry");
  geometry(Shared::Pose(PoseParameters[ThicknessParameter]), arguments.Pose.ThicknessMm);
  const OptionList expert = geometry.Expert();
  AddPoseOptions(expert, arguments.Pose);
  expert(Shared::SourceToDetector, arguments.Unit.SourceToDetectorMm);
  expert(Shared::SupportHeight, arguments.Unit.SupportHeightMm);
  expert.Numbers("--anchor", arguments.Anchor, "X Y Z",
    "point the pose refers to; default: middle of the mesh at the chest wall");
  AddQuantities(geometry, "source.", arguments.Given);
}

void DeclareDetector(const OptionList& add, ProjectArguments& arguments)
{
  const OptionList unit = add.Group("Detector");
  AddQuantities(unit, "realistic", arguments.Given);
  unit.Flag("--display", arguments.Display,
    "what a unit shows in place of transmissions, 0 to 1\n(bright where much is absorbed: rim "
    "evened out, details raised, sigmoid; a .dcm is For Presentation)");
  AddQuantities(unit, "detector.", arguments.Given);
  unit.Expert()("--deflection", arguments.Deflection,
    "write the angles by which refraction bends rays, radians (.mha .nrrd .vti)\n(along columns "
    "and rows, two channels)");
}

void DeclareDualEnergy(const OptionList& add, DualEnergyArguments& arguments)
{
  const OptionList dual = add.Group("Dual energy").Expert();
  dual("--high", arguments.High,
    "a quantity of the beam of a second exposure: 'kvp=42', 'filter=Cu:0.3'\n(kvp has the first "
    "one's anode; --output becomes its -ln I/I0 less a multiple of the first's by which --cancel "
    "look the same; NAME_low and NAME_high beside it are the two exposures)")
    ->type_name("KEY=VALUE");
  dual("--cancel", arguments.Cancel, "the two materials (default: fat gland)")
    ->type_name("MATERIAL MATERIAL")
    ->expected(2);
  dual("--cancel-thickness", arguments.ThicknessMm, Positive("mm"),
    "slabs of them as thick as this look the same");
}
}

void DeclareProject(const OptionList& add, ProjectArguments& arguments)
{
  DeclareInput(add, arguments);
  AddQuantities(add.Group("Beam"), "beam.", arguments.Given);
  DeclareGeometry(add, arguments);
  DeclareDetector(add, arguments);
  const OptionList scatter = add.Group("Scatter and dose");
  AddQuantities(scatter, "scatter.", arguments.Given);
  scatter.Expert()("--make-kernels", arguments.MakeKernels,
    "make kernels for the scene's materials and write them (.csv)\n(by Monte Carlo with "
    "scatter.photons photons; --set scatter.kernels=FILE takes them)");
  AddQuantities(scatter, "dose", arguments.Given);
  DeclareSeries(add, arguments.Series);
  DeclareDualEnergy(add, arguments.DualEnergy);
  AddDicomPictureOptions(add, arguments.Laterality, arguments.ForProcessing);
  AddViewOption(add.Group("DICOM"), arguments.View);
  AddDicomPatientOptions(add, arguments.Patient);
}

void CompleteScene(ProjectArguments& arguments)
{
  arguments.Scene = ReadSceneArguments(arguments.Given);
  SceneDescription& scene = arguments.Scene;
  if (scene.IsRealistic)
  {
    CompleteUnit(scene);
  }
  else if (scene.Fixed.Scatter.Method == SceneScatter::Model::Kernels &&
    !scene.Has("scatter.air-gap"))
  {
    if (!arguments.IsPlacedByUnit())
    {
      throw InputError("scatter.air-gap: expected it beside explicit positions, found none");
    }
    scene.Fixed.Scatter.AirGapMm = arguments.Unit.SupportHeightMm;
  }
}

Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SceneDescription& low)
{
  SceneDescription high;
  for (const std::string& text : arguments.High)
  {
    SetQuantity(ToSetting(text, "--high", "beam."), high);
  }
  const bool hasOther = high.Has("beam.kev") || high.Has("beam.spectrum");
  if (high.Has("beam.kvp") && !high.Has("beam.tube") && !hasOther)
  {
    if (low.Tube.Anode.empty())
    {
      throw InputError("--high kvp: expected --tube beside it, found none");
    }
    SetQuantity({ "--high kvp", "beam.tube", { low.Tube.Anode } }, high);
    if (!high.Has("beam.target-angle"))
    {
      high.Tube.TargetAngleDeg = low.Tube.TargetAngleDeg;
    }
  }
  high.Validate();
  if (!hasOther && !high.Has("beam.tube"))
  {
    throw InputError("--high: expected a kvp, kev or spectrum, found none");
  }
  return FindSpectrum(high);
}
}
