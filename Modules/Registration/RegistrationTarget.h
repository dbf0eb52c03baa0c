// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationTarget_h
#define mammoray_RegistrationTarget_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayRegistrationModule.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * A mammogram made ready for registration: log attenuation on a grid of the receptor, with the
 * breast outlined. Its arrays hold one value for each pixel of the grid, row by row.
 */
struct RegistrationTarget
{
  ReceptorGrid Grid;
  /**
   * -ln(I / I0) up to scale and offset, bright where more is absorbed. Exact in scale and offset
   * (I0 taken from the unattenuated background) for For Processing images.
   */
  std::vector<float> LogAttenuation;
  /// 1 inside the breast.
  std::vector<unsigned char> BreastMask;
  /// Distance to the breast's outline in the receptor plane, mm; negative inside. The image border
  /// that cuts the breast (chest wall) is not outline.
  std::vector<float> SignedDistanceMm;
  /// 1 where the picture inside the breast is not compared: the pectoral muscle, markers and text
  /// burnt into the image, pixels without a measurement. Empty if everything is compared.
  std::vector<unsigned char> Excluded;
  /// Outlines are compared at gantry y of at least this, mm.
  double OutlineFromMm = 0;
  /// Compressed thickness by the header, mm.
  std::optional<double> HeaderThicknessMm;
  /// Assumptions made where the header said nothing, a sentence each.
  std::vector<std::string> Warnings;
  /// Contradictions between header and picture, a sentence each: reasons to doubt a match.
  std::vector<std::string> Disagreements;
};

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

/// Excludes the pixels whose mask (rows x columns of the target) is not 0. Throws InputError if the
/// number of pixels differs.
MAMMORAYREGISTRATION_EXPORT void ExcludePixels(const std::vector<unsigned char>& mask,
  RegistrationTarget& target);

/// The fewest pixels of a picture, in the search's pixel sizes, that are compared.
inline constexpr std::size_t FewestComparedPixels = 10;

/// True if a pixel is left out of the comparison of pictures.
inline bool IsExcluded(const RegistrationTarget& target, std::size_t pixel)
{
  return !target.Excluded.empty() && target.Excluded[pixel] != 0;
}

/// Throws InputError unless the target's arrays fit its size, it holds a breast and its grid is
/// regular.
MAMMORAYREGISTRATION_EXPORT void ValidateTarget(const RegistrationTarget& target);

/**
 * Averages factor x factor pixels into one; the rest at the far borders is dropped. A coarse pixel
 * is breast when all of its pixels are, and excluded when one of them is. Signed distances are
 * averaged; everything that is not a picture is copied.
 */
MAMMORAYREGISTRATION_EXPORT RegistrationTarget Coarsen(const RegistrationTarget& target,
  int factor);

/// Coarsens to pixels of about `pixelSizeMm`; a target whose pixels are larger is copied.
MAMMORAYREGISTRATION_EXPORT RegistrationTarget CoarsenTo(const RegistrationTarget& target,
  double pixelSizeMm);

/**
 * Signed distance, mm, at a receptor point: bilinear between pixels; outside the image the value at
 * the nearest border pixel plus the distance to it.
 */
MAMMORAYREGISTRATION_EXPORT double SignedDistanceAt(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// Gradient of the signed distance (no unit). It is not defined on the lines between pixels.
MAMMORAYREGISTRATION_EXPORT ReceptorPoint SignedDistanceGradient(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// Point (x, 0) of the receptor's chest-wall edge at the middle, across, of the part of the breast
/// whose outline is compared. Throws InputError on an empty mask.
MAMMORAYREGISTRATION_EXPORT ReceptorPoint ChestWallCentre(const RegistrationTarget& target);

/**
 * Outline of the breast along unit directions from `centre`: for each direction the farthest point
 * inside the breast, mm, linear between steps of half a pixel. Nothing where outlines are not
 * compared (OutlineFromMm) and where the image does not show both sides of the outline (2 mm and a
 * pixel from its borders).
 */
MAMMORAYREGISTRATION_EXPORT std::vector<std::optional<ReceptorPoint>> OutlineAlong(
  const RegistrationTarget& target, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions);
}

#endif
