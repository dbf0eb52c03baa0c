// SPDX-License-Identifier: Apache-2.0
#include "ProjectOptions.h"

#include "SharedOptions.h"

namespace mammoray
{
namespace
{
/// What is X-rayed, with what, and what is written.
void DeclareInput(const OptionList& add, ProjectArguments& arguments)
{
  add.Input("--mesh", arguments.Mesh,
    "tetrahedra (.vtu, cell array Material) or triangles (.vtp, .stl, .ply, .obj, .glb, .gltf), of "
    "--materials");
  add("--surface", arguments.Surfaces,
    "in place of --mesh, closed surfaces of one material each: one of --materials, or what it is "
    "made of, with the density in g/cm3 where that does not tell it ('Ti90Al6V4@4.43=matrix.stl'); "
    "where they overlap see --overlap-priority")
    ->type_name("MATERIAL=FILE ...");
  add.Input("--scene", arguments.Scene,
    "file (.json) that says what of this page it holds: source, detector, beam, and samples with "
    "their files, materials, units (um to m) and places; the rest are options (docs/scene.md)");
  AddMaterialsOption(add, arguments.Materials);
  add("--attenuation", arguments.Attenuations,
    "another attenuation of a material of the table, and density, g/cm3: a shipped table's name, a "
    "NIST compound, a formula, or mass fractions ('gland=H:0.102 C:0.184 N:0.032 O:0.682@1.04')")
    ->type_name("MATERIAL=ATTENUATION[@DENSITY]")
    ->allow_extra_args(false);
  AddAcceptUnusualFlag(add, arguments.AcceptUnusual);
  add("-o,--output", arguments.Output,
    "transmission, 0 to 1 (.mha .nrrd .tif .png); .vti holds path lengths and consistency too; "
    ".dcm: a "
    "DICOM mammogram")
    ->required();
  add("--path-lengths", arguments.PathLengths,
    "write path lengths there, mm, one channel per material but air (.mha .nrrd .vti)");
  DeclareSpectrum(add, arguments.XRays);
  DeclareResponse(add, arguments.Response);
}

/// Where source and detector stand.
void DeclareGeometry(const OptionList& add, ProjectArguments& arguments)
{
  AddOrientationOption(add, arguments.Orientation);
  add("--source-to-detector", arguments.Unit.SourceToDetectorMm, Positive("mm"),
    "source to receptor plane");
  add("--support-height", arguments.Unit.SupportHeightMm, NonNegative("mm"),
    "breast support above the receptor");
  AddPoseOption(add, PoseParameters[ThicknessParameter], arguments.Pose.ThicknessMm);
  AddPoseOptions(add, arguments.Pose);
  add.Numbers("--anchor", arguments.Anchor, "X Y Z",
    "point the pose refers to; default: middle of the mesh at the chest wall");
  add.Numbers("--source", arguments.Source, "X Y Z",
    "position of the source, instead of the unit's");
  add.Numbers("--beam-direction", arguments.BeamDirection, "X Y Z",
    "parallel X-rays that travel in this direction, instead of a point source");
  add.Numbers("--detector-origin", arguments.DetectorOrigin, "X Y Z",
    "centre of the pixel in column 0 and row 0, instead of the unit's");
  add.Numbers("--column-direction", arguments.ColumnDirection, "X Y Z",
    "from a pixel to that of the next column");
  add.Numbers("--row-direction", arguments.RowDirection, "X Y Z",
    "from a pixel to that of the next row");
}

void DeclareDetector(const OptionList& add, ProjectArguments& arguments)
{
  add.Word("--unit", arguments.UnitKind, { "plain", "realistic" },
    "realistic: what is not asked for otherwise is that of a modern unit: tungsten tube of 29 kV "
    "with 0.05 mm Rh, heel and inverse square, scatter of 17 mm of air behind a grid of lead 5:1 "
    "with 31 lines per cm and fibre, half modulation 5 per mm, noise of 2e7 photons per mm2, 5 "
    "photons of the detector's own");
  add.Flag("--display", arguments.Display,
    "write what a unit shows in place of transmissions, 0 to 1, bright where much is absorbed: "
    "rim evened out, details raised, sigmoid; a .dcm is For Presentation");
  add("--columns", arguments.Columns, Between(1, 65535), "pixels per row");
  add("--rows", arguments.Rows, Between(1, 65535), "pixels per column");
  add("--pixel-spacing", arguments.PixelSpacingMm, Positive("mm"), "distance of pixel centres");
  add("--samples", arguments.Samples, Between(1, 16),
    "samples x samples rays per pixel; their transmissions are averaged");
  add.Numbers("--focal-spot", arguments.FocalSpot, "W H",
    "edges of the focal spot along columns and rows, mm; default: a point", Between(0, 100));
  add("--focal-spot-samples", arguments.Exposure.FocalSpotSamples, Between(1, 32),
    "n x n source points for the focal spot; each costs a projection");
  add("--photons", arguments.Exposure.PhotonsPerPixel, Between(0, 1e12),
    "photons that meet a pixel without the object, on average; adds quantum noise, 0 adds none");
  add("--electronic-noise", arguments.Exposure.ElectronicNoisePhotons, Between(0, 1e6),
    "standard deviation of the detector's own noise, in signals of one photon; needs --photons");
  add("--half-modulation", arguments.Exposure.HalfModulationPerMm, Between(0, 1000, "1/mm"),
    "frequency at which the detector's modulation transfer is 1/2, a Gaussian, besides that of its "
    "pixels (--samples); blurs signal and quantum noise, 0 does not");
  add.Flag("--inverse-square", arguments.Field.InverseSquare,
    "fewer photons farther from the focus, and where they come in obliquely; 1 where they come in "
    "at right angles");
  add.Numbers("--heel", arguments.Heel, "DEG UM",
    "heel effect: angle between target and central ray, depth at which photons are made in the "
    "target, micrometres ('22 0.5'); the anode lies along the columns' direction");
  add.Word("--refraction", arguments.RefractionLaw, { "geometric", "near-field" },
    "bend rays where they pass bodies, by geometric optics or by the near field of the transport "
    "of "
    "intensity; materials need compositions (--attenuation)");
  add("--bend-distance", arguments.BendDistanceMm, NonNegative("mm"),
    "from where rays are bent to the detector; default: from the middle of the mesh");
  add("--deflection", arguments.Deflection,
    "write the angles by which --refraction bends rays there, radians along columns and rows, two "
    "channels (.mha .nrrd .vti)");
  add("--seed", arguments.Exposure.Seed, "of the noise: the same seed, the same image");
  DeclareScatter(add, arguments.Scatter);
  DeclareSeries(add, arguments.Series);
  DeclareDualEnergy(add, arguments.DualEnergy);
  AddProjectorOptions(add, arguments.Projector);
  add("--overlap-priority", arguments.OverlapPriority,
    "where parts overlap though their surfaces say air, count the first of these MATERIALs that is "
    "there, once; others follow in the table's order. Default: such stretches count for each part, "
    "with a warning (beyond 20,000 triangles where lines through the picture and through each "
    "part meet some; mesh --check finds every crossing). Rays through overlaps are followed twice, "
    "on the host")
    ->type_name("MATERIAL ...");
}

}

void DeclareProject(const OptionList& add, ProjectArguments& arguments)
{
  arguments.IsGiven = [&command = add.App()](const std::string& option)
  { return command.count(option) > 0; };
  DeclareInput(add, arguments);
  DeclareGeometry(add, arguments);
  DeclareDetector(add, arguments);
  AddDicomPictureOptions(add, arguments.Laterality, arguments.ForProcessing);
  add.Group("DICOM").Word("--view", arguments.View, { "CC", "MLO", "ML", "LM", "LMO", "FB" },
    "the mammogram's view; default: the one of the roll");
  AddDicomPatientOptions(add, arguments.Patient, false);
  AddOverwriteFlag(add, arguments.Overwrite);
}

void ApplyUnit(ProjectArguments& arguments)
{
  if (arguments.UnitKind != "realistic")
  {
    return;
  }
  SpectrumArguments& xRays = arguments.XRays;
  if (xRays.Anode.empty() && !xRays.EnergyKeV && xRays.Spectrum == SpectrumArguments().Spectrum)
  {
    xRays.Anode = "W";
    xRays.Tube.KilovoltagePeak = 29;
    if (xRays.Filters.empty())
    {
      xRays.Filters = { "Rh:0.05" };
    }
  }
  arguments.Field.InverseSquare = true;
  if (!arguments.Heel)
  {
    arguments.Heel = { 20, 0.5 };
  }
  if (arguments.Scatter.Method.empty())
  {
    arguments.Scatter.Method = "kernels";
  }
  if (!arguments.Scatter.AirGapMm)
  {
    arguments.Scatter.AirGapMm = 17;
  }
  if (!arguments.Scatter.Grid)
  {
    arguments.Scatter.Grid = { 5, 31, 65 };
  }
  ExposureOptions& exposure = arguments.Exposure;
  if (exposure.HalfModulationPerMm == 0)
  {
    exposure.HalfModulationPerMm = 5;
  }
  if (exposure.PhotonsPerPixel == 0)
  {
    exposure.PhotonsPerPixel = 2e7 * arguments.PixelSpacingMm * arguments.PixelSpacingMm;
  }
  if (exposure.ElectronicNoisePhotons == 0)
  {
    exposure.ElectronicNoisePhotons = 5;
  }
}
}
