// SPDX-License-Identifier: Apache-2.0
// Options that mean the same in several commands, declared once: add(Shared::Mesh, path).
#ifndef mammoray_SharedOptions_h
#define mammoray_SharedOptions_h

#include "OptionList.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Study/LabelSource.h"

#include <optional>
#include <string>

namespace mammoray
{
namespace Shared
{
/// Numbers: one, two or three.
inline const SharedOption Energy{ "--kev", "a single photon energy instead of a spectrum",
  Positive("keV") };
inline const SharedOption LabelSpacing{ "--label-spacing",
  "cubic voxels of the labels; 0 keeps those of the input", NonNegative("mm") };
inline const SharedOption PixelSpacing{ "--pixel-spacing",
  "distance of the picture's pixels at the receptor", Positive("mm") };
inline const SharedOption Series{ "--series",
  "the volume to take, by its number in the list of 'mammoray intake'\n(of segment, intake and "
  "register two: without and with fat suppression)",
  Between(1, 9999) };
inline const SharedOption SimulationCellSize{ "--simulation-cell-size",
  "largest cells of the simulation mesh that is made\n(0: by the size of the breast, 3000 to 6000 "
  "cells)",
  NonNegative("mm") };
inline const SharedOption SourceToDetector{ "--source-to-detector", "source to receptor plane",
  Positive("mm") };
inline const SharedOption SupportHeight{ "--support-height", "breast support above the receptor",
  NonNegative("mm") };
inline const SharedOption Pixel{ "--pixel",
  "a pixel of the mammogram: what lies along its X-ray\n(from 0 at the centre of the first pixel)",
  "COLUMN ROW" };
inline const SharedOption Point{ "--point", "a place in the frame of the label volume, mm",
  "X Y Z" };

/// Files and folders, or names of shipped ones.
inline const SharedOption Image{ "--image",
  "MRI (.nrrd .mha .nii.gz, DICOM series)\n(also .nhdr .mhd .nii; in the frame of the labels)",
  InputTypeName };
inline const SharedOption Labels{ "--labels",
  "label volume (.nrrd .mha .nii.gz, DICOM series or segmentation)\n(also .nhdr .mhd .nii; names "
  "of segments count before numbers)",
  InputTypeName };
inline const SharedOption Lesion{ "--lesion",
  "label volume of lesions, same frame (.nrrd .mha .nii.gz, DICOM SEG)", InputTypeName };
inline const SharedOption Mammograms{ "--mammogram",
  "mammogram (DICOM MG), once for each view of the same breast\n(CC and MLO share the stiffness of "
  "gland; projections of a tomosynthesis share the compression)",
  FileTypeName };
inline const SharedOption Materials{ "--materials",
  "material table: .json or a shipped one's name (victre, segment, ...)", InputTypeName };
inline const SharedOption Mesh{ "--mesh",
  "tetrahedra (.vtu .vtk .msh) or surfaces (.vtp .stl .ply .obj .glb .gltf)\n(cell array Material, "
  "or one "
  "material; those of the material table)",
  FileTypeName };
inline const SharedOption Result{ "--result", "folder written by 'mammoray register'",
  InputTypeName };
inline const SharedOption Scene{ "--scene", "surfaces, source, detector and beam in a file (.json)",
  FileTypeName };
inline const SharedOption SimulationMesh{ "--simulation-mesh",
  "coarse mesh for the mechanics (.vtu)\n(default: made from the labels, else from the mesh)",
  FileTypeName };
inline const SharedOption Spectrum{ "--spectrum",
  "spectrum: a file or a shipped one's name\n(.spc, or two columns of energy and photons; what "
  "each may hold: file formats)",
  InputTypeName };

/// Texts: AnatomicalAxes::FromCode, and MATERIAL=FILE each.
inline const SharedOption Orientation{ "--orientation",
  "directions of the input's axes, such as LPS or ALS\n(a letter of L/R, A/P, S/I for each; LPS is "
  "DICOM's, ALS that of the FDA's phantoms)" };
inline const SharedOption Surface{ "--surface",
  "closed surfaces of one material each, in place of other inputs\n(.vtp .stl .ply .obj .msh .glb "
  ".gltf; for an X-ray the material may be a composition, 'Ti90Al6V4@4.43=matrix.stl')",
  "MATERIAL=FILE" };

/// A parameter of the pose, such as --roll.
SharedOption Pose(const PoseParameter& parameter);
}

/// Adds the options of all parameters of the pose but thickness and stiffness, which do not say
/// where the unit stands.
void AddPoseOptions(const OptionList& add, BreastPose& pose);

/// Adds --labels, --crop, --skin and --cut-side; gives the option --labels.
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source);

/// Adds --side left|right: 'L' or 'R', the patient's own; nothing: not given. Gives the option.
CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side);

/// Adds --unit of the files of --surface and --mesh.
template <typename T>
void AddUnitOption(const OptionList& add, T& unit)
{
  add.Expert().Word("--unit", unit, { "um", "mm", "cm", "m", "in" },
    "unit of the numbers in the files of --surface and --mesh\n(default: mm, of glTF m)");
}

/// Adds --view of mammograms, one or a list.
template <typename T>
void AddViewOption(const OptionList& add, T& view)
{
  add.Word("--view", view, { "CC", "MLO", "ML", "LM", "LMO", "FB" },
    "the mammogram's\n(default: by its header, else by the roll)");
}
}

#endif
