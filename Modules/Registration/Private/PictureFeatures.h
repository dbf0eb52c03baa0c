// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PictureFeatures_h
#define mammoray_PictureFeatures_h

#include "Private/ZScores.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// The compared features of a picture at some pixels, independent of its scale and offset; see
/// PictureComparison.
class MAMMORAYREGISTRATION_EXPORT PictureFeatures
{
public:
  /// `pixels`: those compared, rising, of a picture on `grid`'s pixels. `windowMm`: edge of
  /// Local's.
  PictureFeatures(PictureComparison kind, const ReceptorGrid& grid,
    const std::vector<std::size_t>& pixels, double windowMm);

  /// The features of one picture, and what their derivatives need.
  struct Found
  {
    std::vector<double> Values;
    ZScores Whole;
    /// Mean and standard deviation of each window.
    std::vector<double> Means;
    std::vector<double> Deviations;
  };

  std::size_t Size() const;
  /// The pixel of each feature, as a number in `pixels`; of a difference its first.
  std::vector<std::size_t> Places() const;
  Found Of(const std::vector<float>& image) const;
  /// Derivatives of the features at a picture, from those of its values at the pixels.
  std::vector<double> Differentiate(const Found& at, std::vector<double> derivatives) const;

private:
  /// A window's standard deviation is taken for no smaller than about this part of the whole
  /// picture's: where the breast is even, noise is all there is.
  static constexpr double LeastDeviation = 0.25;

  void FindWindows(const ReceptorGrid& grid, double windowMm);
  void FindNeighbours(const ReceptorGrid& grid);
  /// Differences of the pairs over their distances.
  std::vector<double> Differences(const std::vector<double>& values) const;
  double MeanOver(std::size_t window, const std::vector<double>& values) const;

  PictureComparison Kind;
  std::vector<std::size_t> Pixels;
  /// Local: the pixels (numbers in Pixels) of window w are Members[First[w]] to Members[First[w +
  /// 1]
  /// - 1].
  std::vector<std::size_t> First;
  std::vector<std::size_t> Members;
  /// Gradient: pairs of pixels (numbers in Pixels) beside each other, and their distance,
  /// mm.
  std::vector<std::array<std::size_t, 2>> Pairs;
  std::vector<double> Distances;
};
}

#endif
