// SPDX-License-Identifier: Apache-2.0
// Values that no patient has, and contradictions between a mammogram, its header and the volume.
#ifndef mammoray_Private_CaseChecks_h
#define mammoray_Private_CaseChecks_h

#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Fills in the last of `views` from the case's mammogram of that number: the mammogram, its target
 * and unit, and the other projections of a tomosynthesis, no finer than the search compares them.
 * Throws InputError on what the mammograms alone show to be wrong.
 */
MAMMORAYSTUDY_EXPORT void ReadCasePictures(const RegistrationCase& input,
  std::vector<RegisteredView>& views);

/// Throws InputError with this message, unless the case accepts unusual values. `field`: the member
/// of the case to change; `found`: its value that is wrong.
void RefuseUnusual(const RegistrationCase& input, const std::string& message,
  const std::string& field, const std::string& found);

/// CheckValidRange unless the case accepts unusual values. `remedy`: the field that gives another.
void CheckUsual(const RegistrationCase& input, const ValidRange& range, double value,
  const std::string& path, const char* remedy);

/**
 * Throws InputError if the outlined breast has no patient's width along the chest wall, or if the
 * header of an oblique view gives directions that only the other breast has. The way mammograms are
 * hung (the left breast's chest wall at the left) may contradict the header: this is one of the
 * target's Disagreements, unless the user states the side.
 */
MAMMORAYSTUDY_EXPORT void CheckPicturedBreast(const RegistrationCase& input, RegisteredView& view);

/// Throws InputError if the axes are the mirror image of a patient's.
void CheckHanded(const RegistrationCase& input, const AnatomicalAxes& axes);

/**
 * Throws InputError if the volume holds two breasts, if its breast has no patient's width across or
 * along the body, does not lie in front of what holds it, or is not the breast of the given side
 * ('L', 'R' or '?'). The side shows in a volume that has much more of the body on one side of the
 * breast.
 */
MAMMORAYSTUDY_EXPORT void CheckTissue(const RegistrationCase& input, const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes, char laterality);

/**
 * Compares the pictures of a study with its MRI by how much breast they show (area times the
 * header's thickness), and with each other. Throws InputError if they cannot be of one breast;
 * unusual sizes become Disagreements of the targets.
 */
MAMMORAYSTUDY_EXPORT void CheckSizes(const RegistrationCase& input, double breastCm3,
  std::vector<RegisteredView>& views);
}

#endif
