// SPDX-License-Identifier: Apache-2.0
#include "ProjectOptions.h"

#include "MaterialChanges.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
/// What is X-rayed, with what, and what is written.
void DeclareInput(const OptionList& add, ProjectArguments& arguments)
{
  add(Shared::Mesh, arguments.Scene.Mesh);
  add(Shared::Surface, arguments.Surfaces);
  add(Shared::Scene, arguments.SceneFile);
  add(Shared::Materials, arguments.Scene.Materials);
  add(Shared::Orientation, arguments.Orientation);
  add("-o,--output", arguments.Output,
    "picture (.mha .nrrd .tif .png .vti) or mammogram (.dcm)\n(transmission, 0 to 1; .vti holds "
    "path "
    "lengths and consistency, too)")
    ->required();
  add("--path-lengths", arguments.PathLengths,
    "also path lengths, mm, a channel per material (.mha .nrrd .vti)");
  const OptionList expert = add.Expert();
  expert("--attenuation", arguments.Attenuations,
    "another attenuation of a material of the table, and density, g/cm3\n(a shipped table's name, "
    "a "
    "NIST compound, a formula, or mass fractions: 'gland=H:0.102 C:0.184 N:0.032 O:0.682@1.04')")
    ->type_name("MATERIAL=ATTENUATION[@DENSITY]")
    ->allow_extra_args(false);
  expert("--overlap-priority", arguments.Scene.OverlapPriority,
    "materials whose parts win where parts overlap though their surfaces say air\n(the first of "
    "these that is there counts, once; others follow in the table's order. Default: such stretches "
    "count for each part, with a warning, beyond 20,000 triangles where lines through the picture "
    "and through each part meet some; mesh --check finds every crossing. Rays through overlaps are "
    "followed twice, on the host)")
    ->type_name("MATERIAL");
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
  expert.Numbers("--source", arguments.Source, "X Y Z",
    "position of the source, instead of the unit's");
  expert.Numbers("--beam-direction", arguments.BeamDirection, "X Y Z",
    "parallel X-rays that travel in this direction, instead of a point source");
  expert.Numbers("--detector-origin", arguments.DetectorOrigin, "X Y Z",
    "centre of the pixel in column 0 and row 0, instead of the unit's");
  expert.Numbers("--column-direction", arguments.ColumnDirection, "X Y Z",
    "from a pixel to that of the next column");
  expert.Numbers("--row-direction", arguments.RowDirection, "X Y Z",
    "from a pixel to that of the next row");
}

/// What the source adds to a point, and what the detector makes of photons.
void DeclareDetector(const OptionList& add, ProjectArguments& arguments)
{
  XRayDetector& detector = arguments.Scene.Fixed.Detector;
  ExposureOptions& detection = arguments.Scene.Fixed.Detection;
  detector.Columns = 720;
  detector.Rows = 1080;
  const OptionList unit = add.Group("Detector");
  unit.Word("--unit", arguments.UnitKind, { "plain", "realistic" },
    "realistic: with noise, blur, heel and scatter\n(what is not asked for otherwise is that of a "
    "modern unit: tungsten tube of 29 kV with 0.05 mm Rh, heel and inverse square, scatter of 17 "
    "mm "
    "of air behind a grid of lead 5:1 with 31 lines per cm and fibre, half modulation 5 per mm, "
    "noise of 2e7 photons per mm2, 5 photons of the detector's own)");
  unit.Flag("--display", arguments.Display,
    "what a unit shows in place of transmissions, 0 to 1\n(bright where much is absorbed: rim "
    "evened out, details raised, sigmoid; a .dcm is For Presentation)");
  unit("--columns", detector.Columns, Between(1, 65535), "pixels per row");
  unit("--rows", detector.Rows, Between(1, 65535), "pixels per column");
  unit(Shared::PixelSpacing, arguments.PixelSpacingMm);
  unit("--photons", detection.PhotonsPerPixel, Between(0, 1e12),
    "of a pixel without the object; adds quantum noise, 0 none");
  const OptionList expert = unit.Expert();
  expert("--seed", detection.Seed, "of the noise: the same seed, the same image");
  expert("--samples", detector.Samples, Between(1, 16),
    "samples x samples rays per pixel; their transmissions are averaged");
  expert.Numbers("--focal-spot", arguments.FocalSpot, "W H",
    "edges of the focal spot along columns and rows, mm; default: a point", Between(0, 100));
  expert("--focal-spot-samples", detection.FocalSpotSamples, Between(1, 32),
    "n x n source points for the focal spot; each costs a projection");
  expert("--electronic-noise", detection.ElectronicNoisePhotons, Between(0, 1e6),
    "standard deviation of the detector's own noise, in signals of one photon; needs --photons");
  expert("--half-modulation", detection.HalfModulationPerMm, Between(0, 1000, "1/mm"),
    "frequency at which the detector's modulation transfer is 1/2; 0 does not blur\n(a Gaussian, "
    "besides that of its pixels, --samples; blurs signal and quantum noise)");
  expert.Flag("--inverse-square", arguments.Scene.Fixed.Field.InverseSquare,
    "fewer photons farther from the focus, and where they come in obliquely\n(1 where they come in "
    "at right angles)");
  expert.Numbers("--heel", arguments.Heel, "DEG UM",
    "heel effect: target angle, and depth of photons in the target, um ('22 0.5')\n(the angle is "
    "between target and central ray; the anode lies along the columns' direction)");
  expert.Word("--refraction", arguments.RefractionLaw, { "geometric", "near-field" },
    "bend rays by geometric optics or by the near field\n(of the transport of intensity; materials "
    "need compositions, see --attenuation)");
  expert("--deflection", arguments.Deflection,
    "write the angles by which --refraction bends rays, radians (.mha .nrrd .vti)\n(along columns "
    "and rows, two channels)");
  unit.CaseFile()("--bend-distance", arguments.Scene.BendDistanceMm, NonNegative("mm"),
    "from where rays are bent to the detector; default: from the middle of the mesh");
  DeclareResponse(expert, arguments.Scene.Response);
}

/// Fills in what is not asked for otherwise.
void ApplyRealisticUnit(ProjectArguments& arguments)
{
  SceneDescription& scene = arguments.Scene;
  if (scene.Beam.Anode.empty() && !scene.Beam.EnergyKeV &&
    scene.Beam.Spectrum == SceneBeam().Spectrum)
  {
    scene.Beam.Anode = "W";
    scene.Beam.KilovoltagePeak = 29;
    if (scene.Beam.Filters.empty())
    {
      scene.Beam.Filters = { "Rh:0.05" };
    }
  }
  Scene& fixed = scene.Fixed;
  fixed.Field.InverseSquare = true;
  if (fixed.Field.Heel.TargetAngleDeg == 0)
  {
    fixed.Field.Heel.TargetAngleDeg = 20;
    fixed.Field.Heel.DepthMm = 0.5e-3;
  }
  if (!fixed.Scatter.Grid)
  {
    fixed.Scatter.Grid =
      AntiscatterGridOptions::OfLead({ 5, 31, 65 }, arguments.Scatter.Interspace);
  }
  ExposureOptions& detection = fixed.Detection;
  if (detection.HalfModulationPerMm == 0)
  {
    detection.HalfModulationPerMm = 5;
  }
  if (detection.PhotonsPerPixel == 0)
  {
    const double spacing =
      scene.Has("detector") ? Norm(fixed.Detector.ColumnStep) : arguments.PixelSpacingMm;
    detection.PhotonsPerPixel = 2e7 * spacing * spacing;
  }
  if (detection.ElectronicNoisePhotons == 0)
  {
    detection.ElectronicNoisePhotons = 5;
  }
}
}

void DeclareProject(const OptionList& add, ProjectArguments& arguments)
{
  arguments.IsGiven = [&command = add.App()](const std::string& option)
  {
    const Declaration* declaration = command.Find(option.substr(2));
    return declaration && declaration->Option->count() > 0;
  };
  DeclareInput(add, arguments);
  DeclareSpectrum(add, arguments.Scene.Beam);
  DeclareGeometry(add, arguments);
  DeclareDetector(add, arguments);
  DeclareScatter(add, arguments.Scatter);
  DeclareSeries(add, arguments.Series);
  DeclareDualEnergy(add, arguments.DualEnergy);
  AddDicomPictureOptions(add, arguments.Laterality, arguments.ForProcessing);
  AddViewOption(add.Group("DICOM"), arguments.View);
  AddDicomPatientOptions(add, arguments.Patient);
}

bool ProjectArguments::IsPlacedByUnit() const
{
  return !this->Source && !this->BeamDirection && !this->DetectorOrigin && !this->ColumnDirection &&
    !this->RowDirection && !this->Scene.Has("source") && !this->Scene.Has("detector");
}

void CompleteScene(ProjectArguments& arguments)
{
  SceneDescription& scene = arguments.Scene;
  if (arguments.FocalSpot)
  {
    scene.Fixed.Detection.FocalSpotColumnMm = (*arguments.FocalSpot)[0];
    scene.Fixed.Detection.FocalSpotRowMm = (*arguments.FocalSpot)[1];
  }
  if (arguments.Heel)
  {
    scene.Fixed.Field.Heel.TargetAngleDeg = (*arguments.Heel)[0];
    scene.Fixed.Field.Heel.DepthMm = 1e-3 * (*arguments.Heel)[1];
  }
  if (!arguments.RefractionLaw.empty())
  {
    scene.Fixed.Refraction = { arguments.RefractionLaw == "geometric"
        ? RefractionOptions::Law::Geometric
        : RefractionOptions::Law::NearField };
  }
  if (!scene.Beam.Anode.empty() && scene.Beam.EnergyKeV)
  {
    throw InputError("--tube: expected no --kev beside it, found both");
  }
  const bool isRealistic = arguments.UnitKind == "realistic";
  if (isRealistic && arguments.Scatter.Method.empty())
  {
    arguments.Scatter.Method = "kernels";
  }
  SetAttenuations(arguments.Attenuations, Program().AcceptUnusual, scene);
  SetIodine(arguments.DualEnergy.Iodine, scene);
  SetScatter(arguments.Scatter, scene);
  scene.Samples = ToSamples(arguments.Surfaces);
  ApplySceneFile(arguments.SceneFile, arguments.IsGiven, scene);
  if (isRealistic)
  {
    ApplyRealisticUnit(arguments);
  }
  else if (scene.Fixed.Scatter.Method == SceneScatter::Model::Kernels &&
    !arguments.Scatter.AirGapMm && !scene.Has("scatter.air-gap"))
  {
    if (!arguments.IsPlacedByUnit())
    {
      throw InputError(
        "--scatter kernels: expected --air-gap beside explicit positions, found none");
    }
    scene.Fixed.Scatter.AirGapMm = arguments.Unit.SupportHeightMm;
  }
}
}
