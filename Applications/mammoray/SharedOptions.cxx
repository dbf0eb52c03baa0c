// SPDX-License-Identifier: Apache-2.0
#include "SharedOptions.h"

namespace mammoray
{
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source)
{
  CLI::Option* labels = AddLabelsOption(add, source.Path);
  const OptionList expert = add.Expert();
  expert("--crop", source.Crop,
    "voxels of --labels to keep along i, j and k: three times FIRST:LAST\n(counted from 0, both "
    "included, : for all; e.g. --crop 0:199 : 12:)")
    ->expected(3)
    ->needs(labels);
  expert("--skin", source.Skin,
    "THICKNESS[=MATERIAL]: a layer of that many mm below the air becomes skin\n(default: the "
    "table's thin material), not at fixed tissue nor at the volume's border")
    ->needs(labels);
  expert("--cut-side", source.CutSides,
    "i-, i+, j-, j+, k- or k+: end of an axis at which the tissue was cut flat\nwith air behind "
    "(before the chest wall, say): it gets no --skin and does not move there")
    ->needs(labels);
  return labels;
}

CLI::Option* AddLabelsOption(const OptionList& add, std::string& path)
{
  return add.Input("--labels", path,
    "label volume (.nrrd .mha .nii.gz, DICOM series or segmentation)\n(also .nhdr .mhd .nii; the "
    "labels of a segmentation are its segment numbers)");
}

CLI::Option* AddMaterialsOption(const OptionList& add, std::string& pathOrName)
{
  return add.Input("--materials", pathOrName,
    "material table: .json or a shipped one's name (victre, segment, ...)");
}

CLI::Option* AddOrientationOption(const OptionList& add, std::string& code)
{
  return add("--orientation", code,
    "directions of the input's axes, such as LPS or ALS\n(one letter each of L/R, A/P, S/I for "
    "+x, +y and +z; LPS is DICOM's, ALS that of the FDA's phantoms)");
}

CLI::Option* AddSpectrumOption(const OptionList& add, std::string& pathOrName)
{
  return add.Input("--spectrum", pathOrName, "spectrum: .spc or a shipped one's name");
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

void AddSimulationMeshOption(const OptionList& add, std::string& mesh)
{
  add.Input("--simulation-mesh", mesh,
    "coarse mesh for the mechanics (.vtu)\n(default: made from the labels, else from the mesh)");
}

void AddSimulationCellSizeOption(const OptionList& add, double& cellSizeMm)
{
  add("--simulation-cell-size", cellSizeMm, NonNegative("mm"),
    "largest cells of the simulation mesh that is made\n(0: by the size of the breast, 3000 to "
    "6000 cells)");
}

void AddLabelSpacingOption(const OptionList& add, double& spacingMm)
{
  add("--label-spacing", spacingMm, NonNegative("mm"), LabelSpacingHelp);
}

CLI::Option* AddMeshOption(const OptionList& add, std::string& path)
{
  return add.Input("--mesh", path,
    "tetrahedra (.vtu) or triangles (.vtp .stl .ply .obj .glb .gltf)\n(cell array Material, or one "
    "material; those of --materials)");
}

CLI::Option* AddSurfaceOption(const OptionList& add, std::vector<std::string>& surfaces)
{
  return add("--surface", surfaces,
    "closed surfaces of one material each, in place of other inputs\n(.vtp .stl .ply .obj .glb "
    ".gltf; for an X-ray the material may be what it is made of, with the density in g/cm3 where "
    "that does not tell it: 'Ti90Al6V4@4.43=matrix.stl')")
    ->type_name("MATERIAL=FILE");
}

CLI::Option* AddSceneOption(const OptionList& add, std::string& path)
{
  return add.Input("--scene", path,
    "surfaces, source, detector and beam in a file (.json, docs/scene.md)");
}

void AddEnergyOption(const OptionList& add, std::optional<double>& energyKeV)
{
  add("--kev", energyKeV, Positive("keV"), "a single photon energy instead of a spectrum");
}

void AddPointOption(const OptionList& add, std::optional<Vector3>& point)
{
  add.Numbers("--point", point, "X Y Z", "a place in the frame of the label volume, mm");
}

void AddLesionOption(const OptionList& add, std::string& path)
{
  add.Input("--lesion", path,
    "label volume of lesions, same frame (.nrrd .mha .nii.gz, DICOM SEG)");
}

CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side)
{
  return add.Choice<std::optional<char>>("--side", side, { { "left", 'L' }, { "right", 'R' } },
    "the patient's own breast\n(default: by the mammogram's header, where there is one)");
}

CLI::Option* AddImageOption(const OptionList& add, std::string& path)
{
  return add.Input("--image", path,
    "MRI (.nrrd .mha .nii.gz, DICOM series)\n(also .nhdr .mhd .nii; in the frame of the labels, "
    "where there are some)");
}

CLI::Option* AddMammogramsOption(const OptionList& add, std::vector<std::string>& paths)
{
  return add.Input("--mammogram", paths,
    "mammogram (DICOM MG), once for each view of the same breast\n(CC and MLO are registered "
    "together, with one stiffness of gland; of a tomosynthesis, Breast Projection X-Ray Image, all "
    "projections against one compression)");
}

void AddPixelOption(const OptionList& add, std::optional<std::array<double, 2>>& pixel)
{
  add.Numbers("--pixel", pixel, "COLUMN ROW",
    "a pixel of the mammogram: what lies along its X-ray\n(from 0 at the centre of the first "
    "pixel)");
}
}
