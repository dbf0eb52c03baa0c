// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Mammogram.h"

#include <cmath>

namespace mammoray
{
std::optional<double> NominalRollDeg(const Mammogram& mammogram)
{
  const std::string& view = mammogram.View;
  if (view == "CC" || view == "XCC" || view == "XCCL" || view == "XCCM")
  {
    return 0.0;
  }
  if (view == "FB")
  {
    return 180.0;
  }
  double size = 0;
  if (view == "ML" || view == "LM")
  {
    size = 90;
  }
  else if (view == "MLO" || view == "LMO")
  {
    // The sign of the header's angle depends on the side; only its magnitude is used.
    size = std::abs(mammogram.PositionerPrimaryAngleDeg.value_or(0));
    if (size == 0)
    {
      size = 45;
    }
    else if (size > 90)
    {
      size = 180 - size;
    }
  }
  else
  {
    return std::nullopt;
  }
  if (mammogram.Laterality != 'L' && mammogram.Laterality != 'R')
  {
    return std::nullopt;
  }
  // A positive roll moves the source to the patient's left: the medial side of the right breast.
  const bool sourceMedial = view[0] == 'M';
  return (mammogram.Laterality == 'R') == sourceMedial ? size : -size;
}
}
