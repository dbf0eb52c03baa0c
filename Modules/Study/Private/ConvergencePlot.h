// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ConvergencePlot_h
#define mammoray_ConvergencePlot_h

#include "mammoray/Registration/Registration.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Costs over iterations as an SVG element; the ordinate is logarithmic where the costs span more
/// than a factor of 20. Picture.h says why no chart of VTK draws it.
MAMMORAYSTUDY_EXPORT std::string ConvergencePlot(
  const std::vector<RegistrationIteration>& iterations);
}

#endif
