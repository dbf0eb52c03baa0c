// SPDX-License-Identifier: Apache-2.0
// Options that mean the same in several commands, declared once.
#ifndef mammoray_SharedOptions_h
#define mammoray_SharedOptions_h

#include "OptionList.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Biomechanics/WallAttachment.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <optional>
#include <string>

namespace mammoray
{
/// Adds --labels, --crop, --skin, --cut-side, --axes-as-given and --accept-unusual; gives the
/// option --labels.
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source);

/// Adds --accept-unusual: values outside their ValidRange are accepted.
void AddAcceptUnusualFlag(const OptionList& add, bool& accept);

/// Adds --materials: a file or a shipped table's name (see FindMaterialTable); gives the option.
CLI::Option* AddMaterialsOption(const OptionList& add, std::string& pathOrName);

/// Adds --orientation: directions of the axes of `what` (AnatomicalAxes::FromCode).
CLI::Option* AddOrientationOption(const OptionList& add, std::string& code,
  const std::string& what);

/// Adds --spectrum: a file or a shipped one's name.
CLI::Option* AddSpectrumOption(const OptionList& add, std::string& pathOrName,
  const std::string& remark = "");

/// Adds --device and --projector auto|ray-tracing|rasterisation.
void AddProjectorOptions(const OptionList& add, ProjectorOptions& options);

/// Adds --result: the folder of a registration; gives the option.
CLI::Option* AddResultOption(const OptionList& add, std::string& folder);

/// Unit and range of a parameter of the pose.
Quantity QuantityOf(const PoseParameter& parameter);

/// Adds --roll, say; `T` as in OptionList. Gives the option.
template <typename T>
CLI::Option* AddPoseOption(const OptionList& add, const PoseParameter& parameter, T& value,
  const std::string& remark = "")
{
  return add(std::string("--") + parameter.Name, value, QuantityOf(parameter),
    parameter.Help + remark);
}

/// Adds an option for each parameter of the pose but thickness and stiffness, which do not say
/// where the unit stands.
void AddPoseOptions(const OptionList& add, BreastPose& pose);

/// Adds --support-edge, --paddle-edge and --edge-radius.
void AddPlateOptions(const OptionList& add, double& supportEdgeMm, double& paddleEdgeMm,
  double& edgeRadiusMm);

/// Adds --pixel-sizes, --residual and --window: how a registration compares pictures.
void AddComparisonOptions(const OptionList& add, RegistrationOptions& options);

/// Adds --chest-wall.
void AddChestWallOption(const OptionList& add, ChestWallMode& mode);

/// Adds --mri-position.
void AddImagePositionOption(const OptionList& add, std::optional<PatientPosition>& position);

/// Adds --point: a place of the breast, mm; `use` ends the help: what is done with it.
void AddPointOption(const OptionList& add, std::optional<Vector3>& point, const std::string& use);

/// Adds --lesion: a volume of lesions (ReadLesions) in the frame of the label volume; `use` as
/// above.
void AddLesionOption(const OptionList& add, std::string& path, const std::string& use);

/// Adds --axes-as-given of --lesion (AxesOf).
void AddLesionAxesFlag(const OptionList& add, bool& asGiven);

/// Adds --side left|right: 'L' or 'R', the patient's own; nothing: not given. Gives the option.
CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side,
  const std::string& help);

/// Adds --overwrite.
void AddOverwriteFlag(const OptionList& add, bool& overwrite,
  const std::string& what = "output files");
}

#endif
