// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plate_h
#define mammoray_Plate_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/**
 * Fits a thin plate to weighted heights over the coronal plane: the h that minimises
 *
 *   sum_n w_n (h_n - given_n)^2 + (wavelength / (2 pi cell))^4 sum (h_xx^2 + 2 h_xz^2 + h_zz^2)
 *
 * with second differences over cells. Where w = 1, the plate halves waves of this length, mm, keeps
 * longer ones and removes shorter ones; where w = 0 it continues without a force. Heights and
 * weights share a grid of square cells; at least three weights must be positive. Solved by
 * conjugate gradients on cells of at most a sixteenth of the wavelength.
 */
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitPlate(const HeightMap* heights,
  const HeightMap* weights, double wavelengthMm);

/// Shape of a plate without forces.
enum class PlateShape
{
  Flat,
  Paraboloid ///< that of FitParaboloid
};

/// Fits a + b x + c z + d x^2 + e x z + f z^2 to the heights by weighted least squares.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitParaboloid(const HeightMap* heights,
  const HeightMap* weights);

/// As FitPlate, but robust against outliers: the fit is repeated once per scale (decreasing, mm)
/// with the weights times Tukey's biweight (1 - (r / scale)^2)^2 of the residuals r, which is 0
/// beyond the scale.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitRobustPlate(const HeightMap* heights,
  const HeightMap* weights, double wavelengthMm, const std::vector<double>& scalesMm,
  PlateShape shape = PlateShape::Flat);
}

#endif
