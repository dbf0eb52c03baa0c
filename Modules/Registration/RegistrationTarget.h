// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationTarget_h
#define mammoray_RegistrationTarget_h

#include "mammoray/Registration/Silhouette.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * A mammogram made ready for registration: log attenuation on a pixel grid in the receptor plane (z
 * = 0) of the gantry frame, with the breast outlined.
 */
struct RegistrationTarget
{
  int Columns = 0;
  int Rows = 0;
  /// Gantry x, y of the centre of pixel (0, 0), and of the steps to the next column and row, mm.
  std::array<double, 2> Origin{ 0, 0 };
  std::array<double, 2> ColumnStep{ 0.1, 0 };
  std::array<double, 2> RowStep{ 0, 0.1 };
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
  /// burnt into the image, what the detector does not measure. Empty: nowhere.
  std::vector<unsigned char> Excluded;
  /// Gantry y from which on outlines are compared, mm.
  double OutlineFromMm = 0;
  /// What had to be assumed because the header did not say, a sentence each.
  std::vector<std::string> Warnings;
  /// What header and picture disagree on, a sentence each: reasons to doubt a match.
  std::vector<std::string> Disagreements;
};

/// Whether a pixel's picture is not compared.
inline bool IsExcluded(const RegistrationTarget& target, std::size_t pixel)
{
  return !target.Excluded.empty() && target.Excluded[pixel] != 0;
}

/// Throws InputError unless the target's arrays fit its size, it holds a breast and its grid is
/// regular.
MAMMORAYREGISTRATION_EXPORT void ValidateTarget(const RegistrationTarget& target);

/**
 * The target with factor x factor pixels averaged into one (rest at the far borders dropped). A
 * coarse pixel is breast when all of its pixels are, and excluded when one of them is. Signed
 * distances are averaged.
 */
MAMMORAYREGISTRATION_EXPORT RegistrationTarget Coarsen(const RegistrationTarget& target,
  int factor);

/// The target in pixels of about `pixelSizeMm`, no smaller than its own.
MAMMORAYREGISTRATION_EXPORT RegistrationTarget CoarsenTo(const RegistrationTarget& target,
  double pixelSizeMm);

/// Gantry x, y of a continuous pixel position (pixel centres at whole numbers).
MAMMORAYREGISTRATION_EXPORT ReceptorPoint PixelPosition(const RegistrationTarget& target,
  double column, double row);

/// The continuous column and row of a point: the inverse of PixelPosition.
MAMMORAYREGISTRATION_EXPORT std::array<double, 2> PixelOf(const RegistrationTarget& target,
  const ReceptorPoint& point);

/**
 * Signed distance, mm, at a receptor point: bilinear between pixels; outside the image the value at
 * the nearest border pixel plus the distance to it.
 */
MAMMORAYREGISTRATION_EXPORT double SignedDistanceAt(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// Its gradient, without unit, where it has one (not on the lines between pixels).
MAMMORAYREGISTRATION_EXPORT ReceptorPoint SignedDistanceGradient(const RegistrationTarget& target,
  const ReceptorPoint& point);

/// True inside the image, at least `marginMm` away from its borders.
MAMMORAYREGISTRATION_EXPORT bool Contains(const RegistrationTarget& target,
  const ReceptorPoint& point, double marginMm);

/// Middle of the breast mask across where outlines are compared, on the receptor's chest-wall edge:
/// (x, 0). Throws InputError on an empty mask.
MAMMORAYREGISTRATION_EXPORT ReceptorPoint ChestWallCentre(const RegistrationTarget& target);

/**
 * The breast's outline along unit directions from `centre`: of each the farthest place inside the
 * breast, mm, where outlines are compared (OutlineFromMm) and the image shows both sides of it (2
 * mm and a pixel from its borders), or nothing. Linear between steps of half a pixel.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<std::optional<ReceptorPoint>> OutlineAlong(
  const RegistrationTarget& target, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions);
}

#endif
