// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastColumns_h
#define mammoray_BreastColumns_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/**
 * Where, seen from the front, the breast is: pieces of tissue go into columns along the anterior
 * direction, and the tissue in front of the held tissue in each column is a height over the body.
 * The breast is the hill with the highest peak. Apart from it are hills behind a valley that is
 * deeper than a tenth of the peak's height (the other breast, the belly, the armpit's fold), and
 * what lies farther than three eighths of the peak's height from where the hill is a quarter as
 * high as its peak (flat tissue over the ribs: a breast slopes more).
 */
class MAMMORAYFOUNDATION_EXPORT BreastColumns
{
public:
  /// Places (left, anterior, superior), mm, in a box from `low` to `high`; pieces are smaller than
  /// `pieceMm`, or lie closer.
  BreastColumns(const Vector3& low, const Vector3& high, double pieceMm);
  /// A piece of tissue.
  void Add(const Vector3& place, bool isHeld);
  /// Finds the breast in all that was added.
  void Find();
  /// Whether the column of a place belongs to the breast.
  bool IsBreast(const Vector3& place) const { return this->Breast[this->ColumnOf(place)] != 0; }

private:
  std::size_t ColumnOf(const Vector3& place) const;
  /// Heights over the body, mm; negative where there is no tissue.
  std::vector<double> Heights() const;
  /// 1 for the columns of the highest hill.
  std::vector<char> HighestHill(const std::vector<double>& heights) const;
  /// Calls visit(column, steps to it) for the columns within so many steps along both directions.
  template <typename Visit>
  void Around(std::size_t column, int steps, Visit visit) const;

  Vector3 Low;
  double WidthMm;
  int Across;
  int Along;
  /// Ends of tissue and front of held tissue by column, mm.
  std::vector<double> Front;
  std::vector<double> Back;
  std::vector<double> HeldFront;
  std::vector<char> Breast;
};
}

#endif
