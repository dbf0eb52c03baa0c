// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Mammogram.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
std::size_t ReceptorGrid::NumberOfPixels() const
{
  return static_cast<std::size_t>(std::max(this->Columns, 0)) *
    static_cast<std::size_t>(std::max(this->Rows, 0));
}

double ReceptorGrid::ColumnSpacingMm() const
{
  return std::hypot(this->ColumnStep[0], this->ColumnStep[1]);
}

double ReceptorGrid::RowSpacingMm() const
{
  return std::hypot(this->RowStep[0], this->RowStep[1]);
}

double ReceptorGrid::PixelAreaMm2() const
{
  return std::abs(this->ColumnStep[0] * this->RowStep[1] - this->ColumnStep[1] * this->RowStep[0]);
}

ReceptorPoint ReceptorGrid::PositionOf(double column, double row) const
{
  return { this->Origin[0] + column * this->ColumnStep[0] + row * this->RowStep[0],
    this->Origin[1] + column * this->ColumnStep[1] + row * this->RowStep[1] };
}

std::array<double, 2> ReceptorGrid::IndexOf(const ReceptorPoint& position) const
{
  const double dx = position[0] - this->Origin[0];
  const double dy = position[1] - this->Origin[1];
  const auto& c = this->ColumnStep;
  const auto& r = this->RowStep;
  const double determinant = c[0] * r[1] - c[1] * r[0];
  return { (dx * r[1] - dy * r[0]) / determinant, (c[0] * dy - c[1] * dx) / determinant };
}

bool ReceptorGrid::Contains(const ReceptorPoint& position, double marginMm) const
{
  const auto [column, row] = this->IndexOf(position);
  const double columnMargin = marginMm / this->ColumnSpacingMm() - 0.5;
  const double rowMargin = marginMm / this->RowSpacingMm() - 0.5;
  return column >= columnMargin && column <= this->Columns - 1 - columnMargin && row >= rowMargin &&
    row <= this->Rows - 1 - rowMargin;
}

ReceptorGrid ReceptorGrid::Coarsened(int factor) const
{
  ReceptorGrid coarse;
  coarse.Columns = this->Columns / factor;
  coarse.Rows = this->Rows / factor;
  coarse.Origin = this->PositionOf(0.5 * (factor - 1), 0.5 * (factor - 1));
  for (int axis = 0; axis < 2; ++axis)
  {
    coarse.ColumnStep[axis] = factor * this->ColumnStep[axis];
    coarse.RowStep[axis] = factor * this->RowStep[axis];
  }
  return coarse;
}

std::string SideName(char laterality)
{
  return laterality == 'L' ? "left" : laterality == 'R' ? "right" : "unnamed";
}

std::optional<double> NominalRollDeg(const Mammogram& mammogram)
{
  const std::string& view = mammogram.View;
  if (view == "CC" || view == "XCC" || view == "XCCL" || view == "XCCM")
  {
    return 0.0;
  }
  if (view == "FB")
  {
    return 180.0;
  }
  double size = 0;
  if (view == "ML" || view == "LM")
  {
    size = 90;
  }
  else if (view == "MLO" || view == "LMO")
  {
    // The sign of the header's angle depends on the side; only its magnitude is used.
    size = std::abs(mammogram.PositionerPrimaryAngleDeg.value_or(0));
    if (size == 0)
    {
      size = 45;
    }
    else if (size > 90)
    {
      size = 180 - size;
    }
  }
  else
  {
    return std::nullopt;
  }
  if (mammogram.Laterality != 'L' && mammogram.Laterality != 'R')
  {
    return std::nullopt;
  }
  // A positive roll moves the source to the patient's left: the medial side of the right breast.
  const bool sourceMedial = view[0] == 'M';
  return (mammogram.Laterality == 'R') == sourceMedial ? size : -size;
}
}
