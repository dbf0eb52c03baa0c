// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_CasePictures_h
#define mammoray_Private_CasePictures_h

#include "mammoray/Study/RegistrationCase.h"

#include <vector>

namespace mammoray
{
/**
 * Reads the case's mammogram of the last of these views into it: the mammogram, its target and
 * unit, and, of a tomosynthesis, the other projections, no finer than the search compares them.
 * What can be told of the mammograms alone is checked, cheap things first. Throws InputError.
 */
void ReadCasePictures(const RegistrationCase& input, std::vector<RegisteredView>& views);
}

#endif
