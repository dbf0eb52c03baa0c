// SPDX-License-Identifier: Apache-2.0
#include "SharedOptions.h"

#include "mammoray/Biomechanics/Plates.h"

namespace mammoray
{
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source)
{
  CLI::Option* labels = add.Input("--labels", source.Path,
    "label volume: .nrrd .nhdr .mha .mhd .nii .nii.gz, a DICOM segmentation (.dcm; labels are its "
    "segment numbers) or a folder with a DICOM series");
  add("--crop", source.Crop,
    "voxels of --labels to keep along i, j and k: three times FIRST:LAST, counted from 0, both "
    "included, : for all; e.g. --crop 0:199 : 12:")
    ->expected(3)
    ->needs(labels);
  add("--skin", source.Skin,
    "THICKNESS[=MATERIAL]: a layer of that many mm below the air becomes skin (default: the "
    "table's thin material), not at fixed tissue nor at the volume's border")
    ->needs(labels);
  add("--cut-side", source.CutSides,
    "i-, i+, j-, j+, k- or k+: end of an axis of --labels at which the tissue was cut flat, with "
    "air behind (before the chest wall, say): it gets no --skin and does not move there; may be "
    "given for several")
    ->needs(labels);
  add
    .Flag("--axes-as-given", source.AxesAsGiven,
      "take the axes of the header of --labels as they are, with no conversion to LPS")
    ->needs(labels);
  AddAcceptUnusualFlag(add, source.AcceptUnusual);
  return labels;
}

void AddAcceptUnusualFlag(const OptionList& add, bool& accept)
{
  add.Flag("--accept-unusual", accept,
    "take what no patient has, too, such as voxels of 100 mm: a refusal says where it is needed");
}

CLI::Option* AddMaterialsOption(const OptionList& add, std::string& pathOrName)
{
  return add.Input("--materials", pathOrName,
    "material table: a file (.json) or the name of a shipped one (victre, segment, ...)");
}

CLI::Option* AddOrientationOption(const OptionList& add, std::string& code, const std::string& what)
{
  return add("--orientation", code,
    "patient directions of the +x, +y, +z of " + what +
      ": one letter each of L/R, A/P, S/I, e.g. LPS (DICOM) or ALS (FDA phantoms)");
}

CLI::Option* AddSpectrumOption(const OptionList& add, std::string& pathOrName,
  const std::string& remark)
{
  return add.Input("--spectrum", pathOrName,
    "X-ray spectrum: a file (.spc) or the name of a shipped one" + remark);
}

void AddProjectorOptions(const OptionList& add, ProjectorOptions& options)
{
  using Method = ProjectorOptions::Method;
  add("--device", options.Device,
    "part of the wanted Vulkan device's name (see mammoray devices); default: MAMMORAY_DEVICE, "
    "else the most capable one");
  add.Choice<Method>("--projector", options.Projection,
    { { "auto", Method::Auto }, { "ray-tracing", Method::RayTracing },
      { "rasterisation", Method::Rasterisation } },
    "how path lengths are found; auto traces rays on hardware that can and rasterises elsewhere");
}

CLI::Option* AddResultOption(const OptionList& add, std::string& folder)
{
  return add.Input("--result", folder, "folder written by 'mammoray register'");
}

Quantity QuantityOf(const PoseParameter& parameter)
{
  switch (parameter.Index)
  {
    case ThicknessParameter:
    case StiffnessParameter:
      return Positive(parameter.Unit);
    case TiltParameter:
      return Between(-30, 30, parameter.Unit);
    default:
      return parameter.Unit;
  }
}

void AddPoseOptions(const OptionList& add, BreastPose& pose)
{
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (parameter.Index != ThicknessParameter && parameter.Index != StiffnessParameter)
    {
      AddPoseOption(add, parameter, pose.*parameter.Value);
    }
  }
}

void AddPlateOptions(const OptionList& add, double& supportEdgeMm, double& paddleEdgeMm,
  double& edgeRadiusMm)
{
  add("--support-edge", supportEdgeMm, "mm",
    "chest-wall edge of the support, in front of the receptor's (gantry y)");
  add("--paddle-edge", paddleEdgeMm, "mm",
    "chest-wall edge of the paddle, in front of the receptor's (gantry y)");
  add("--edge-radius", edgeRadiusMm, Between(0, MostEdgeRadiusMm, "mm"),
    "radius of the plates' chest-wall edges");
}

void AddComparisonOptions(const OptionList& add, RegistrationOptions& options)
{
  add("--pixel-sizes", options.PixelSizesMm, Positive("mm"),
    "pixels in which the pictures are compared, coarse to fine");
  add.Choice<PictureComparison>("--residual", options.Comparison,
    { { NameOf(PictureComparison::Gradient), PictureComparison::Gradient },
      { NameOf(PictureComparison::Global), PictureComparison::Global },
      { NameOf(PictureComparison::Local), PictureComparison::Local } },
    "how pictures are compared at last: the gradient of log attenuation, or log attenuation "
    "normalised globally or locally (in windows)");
  add("--window", options.WindowMm, Positive("mm"), "edge of the windows of --residual local");
}

void AddChestWallOption(const OptionList& add, ChestWallMode& mode)
{
  add.Choice<ChestWallMode>("--chest-wall", mode,
    { { "fixed", ChestWallMode::Fixed }, { "sliding", ChestWallMode::Sliding },
      { "elastic", ChestWallMode::Elastic } },
    "how the breast is attached to the fixed materials: fixed, sliding along their surface, or "
    "elastic");
}

void AddImagePositionOption(const OptionList& add, std::optional<PatientPosition>& position)
{
  add.Choice<std::optional<PatientPosition>>("--mri-position", position,
    { { "none", std::nullopt }, { "prone", PatientPosition::Prone },
      { "supine", PatientPosition::Supine } },
    "how the patient lay in the MRI: from prone or supine the breast is unloaded of "
    "its weight and compressed under that of the standing patient; none: no weight");
}

void AddPointOption(const OptionList& add, std::optional<Vector3>& point, const std::string& use)
{
  add.Numbers("--point", point, "X Y Z", "a place in the frame of the label volume, mm" + use);
}

void AddLesionOption(const OptionList& add, std::string& path, const std::string& use)
{
  add.Input("--lesion", path,
    "label volume in the same frame (.nrrd .mha .nii .nii.gz, DICOM SEG)" + use);
}

void AddLesionAxesFlag(const OptionList& add, bool& asGiven)
{
  add.Flag("--axes-as-given", asGiven,
    "take the header's axes of --lesion as they are, with no conversion to LPS");
}

CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side,
  const std::string& help)
{
  return add.Choice<std::optional<char>>("--side", side, { { "left", 'L' }, { "right", 'R' } },
    help);
}

void AddOverwriteFlag(const OptionList& add, bool& overwrite, const std::string& what)
{
  add.Flag("--overwrite", overwrite, "replace " + what);
}
}
