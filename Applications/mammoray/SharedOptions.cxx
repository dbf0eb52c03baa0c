// SPDX-License-Identifier: Apache-2.0
#include "SharedOptions.h"

namespace mammoray
{
CLI::Option* AddLabelOptions(const OptionList& add, LabelSource& source)
{
  CLI::Option* labels = add(Shared::Labels, source.Path);
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
    "(for example in front of the chest wall): no --skin there, and it does not move")
    ->needs(labels);
  return labels;
}

SharedOption Shared::Pose(const PoseParameter& parameter)
{
  Quantity quantity = parameter.Unit;
  if (parameter.Index == ThicknessParameter || parameter.Index == StiffnessParameter)
  {
    quantity = Positive(parameter.Unit);
  }
  else if (parameter.Index == TiltParameter)
  {
    quantity = Between(-30, 30, parameter.Unit);
  }
  return { std::string("--") + parameter.Name, parameter.Help, quantity };
}

void AddPoseOptions(const OptionList& add, BreastPose& pose)
{
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (parameter.Index != ThicknessParameter && parameter.Index != StiffnessParameter)
    {
      add(Shared::Pose(parameter), pose.*parameter.Value);
    }
  }
}

CLI::Option* AddSideOption(const OptionList& add, std::optional<char>& side)
{
  return add.Choice<std::optional<char>>("--side", side, { { "left", 'L' }, { "right", 'R' } },
    "the patient's own breast\n(default: by the mammogram's header, where there is one)");
}
}
