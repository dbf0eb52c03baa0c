// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AirLevel_h
#define mammoray_AirLevel_h

#include "Private/PixelMask.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <vector>

namespace mammoray
{
/**
 * The level of air in a picture, where it slopes: the heel of the anode (a fifth from the chest
 * wall to the far edge), the inverse square of the distance and the way through the filter change
 * it smoothly over the whole picture; scattered photons brighten the air beside the breast, over
 * some centimetres.
 *
 * The former, `At`, is a polynomial of second degree in the receptor's coordinates, fitted to the
 * medians of air in blocks of a centimetre by iteratively reweighted least squares (Huber, 1964);
 * blocks near the breast count less, for the scatter, and a weak prior holds slopes and curvatures
 * so that it stays tame where no air is seen. It can be taken from the whole picture. The latter is
 * what is left near a place, `LocalAt`: the mean remainder of the blocks around, which matters for
 * the breast's edge only.
 */
class MAMMORAYREGISTRATION_EXPORT AirLevel
{
public:
  /**
   * `values`: one for each pixel, in any unit; `air`: the pixels to fit to, at least one;
   * `contrast`: of the breast above the air, same unit, positive, which says how large a slope is
   * to be expected (0.15 of it over 100 mm) and how little matters (0.001 of it).
   */
  AirLevel(const PixelGrid& grid, const std::vector<float>& values, const PixelMask& air,
    double contrast);

  /// The smooth level at a pixel's centre.
  double At(int column, int row) const;
  /// The level including the scatter there.
  double LocalAt(int column, int row) const;
  /// Robust standard deviation of air within a block.
  double Sigma() const { return this->Deviation; }

private:
  struct Block
  {
    double X = 0; // 100 mm, from the middle of the picture
    double Y = 0;
    /// Median of what its air is above the polynomial found so far.
    double Remainder = 0;
    /// To the nearest block that is not all air, mm.
    double Away = 0;
  };

  void GatherBlocks(const std::vector<float>& values, const PixelMask& air);
  void MeasureBlock(int across, int down, const std::vector<float>& values, const PixelMask& air,
    std::vector<float>& found, Block& block) const;
  void FitPolynomial(double contrast);
  void SpreadRemainders();
  double Polynomial(double x, double y) const;
  double ColumnToX(double column) const;
  double RowToY(double row) const;

  PixelGrid Grid;
  int BlockColumns = 1;
  int BlockRows = 1;
  std::vector<Block> Blocks;
  std::array<double, 6> Coefficients{};
  double Deviation = 0;
  /// Remainders at the centres of all blocks, also those without air; row by row.
  int CountAcross = 1;
  int CountDown = 1;
  std::vector<double> Remainders;
};
}

#endif
