// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TargetPreparation_h
#define mammoray_TargetPreparation_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

namespace mammoray
{
struct TargetOptions
{
  /**
   * Level of the breast's edge, as a fraction of the step from the log attenuation of air to the
   * breast's median, (0, 1). A compressed breast ends in a bulge, so 3 % is within a tenth of a
   * millimetre of its edge.
   */
  double EdgeFraction = 0.03;
  /// Level of the edge in robust standard deviations of the air within a centimetre (after a median
  /// over 3 x 3 pixels). The larger of the two levels is used. Positive.
  double EdgeSigmas = 6;
  /// Parts of the breast thinner than this are removed, mm: frames of the detector and markers that
  /// touch it.
  double ThinnestFeatureMm = 2;
  /// Coarsest grid on which the outline is found, mm; positive.
  double OutlineGridMm = 0.2;
  /// Parts of the breast's picture that are not compared (RegistrationTarget::Excluded): the
  /// pectoral muscle in oblique views (FindPectoralEdge); what is burnt into the picture
  /// (ExcludeSaturated); what is as dark as air within the breast, such as a detector's frame.
  bool ExcludePectoral = true;
  bool ExcludeMarkers = true;
  bool ExcludeUnseen = true;
  /**
   * Depth of a strip along the chest wall in which neither picture nor outline is compared, mm; not
   * negative (RegistrationTarget::OutlineFromMm). A patient's MRI shows fat and muscle of the body
   * there, which the edges of the plates push away.
   */
  double ChestWallMarginMm = 0;
};

/**
 * Brings a mammogram into the gantry frame, to log attenuation, and outlines the breast.
 *
 * *Frame.* The chest-wall side of the picture is that of the header's Patient Orientation; the
 * origin is the middle of that edge of the outermost pixels. +x follows Patient Orientation, turned
 * with the view as BreastPose::RollDeg turns the unit: patient left in CC, towards the head in MLO
 * and ML of the left breast, towards the feet in those of the right one. What the header leaves
 * open is taken from the picture and from how mammograms are hung (lateral or head up), with a
 * warning each.
 *
 * *Log attenuation.* Linear images: -ln(I / I0), I0 a smooth level fitted to the air beside the
 * breast (heel effect, inverse square), so 0 is air. Logarithmic and For Presentation images: the
 * stored values, turned so that more attenuation is more, less such a level of the air. The
 * header's window (VOI LUT) is for eyes and is not applied.
 *
 * *Breast.* Above the air's level there, what scatter adds beside the breast included, by
 * TargetOptions' threshold, connected, the piece that occupies most of the chest-wall side's
 * neighbourhood, holes filled. SignedDistanceMm counts only the outline within the picture: its
 * borders, which cut the breast, are not outline, as if the breast went on beyond them. Good to
 * about a third of OutlineGridMm or of a pixel, whichever is smaller.
 *
 * Throws InputError when the image is flat, shows no air or no breast, or cuts the breast off at
 * its front.
 */
MAMMORAYREGISTRATION_EXPORT RegistrationTarget PrepareTarget(const Mammogram& mammogram,
  const TargetOptions& options = {});
}

#endif
