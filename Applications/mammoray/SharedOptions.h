// SPDX-License-Identifier: Apache-2.0
// Options that mean the same in several commands, declared once.
#ifndef mammoray_SharedOptions_h
#define mammoray_SharedOptions_h

#include "OptionList.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Study/LabelSource.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Adds --labels, --crop, --skin and --cut-side; gives the option --labels.
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source);

/// Adds --labels alone.
CLI::Option* AddLabelsOption(const OptionList& add, std::string& path);

/// Adds --materials: a file or a shipped table's name (see FindMaterialTable); gives the option.
CLI::Option* AddMaterialsOption(const OptionList& add, std::string& pathOrName);

/// Adds --orientation: directions of the axes of the input (AnatomicalAxes::FromCode).
CLI::Option* AddOrientationOption(const OptionList& add, std::string& code);

/// Adds --spectrum: a file or a shipped one's name.
CLI::Option* AddSpectrumOption(const OptionList& add, std::string& pathOrName);

/// Adds --result: the folder of a registration; gives the option.
CLI::Option* AddResultOption(const OptionList& add, std::string& folder);

/// Unit and range of a parameter of the pose.
Quantity QuantityOf(const PoseParameter& parameter);

/// Adds the option of a parameter of the pose, such as --roll; `T` as in OptionList.
template <typename T>
CLI::Option* AddPoseOption(const OptionList& add, const PoseParameter& parameter, T& value)
{
  return add(std::string("--") + parameter.Name, value, QuantityOf(parameter), parameter.Help);
}

/// Adds an option for each parameter of the pose but thickness and stiffness, which do not say
/// where the unit stands.
void AddPoseOptions(const OptionList& add, BreastPose& pose);

/// Adds --simulation-mesh.
void AddSimulationMeshOption(const OptionList& add, std::string& mesh);

/// Adds --simulation-cell-size.
void AddSimulationCellSizeOption(const OptionList& add, double& cellSizeMm);

/// Adds --label-spacing.
void AddLabelSpacingOption(const OptionList& add, double& spacingMm);

/// Help of options that several commands keep in variables of different types.
inline constexpr const char* SourceToDetectorHelp = "source to receptor plane";
inline constexpr const char* LabelSpacingHelp =
  "cubic voxels of the labels; 0 keeps those of the input";
inline constexpr const char* SupportHeightHelp = "breast support above the receptor";
inline constexpr const char* PixelSpacingHelp = "distance of the picture's pixels at the receptor";

/// Adds --mesh; gives the option.
CLI::Option* AddMeshOption(const OptionList& add, std::string& path);

/// Adds --surface: MATERIAL=FILE each; gives the option.
CLI::Option* AddSurfaceOption(const OptionList& add, std::vector<std::string>& surfaces);

/// Adds --scene; gives the option.
CLI::Option* AddSceneOption(const OptionList& add, std::string& path);

/// Adds --kev.
void AddEnergyOption(const OptionList& add, std::optional<double>& energyKeV);

/// Adds --point: a place of the breast, mm.
void AddPointOption(const OptionList& add, std::optional<Vector3>& point);

/// Adds --lesion: a volume of lesions (ReadLesions) in the frame of the label volume.
void AddLesionOption(const OptionList& add, std::string& path);

/// Adds --image: an MRI in the frame of the label volume; gives the option.
CLI::Option* AddImageOption(const OptionList& add, std::string& path);

/// Adds --side left|right: 'L' or 'R', the patient's own; nothing: not given. Gives the option.
CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side);

/// Adds --mammogram: one for each view; gives the option.
CLI::Option* AddMammogramsOption(const OptionList& add, std::vector<std::string>& paths);

/// Adds --view of mammograms, one or a list.
template <typename T>
void AddViewOption(const OptionList& add, T& view)
{
  add.Word("--view", view, { "CC", "MLO", "ML", "LM", "LMO", "FB" },
    "the mammogram's\n(default: by its header, else by the roll)");
}

/// Adds --pixel: a pixel of the mammogram.
void AddPixelOption(const OptionList& add, std::optional<std::array<double, 2>>& pixel);
}

#endif
