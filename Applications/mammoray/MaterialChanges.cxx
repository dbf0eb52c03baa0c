// SPDX-License-Identifier: Apache-2.0
#include "MaterialChanges.h"

#include "OptionList.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ValidRange.h"

#include <algorithm>

namespace mammoray
{
void SetAttenuations(const std::vector<std::string>& changes, bool acceptUnusual,
  SceneDescription& description)
{
  for (const std::string& text : changes)
  {
    const std::size_t equals = text.find('=');
    const std::size_t at = std::min(text.rfind('@'), text.size());
    double density = 1;
    bool usable = equals != std::string::npos && equals > 0 && at > equals + 1;
    if (usable && at < text.size())
    {
      usable = ToNumber(text.substr(at + 1), density) && density > 0;
      if (usable && !acceptUnusual)
      {
        CheckValidRange(ValidRanges::Density, density, "--attenuation " + text);
      }
    }
    if (!usable)
    {
      throw InputError(
        "--attenuation: expected MATERIAL=ATTENUATION[@DENSITY], found '" + text + "'");
    }
    description.Attenuations[text.substr(0, equals)] = text.substr(equals + 1);
  }
}

void SetIodine(const std::vector<std::string>& additions, SceneDescription& description)
{
  for (const std::string& text : additions)
  {
    const std::string form = "MATERIAL=MG_PER_ML, 0 to 500";
    const auto [name, number] = SplitAssignment(text, "--iodine", form);
    double iodine = 0;
    if (!ToNumber(number, iodine) || !(iodine >= 0 && iodine <= 500))
    {
      throw InputError("--iodine: expected " + form + ", found '" + text + "'");
    }
    description.IodineMgPerMl[name] = iodine;
  }
}
}
