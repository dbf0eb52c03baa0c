// SPDX-License-Identifier: Apache-2.0
#include "Private/JointSearch.h"

#include <numeric>

namespace mammoray
{
std::vector<std::size_t> JointSearch::MammogramsOf(int parameter, std::size_t mammogram) const
{
  if (!IsShared(parameter))
  {
    return { mammogram };
  }
  std::vector<std::size_t> all(this->Mammograms.size());
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  return all;
}

std::vector<std::shared_ptr<EvaluatedState>> JointSearch::States() const
{
  std::vector<std::shared_ptr<EvaluatedState>> states;
  for (const MammogramSearch& mammogram : this->Mammograms)
  {
    states.push_back(mammogram.Here);
  }
  return states;
}

void JointSearch::Observe() const
{
  if (!this->Observer)
  {
    return;
  }
  std::vector<const RegistrationResult*> found;
  for (const MammogramSearch& mammogram : this->Mammograms)
  {
    found.push_back(&mammogram.Result);
  }
  this->Observer(found);
}

void JointSearch::CollectUnknowns()
{
  this->Unknowns.clear();
  for (std::size_t mammogram = 0; mammogram < this->Mammograms.size(); ++mammogram)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = this->Mammograms[mammogram].Result.Parameters[index];
      if (parameter.Fixed || (IsShared(index) && mammogram > 0))
      {
        continue;
      }
      this->Unknowns.push_back({ index, this->MammogramsOf(index, mammogram), parameter.Lower,
        parameter.Upper, parameter.Scale });
    }
  }
}
}
