// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/PoseParameters.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
double PoseParameter::Lower(double start) const
{
  return std::isfinite(this->Least) ? std::min(this->Least, start)
                                    : start - (this->Reach + this->RelativeReach * start);
}

double PoseParameter::Upper(double start) const
{
  return std::isfinite(this->Most) ? std::max(this->Most, start)
                                   : start + (this->Reach + this->RelativeReach * start);
}

const PoseParameter& FindPoseParameter(const std::string& name)
{
  const auto found = std::find_if(PoseParameters.begin(), PoseParameters.end(),
    [&](const PoseParameter& parameter) { return name == parameter.Name; });
  if (found == PoseParameters.end())
  {
    std::vector<std::string> known;
    known.reserve(PoseParameters.size());
    for (const PoseParameter& parameter : PoseParameters)
    {
      known.emplace_back(parameter.Name);
    }
    throw InputError("there is no parameter '" + name + "'; " + SpellingHint(name, known));
  }
  return *found;
}

std::string PoseParameterNames(const std::string& separator)
{
  std::string names;
  for (const PoseParameter& parameter : PoseParameters)
  {
    names += (names.empty() ? "" : separator) + parameter.Name;
  }
  return names;
}

std::vector<std::string> FreePoseParameterNames()
{
  std::vector<std::string> names;
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (parameter.Free)
    {
      names.emplace_back(parameter.Name);
    }
  }
  return names;
}

BreastPose DefaultStart()
{
  BreastPose start;
  for (const PoseParameter& parameter : PoseParameters)
  {
    start.*parameter.Value = parameter.Start;
  }
  return start;
}

std::vector<double> ValuesOf(const BreastPose& pose)
{
  std::vector<double> values;
  values.reserve(PoseParameters.size());
  for (const PoseParameter& parameter : PoseParameters)
  {
    values.push_back(pose.*parameter.Value);
  }
  return values;
}

BreastPose PoseOf(const std::vector<double>& values)
{
  BreastPose pose;
  for (const PoseParameter& parameter : PoseParameters)
  {
    pose.*parameter.Value = values.at(parameter.Index);
  }
  return pose;
}
}
