// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastColumns_h
#define mammoray_BreastColumns_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace mammoray
{
/**
 * Locates the breast as seen from the front. Pieces of tissue are sorted into columns along the
 * anterior direction; the tissue in front of the fixed tissue in each column is a height over the
 * body. The breast is the hill with the highest peak. Two kinds of columns do not belong to it:
 * hills behind a valley deeper than a tenth of the peak's height (the other breast, the belly, the
 * armpit's fold), and columns farther than three eighths of the peak's height from the part of the
 * hill above a quarter of the peak, its core (flat tissue over the ribs: a breast slopes more). The
 * core does not depend on how much of the body around the breast is there.
 */
class MAMMORAYFOUNDATION_EXPORT BreastColumns
{
public:
  /// Positions (left, anterior, superior) are in mm in a box from `low` to `high`. Pieces are at
  /// most `pieceMm` large or apart.
  BreastColumns(const Vector3& low, const Vector3& high, double pieceMm);
  /// Adds a piece of tissue.
  void Add(const Vector3& place, bool isFixed);
  /// Finds the breast in all pieces that were added.
  void Find();
  /**
   * The lateral position between two breasts side by side, mm; nothing where there are none. The
   * second breast is a hill beside the highest, at least half as high and with a quarter of its
   * tissue, that rises 15 mm above the valley between the two.
   */
  std::optional<double> Midline() const;
  /// How far the front of the fixed tissue behind the breast comes forward per mm to the left and
  /// per mm to the head: of the least-squares plane through the columns of the breast's core; 0
  /// without fixed tissue.
  std::array<double, 2> WallSlopes() const;
  /// The middle of the core's columns; along the anterior direction the mean front of the fixed
  /// tissue, or 0 without any.
  Vector3 Middle() const;
  /// True if the column of a position belongs to the breast.
  bool IsBreast(const Vector3& place) const { return this->Breast[this->ColumnOf(place)] != 0; }

private:
  std::size_t ColumnOf(const Vector3& place) const;
  /// The core's columns: the mean position of their pieces across and along, and the front of the
  /// fixed tissue (infinite where there is none).
  std::vector<Vector3> CoreColumns() const;
  /// Heights over the body, mm; negative without tissue.
  std::vector<double> Heights() const;
  /// The column of its hill's peak for each column; NoHill without tissue.
  std::vector<std::size_t> Hills(const std::vector<double>& heights) const;
  /// Calls visit(column, distance in steps) for the columns within `steps` in both directions.
  template <typename Visit>
  void VisitNear(std::size_t column, int steps, Visit visit) const;

  static constexpr auto NoHill = std::numeric_limits<std::size_t>::max();

  Vector3 Low;
  double WidthMm;
  int CountAcross;
  int CountAlong;
  /// Front and back of the tissue and front of the fixed tissue in each column, mm.
  std::vector<double> Front;
  std::vector<double> Back;
  std::vector<double> FixedFront;
  /// Sums of the lateral and longitudinal positions of the pieces, and their number.
  std::vector<Vector3> Sums;
  std::vector<char> Core;
  std::vector<char> Breast;
};
}

#endif
