// SPDX-License-Identifier: Apache-2.0
// What no patient has, and what a mammogram, its header and the volume disagree on.
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
/// CheckValidRange unless the case accepts unusual values. `remedy`: the field that gives another.
void CheckUsual(const RegistrationCase& input, const ValidRange& range, double value,
  const std::string& path, const char* remedy);

/// Throws InputError where the header of a DICOM mammogram says that it is none of a whole breast
/// as plates press it onto the receptor (WhyNotWholeBreast).
void CheckWholeBreast(const RegistrationCase& input, const std::string& path);

/// Throws InputError where the last view's picture is an earlier one's, or its pixels are no
/// detector's.
void CheckMammogram(const RegistrationCase& input, const std::vector<RegisteredView>& views);

/**
 * Throws InputError where the outlined breast has no patient's width along the chest wall, or its
 * header names an oblique view's directions as the other breast has them. Which breast it is
 * according to how mammograms are hung (the left one's chest wall at the left) may differ from what
 * the header says, where the user does not say it: the target's Disagreements tell.
 */
MAMMORAYSTUDY_EXPORT void CheckPicturedBreast(const RegistrationCase& input, RegisteredView& view);

/// Throws InputError unless the axes are those of a patient and not of their mirror image.
void CheckHanded(const RegistrationCase& input, const AnatomicalAxes& axes);

/**
 * Throws InputError where the volume's breast has no patient's width across or along the body, does
 * not lie in front of what holds it, or is, in a volume that shows much more of the body on one
 * side of it than on the other, not the breast of that side ('L', 'R' or '?').
 */
MAMMORAYSTUDY_EXPORT void CheckTissue(const RegistrationCase& input, const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes, char laterality);

/**
 * Compares how much breast the pictures of a study show, area times the header's thickness, with
 * its MRI, and the pictures with each other. Throws InputError where they cannot be of one breast;
 * what is unusual is told by the targets' Disagreements.
 */
MAMMORAYSTUDY_EXPORT void CheckSizes(const RegistrationCase& input, double breastCm3,
  std::vector<RegisteredView>& views);
}

#endif
