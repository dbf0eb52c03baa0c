// SPDX-License-Identifier: Apache-2.0
#include "Private/GantryGrid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace mammoray
{
namespace
{
/// Chest-wall side by Patient Orientation: the direction whose first letter is A or P leads from or
/// to it.
bool SideByHeader(const Mammogram& mammogram, Side& side)
{
  const auto first = [](const std::string& text) { return text.empty() ? ' ' : text[0]; };
  const char row = first(mammogram.RowDirection);
  const char column = first(mammogram.ColumnDirection);
  if (row == 'A' || row == 'P')
  {
    side = row == 'A' ? Side::Left : Side::Right;
    return true;
  }
  if (column == 'A' || column == 'P')
  {
    side = column == 'A' ? Side::Top : Side::Bottom;
    return true;
  }
  return false;
}

/// Where the chest wall is in the picture.
Side ChestWallSide(const Mammogram& mammogram, const std::array<double, 4>& touched,
  RegistrationTarget& target)
{
  const auto most = std::max_element(touched.begin(), touched.end());
  const Side seen = static_cast<Side>(most - touched.begin());
  Side side = seen;
  if (!SideByHeader(mammogram, side))
  {
    target.Warnings.push_back(std::string("The header gives no patient orientation; the chest wall "
                                          "is taken to be at the ") +
      NameOf(seen) + " edge of the picture, which the breast touches most.");
  }
  else if (touched[static_cast<int>(side)] < 0.5 * *most)
  {
    target.Disagreements.push_back(std::string("The header puts the chest wall at the ") +
      NameOf(side) + " edge of the picture, but the breast touches the " + NameOf(seen) +
      " edge most; the header is followed.");
  }
  return side;
}

bool IsKnown(char laterality)
{
  return laterality == 'L' || laterality == 'R';
}

/// Mammograms are hung with the left breast's chest wall at the left.
char AssumeLaterality(Side side, std::vector<std::string>& warnings)
{
  const char laterality = side == Side::Right ? 'R' : 'L';
  warnings.push_back(std::string("The header does not say which breast this is; taken as the ") +
    SideName(laterality) + " one, as mammograms are hung.");
  return laterality;
}

/// The roll of the view; `laterality` is assumed where the header does not say it and the view's
/// roll depends on it.
double RollOf(const Mammogram& mammogram, Side side, char& laterality,
  std::vector<std::string>& warnings)
{
  std::optional<double> roll = NominalRollDeg(mammogram);
  if (!roll)
  {
    Mammogram assumed = mammogram;
    if (!IsKnown(laterality))
    {
      laterality = AssumeLaterality(side, warnings);
      assumed.Laterality = laterality;
    }
    roll = NominalRollDeg(assumed);
    if (!roll)
    {
      roll = 0.0;
      warnings.push_back("The header's view '" + mammogram.View +
        "' is not one of CC, MLO, ML, LM, LMO, FB; taken as CC.");
    }
  }
  return *roll;
}

/// Gantry +x along the chest wall of a picture whose header does not say it, in the sense of
/// AlongX: hung with the lateral side (CC) or the head (other views) up.
double AssumedAlongX(Side side, double rollDeg, char laterality, std::vector<std::string>& warnings)
{
  const bool fromAbove = std::abs(std::cos(rollDeg * std::numbers::pi / 180)) > 0.9;
  const std::string down = !fromAbove ? "F" : laterality == 'L' ? "R" : "L";
  const bool upright = side == Side::Left || side == Side::Right;
  warnings.push_back(std::string("The header does not give the patient direction along the "
                                 "chest wall; the ") +
    (fromAbove ? "lateral side" : "head") + " is taken to be " +
    (upright ? "up" : "where it is after turning an upright picture") + ".");
  const double along = AlongX(down, rollDeg);
  // Turned pictures are taken as turned by 90 degrees from the way mammograms are hung.
  return side == Side::Top ? -along : along;
}

/// The grid whose chest wall is at `side` and whose direction along it is that of +x where
/// `direction` is 1, and against it where it is -1.
void PlaceGrid(const PixelGrid& grid, Side side, double direction, RegistrationTarget& target)
{
  const double inward = side == Side::Left || side == Side::Top ? 1 : -1;
  if (side == Side::Left || side == Side::Right)
  {
    target.Grid.ColumnStep = { 0, inward * grid.ColumnSpacing };
    target.Grid.RowStep = { direction * grid.RowSpacing, 0 };
    target.Grid.Origin = { -0.5 * (grid.Rows - 1) * target.Grid.RowStep[0],
      inward > 0 ? 0.5 * grid.ColumnSpacing : (grid.Columns - 0.5) * grid.ColumnSpacing };
  }
  else
  {
    target.Grid.ColumnStep = { direction * grid.ColumnSpacing, 0 };
    target.Grid.RowStep = { 0, inward * grid.RowSpacing };
    target.Grid.Origin = { -0.5 * (grid.Columns - 1) * target.Grid.ColumnStep[0],
      inward > 0 ? 0.5 * grid.RowSpacing : (grid.Rows - 0.5) * grid.RowSpacing };
  }
}
}

double AlongX(const std::string& direction, double rollDeg)
{
  // Gantry x at roll r is cos r * left - sin r * superior (MammographyGeometry.h).
  const double roll = rollDeg * std::numbers::pi / 180;
  const double left = std::cos(roll);
  const double head = -std::sin(roll);
  double along = 0;
  for (const char letter : direction)
  {
    along += letter == 'L' ? left
      : letter == 'R'      ? -left
      : letter == 'H'      ? head
      : letter == 'F'      ? -head
                           : 0;
  }
  return along;
}

double PlaceInGantry(const Mammogram& mammogram, const PixelGrid& grid,
  const std::array<double, 4>& touched, RegistrationTarget& target)
{
  const Side side = ChestWallSide(mammogram, touched, target);
  char laterality = mammogram.Laterality;
  const double roll = RollOf(mammogram, side, laterality, target.Warnings);
  const bool upright = side == Side::Left || side == Side::Right;
  double along = AlongX(upright ? mammogram.ColumnDirection : mammogram.RowDirection, roll);
  if (std::abs(along) < 0.1)
  {
    if (!IsKnown(laterality))
    {
      laterality = AssumeLaterality(side, target.Warnings);
    }
    along = AssumedAlongX(side, roll, laterality, target.Warnings);
  }
  PlaceGrid(grid, side, along > 0 ? 1 : -1, target);
  return roll;
}
}
