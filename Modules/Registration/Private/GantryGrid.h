// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GantryGrid_h
#define mammoray_GantryGrid_h

#include "Private/PixelMask.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <string>

namespace mammoray
{
/// What the letters of a patient direction ("L", "FR") mean along gantry +x of a unit rolled by
/// `rollDeg`: > 0 with it, < 0 against it.
MAMMORAYREGISTRATION_EXPORT double AlongX(const std::string& direction, double rollDeg);

/**
 * Places the target's pixel grid in the gantry frame, by the header and, where it leaves something
 * open, by how far the breast touches each side of the picture (`touched`, TouchedSides) and by how
 * mammograms are hung, with a warning each. Answers the roll of the view, as said or assumed,
 * degrees.
 */
MAMMORAYREGISTRATION_EXPORT double PlaceInGantry(const Mammogram& mammogram, const PixelGrid& grid,
  const std::array<double, 4>& touched, RegistrationTarget& target);
}

#endif
