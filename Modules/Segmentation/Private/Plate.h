// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plate_h
#define mammoray_Plate_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/**
 * A thin plate through weighted heights over the coronal plane: the h that minimises
 *
 *   sum_n w_n (h_n - given_n)^2 + (wavelength / (2 pi cell))^4 sum (h_xx^2 + 2 h_xz^2 + h_zz^2)
 *
 * with second differences over cells. Where w = 1 it halves waves of that length, mm, keeps longer
 * ones and takes out shorter; where w = 0 it bends on without a force. Heights and weights share a
 * grid of square cells; at least three weights must be positive. Solved by conjugate gradients on
 * cells of at most a sixteenth of the wavelength.
 */
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitPlate(const HeightMap* heights,
  const HeightMap* weights, double wavelengthMm);

/// A plate's shape without a force.
enum class PlateShape
{
  Flat,
  Paraboloid ///< that of FitParaboloid
};

/// Of the heights a + b x + c z + d x^2 + e x z + f z^2 those nearest to the given ones, by weight.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitParaboloid(const HeightMap* heights,
  const HeightMap* weights);

/**
 * The same without outliers: fitted once for each scale, falling, mm, then with the weights times
 * Tukey's biweight (1 - (r / scale)^2)^2 of the residuals r, 0 beyond the scale.
 */
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FitRobustPlate(const HeightMap* heights,
  const HeightMap* weights, double wavelengthMm, const std::vector<double>& scalesMm,
  PlateShape shape = PlateShape::Flat);
}

#endif
