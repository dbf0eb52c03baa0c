// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationTarget_h
#define mammoray_RegistrationTarget_h

#include "mammoray/Foundation/ReceptorGrid.h"
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
